! SPDX-License-Identifier: MIT
!> Stencil rings: neighbours of a cell in order of distance, and steps from cell to cell. The steps
!> are point physics: compiled for the CPU and for the GPU.
module brz_cell_shells
    use brz_air_grid, only: cell_at, number_of
    use brz_kinds, only: int32
    implicit none
    private
    public :: shells_t, make_shells, cell_at, number_of, index_along, next_along
    public :: neighbour_or_image

    integer, parameter :: reach = 3 !! farthest neighbour, in cells
    integer, parameter :: max_shells = 8, max_offsets = 122

    !> Shell s holds offsets first(s)..first(s+1)-1, all of the same distance. It is symmetric: with
    !> an offset it holds its opposite.
    type :: shells_t
        integer :: n = 0
        integer :: first(max_shells + 1) = 1
        integer :: offset(3, max_offsets) = 0
    end type shells_t

contains

    !> Shells within `reach` cells in the directions that have more than one cell.
    pure subroutine make_shells(n, shells)
        integer, intent(in) :: n(3) !! cells of the grid
        type(shells_t), intent(out) :: shells
        integer :: r(3), d2, i, j, k, m

        r = merge(reach, 0, n > 1)
        m = 0
        do d2 = 1, reach**2
            do k = -r(3), r(3)
                do j = -r(2), r(2)
                    do i = -r(1), r(1)
                        if (i*i + j*j + k*k /= d2) cycle
                        m = m + 1
                        shells%offset(:, m) = [i, j, k]
                    end do
                end do
            end do
            if (m + 1 == shells%first(shells%n + 1)) cycle
            shells%n = shells%n + 1
            shells%first(shells%n + 1) = m + 1
        end do
    end subroutine make_shells

    !> Cell reached from `from` by `offset`, or the cell whose image is there beyond planes of
    !> symmetry; `inside` is false beyond the box.
    !@cuf attributes(host,device) &
    pure subroutine neighbour_or_image(n, wraps, mirrors, from, offset, to, turned, inside)
        integer, intent(in) :: n(3) !! cells of the grid
        logical, intent(in) :: wraps(3) !! periodic directions
        logical, intent(in) :: mirrors(2, 3) !! planes of symmetry at the low and the high end
        integer, intent(in) :: from(3), offset(3)
        integer, intent(out) :: to(3)
        logical, intent(out) :: turned(3) !! directions in which it is an image that is there
        logical, intent(out) :: inside
        integer :: d, side

        inside = .true.
        do d = 1, 3
            turned(d) = .false.
            to(d) = from(d) + offset(d)
            if (to(d) >= 1 .and. to(d) <= n(d)) cycle
            if (wraps(d)) then
                to(d) = modulo(to(d) - 1, n(d)) + 1
                cycle
            end if
            do while (to(d) < 1 .or. to(d) > n(d)) ! once more where two planes are close
                side = merge(1, 2, to(d) < 1)
                if (.not. mirrors(side, d)) then
                    inside = .false.
                    exit
                end if
                to(d) = merge(1, 2*n(d) + 1, side == 1) - to(d)
                turned(d) = .not. turned(d)
            end do
        end do
    end subroutine neighbour_or_image

    !> Index of a cell along direction d.
    !@cuf attributes(host,device) &
    pure function index_along(n, number, d) result(i)
        integer, intent(in) :: n(3)
        integer(int32), intent(in) :: number
        integer, intent(in) :: d
        integer :: i

        i = number - 1
        if (d > 1) i = i/n(1)
        if (d > 2) i = i/n(2)
        if (d < 3) i = mod(i, n(d))
        i = i + 1
    end function index_along

    !> Number of the next cell along an axis; 0 beyond the box.
    !@cuf attributes(host,device) &
    pure function next_along(n, wraps, number, d, s) result(next)
        integer, intent(in) :: n(3)
        logical, intent(in) :: wraps(3) !! periodic directions
        integer(int32), intent(in) :: number
        integer, intent(in) :: d, s !! direction, and +1 or -1
        integer(int32) :: next
        integer :: i, stride

        stride = 1
        if (d > 1) stride = n(1)
        if (d > 2) stride = stride*n(2)
        i = index_along(n, number, d)
        next = number + s*stride
        if (i + s >= 1 .and. i + s <= n(d)) return
        next = merge(number + s*(1 - n(d))*stride, 0, wraps(d))
    end function next_along
end module brz_cell_shells
