! SPDX-License-Identifier: MIT
!> What several processes tell each other of the coupling: who gets which particles, cells and
!> debts. A process is asked for by a box of cells; marks are a row for each box.
module brz_guest_items
    use brz_cell_place, only: cell_number
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_box, only: box_t
    use brz_kinds, only: dp, int32, rk
    use brz_solid_state, only: is_gone
    implicit none
    private
    public :: mark_guest, miss_guest, mark_cells, take_load, renumber

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
        integer :: r
        logical :: there

        there = is_listed(bodies, body, i)
        if (there) there = fixed(i) /= is_gone
        do r = 1, boxes
            mark((r - 1)*row + i) = 0
            if (.not. there) cycle
            if (is_in(asks(1, r), box, x(1, i))) mark((r - 1)*row + i) = 1
        end do
    end subroutine mark_guest

    !> missed = 1 if a particle of a body is in a box without being listed for it.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine miss_guest(i, row, bodies, body, boxes, asks, box, wide, x, fixed, listed, &
                               missed)
        integer, intent(in) :: i !! places
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: bodies, boxes
        integer(int32), intent(in) :: body(2, *) !! first and last particle
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(in) :: listed(*) !! running sums of the marks when they were listed
        integer(int32), intent(inout) :: missed(*)
        integer :: k, r

        if (.not. is_listed(bodies, body, i)) return
        if (fixed(i) == is_gone) return
        do r = 1, boxes
            k = (r - 1)*row + i
            if (listed(k + 1) > listed(k)) cycle
            if (is_in(asks(1, r), box, x(1, i))) missed(1) = 1
        end do
    end subroutine miss_guest

    !> True for a particle of one of the bodies.
    !@cuf attributes(host,device) &
    pure function is_listed(bodies, body, i) result(listed)
        integer, intent(in) :: bodies
        integer(int32), intent(in) :: body(2, bodies) !! first and last particle
        integer, intent(in) :: i
        logical :: listed
        integer :: b

        listed = .false.
        do b = 1, bodies
            listed = listed .or. (i >= body(1, b) .and. i <= body(2, b))
        end do
    end function is_listed

    !> True for a point in a box of cells of the grid.
    !@cuf attributes(host,device) &
    pure function is_in(ask, box, x) result(inside)
        integer(int32), intent(in) :: ask(6) !! lowest and highest cell
        type(box_t), intent(in) :: box
        real(dp), intent(in) :: x(3) !! [m]
        logical :: inside
        integer :: before(3), cells(3), d
        real(dp) :: y(3)

        do d = 1, 3
            before(d) = ask(d) - 1
            cells(d) = ask(3 + d) - before(d)
            y(d) = x(d)
        end do
        inside = cell_number(y, box%lo, box%dx, box%whole, box%wraps, before, cells) > 0
    end function is_in

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

    !> The load of a particle, from the process in whose box it is: none comes from others.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine take_load(k, r, asks, box, wide, x, fixed, places, place, step, seat, guests, &
                              load)
        integer, intent(in) :: k !! particles that the process has copies of
        integer, intent(in) :: r !! row of its box
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer, intent(in) :: places !! of this process
        integer(int32), intent(in) :: place(*) !! of the particle
        integer, intent(in) :: step !! numbers from a guest to the next
        integer(int32), intent(in) :: seat(*) !! of its copy
        real(rk), intent(in) :: guests(*) !! (step, guests) loads of them [N]
        real(rk), intent(inout) :: load(*) !! (places, 3)
        integer :: d, p

        p = place(k)
        if (fixed(p) == is_gone) return
        if (.not. is_in(asks(1, r), box, x(1, p))) return
        do d = 1, 3
            load((d - 1)*places + p) = guests((seat(k) - 1)*step + d)
        end do
    end subroutine take_load

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
