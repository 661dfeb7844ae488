! SPDX-License-Identifier: MIT
!> Places that are marked for other processes, a row of marks for each process, and lists of them.
!> On a GPU the host hears how many there are.
module brz_send_lists
    use brz_errors, only: error_t
    use brz_kinds, only: int64
    use brz_lists, only: at_least, clear_list, put_changed, put_list, read_first, &
        running_sum, swap
    use brz_mark_loop_bodies, only: marks_of_a_chunk
    use brz_mark_loops, only: for_each_count_chunk, for_each_list_chunk, for_each_marked_before
    use brz_place_loops, only: for_each_give_place, for_each_join_place
    use brz_places, only: find_firsts, find_joined, find_pieces, marks_t, message_buffers_t
    implicit none
    private
    public :: reserve_marks, begin_marks, count_marks, list_marks, place_pieces, join_lists

contains

    !> Room for marks.
    subroutine reserve_marks(on_gpu, n, rows, marks, err)
        logical, intent(in) :: on_gpu
        type(error_t), intent(inout) :: err
        integer, intent(in) :: n !! places
        integer, intent(in) :: rows
        type(marks_t), intent(inout) :: marks

        call at_least(on_gpu, marks%mark, n*rows, err)
    end subroutine reserve_marks

    !> The same, and no place is marked.
    subroutine begin_marks(on_gpu, n, rows, marks, err)
        logical, intent(in) :: on_gpu
        type(error_t), intent(inout) :: err
        integer, intent(in) :: n !! places
        integer, intent(in) :: rows
        type(marks_t), intent(inout) :: marks

        call reserve_marks(on_gpu, n, rows, marks, err)
        call clear_list(on_gpu, n*rows, marks%mark, err)
    end subroutine begin_marks

    !> How many places of each body are marked for each process. Chunks of marks get running sums.
    subroutine count_marks(on_gpu, n, first, marks, number, err)
        logical, intent(in) :: on_gpu
        type(error_t), intent(inout) :: err
        integer, intent(in) :: n !! places
        integer, dimension(:), intent(in) :: first !! (bodies) their first places, on the host
        type(marks_t), intent(inout) :: marks
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        integer :: at(size(number) + 1), b, chunks, r

        associate (m => n*size(number, 2))
            chunks = chunks_of(m)
            call at_least(on_gpu, marks%before, chunks + 1, err)
            call for_each_count_chunk(on_gpu, chunks, m, marks%mark, marks%before, err)
            call running_sum(on_gpu, marks%before, chunks, err)
            at = [((first(b) + r*n, b=1, size(first)), r=0, size(number, 2) - 1), m + 1]
        end associate
        call put_changed(on_gpu, at, marks%ends_there, marks%ends, err)
        call at_least(on_gpu, marks%sums, size(at), err)
        call for_each_marked_before(on_gpu, size(at), marks%ends, marks%mark, marks%before, &
            marks%sums, err)
        call read_first(on_gpu, size(at), marks%sums, at, err)
        number = reshape(at(2:) - at(:size(at) - 1), shape(number))
    end subroutine count_marks

    !> The marked places, process by process.
    subroutine list_marks(on_gpu, n, number, marks, list, err)
        logical, intent(in) :: on_gpu
        type(error_t), intent(inout) :: err
        integer, intent(in) :: n !! places
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        type(marks_t), intent(in) :: marks !! that are counted
        type(message_buffers_t), intent(inout) :: list

        call find_firsts(number, list%first)
        call at_least(on_gpu, list%place, int(sum(number)), err)
        associate (m => n*size(number, 2))
            if (sum(number) > 0) call for_each_list_chunk(on_gpu, chunks_of(m), m, n, marks%mark, &
                                                       marks%before, list%place, err)
        end associate
    end subroutine list_marks

    !> Chunks of a row of marks.
    pure integer function chunks_of(m)
        integer, intent(in) :: m !! marks

        chunks_of = (m - 1)/marks_of_a_chunk + 1
    end function chunks_of

    !> Places of what comes, that of a process and body in one piece, process by process.
    subroutine place_pieces(on_gpu, number, before, marks, list, err)
        logical, intent(in) :: on_gpu
        type(error_t), intent(inout) :: err
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, dimension(:), intent(inout) :: before
        !! (bodies) places that are taken; these ones, too, then
        type(marks_t), intent(inout) :: marks
        type(message_buffers_t), intent(inout) :: list
        integer :: piece(2, size(number))

        call find_pieces(number, before, piece)
        call find_firsts(number, list%first)
        call at_least(on_gpu, list%place, int(sum(number)), err)
        call put_list(on_gpu, reshape(piece, [size(piece)]), marks%pieces, err)
        call for_each_give_place(on_gpu, int(sum(number)), size(number), marks%pieces, &
            list%place, err)
    end subroutine place_pieces

    !> Put the entries of a list into another, process by process and body by body behind those that
    !> are kept there.
    subroutine join_lists(on_gpu, was, kept, number, added, marks, list, err)
        logical, intent(in) :: on_gpu
        type(error_t), intent(inout) :: err
        integer(int64), intent(in) :: was(:, :), number(:, :) !! (bodies, processes) in both lists
        logical, intent(in) :: kept(:) !! (bodies) else what the first one has is left out
        type(message_buffers_t), intent(in) :: added
        type(marks_t), intent(inout) :: marks
        type(message_buffers_t), intent(inout) :: list
        integer(int64) :: all(size(number, 1), size(number, 2))
        integer :: piece(2, 2*size(number))

        call find_joined(was, kept, number, piece)
        all = number + merge(was, 0_int64, spread(kept, 2, size(number, 2)))
        call find_firsts(all, list%first)
        call at_least(on_gpu, list%place, 0, err)
        call at_least(on_gpu, marks%joined, int(sum(all)), err)
        call put_list(on_gpu, reshape(piece, [size(piece)]), marks%pieces, err)
        call for_each_join_place(on_gpu, int(sum(all)), 2*size(number), marks%pieces, list%place, &
            added%place, marks%joined, err)
        call swap(list%place, marks%joined)
    end subroutine join_lists
end module brz_send_lists
