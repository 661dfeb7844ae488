! SPDX-License-Identifier: MIT
!> Places that are marked for other processes, a row of marks for each process, and lists of them.
!> The host hears how many there are.
module brz_gpu_marks
    use brz_buffers, only: integers_t
    use brz_device, only: clear_buffer, copy_out, free_buffers, put_buffer, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_parcels, only: gpu_places_t
    use brz_kinds, only: int64
    use brz_place_launches, only: place_kernels_t
    implicit none
    private
    public :: begin_marks, count_marks, list_marks, find_firsts

contains

    !> No place is marked for any process.
    subroutine begin_marks(n, processes, mark, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: processes
        type(integers_t), intent(inout) :: mark
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        bytes = 4*(int(n, int64)*processes + 1)
        call reserve_buffer(mark, bytes, err)
        call clear_buffer(mark, err, bytes)
    end subroutine begin_marks

    !> How many places of each body are marked for each process. Marks become running sums.
    subroutine count_marks(n, first, common, kernels, mark, number, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: first(:) !! (bodies) their first places
        type(gpu_common_t), intent(inout) :: common
        type(place_kernels_t), intent(in) :: kernels
        type(integers_t), intent(in) :: mark
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        integer :: at(size(number) + 1), b, r
        type(integers_t) :: ends, sums

        call common%running_sum(mark, n*size(number, 2), err)
        at = [((first(b) + r*n, b=1, size(first)), r=0, size(number, 2) - 1), &
              n*size(number, 2) + 1]
        call put_buffer(at, ends, 4_int64*size(at), err)
        call put_buffer(at, sums, 4_int64*size(at), err)
        call kernels%pick_words(size(at), 1, 1, 0_int64, 1, 0, ends, mark, sums, err)
        at = 0
        call copy_out(sums, at, 4_int64*size(at), err)
        call free_buffers(ends, sums)
        number = reshape(at(2:) - at(:size(at) - 1), shape(number))
    end subroutine count_marks

    !> The marked places, process by process.
    subroutine list_marks(n, number, kernels, mark, list, err)
        integer, intent(in) :: n !! places
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        type(place_kernels_t), intent(in) :: kernels
        type(integers_t), intent(in) :: mark !! running sums
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        call find_firsts(number, list%first)
        call reserve_buffer(list%place, 4*max(sum(number), 1_int64), err)
        if (sum(number) > 0) &
            call kernels%list_marked(n*size(number, 2), n, mark, list%place, err)
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
end module brz_gpu_marks
