! SPDX-License-Identifier: MIT
!> The grid of cells of a list of neighbours that is built anew in part.
module brz_kept_cells
    use brz_kinds, only: dp
    implicit none
    private
    public :: kept_cells_t

    !> What lists keep that are built anew in part, see brz_list_drift.
    type :: kept_cells_t
        integer :: renewals = -1 !! how often a part was built anew; -1: the list is not yet built
        integer :: along(3) = 0 !! on a GPU: cells along each axis; 0: they must be chosen
        real(dp) :: lo(3) = 0 !! their low corner [m]
        logical :: in_part = .false. !! only chosen lists are about to be built
    end type kept_cells_t
end module brz_kept_cells
