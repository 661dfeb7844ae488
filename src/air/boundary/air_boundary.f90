! SPDX-License-Identifier: MIT
!> Conditions at the ends of the lines of cells. Point physics: compiled for the CPU and for the
!> GPU.
module brz_air_boundary
    use brz_boundary_codes, only: bc_outflow, bc_periodic, bc_wall
    use brz_scheme, only: hllc, scheme_t
    implicit none
    private
    public :: image_at, beyond_wall

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

    !> True for a ghost beyond a wall: the face before it gets the flux at a wall, as one of a body
    !> does. Split fluxes do not need that; they meet the mirror image, as at a plane of symmetry.
    !@cuf attributes(host,device) &
    pure function beyond_wall(scheme, low, high, n, p) result(beyond)
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: low, high !! boundary conditions
        integer, intent(in) :: n !! cells of the line
        integer, intent(in) :: p !! index of a cell along it, ghosts included
        logical :: beyond

        beyond = scheme%flux == hllc .and. &
                 ((p < 1 .and. low == bc_wall) .or. (p > n .and. high == bc_wall))
    end function beyond_wall
end module brz_air_boundary
