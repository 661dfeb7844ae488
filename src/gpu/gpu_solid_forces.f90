! SPDX-License-Identifier: MIT
!> Pass 2 on the GPU: accelerations by the internal forces, heat of the viscous ones, energy
!> accounts.
module brz_gpu_solid_forces
    use brz_device, only: side_by_side
    use brz_errors, only: error_t
    use brz_gpu_solid_tiles, only: lay_tiles, threads_of_kind, tiles_of
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
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer :: k, load

        load = gpu%column%load
        if (solid%steps == 0) load = 0 ! all of it acts after the half step up to here
        call lay_tiles(gpu, err)
        do k = 1, size(gpu%kinds)
            associate (kind => gpu%kinds(k))
                if (kind%tiles == 0) cycle
                call side_by_side(merge(k, 0, size(gpu%kinds) > 1))
                call launch_solid_forces(gpu%bodies(kind%like)%forces, threads_of_kind(kind), &
                    gpu%stride_d, real(dt, rk), merge(1, 0, gpu%linked), load, &
                    tiles_of(gpu, kind), gpu%params, gpu%offsets, gpu%place, gpu%near, gpu%far, &
                    gpu%motion, gpu%row, gpu%k_axes, gpu%control, gpu%count, gpu%acting, &
                    gpu%count, gpu%extra, gpu%state, gpu%tag, gpu%diag, gpu%flags, err)
            end associate
        end do
        call side_by_side(0)
    end subroutine force_pass
end module brz_gpu_solid_forces
