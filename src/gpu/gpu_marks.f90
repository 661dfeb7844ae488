! SPDX-License-Identifier: MIT
!> Places that are marked for other processes, a row of marks for each process, and lists of them.
!> The host hears how many there are.
module brz_gpu_marks
    use brz_buffers, only: integers_t
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_parcels, only: gpu_places_t, put_places
    use brz_kinds, only: int64
    use brz_place_launches, only: place_kernels_t
    implicit none
    private
    public :: gpu_marks_t, begin_marks, count_marks, list_marks, find_firsts

    type :: gpu_marks_t
        type(integers_t) :: mark !! (places, processes)
        type(integers_t) :: ends, sums !! of bodies, in a row; of the marks before
    end type gpu_marks_t

contains

    !> No place is marked for any process.
    subroutine begin_marks(n, processes, marks, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: processes
        type(gpu_marks_t), intent(inout) :: marks
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        bytes = 4*(int(n, int64)*processes + 1)
        call reserve_buffer(marks%mark, bytes, err)
        call clear_buffer(marks%mark, err, bytes)
    end subroutine begin_marks

    !> How many places of each body are marked for each process. Marks become running sums.
    subroutine count_marks(n, first, common, kernels, marks, number, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: first(:) !! (bodies) their first places
        type(gpu_common_t), intent(inout) :: common
        type(place_kernels_t), intent(in) :: kernels
        type(gpu_marks_t), intent(inout) :: marks
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        integer :: at(size(number) + 1), b, r

        call common%running_sum(marks%mark, n*size(number, 2), err)
        at = [((first(b) + r*n, b=1, size(first)), r=0, size(number, 2) - 1), &
              n*size(number, 2) + 1]
        call put_places(at, marks%ends, err)
        call reserve_buffer(marks%sums, 4_int64*size(at), err)
        call kernels%pick_words(size(at), 1, 1, 0_int64, 1, 0, marks%ends, marks%mark, marks%sums, &
                                err)
        at = 0
        call copy_out(marks%sums, at, 4_int64*size(at), err)
        number = reshape(at(2:) - at(:size(at) - 1), shape(number))
    end subroutine count_marks

    !> The marked places, process by process.
    subroutine list_marks(n, number, kernels, marks, list, err)
        integer, intent(in) :: n !! places
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        type(place_kernels_t), intent(in) :: kernels
        type(gpu_marks_t), intent(in) :: marks !! running sums
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        call find_firsts(number, list%first)
        call reserve_buffer(list%place, 4*max(sum(number), 1_int64), err)
        if (sum(number) > 0) &
            call kernels%list_marked(n*size(number, 2), n, marks%mark, list%place, err)
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
