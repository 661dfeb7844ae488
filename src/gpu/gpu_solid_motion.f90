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
    use brz_kinds, only: dp
    use brz_motion_launches, only: motion_kernels
    use brz_solid_launches, only: solid_kernels
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: record_first_half, size_particles, end_support

contains

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
