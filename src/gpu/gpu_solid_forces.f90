! SPDX-License-Identifier: MIT
!> Pass 2 on the GPU: accelerations by the internal forces, heat of the viscous ones, energy
!> accounts.
module brz_gpu_solid_forces
    use brz_device, only: side_by_side
    use brz_errors, only: error_t
    use brz_gpu_solid_state, only: threads_of
    use brz_solid_device, only: solid_device_t
    use brz_kinds, only: dp, rk
    use brz_solid_launches, only: launch_solid_forces
    use brz_particles, only: particles_t
    implicit none
    private
    public :: force_pass

contains

    !> Heat and energy accounts are those over dt, the step just made.
    subroutine force_pass(gpu, solid, dt, err)
        type(solid_device_t), intent(in) :: gpu
        class(particles_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer :: b, load

        load = gpu%column%load
        if (solid%steps == 0) load = 0 ! all of it acts after the half step up to here
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%rigid .or. gpu%bodies(b)%inactive) cycle
            call side_by_side(merge(b, 0, size(gpu%bodies) > 1))
            associate (body => gpu%bodies(b))
                call launch_solid_forces(body%forces, threads_of(body), gpu%stride_d, &
                    real(dt, rk), merge(1, 0, gpu%linked), load, body%params, gpu%place, gpu%near, &
                    gpu%far, gpu%motion, gpu%row, gpu%k_axes, gpu%control, body%slice, gpu%acting, &
                    body%pairs, gpu%extra, gpu%state, gpu%tag, gpu%diag, gpu%flags, err)
            end associate
        end do
        call side_by_side(0)
    end subroutine force_pass
end module brz_gpu_solid_forces
