! SPDX-License-Identifier: MIT
!> Particles of rigid bodies on the GPU: what brz_rigid_steps leaves to each backend.
module brz_gpu_solid_rigid
    use brz_device, only: clear_buffer
    use brz_buffers, only: doubles_t, from, integers_t
    use brz_errors, only: error_t
    use brz_gpu_solid_layout, only: at_drag, at_stiff, book_contact_heat
    use brz_gpu_solid_state, only: book_of, gpu_solid_t
    use brz_kinds, only: dp, int64
    use brz_motion_launches, only: motion_kernels
    use brz_rigid_pose, only: resting_pose
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: fill_rigid, sum_pushes, settle_drag

contains

    !> What contact gathers of the particles of body b.
    subroutine fill_rigid(gpu, solid, b, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        associate (there => gpu%bodies(b), n => gpu%bodies(b)%last - gpu%bodies(b)%first + 1)
            call motion_kernels%fill_rigid_row(n, there%first, 4, &
                resting_pose(solid%bodies(b)%rigid), gpu%volume, gpu%pair, err)
            ! the host knows its time step
            call clear_buffer(from(gpu%rate, int(there%first, int64)), err, 8_int64*n)
        end associate
    end subroutine fill_rigid

    !> Force and torque on rigid bodies by contact and interfaces.
    subroutine sum_pushes(gpu, solid, dt, push, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(out) :: push(6, size(gpu%bodies)) !! [N], [N m]
        type(error_t), intent(inout) :: err
        integer :: b

        push = 0
        do b = 1, merge(size(gpu%bodies), 0, gpu%linked)
            associate (there => gpu%bodies(b))
                if (.not. there%rigid .or. there%asleep .and. dt > 0) cycle
                call motion_kernels%sum_pairs(there%last - there%first + 1, there%first, gpu%wide, &
                    0, gpu%n, 1, at_drag, at_stiff, 0, resting_pose(solid%bodies(b)%rigid), &
                    integers_t(), integers_t(), integers_t(), doubles_t(), gpu%x, gpu%extra, &
                    gpu%exact, err)
                push(:, b) = gpu%exact%total(:6)
            end associate
        end do
    end subroutine sum_pushes

    !> The heat of drag on their particles.
    subroutine settle_drag(gpu, solid, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err
        real(dp) :: turn(3)
        integer :: b

        do b = 1, merge(size(gpu%bodies), 0, gpu%linked)
            associate (there => gpu%bodies(b))
                if (.not. there%rigid .or. there%asleep) cycle
                turn = solid%bodies(b)%rigid%omega - solid%bodies(b)%rigid%spin
                call motion_kernels%settle_heat(there%last - there%first + 1, there%first, gpu%n, &
                    dt, turn(1), turn(2), turn(3), gpu%mass, gpu%extra, gpu%a, gpu%energy, &
                    book_of(gpu, book_contact_heat), err)
            end associate
        end do
    end subroutine settle_drag
end module brz_gpu_solid_rigid
