! SPDX-License-Identifier: MIT
!> Regions of bodies whose velocity is prescribed, on the GPU.
module brz_gpu_solid_regions
    use brz_device, only: clear_buffer
    use brz_drive, only: begin_motion, end_motion
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_layout, only: at_accel, tag_fixed
    use brz_gpu_solid_state, only: column_of, gpu_solid_t, tags_of
    use brz_kinds, only: dp
    use brz_motion, only: velocity_of
    use brz_solid_state, only: ledger_t, solid_t
    implicit none
    private
    public :: move_gpu_regions, balance_gpu_regions

contains

    !> Carry the regions of body b along that are moved.
    subroutine move_gpu_regions(gpu, solid, b, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(ledger_t) :: ledger
        real(dp) :: v(3)
        integer :: m

        associate (body => solid%bodies(b), there => gpu%bodies(b))
            do m = 1, size(body%regions)
                ledger = body%ledger
                call begin_motion(body%regions(m), solid%time, dt, v, ledger)
                if (solid%ranks%rank == 0) body%ledger = ledger
                call gpu%moves%drive_particle(there%last - there%first + 1, there%first, 4, m, dt, &
                    v(1), v(2), v(3), tags_of(gpu, tag_fixed), gpu%place, gpu%motion, err)
            end do
        end associate
    end subroutine move_gpu_regions

    !> Forces of body b on these regions, the work of the half step up to now, and their velocities.
    subroutine balance_gpu_regions(gpu, solid, b, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(ledger_t) :: ledger
        real(dp) :: v(3), work
        integer :: m, n

        associate (body => solid%bodies(b), there => gpu%bodies(b))
            n = there%last - there%first + 1
            do m = 1, size(body%regions)
                call gpu%forces%sum_region(n, there%first, m, gpu%n, 1, &
                    merge(1, 0, gpu%load > 0), tags_of(gpu, tag_fixed), &
                    column_of(gpu, gpu%load + 1), column_of(gpu, gpu%grip + 1), &
                    gpu%exact, err)
                ledger = body%ledger
                call end_motion(body%regions(m), solid%time, dt, gpu%exact%total(:6), ledger, work)
                if (solid%ranks%rank == 0) then ! it books the work
                    body%ledger = ledger
                    ! that on free particles is in `book`, and added to this
                    gpu%ledger(b)%load = gpu%ledger(b)%load + work
                end if
                v = velocity_of(body%regions(m), solid%time)
                call gpu%moves%follow_drive(n, there%first, 4, m, gpu%n, 1, dt, v(1), v(2), v(3), &
                    tags_of(gpu, tag_fixed), gpu%motion, column_of(gpu, at_accel + 1), err)
            end do
        end associate
    end subroutine balance_gpu_regions
end module brz_gpu_solid_regions
