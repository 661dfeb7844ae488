! SPDX-License-Identifier: MIT
!> What the search for neighbours and the sums block by block keep from one use to the next.
module brz_search_arrays
    use brz_kinds, only: dp
    implicit none
    private
    public :: search_t

    !> Work arrays.
    type :: search_t
        integer :: cells(3) = 1 !! of the grid of the body at hand
        real(dp) :: lo(3) = 0, size = 1 !! its low corner and the side of a cell [m]
        real(dp) :: deep(3) = 0 !! what its particles are below 0, as some behind planes of symmetry
        integer, allocatable :: code(:, :) !! (cells, 3) share of an axis in the number of a cell
        integer, allocatable :: start(:) !! first place of a cell in `order`
        integer, allocatable :: order(:) !! (n) particles cell by cell
        integer, allocatable :: marked(:) !! (cells) 1: some particle there has a new place
        logical, allocatable :: chosen(:) !! (groups) whose lists are built anew
        real(dp), allocatable :: sums(:, :) !! (sums, blocks) partial sums of a pass
        real(dp), allocatable :: limit(:) !! (blocks) largest stable time step [s]
        logical, allocatable :: in_tension(:) !! (blocks) some particle is held
        integer, allocatable :: bad(:) !! (blocks) first particle with an impossible state, 0: none
    end type search_t
end module brz_search_arrays
