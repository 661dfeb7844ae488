! SPDX-License-Identifier: MIT
!> How the particles move on the GPU: what is to be done at the begin of a step, kick and drift, how
!> far they have gone since their lists were built, and how many intact neighbours they have left.
module brz_gpu_solid_motion
    use brz_device, only: clear_buffer, copy_out
    use brz_errors, only: error_t
    use brz_gpu_cohesive_steps, only: cohesive_pass
    use brz_gpu_solid_contact, only: contact_pass
    use brz_gpu_solid_ghosts, only: refresh_rows
    use brz_gpu_solid_layout, only: book_load
    use brz_gpu_solid_passes, only: gradient_pass
    use brz_gpu_solid_state, only: book_of, gpu_solid_t, moved_flags, threads_of
    use brz_gpu_solid_sums, only: add_held_impulse
    use brz_kinds, only: dp, int64, rk
    use brz_list_drift, only: level_unit
    use brz_motion_launches, only: motion_kernels
    use brz_move_level, only: move_levels
    use brz_solid_launches, only: solid_kernels
    use brz_solid_state, only: form_bending, intact_share, solid_t
    implicit none
    private
    public :: begin_step, book_first_half, kick_bodies, find_levels, end_support

contains

    !> The GPU goes on from what the host handed over, or from its last step.
    subroutine begin_step(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        ! of bodies that sleep, too
        if (.not. gpu%stepped) call gradient_pass(gpu, solid, 0.0_dp, err)
        gpu%bodies%asleep = solid%bodies%asleep
        gpu%fetched = .false.
        gpu%stepped = .true.
        gpu%summed = .false.
        gpu%points_fetched = .false.
        if (solid%steps > 0) return
        call refresh_rows(gpu, solid, err)
        call cohesive_pass(gpu, solid, err)
        call contact_pass(gpu, solid, 0.0_dp, err)
    end subroutine begin_step

    !> What driven bodies take up in the first half step.
    subroutine book_first_half(gpu, solid, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: force(3)
        integer :: b

        do b = 1, size(gpu%bodies)
            if (solid%bodies(b)%motion%n > 0 .and. .not. gpu%bodies(b)%rigid) &
                call add_held_impulse(gpu, solid, b, dt, force, err)
        end do
    end subroutine book_first_half

    !> Velocity by the mean of the last and this time step, then position, and how far the particles
    !> have gone; of rigid bodies that alone.
    subroutine kick_bodies(gpu, solid, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: dt
        type(error_t), intent(inout) :: err
        real(dp) :: unit
        integer :: b, n

        call clear_buffer(gpu%flags, err)
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%asleep) cycle
            associate (body => solid%bodies(b), there => gpu%bodies(b))
                n = there%last - there%first + 1
                if (there%rigid) then
                    call motion_kernels%note_particle(n, there%first, 4, level_unit(solid), &
                        body%drift(1), body%drift(2), body%drift(3), gpu%x, gpu%built, &
                        moved_flags(gpu, b), err)
                    cycle
                end if
                if (body%variable) call motion_kernels%size_particle(n, there%first, &
                    solid%dimension, body%h, body%h_range(1), body%h_range(2), gpu%mu, gpu%x, err)
                unit = merge(sqrt(huge(dt))/(2*move_levels), level_unit(solid), &
                             there%total .and. .not. gpu%linked)
                call motion_kernels%drift_particle(n, there%first, 4, gpu%n, 1, &
                    real((solid%dt_last + dt)/2, rk), dt, merge(1, 0, gpu%column%load > 0), unit, &
                    body%drift(1), body%drift(2), body%drift(3), gpu%a, gpu%load, gpu%mass, &
                    gpu%fixed, gpu%built, gpu%x, gpu%v, book_of(gpu, book_load), &
                    moved_flags(gpu, b), err)
            end associate
        end do
    end subroutine kick_bodies

    !> How far the particles of each body have moved relative to it since its list was built: the
    !> highest level of brz_list_drift, of this process.
    subroutine find_levels(gpu, solid, level, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        integer(int64), intent(out) :: level(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: flags(move_levels, size(solid%bodies)), b

        flags = 0
        call copy_out(moved_flags(gpu, 1), flags, 4_int64*size(flags), err)
        do b = 1, size(gpu%bodies)
            level(b) = findloc(flags(:, b), 1, dim=1, back=.true.)
        end do
    end subroutine find_levels

    !> End the stiff hourglass force, and the tilt, for good where half of the intact neighbours are
    !> gone.
    subroutine end_support(gpu, solid, anew, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        logical, intent(in) :: anew(:) !! (bodies) whose lists were built anew
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            if (.not. anew(b)) cycle
            if (solid%bodies(b)%formulation /= form_bending .and. .not. gpu%bodies(b)%drawn) cycle
            associate (body => gpu%bodies(b))
                call solid_kernels%solid_end_support(threads_of(body), gpu%n, body%params, &
                    intact_share, body%slice, gpu%count, body%list, gpu%reference, gpu%state, &
                    gpu%tag, err)
            end associate
        end do
    end subroutine end_support
end module brz_gpu_solid_motion
