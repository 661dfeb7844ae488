! SPDX-License-Identifier: MIT
!> Conditions at the ends of the lines of cells. Point physics: compiled for the CPU and for the
!> GPU.
module brz_air_boundary
    implicit none
    private
    public :: image_at, bc_outflow, bc_wall, bc_symmetry, bc_periodic

    integer, parameter :: bc_outflow = 1, bc_wall = 2, bc_symmetry = 3, bc_periodic = 4

contains

    !> Cell of a line whose state the cell at position p takes: itself, or the image of a ghost.
    !@cuf attributes(host,device) &
    pure function image_at(n, low, high, p) result(at)
        integer, intent(in) :: n !! cells of the line
        integer, intent(in) :: low, high !! boundary conditions
        integer, intent(in) :: p !! index of a cell along it, ghosts included
        integer :: at

        at = p
        if (p < 1) then
            at = min(1 - p, n)
            if (low == bc_outflow) at = 1
            if (low == bc_periodic) at = p + n
        else if (p > n) then
            at = max(2*n + 1 - p, 1)
            if (high == bc_outflow) at = n
            if (high == bc_periodic) at = p - n
        end if
    end function image_at
end module brz_air_boundary
