! SPDX-License-Identifier: MIT
!> Particles on several GPUs that are marked for other processes: those that leave, and those that
!> others need as ghosts.
module brz_gpu_solid_marks
    use brz_buffers, only: doubles_t, from
    use brz_device, only: copy_in, reserve_buffer
    use brz_errors, only: error_t
    use brz_ghost_wants, only: inhabited, planes_of, wants_of
    use brz_gpu_marks, only: begin_marks, count_marks
    use brz_gpu_solid_state, only: gpu_solid_t
    use brz_home_launches, only: home_kernels
    use brz_kinds, only: dp, int64
    use brz_solid_state, only: is_gone, solid_t
    implicit none
    private
    public :: mark_leaving, mark_ghosts

contains

    !> Mark the particles of some bodies that leave, and count them.
    subroutine mark_leaving(gpu, solid, which, number, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        integer :: b

        call begin_marks(gpu%n, solid%ranks%n, gpu%marks, err)
        call put_doubles(solid%part%region, gpu%marks%regions, size(solid%part%region), err)
        do b = 1, size(which)
            associate (body => gpu%bodies(b))
                if (which(b)) call home_kernels%mark_home(body%last - body%first + 1, &
                    body%first, gpu%n, solid%ranks%n, solid%ranks%rank, gpu%marks%regions, &
                    gpu%built, gpu%marks%mark, err)
            end associate
        end do
        call count_marks(gpu%n, gpu%bodies%first, gpu%common, gpu%marks, number, err)
    end subroutine mark_leaving

    !> Mark the particles that others have ghosts of, and count them.
    subroutine mark_ghosts(gpu, solid, number, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        real(dp) :: regions(3, 2, 0:solid%ranks%n - 1)
        real(dp), allocatable :: want(:, :)
        integer :: b, r

        call begin_marks(gpu%n, solid%ranks%n, gpu%marks, err)
        do b = 1, size(gpu%bodies)
            associate (lowest => merge(gpu%bodies(b)%box(:, 1), -huge(1.0_dp), solid%mirror))
                if (b == 1) solid%part%lowest = lowest
                solid%part%lowest = min(solid%part%lowest, lowest)
            end associate
        end do
        do r = 0, solid%ranks%n - 1
            regions(:, :, r) = inhabited(solid, solid%part%region(:, :, r))
        end do
        call put_doubles(regions, gpu%marks%regions, size(regions), err)
        do b = 1, size(number, 1)
            want = wants_of(solid, b)
            if (size(want) == 0) cycle
            call put_doubles(want, gpu%marks%wants, size(want), err)
            do r = 0, solid%ranks%n - 1
                if (r == solid%ranks%rank) cycle
                associate (body => gpu%bodies(b))
                    call home_kernels%mark_near(body%last - body%first + 1, body%first, &
                        is_gone, planes_of(solid), size(want, 2), gpu%marks%wants, &
                        from(gpu%marks%regions, 6_int64*r + 1), gpu%built, gpu%fixed, &
                        from(gpu%marks%mark, int(gpu%n, int64)*r + 1), err)
                end associate
            end do
        end do
        call count_marks(gpu%n, gpu%bodies%first, gpu%common, gpu%marks, number, err)
    end subroutine mark_ghosts

    !> A small table, into a buffer with room for it.
    subroutine put_doubles(x, buffer, n, err)
        real(dp), intent(in) :: x(*)
        type(doubles_t), intent(inout) :: buffer
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err

        call reserve_buffer(buffer, 8_int64*n, err)
        call copy_in(x(:n), buffer, 8_int64*n, err)
    end subroutine put_doubles
end module brz_gpu_solid_marks
