! SPDX-License-Identifier: MIT
!> The box of the air as the loops of the coupling see it: plain data. Point physics: compiled for
!> the CPU and for the GPU.
!>
!> Cells go by their number in memory order, ghosts left out, or by their place in the arrays of
!> the air. On several processes the box is a halo of the grid: the cells of this process, and
!> those of others around them.
module brz_coupling_box
    use brz_air_grid, only: grid_t, place_of
    use brz_cell_shells, only: cell_at, neighbour, neighbour_or_image, next_along
    use brz_kinds, only: dp, int32, int64, int8, rk
    implicit none
    private
    public :: box_t, place_at, place_beside, look_beside, go_on, is_turned, is_own
    public :: is_gas, is_solid, is_left, is_buried

    ! what a cell is in the map `mark`
    integer(int8), parameter :: is_gas = 0, is_solid = 1
    integer(int8), parameter :: is_left = 2 !! gas: the solid has left it
    integer(int8), parameter :: is_buried = 3 !! solid that has lost touch with the gas

    type :: box_t
        integer :: n(3) !! cells
        integer :: whole(3) !! cells of the grid
        integer :: before(3) !! cells of the grid before the halo
        integer :: own(3, 2) !! first and last cell of this process, as the halo counts
        integer :: cells !! their product
        integer :: n_var !! conserved variables
        integer :: layers !! solid cells behind the first that a face may load
        logical :: closed(2, 3) !! a wall stands there
        logical :: mirrors(2, 3) !! a plane of symmetry is there
        logical :: wraps(3) !! periodic directions
        real(rk) :: spread !! depth over which a load is spread, in cells
        real(rk) :: reference !! pressure that is taken off [Pa]
        real(rk) :: floors(3) !! of the gas, see floors_of
        real(dp) :: lo(3), dx(3) !! low corner of the grid, sides of a cell [m]
        real(dp) :: area(3) !! of the faces normal to each direction [m2]
        type(grid_t) :: grid !! where the cells lie in memory
    end type box_t

contains

    !> Place of a cell among the values of a variable, from its number.
    !@cuf attributes(host,device) &
    pure function place_at(box, number) result(at)
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: number
        integer(int64) :: at
        integer :: ijk(3)

        ijk = cell_at(box%n, number)
        at = place_of(box%grid, ijk(1), ijk(2), ijk(3))
    end function place_at

    !> True for a cell of this process, from its number.
    !@cuf attributes(host,device) &
    pure function is_own(box, number) result(own)
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: number
        logical :: own
        integer :: d, ijk(3)

        ijk = cell_at(box%n, number)
        own = .true.
        do d = 1, 3
            own = own .and. ijk(d) >= box%own(d, 1) .and. ijk(d) <= box%own(d, 2)
        end do
    end function is_own

    !> Place of the cell that is reached from another by an offset; 0 beyond the box.
    !@cuf attributes(host,device) &
    pure function place_beside(box, ijk, offset) result(at)
        type(box_t), intent(in) :: box
        integer, intent(in) :: ijk(3) !! the other cell
        integer, intent(in) :: offset(3)
        integer(int64) :: at
        integer :: to(3)
        logical :: inside

        at = 0
        call neighbour(box%n, box%wraps, ijk, offset, to, inside)
        if (inside) at = place_of(box%grid, to(1), to(2), to(3))
    end function place_beside

    !> The same, or the place of the cell whose image is there.
    !@cuf attributes(host,device) &
    pure subroutine look_beside(box, ijk, offset, at, turned)
        type(box_t), intent(in) :: box
        integer, intent(in) :: ijk(3) !! the other cell
        integer, intent(in) :: offset(3)
        integer(int64), intent(out) :: at
        logical, intent(out) :: turned(3) !! directions in which it is an image
        integer :: to(3)
        logical :: inside

        at = 0
        call neighbour_or_image(box%n, box%wraps, box%mirrors, ijk, offset, to, turned, inside)
        if (inside) at = place_of(box%grid, to(1), to(2), to(3))
    end subroutine look_beside

    !> True for a conserved variable that an image has with the opposite sign: momentum.
    !@cuf attributes(host,device) &
    pure function is_turned(turned, k) result(opposite)
        logical, intent(in) :: turned(3) !! directions in which it is an image
        integer, intent(in) :: k !! variable
        logical :: opposite

        ! spelled out: a kernel keeps what it indexes at run time in local memory
        opposite = (k == 2 .and. turned(1)) .or. (k == 3 .and. turned(2)) &
                   .or. (k == 4 .and. turned(3))
    end function is_turned

    !> Go on to the next cell along an axis; to 0 beyond the box. Behind a plane of symmetry the way
    !> leads through the image: the cell before the plane comes once more, and the sign turns.
    !@cuf attributes(host,device) &
    pure subroutine go_on(box, d, s, number)
        type(box_t), intent(in) :: box
        integer, intent(in) :: d !! direction
        integer, intent(inout) :: s !! +1 or -1
        integer(int32), intent(inout) :: number !! of the cell
        integer(int32) :: next

        next = next_along(box%n, box%wraps, number, d, s)
        if (next == 0) then
            if (box%mirrors(merge(1, 2, s < 0), d)) then
                next = number
                s = -s
            end if
        end if
        number = next
    end subroutine go_on
end module brz_coupling_box
