! SPDX-License-Identifier: MIT
!> Cells over the particles of one body, along a Morton curve: near in space is near in memory.
!>
!> The grid repeats itself in space. It covers the body and one empty cell more along each axis;
!> where fragments fly so far that this takes too many cells, parts of space share cells, evenly.
!> Neighbours are in neighbouring cells either way.
module brz_cell_grid
    use brz_body, only: body_t
    use brz_cell_places, only: cell_along, cells_beyond
    use brz_formulation_names, only: form_total
    use brz_kept_cells, only: kept_cells_t
    use brz_kinds, only: dp, int32, int64
    use brz_particle_groups, only: lanes
    use brz_particle_marks, only: is_gone
    use brz_search_arrays, only: search_t
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: lay_grid, extent, choose_cells, take_cells, fill_cells, cell_span, box_span, &
        reach_of_lists, cell_of_groups, number_of_cell

    integer, parameter :: cells_per_particle = 2 !! most cells, empty ones included

contains

    !> Length of a pair in the list: the support of the kernel, and the skin where pairs change [m].
    pure real(dp) function reach_of_lists(solid, b) result(reach)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b

        associate (body => solid%bodies(b))
            reach = 2*real(body%h, dp)
            if (body%variable) reach = reach*body%h_range(2)
            if (body%formulation /= form_total) reach = reach + solid%skin
        end associate
    end function reach_of_lists

    !> Side of the cells along which particles are sorted: on a lattice each holds one group [m].
    pure real(dp) function cell_of_groups(solid, b) result(side)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b

        side = solid%bodies(b)%spacing*real(lanes, dp)**(1/real(solid%dimension, dp))
    end function cell_of_groups

    !> Choose the cells for one body.
    subroutine lay_grid(s, x, fixed, body, size)
        type(search_t), intent(inout) :: s
        real(dp), intent(in) :: x(:, :) !! (3, n) [m]
        integer(int32), intent(in) :: fixed(:) !! (n)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: size !! side of a cell [m]
        real(dp) :: lo(3), hi(3)

        call extent(x, fixed, body, lo, hi)
        s%deep = max(-lo, 0.0_dp)
        call choose_cells(s, lo, hi, body%rim - body%first + 1, size)
    end subroutine lay_grid

    !> Corners of the particles of a body, and of its ghosts, that are not gone.
    pure subroutine extent(x, fixed, body, lo, hi)
        real(dp), intent(in) :: x(:, :) !! (3, n) [m]
        integer(int32), intent(in) :: fixed(:) !! (n)
        type(body_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3) !! [m]
        integer :: i

        lo = huge(lo)
        hi = -huge(hi)
        do i = body%first, body%rim
            if (fixed(i) == is_gone) cycle
            lo = min(lo, x(:, i))
            hi = max(hi, x(:, i))
        end do
        if (all(lo <= hi)) return
        lo = 0
        hi = 0
    end subroutine extent

    !> The same from the extent of the body. Layers of a lattice lie on no side of a cell.
    subroutine choose_cells(s, lo, hi, n, size)
        type(search_t), intent(inout) :: s
        real(dp), intent(in) :: lo(3), hi(3) !! corners [m]
        integer, intent(in) :: n !! particles
        real(dp), intent(in) :: size !! side of a cell [m]
        integer :: a, most

        s%lo = lo - size/4
        s%size = size
        s%cells = int(min((hi - s%lo)/size, 1e6_dp)) + 2
        most = max(512, cells_per_particle*n)
        do while (product(real(padded(s%cells), dp)) > most)
            a = maxloc(s%cells, 1)
            s%cells(a) = max(1, s%cells(a)/2)
        end do
        call number_cells(s)
    end subroutine choose_cells

    !> The cells that a body has kept.
    subroutine take_cells(s, kept, size)
        type(search_t), intent(inout) :: s
        type(kept_cells_t), intent(in) :: kept
        real(dp), intent(in) :: size !! side of a cell [m]

        s%lo = kept%lo
        s%size = size
        s%cells = kept%along
        call number_cells(s)
    end subroutine take_cells

    !> Smallest powers of two that hold n.
    elemental integer function padded(n)
        integer, intent(in) :: n

        padded = 1
        do while (padded < n)
            padded = 2*padded
        end do
    end function padded

    !> Share of each axis in the number of a cell: its bits interleaved with those of the others.
    !> The tables go on for a second period, so that a span of cells may run across the end.
    subroutine number_cells(s)
        type(search_t), intent(inout) :: s
        integer :: a, c, level, place(0:31, 3), p, bits(3)

        if (allocated(s%code)) then
            if (size(s%code, 1) < 2*maxval(s%cells)) deallocate (s%code)
        end if
        if (.not. allocated(s%code)) allocate (s%code(0:4*maxval(s%cells) - 1, 3))
        bits = trailz(padded(s%cells))
        p = 0
        do level = 0, maxval(bits) - 1
            do a = 1, 3
                if (level >= bits(a)) cycle
                place(level, a) = p
                p = p + 1
            end do
        end do
        do a = 1, 3
            do c = 0, s%cells(a) - 1
                s%code(c, a) = 0
                do level = 0, bits(a) - 1
                    if (btest(c, level)) s%code(c, a) = ibset(s%code(c, a), place(level, a))
                end do
                s%code(c + s%cells(a), a) = s%code(c, a)
            end do
        end do
        if (allocated(s%start)) then
            if (size(s%start) < 2**p + 1) deallocate (s%start)
        end if
        if (.not. allocated(s%start)) allocate (s%start(0:2**p))
    end subroutine number_cells

    !> Sort the particles of a body and its ghosts into the cells; equal cells keep the order of the
    !> particles. Those that are gone come last, in no cell.
    subroutine fill_cells(s, x, fixed, body)
        type(search_t), intent(inout) :: s
        real(dp), intent(in) :: x(:, :) !! (3, n) [m]
        integer(int32), intent(in) :: fixed(:) !! (n)
        type(body_t), intent(in) :: body
        integer :: i, c, n

        s%start = 0
        do i = body%first, body%rim
            c = cell_of(s, x(:, i), fixed(i))
            s%start(c) = s%start(c) + 1
        end do
        n = body%first
        do c = 0, ubound(s%start, 1)
            i = s%start(c)
            s%start(c) = n
            n = n + i
        end do
        do i = body%first, body%rim
            c = cell_of(s, x(:, i), fixed(i))
            s%order(s%start(c)) = i
            s%start(c) = s%start(c) + 1
        end do
        do c = ubound(s%start, 1), 1, -1
            s%start(c) = s%start(c - 1)
        end do
        s%start(0) = body%first
    end subroutine fill_cells

    !> Number of the cell of a particle along the curve; that behind the last if it is gone.
    pure integer function cell_of(s, x, fixed) result(c)
        type(search_t), intent(in) :: s
        real(dp), intent(in) :: x(3) !! [m]
        integer(int32), intent(in) :: fixed
        integer :: at(3)

        c = ubound(s%start, 1)
        if (fixed == is_gone) return
        at = place(s, x)
        c = number_of_cell(s, at(1), at(2), at(3))
    end function cell_of

    !> Number along the curve of a cell, given by its place along each axis, from 0.
    pure integer function number_of_cell(s, x, y, z) result(c)
        type(search_t), intent(in) :: s
        integer, intent(in) :: x, y, z

        c = s%code(x, 1) + s%code(y, 2) + s%code(z, 3)
    end function number_of_cell

    !> Cell of a point along each axis.
    pure function place(s, x) result(c)
        type(search_t), intent(in) :: s
        real(dp), intent(in) :: x(3)
        integer :: c(3)
        integer :: a

        do a = 1, 3
            c(a) = cell_along(x(a), s%lo(a), s%size, s%cells(a))
        end do
    end function place

    !> Cells lo..hi along each axis that hold everything within a reach of a point.
    pure subroutine cell_span(s, x, reach, lo, hi)
        type(search_t), intent(in) :: s
        real(dp), intent(in) :: x(3), reach !! [m]
        integer, intent(out) :: lo(3), hi(3)

        call box_span(s, x, [reach, reach, reach], lo, hi)
    end subroutine cell_span

    !> The same of everything within a box.
    pure subroutine box_span(s, middle, half, lo, hi)
        type(search_t), intent(in) :: s
        real(dp), intent(in) :: middle(3), half(3) !! of the box, and of its sides [m]
        integer, intent(out) :: lo(3), hi(3)
        integer :: a

        lo = place(s, middle - half)
        do a = 1, 3
            hi(a) = lo(a) + cells_beyond(middle(a), half(a), s%lo(a), s%size, s%cells(a))
        end do
    end subroutine box_span
end module brz_cell_grid
