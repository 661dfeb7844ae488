! SPDX-License-Identifier: MIT
!> What driven bodies take up first on the GPU, smoothing lengths that vary, and how many
!> intact neighbours particles have left.
module brz_gpu_solid_motion
    use brz_errors, only: error_t
    use brz_formulation_names, only: form_bending
    use brz_gpu_solid_state, only: threads_of
    use brz_solid_device, only: solid_device_t
    use brz_gpu_solid_diagnostics, only: add_held_impulse
    use brz_intact_share, only: intact_share
    use brz_gpu_solid_tiles, only: lay_tiles, threads_of_kinds
    use brz_kinds, only: dp, rk
    use brz_lists, only: put_changed => put_changed_table
    use brz_motion_launches, only: motion_kernels
    use brz_solid_launches, only: solid_kernels
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: drift_tiles, record_first_half, size_particles, end_support

contains

    !> Kick and drift of all bodies that are active and not rigid, in one launch.
    subroutine drift_tiles(gpu, solid, dt, unit, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! [s]
        real(dp), intent(in) :: unit(:) !! (bodies) of levels of motion [m]
        type(error_t), intent(inout) :: err
        real(dp) :: drifts(4, size(unit))
        integer :: b, threads(3)

        do b = 1, size(unit)
            drifts(:, b) = [solid%bodies(b)%drift, unit(b)]
        end do
        call put_changed(transfer(drifts, [0]), gpu%drifts_there, gpu%drifts, err)
        call lay_tiles(gpu, err)
        threads = threads_of_kinds(gpu%kinds)
        if (threads(1) == 0) return
        call solid_kernels%solid_drift(threads, gpu%stride_d, gpu%tiles, gpu%params, gpu%drifts, &
            real((solid%dt_last + dt)/2, rk), dt, merge(1, 0, gpu%column%load > 0), gpu%a, &
            gpu%load, gpu%mass, gpu%fixed, gpu%built, gpu%place, gpu%motion, gpu%work, gpu%moved, &
            err)
    end subroutine drift_tiles

    !> What driven bodies take up in the first half step.
    subroutine record_first_half(gpu, solid, dt, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: force(3)
        integer :: b

        do b = 1, size(gpu%bodies)
            if (solid%bodies(b)%motion%n > 0 .and. .not. gpu%bodies(b)%rigid) &
                call add_held_impulse(gpu, solid, b, dt, force, err)
        end do
    end subroutine record_first_half

    !> Smoothing lengths that follow the density.
    subroutine size_particles(gpu, solid, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            associate (body => solid%bodies(b), there => gpu%bodies(b))
                if (there%inactive .or. there%rigid .or. .not. body%variable) cycle
                call motion_kernels%size_particle(there%last - there%first + 1, there%first, &
                    solid%dimension, body%h, body%h_range(1), body%h_range(2), gpu%mu, gpu%x, err)
            end associate
        end do
    end subroutine size_particles

    !> End the stiff hourglass force, and the tilt, for good where half of the intact neighbours are
    !> gone.
    subroutine end_support(gpu, solid, anew, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(in) :: solid
        logical, intent(in) :: anew(:) !! (bodies) whose lists were built anew
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            if (.not. anew(b)) cycle
            if (solid%bodies(b)%formulation /= form_bending .and. .not. gpu%bodies(b)%in_tension) &
                cycle
            associate (body => gpu%bodies(b))
                call solid_kernels%solid_end_support(threads_of(body), gpu%stride_d, body%params, &
                    intact_share, body%slice, gpu%count, body%list, gpu%reference, gpu%state, &
                    gpu%tag, err)
            end associate
        end do
    end subroutine end_support
end module brz_gpu_solid_motion
