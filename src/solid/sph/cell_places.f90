! SPDX-License-Identifier: MIT
!> Cells along an axis of a grid over the particles of a body, for the CPU and for kernels.
module brz_cell_places
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: cell_along, cells_beyond

    real(dp), parameter :: farthest = 1e15_dp !! [sides of a cell]: whole numbers of real64 end here

contains

    !> Cell of a coordinate along one axis, from 0; what is no number is in the first.
    !@cuf attributes(host,device) &
    pure function cell_along(x, lo, size, cells) result(c)
        real(dp), intent(in) :: x, lo, size !! coordinate, low corner, side of a cell [m]
        integer, intent(in) :: cells !! in a period
        integer :: c
        real(dp) :: t

        c = 0
        t = (x - lo)/size
        if (abs(t) < farthest) c = min(int(t - cells*real(floor(t/cells, int64), dp)), cells - 1)
    end function cell_along

    !> Cells along one axis after that of x - reach that hold what is within the reach of x, each
    !> cell once.
    !@cuf attributes(host,device) &
    pure function cells_beyond(x, reach, lo, size, cells) result(n)
        real(dp), intent(in) :: x, reach, lo, size !! low corner, side of a cell [m]
        integer, intent(in) :: cells !! in a period
        integer :: n
        real(dp) :: low, high

        n = 0
        low = (x - reach - lo)/size
        high = (x + reach - lo)/size
        if (abs(low) < farthest .and. abs(high) < farthest) &
            n = int(min(floor(high, int64) - floor(low, int64), int(cells - 1, int64)))
    end function cells_beyond
end module brz_cell_places
