! SPDX-License-Identifier: MIT
!> Particles on several GPUs that are marked for other processes: those that leave, and those that
!> others need as ghosts. The host hears how many there are.
module brz_gpu_solid_marks
    use brz_buffers, only: doubles_t, from, integers_t
    use brz_device, only: clear_buffer, copy_out, free_buffers, put_buffer, reserve_buffer
    use brz_errors, only: error_t
    use brz_ghost_wants, only: planes_of, wants_of
    use brz_gpu_parcels, only: gpu_places_t
    use brz_gpu_solid_layout, only: tag_fixed
    use brz_gpu_solid_state, only: gpu_solid_t, tags_of
    use brz_kinds, only: dp, int64
    use brz_solid_state, only: is_gone, solid_t
    implicit none
    private
    public :: mark_leaving, mark_ghosts, list_marks, find_firsts

contains

    !> Mark the particles of some bodies that leave, and count them.
    subroutine mark_leaving(gpu, solid, which, number, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        type(doubles_t) :: region
        integer :: b

        call begin_marks(gpu, solid, err)
        call put_buffer(solid%part%region, region, 48_int64*solid%ranks%n, err)
        do b = 1, size(which)
            associate (body => gpu%bodies(b))
                if (which(b)) call gpu%homes%mark_home(body%last - body%first + 1, body%first, &
                    gpu%n, solid%ranks%n, solid%ranks%rank, region, gpu%built, gpu%mark, err)
            end associate
        end do
        call free_buffers(region)
        call count_marks(gpu, solid, number, err)
    end subroutine mark_leaving

    !> Mark the particles that others have ghosts of, and count them.
    subroutine mark_ghosts(gpu, solid, number, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        type(doubles_t) :: region, wants
        real(dp), allocatable :: want(:, :)
        integer :: b, r

        call begin_marks(gpu, solid, err)
        call put_buffer(solid%part%region, region, 48_int64*solid%ranks%n, err)
        do b = 1, size(number, 1)
            want = wants_of(solid, b)
            if (size(want) == 0) cycle
            call put_buffer(want, wants, 8_int64*size(want), err)
            do r = 0, solid%ranks%n - 1
                if (r == solid%ranks%rank) cycle
                associate (body => gpu%bodies(b))
                    call gpu%homes%mark_near(body%last - body%first + 1, body%first, is_gone, &
                        planes_of(solid), size(want, 2), wants, from(region, 6_int64*r + 1), &
                        gpu%built, tags_of(gpu, tag_fixed), from(gpu%mark, int(gpu%n, int64)*r &
                        + 1), err)
                end associate
            end do
            call free_buffers(wants)
        end do
        call free_buffers(region)
        call count_marks(gpu, solid, number, err)
    end subroutine mark_ghosts

    !> No place is marked for any process.
    subroutine begin_marks(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        bytes = 4*(int(gpu%n, int64)*solid%ranks%n + 1)
        call reserve_buffer(gpu%mark, bytes, err)
        call clear_buffer(gpu%mark, err, bytes)
    end subroutine begin_marks

    !> How many places of each body are marked for each process. Marks become running sums.
    subroutine count_marks(gpu, solid, number, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        integer :: at(size(number) + 1), b, r
        type(integers_t) :: ends, sums

        call gpu%common%running_sum(gpu%mark, gpu%n*solid%ranks%n, err)
        at = [((gpu%bodies(b)%first + r*gpu%n, b=1, size(number, 1)), r=0, solid%ranks%n - 1), &
              gpu%n*solid%ranks%n + 1]
        call put_buffer(at, ends, 4_int64*size(at), err)
        call put_buffer(at, sums, 4_int64*size(at), err)
        call gpu%ghosts%kernels%pick_words(size(at), 1, 1, 0_int64, 1, 0, ends, gpu%mark, sums, err)
        at = 0
        call copy_out(sums, at, 4_int64*size(at), err)
        call free_buffers(ends, sums)
        number = reshape(at(2:) - at(:size(at) - 1), shape(number))
    end subroutine count_marks

    !> The marked places, process by process.
    subroutine list_marks(gpu, number, list, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        call find_firsts(number, list%first)
        call reserve_buffer(list%place, 4*max(sum(number), 1_int64), err)
        if (sum(number) > 0) call gpu%ghosts%kernels%list_marked(gpu%n*size(number, 2), gpu%n, &
            gpu%mark, list%place, err)
    end subroutine list_marks

    !> First entry of the parcel of each process.
    pure subroutine find_firsts(number, first)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, allocatable, intent(out) :: first(:) !! (0:processes)
        integer :: r

        allocate (first(0:size(number, 2)))
        first(0) = 1
        do r = 1, size(number, 2)
            first(r) = first(r - 1) + int(sum(number(:, r)))
        end do
    end subroutine find_firsts
end module brz_gpu_solid_marks
