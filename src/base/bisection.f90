! SPDX-License-Identifier: MIT
!> Where a number stands among numbers that grow.
module brz_bisection
    use brz_kinds, only: dp
    implicit none
    private
    public :: count_up_to

contains

    !> How many of the numbers are not above a limit.
    pure integer function count_up_to(x, limit) result(low)
        real(dp), intent(in) :: x(:) !! in order, from the smallest
        real(dp), intent(in) :: limit
        integer :: high, middle

        low = 0
        high = size(x) + 1
        do while (high - low > 1)
            middle = (low + high)/2
            if (x(middle) <= limit) then
                low = middle
            else
                high = middle
            end if
        end do
    end function count_up_to
end module brz_bisection
