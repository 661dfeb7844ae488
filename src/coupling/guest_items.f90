! SPDX-License-Identifier: MIT
!> What several processes tell each other of the coupling: who gets which particles, cells and
!> debts. A process is asked for by a box of cells; marks are a row for each box.
module brz_guest_items
    use brz_cell_place, only: cell_number
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_box, only: box_t, is_own
    use brz_kinds, only: dp, int32
    use brz_solid_state, only: is_gone
    implicit none
    private
    public :: mark_guest, mark_cells, mark_load, renumber

contains

    !> mark = 1 for a particle of a body that is in a box, else 0.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine mark_guest(i, row, bodies, body, boxes, asks, box, wide, x, fixed, mark)
        integer, intent(in) :: i !! places
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: bodies, boxes
        integer(int32), intent(in) :: body(2, *) !! first and last particle
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(inout) :: mark(*) !! (places, boxes)
        real(dp) :: y(3)
        integer :: b, before(3), d, cells(3), r
        logical :: there

        there = .false.
        do b = 1, bodies
            there = there .or. (i >= body(1, b) .and. i <= body(2, b))
        end do
        if (there) there = fixed(i) /= is_gone
        do d = 1, 3
            y(d) = x(d, i)
        end do
        do r = 1, boxes
            mark((r - 1)*row + i) = 0
            if (.not. there) cycle
            do d = 1, 3
                before(d) = asks(d, r) - 1
                cells(d) = asks(3 + d, r) - before(d)
            end do
            if (cell_number(y, box%lo, box%dx, box%whole, box%wraps, before, cells) > 0) &
                mark((r - 1)*row + i) = 1
        end do
    end subroutine mark_guest

    !> mark = 1 for a cell of a list that is in a box, else 0.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine mark_cells(i, row, boxes, asks, box, cell, mark)
        integer, intent(in) :: i !! of the list
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: boxes
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box !! in which cells are numbered
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: mark(*) !! (list, boxes)
        integer :: d, ijk(3), r
        logical :: there

        ijk = cell_at(box%n, cell(i))
        do r = 1, boxes
            there = .true.
            do d = 1, 3
                there = there .and. ijk(d) + box%before(d) >= asks(d, r) &
                        .and. ijk(d) + box%before(d) <= asks(3 + d, r)
            end do
            mark((r - 1)*row + i) = 0
            if (there) mark((r - 1)*row + i) = 1
        end do
    end subroutine mark_cells

    !> mark = 1 for a guest in a cell of this process, in the row of the process that it came from.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine mark_load(i, row, processes, pieces, ends, box, cell, mark)
        integer, intent(in) :: i !! guests, body by body, process by process
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: processes, pieces
        integer(int32), intent(in) :: ends(*) !! (pieces) last guest of each
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*) !! 0: none
        integer(int32), intent(inout) :: mark(*) !! (guests, processes)
        integer :: k, r

        do k = 1, pieces
            if (i <= ends(k)) exit
        end do
        do r = 1, processes
            mark((r - 1)*row + i) = 0
        end do
        if (cell(i) == 0) return
        if (is_own(box, cell(i))) mark(mod(k - 1, processes)*row + i) = 1
    end subroutine mark_load

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
