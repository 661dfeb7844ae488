! SPDX-License-Identifier: MIT
!> Which of many points is nearest to a place.
module brz_nearest_point
    use brz_kinds, only: dp
    implicit none
    private
    public :: nearest_point

contains

    !> The point nearest to a place; the first of the file among equals.
    pure integer function nearest_point(points, order, at) result(nearest)
        real(dp), intent(in) :: points(:, :) !! (dimension, points) [m]
        integer, intent(in) :: order(:) !! of the points along the first axis
        real(dp), intent(in) :: at(:) !! [m]
        real(dp) :: least, distance
        integer :: high, k, low, middle, side

        low = 0
        high = size(order) + 1
        do while (high - low > 1) ! low: the last point at or before the place
            middle = (low + high)/2
            if (points(1, order(middle)) <= at(1)) then
                low = middle
            else
                high = middle
            end if
        end do
        nearest = 0
        least = huge(least)
        do side = -1, 1, 2
            k = merge(low, low + 1, side < 0)
            do while (k >= 1 .and. k <= size(order))
                if ((points(1, order(k)) - at(1))**2 > least) exit
                distance = sum((points(:, order(k)) - at)**2)
                if (distance < least .or. (distance <= least .and. order(k) < nearest)) then
                    least = distance
                    nearest = order(k)
                end if
                k = k + side
            end do
        end do
    end function nearest_point
end module brz_nearest_point
