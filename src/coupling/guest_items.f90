! SPDX-License-Identifier: MIT
!> What several processes tell each other of the coupling: who gets which particles, cells and
!> debts. A process is asked for by a box that has its window, or in `own` its part of the grid.
module brz_guest_items
    use brz_cell_place, only: cell_number
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_box, only: box_t, is_own
    use brz_kinds, only: dp, int32
    use brz_solid_state, only: is_gone
    implicit none
    private
    public :: mark_guest, mark_own, give_seat, renumber

contains

    !> mark = 1 for a particle in the window of a box, else 0.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine mark_guest(p, first, box, wide, x, fixed, mark)
        integer, intent(in) :: p !! particles of a body
        integer, intent(in) :: first !! the first of them
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(inout) :: mark(*)
        real(dp) :: y(3)
        integer :: d, i

        i = first - 1 + p
        do d = 1, 3
            y(d) = x(d, i)
        end do
        mark(i) = 0
        if (fixed(i) == is_gone) return
        if (cell_number(y, box%lo, box%dx, box%whole, box%wraps, box%before, box%n) > 0) mark(i) = 1
    end subroutine mark_guest

    !> mark = 1 for a cell in the part of the grid that a box says is `own`, else 0.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine mark_own(i, box, cell, mark)
        integer, intent(in) :: i !! of a list
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*) !! 0: none
        integer(int32), intent(inout) :: mark(*)

        mark(i) = 0
        if (cell(i) == 0) return
        if (is_own(box, cell(i))) mark(i) = 1
    end subroutine mark_own

    !> Places of those that come one after the other.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine give_seat(k, before, taken, place)
        integer, intent(in) :: k !! particles that come together
        integer, intent(in) :: before !! entries of the list before theirs
        integer, intent(in) :: taken !! places before theirs
        integer(int32), intent(inout) :: place(*)

        place(before + k) = taken + k
    end subroutine give_seat

    !> The number that a cell of one window has in another, which holds it too.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine renumber(i, here, there, cell, number)
        integer, intent(in) :: i !! cells
        type(box_t), intent(in) :: here, there
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: number(*)
        integer :: d, ijk(3)

        ijk = cell_at(here%n, cell(i))
        do d = 1, 3
            ijk(d) = ijk(d) + here%before(d) - there%before(d)
        end do
        number(i) = number_of(there%n, ijk)
    end subroutine renumber
end module brz_guest_items
