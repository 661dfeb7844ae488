! SPDX-License-Identifier: MIT
!> Send masks: marks of places, a row for each process, and the places that are marked. They are
!> counted in chunks: what is mostly not marked is read twice, and never written.
module brz_mark_loop_bodies
    use brz_kinds, only: int32
    implicit none
    private
    public :: marks_of_a_chunk, count_chunk, marked_before, list_chunk

    integer, parameter :: marks_of_a_chunk = 32 !! that a thread looks at

contains

    !> Count the marks of each chunk.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine count_chunk(t, marks, mark, before)
        integer, intent(in) :: t !! chunks
        integer, intent(in) :: marks
        integer(int32), intent(in) :: mark(*)
        integer(int32), intent(inout) :: before(*)

        before(t) = sum_of((t - 1)*marks_of_a_chunk + 1, min(t*marks_of_a_chunk, marks), mark)
    end subroutine count_chunk

    !> How many are marked before a place of the row of marks.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine marked_before(t, place, mark, before, found)
        integer, intent(in) :: t !! places that are looked up
        integer(int32), intent(in) :: place(*)
        integer(int32), intent(in) :: mark(*)
        integer(int32), intent(in) :: before(*) !! how many are marked before each chunk
        integer(int32), intent(inout) :: found(*)
        integer :: chunk

        chunk = (place(t) - 1)/marks_of_a_chunk
        found(t) = before(chunk + 1) + sum_of(chunk*marks_of_a_chunk + 1, place(t) - 1, mark)
    end subroutine marked_before

    !> List the places that are marked, in order.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine list_chunk(t, marks, row, mark, before, place)
        integer, intent(in) :: t !! chunks
        integer, intent(in) :: marks
        integer, intent(in) :: row !! places of a process
        integer(int32), intent(in) :: mark(*)
        integer(int32), intent(in) :: before(*) !! how many are marked before each chunk
        integer(int32), intent(inout) :: place(*)
        integer :: at, k

        at = before(t)
        if (before(t + 1) == at) return
        do k = (t - 1)*marks_of_a_chunk + 1, min(t*marks_of_a_chunk, marks)
            if (mark(k) == 0) cycle
            at = at + 1
            place(at) = mod(k - 1, row) + 1
        end do
    end subroutine list_chunk

    !> Sum of some marks, of which a thread waits for several at once.
    !@cuf attributes(host,device) &
    pure integer function sum_of(first, last, mark) result(total)
        integer, intent(in) :: first, last
        integer(int32), intent(in) :: mark(*) !! 0 or 1
        integer, parameter :: at_once = 8
        integer :: k, q, some(at_once)

        total = 0
        do k = first, last, at_once
            do q = 1, at_once
                some(q) = mark(min(k + q - 1, last))
            end do
            do q = 1, at_once
                if (k + q - 1 <= last) total = total + some(q)
            end do
        end do
    end function sum_of
end module brz_mark_loop_bodies
