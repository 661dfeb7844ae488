! SPDX-License-Identifier: MIT
!> The box of the air as the loops of the coupling see it: plain data.
!>
!> Cells go by their number in memory order, ghosts left out, or by their place in the arrays of
!> the air. On several processes the box is a halo of the grid: the cells of this process, and
!> those of others around them.
module brz_coupling_box
    use brz_air_grid, only: grid_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: box_t

    type :: box_t
        integer :: n(3) !! cells
        integer :: whole(3) !! cells of the grid
        integer :: before(3) !! cells of the grid before the halo
        integer :: own(3, 2) !! first and last cell of this process, as the halo counts
        logical :: wraps(3) !! periodic directions
        real(dp) :: lo(3), dx(3) !! low corner of the grid, sides of a cell [m]
        type(grid_t) :: grid !! where the cells lie in memory
    end type box_t
end module brz_coupling_box
