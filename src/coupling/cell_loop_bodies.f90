! SPDX-License-Identifier: MIT
!> Lists of the cells that a map marks, in memory order.
module brz_cell_loop_bodies
    use brz_kinds, only: int32, int8
    implicit none
    private
    public :: count_kind, list_kind, cells_of_a_chunk

    integer, parameter :: cells_of_a_chunk = 64 !! that one thread looks through

contains

    !> Count the cells of a kind in each chunk of the map.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine count_kind(t, cells, kind, mark, top)
        integer, intent(in) :: t !! chunks
        integer, intent(in) :: cells, kind
        integer(int8), intent(in) :: mark(*)
        integer(int32), intent(inout) :: top(*)
        integer :: i, total

        total = 0
        do i = (t - 1)*cells_of_a_chunk + 1, min(t*cells_of_a_chunk, cells)
            if (mark(i) == kind) total = total + 1
        end do
        top(t) = total
    end subroutine count_kind

    !> List the cells of a kind in order; `top` holds how many are before each chunk.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine list_kind(t, cells, kind, mark, top, list)
        integer, intent(in) :: t !! chunks
        integer, intent(in) :: cells, kind
        integer(int8), intent(in) :: mark(*)
        integer(int32), intent(in) :: top(*)
        integer(int32), intent(inout) :: list(*)
        integer :: at, i

        at = top(t)
        if (top(t + 1) == at) return
        do i = (t - 1)*cells_of_a_chunk + 1, min(t*cells_of_a_chunk, cells)
            if (mark(i) /= kind) cycle
            at = at + 1
            list(at) = i
        end do
    end subroutine list_kind
end module brz_cell_loop_bodies
