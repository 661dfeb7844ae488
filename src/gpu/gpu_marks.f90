! SPDX-License-Identifier: MIT
!> Places that are marked for other processes, a row of marks for each process, and lists of them.
!> The host hears how many there are.
module brz_gpu_marks
    use brz_boxes, only: box_t
    use brz_buffers, only: doubles_t, integers_t
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_parcels, only: gpu_places_t, pick_rows, put_places, rows_of
    use brz_kinds, only: int64
    use brz_place_launches, only: place_kernels
    use brz_solid_part, only: find_firsts, find_pieces
    implicit none
    private
    public :: gpu_marks_t, asks_of, reserve_marks, begin_marks, count_marks, list_marks, &
        place_pieces

    type :: gpu_marks_t
        type(integers_t) :: mark !! (places, processes)
        type(integers_t) :: ends, sums !! of bodies, in a row; of the marks before
        type(integers_t) :: pieces, asks !! small tables
        type(doubles_t) :: region, wants !! others
    end type gpu_marks_t

contains

    !> Room for marks.
    subroutine reserve_marks(n, rows, marks, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: rows
        type(gpu_marks_t), intent(inout) :: marks
        type(error_t), intent(inout) :: err

        call reserve_buffer(marks%mark, 4*(int(n, int64)*rows + 1), err)
    end subroutine reserve_marks

    !> The same, and no place is marked.
    subroutine begin_marks(n, rows, marks, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: rows
        type(gpu_marks_t), intent(inout) :: marks
        type(error_t), intent(inout) :: err

        call reserve_marks(n, rows, marks, err)
        call clear_buffer(marks%mark, err, 4*int(n, int64)*rows)
    end subroutine begin_marks

    !> Boxes of cells as kernels are told them: lowest and highest cell.
    pure function asks_of(boxes) result(asks)
        type(box_t), intent(in) :: boxes(:)
        integer :: asks(6*size(boxes))
        integer :: r

        asks = [(boxes(r)%lo, boxes(r)%hi, r=1, size(boxes))]
    end function asks_of

    !> How many places of each body are marked for each process. Marks become running sums.
    subroutine count_marks(n, first, common, marks, number, err)
        integer, intent(in) :: n !! places
        integer, intent(in) :: first(:) !! (bodies) their first places
        type(gpu_common_t), intent(inout) :: common
        type(gpu_marks_t), intent(inout) :: marks
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        integer :: at(size(number) + 1), b, r

        call common%running_sum(marks%mark, n*size(number, 2), err)
        at = [((first(b) + r*n, b=1, size(first)), r=0, size(number, 2) - 1), &
              n*size(number, 2) + 1]
        call put_places(at, marks%ends, err)
        call reserve_buffer(marks%sums, 4_int64*size(at), err)
        call pick_rows([rows_of(marks%mark, 1)], marks%ends, size(at), marks%sums, err, wide=1)
        at = 0
        call copy_out(marks%sums, at, 4_int64*size(at), err)
        number = reshape(at(2:) - at(:size(at) - 1), shape(number))
    end subroutine count_marks

    !> The marked places, process by process.
    subroutine list_marks(n, number, marks, list, err)
        integer, intent(in) :: n !! places
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        type(gpu_marks_t), intent(in) :: marks !! running sums
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err

        call find_firsts(number, list%first)
        call reserve_buffer(list%place, 4*max(sum(number), 1_int64), err)
        if (sum(number) > 0) call place_kernels%list_marked(n*size(number, 2), n, marks%mark, &
                                                            list%place, err)
    end subroutine list_marks

    !> Places of what comes, that of a process and body in one piece, process by process.
    subroutine place_pieces(number, before, pieces, list, err)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, intent(inout) :: before(:) !! (bodies) places that are taken; these ones, too, then
        type(integers_t), intent(inout) :: pieces
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err
        integer :: n, piece(2, size(number))

        n = int(sum(number))
        call find_pieces(number, before, piece)
        call find_firsts(number, list%first)
        call reserve_buffer(list%place, 4*max(n, 1)*1_int64, err)
        call put_places(reshape(piece, [size(piece)]), pieces, err)
        call place_kernels%give_place(n, size(number), pieces, list%place, err)
    end subroutine place_pieces
end module brz_gpu_marks
