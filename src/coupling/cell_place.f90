! SPDX-License-Identifier: MIT
!> Which air cell holds a point. Point physics: compiled for the CPU and for the GPU.
module brz_cell_place
    use brz_kinds, only: dp, int32
    implicit none
    private
    public :: cell_number, cell_middle

contains

    !> Number of the cell that holds a point, counted from 1 in memory order of a halo of the
    !> grid; 0 outside.
    !>
    !> A direction with one cell is not modelled: any coordinate lies in it.
    !@cuf attributes(host,device) &
    pure function cell_number(x, lo, dx, whole, wraps, before, n) result(c)
        real(dp), intent(in) :: x(3) !! point [m]
        real(dp), intent(in) :: lo(3), dx(3) !! low corner of the grid and sides of a cell [m]
        integer, intent(in) :: whole(3) !! cells of the grid
        logical, intent(in) :: wraps(3) !! periodic directions
        integer, intent(in) :: before(3) !! cells of the grid before the halo
        integer, intent(in) :: n(3) !! cells of the halo
        integer(int32) :: c
        real(dp) :: s
        integer :: d, i, stride

        c = 1
        stride = 1
        do d = 1, 3
            if (whole(d) > 1) then
                s = (x(d) - lo(d))/dx(d)
                if (wraps(d)) s = s - whole(d)*floor(s/whole(d))
                if (.not. (s >= before(d) .and. s < before(d) + n(d))) then
                    c = 0
                    return
                end if
                i = min(int(s), whole(d) - 1) - before(d)
                c = c + i*stride
            end if
            stride = stride*n(d)
        end do
    end function cell_number

    !> Middle of the cell that holds a point, beside the point where a direction is periodic.
    !@cuf attributes(host,device) &
    pure function cell_middle(x, lo, dx) result(middle)
        real(dp), intent(in) :: x(3) !! point [m]
        real(dp), intent(in) :: lo(3), dx(3) !! low corner of the box and sides of a cell [m]
        real(dp) :: middle(3)
        integer :: d

        do d = 1, 3
            middle(d) = lo(d) + (floor((x(d) - lo(d))/dx(d)) + 0.5_dp)*dx(d)
        end do
    end function cell_middle
end module brz_cell_place
