! SPDX-License-Identifier: MIT
!> Bodies that carry particles, on the GPU: the host moves them, the GPU sums what the gas does.
module brz_gpu_coupling_carriers
    use brz_carrier_motion, only: foresee_carriers, read_carriers
    use brz_carrier_rules, only: carrier_t, carries_all, carries_none, n_push
    use brz_coupling_state, only: coupling_t
    use brz_coupling_launches, only: launch_sum_carriers
    use brz_device, only: copy_in, kernel_t
    use brz_errors, only: error_t
    use brz_gpu_coupling_state, only: fold_rows, gpu_coupling_t, particles_t
    use brz_kinds, only: dp, int64
    use brz_solid_state, only: solid_t
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
        real(dp) :: shift(3, gpu%bodies)
        integer :: b

        call read_carriers(solid, coupling%carrier)
        if (all(coupling%carrier%carries == carries_none)) return
        call sum_over(gpu, gpu%shift, particles, shift, err)
        do b = 1, gpu%bodies
            if (coupling%carrier(b)%carries == carries_all) coupling%carrier(b)%centre = &
                coupling%carrier(b)%centre + shift(:, b)/solid%bodies(b)%rigid%mass
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

        if (all(coupling%carrier%carries == carries_none)) return
        push = 0
        if (any(coupling%carrier%carries == carries_all)) &
            call sum_over(gpu, gpu%push, particles, push, err)
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
        real(dp) :: load(6, gpu%bodies)
        integer :: b

        if (all(coupling%carrier%carries == carries_none)) return
        call sum_over(gpu, gpu%load, particles, load, err)
        do b = 1, gpu%bodies
            solid%bodies(b)%rigid%load = load(:, b)
        end do
    end subroutine load_gpu_carriers

    !> Sums over the particles of each body, in a fixed order.
    subroutine sum_over(gpu, kernel, particles, sums, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(kernel_t), intent(in) :: kernel !! one of sum_carriers
        type(particles_t), intent(in) :: particles
        real(dp), intent(out) :: sums(:, :) !! (sums, bodies)
        type(error_t), intent(inout) :: err
        real(dp) :: part(size(sums, 2)*fold_rows, size(sums, 1))

        call launch_sum_carriers(kernel, [gpu%carrier_threads, gpu%bodies, 1], particles%n, &
            gpu%bodies, gpu%carrier_threads, particles%load, gpu%box, gpu%carrier, gpu%gas, &
            gpu%home, gpu%above, particles%place, particles%state, particles%tag, gpu%surface, &
            gpu%weight, gpu%force, gpu%impedance, gpu%carrier_part, err)
        call gpu%common%fold(gpu%carrier_part, size(sums, 2)*gpu%carrier_threads, part, err)
        sums = transpose(sum(reshape(part, [size(sums, 2), fold_rows, size(sums, 1)]), 2))
    end subroutine sum_over
end module brz_gpu_coupling_carriers
