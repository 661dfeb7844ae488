! SPDX-License-Identifier: MIT
!> What several processes tell each other of the coupling: who gets which particles, cells and
!> debts. A process is asked for by a box of cells; marks are a row for each box.
module brz_guest_items
    use brz_cell_place, only: cell_number
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_box, only: box_t
    use brz_kinds, only: dp, int32, int8, rk
    use brz_solid_state, only: is_gone
    implicit none
    private
    public :: mark_guest, miss_guest, mark_cells, take_load, renumber, mark_around
    public :: block_at, blocks_of, always_near

    integer, parameter :: side = 4 !! cells of a block, more than an event reaches
    integer, parameter :: always_near = 1 !! a block that stands for cells which are always fetched

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
    pure subroutine take_load(k, r, asks, box, wide, x, fixed, places, place, seat, guests, load)
        integer, intent(in) :: k !! particles that the process has copies of
        integer, intent(in) :: r !! row of its box
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer, intent(in) :: places !! of this process
        integer(int32), intent(in) :: place(*) !! of the particle
        integer(int32), intent(in) :: seat(*) !! of its copy
        real(rk), intent(in) :: guests(*) !! (3, guests) loads of them [N]
        real(rk), intent(inout) :: load(*) !! (places, 3)
        integer :: d, p

        p = place(k)
        if (fixed(p) == is_gone) return
        if (.not. is_in(asks(1, r), box, x(1, p))) return
        do d = 1, 3
            load((d - 1)*places + p) = guests((seat(k) - 1)*3 + d)
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

    !> Mark the blocks of cells around a solid cell, row by row for the processes that see it, too.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine mark_around(c, boxes, asks, box, cell, near)
        integer, intent(in) :: c !! solid cells
        integer, intent(in) :: boxes
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(inout) :: near(*) !! (blocks, boxes), behind always_near
        integer :: d, i, ijk(3), j, k, r, to(3)
        logical :: there

        ijk = cell_at(box%n, cell(c))
        do r = 1, boxes
            there = .true.
            do d = 1, 3
                there = there .and. ijk(d) + box%before(d) >= asks(d, r) &
                        .and. ijk(d) + box%before(d) <= asks(3 + d, r)
            end do
            if (.not. there) cycle
            do k = -1, 1
                do j = -1, 1
                    do i = -1, 1
                        to(1) = min(max(ijk(1) + i*side, 1), box%n(1))
                        to(2) = min(max(ijk(2) + j*side, 1), box%n(2))
                        to(3) = min(max(ijk(3) + k*side, 1), box%n(3))
                        near(block_at(box, r, to)) = 1
                    end do
                end do
            end do
        end do
    end subroutine mark_around

    !> Place of the block of a cell in the map of blocks for a box. Blocks are those of the grid.
    !@cuf attributes(host,device) &
    pure function block_at(box, r, ijk) result(at)
        type(box_t), intent(in) :: box
        integer, intent(in) :: r !! of the box, from 1
        integer, intent(in) :: ijk(3) !! as the window counts
        integer :: at, d

        at = r - 1
        do d = 3, 1, -1
            at = at*((box%before(d) + box%n(d) - 1)/side - box%before(d)/side + 1) &
                 + (box%before(d) + ijk(d) - 1)/side - box%before(d)/side
        end do
        at = at + always_near + 1
    end function block_at

    !> Blocks of a window.
    pure integer function blocks_of(box)
        type(box_t), intent(in) :: box

        blocks_of = product((box%before + box%n - 1)/side - box%before/side + 1)
    end function blocks_of
end module brz_guest_items
