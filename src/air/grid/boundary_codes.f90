! SPDX-License-Identifier: MIT
!> Codes of the conditions at the ends of the lines of cells, in the order of brz_boundary_names.
module brz_boundary_codes
    implicit none
    private
    public :: bc_outflow, bc_wall, bc_symmetry, bc_periodic, bc_inside

    integer, parameter :: bc_outflow = 1, bc_wall = 2, bc_symmetry = 3, bc_periodic = 4
    integer, parameter :: bc_inside = 5 !! no boundary: the box of another process begins there
end module brz_boundary_codes
