! SPDX-License-Identifier: MIT
!> Bodies that carry particles, on the GPU: the host moves them, the GPU sums what the gas does.
module brz_gpu_coupling_carriers
    use brz_carrier_motion, only: foresee_carriers, read_carriers
    use brz_carrier_rules, only: carrier_t, carries_all, carries_none, n_push
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, copy_in
    use brz_errors, only: error_t
    use brz_gpu_coupling_state, only: column_of, fold_rows, gpu_coupling_t, &
        particles_t, tags_of
    use brz_gpu_solid_layout, only: at_mass, tag_fixed
    use brz_kinds, only: dp, int64
    use brz_solid_state, only: solid_t
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: put_carriers, see_gpu_carriers, move_gpu_carriers, load_gpu_carriers

contains

    !> Motion of the bodies at the step, as see_carriers has it.
    subroutine see_gpu_carriers(gpu, particles, solid, coupling, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err
        real(dp) :: shift(3)
        integer :: b

        call read_carriers(solid, coupling%carrier)
        if (all(coupling%carrier%carries == carries_none)) return
        do b = 1, gpu%bodies
            associate (carrier => coupling%carrier(b))
                if (carrier%carries /= carries_all) cycle
                call clear_buffer(gpu%carrier_part, err)
                call gpu%carriers%sum_shift(carrier%last - carrier%first + 1, carrier%first, &
                    gpu%box, 4, particles%place, column_of(particles, at_mass), &
                    gpu%carrier_part, err)
                call add_up(gpu, shift, err)
                carrier%centre = carrier%centre + shift/solid%bodies(b)%rigid%mass
            end associate
        end do
        call put_carriers(gpu, coupling%carrier, err)
    end subroutine see_gpu_carriers

    subroutine put_carriers(gpu, carrier, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(carrier_t), intent(in) :: carrier(:)
        type(error_t), intent(inout) :: err

        call copy_in(carrier, gpu%carrier, size(carrier)*(storage_size(carrier, int64)/8), err)
    end subroutine put_carriers

    !> Bring the bodies to the middle of the coming step, as move_carriers does.
    subroutine move_gpu_carriers(gpu, particles, solid, coupling, dt, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the air [s]
        type(error_t), intent(inout) :: err
        real(dp) :: push(n_push, gpu%bodies)
        integer :: b

        if (all(coupling%carrier%carries == carries_none)) return
        push = 0
        do b = 1, gpu%bodies
            associate (carrier => coupling%carrier(b))
                if (carrier%carries /= carries_all) cycle
                call clear_buffer(gpu%carrier_part, err)
                call gpu%carriers%sum_push(carrier%last - carrier%first + 1, carrier%first, &
                    gpu%box, carrier, 4, gpu%cell_of, gpu%home, gpu%above, gpu%gas, gpu%surface, &
                    gpu%weight, gpu%force, gpu%impedance, particles%place, &
                    column_of(particles, at_mass), gpu%carrier_part, err)
                call add_up(gpu, push(:, b), err)
            end associate
        end do
        call foresee_carriers(solid, push, dt, coupling%carrier)
        call put_carriers(gpu, coupling%carrier, err)
    end subroutine move_gpu_carriers

    !> Force and torque of the air on the bodies that carry particles, as load_carriers has them.
    subroutine load_gpu_carriers(gpu, particles, solid, coupling, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, gpu%bodies
            associate (carrier => coupling%carrier(b))
                if (carrier%carries == carries_none) cycle
                call clear_buffer(gpu%carrier_part, err)
                call gpu%carriers%sum_air_load(carrier%last - carrier%first + 1, carrier%first, &
                    gpu%box, carrier, 4, particles%n, 1, tags_of(particles, tag_fixed), &
                    particles%place, column_of(particles, particles%load + 1), &
                    gpu%carrier_part, err)
                call add_up(gpu, solid%bodies(b)%rigid%load, err)
            end associate
        end do
    end subroutine load_gpu_carriers

    !> The sums of an item, in a fixed order.
    subroutine add_up(gpu, sums, err)
        type(gpu_coupling_t), intent(in) :: gpu
        real(dp), intent(out) :: sums(:)
        type(error_t), intent(inout) :: err
        real(dp) :: folded(fold_rows, size(sums))

        call gpu%common%fold(gpu%carrier_part, tally_threads, folded, err)
        sums = sum(folded, 1)
    end subroutine add_up
end module brz_gpu_coupling_carriers
