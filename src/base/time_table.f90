! SPDX-License-Identifier: MIT
!> Histories given as a table of times and values, straight lines between them.
module brz_time_table
    use brz_kinds, only: dp
    implicit none
    private
    public :: mean_over, value_at

contains

    !> Mean of a history over a step; one value without a time holds for ever.
    !>
    !> Before the first time and after the last one it is zero, or stays as it is there.
    pure real(dp) function mean_over(time, value, from, dt, hold) result(mean)
        real(dp), intent(in) :: time(:) !! growing, (points) or none [s]
        real(dp), intent(in) :: value(:) !! (points)
        real(dp), intent(in) :: from, dt !! start of the step, its length [s]
        logical, intent(in) :: hold !! the ends stay as they are
        real(dp) :: low, high
        integer :: i, n

        mean = value(1)
        n = size(time)
        if (n == 0) return
        mean = 0
        if (hold) then
            if (from >= time(n)) mean = value(n)
            if (from + dt <= time(1)) mean = value(1)
            if (from >= time(n) .or. from + dt <= time(1)) return
            mean = (max(time(1) - from, 0.0_dp)*value(1) &
                    + max(from + dt - time(n), 0.0_dp)*value(n))/dt
        end if
        do i = 1, n - 1
            low = max(from, time(i))
            high = min(from + dt, time(i + 1))
            if (high > low) mean = mean + (high - low)/dt*(value(i) &
                + ((low + high)/2 - time(i))/(time(i + 1) - time(i))*(value(i + 1) - value(i)))
        end do
    end function mean_over

    !> Value of a history at a time, with the same ends; at a jump at an end that of the table.
    pure real(dp) function value_at(time, value, at, hold) result(v)
        real(dp), intent(in) :: time(:), value(:) !! as above
        real(dp), intent(in) :: at !! [s]
        logical, intent(in) :: hold
        integer :: i, n

        v = value(1)
        n = size(time)
        if (n == 0) return
        if (at < time(1) .or. at > time(n)) then
            if (at > time(n)) v = value(n)
            if (.not. hold) v = 0
            return
        end if
        do i = 1, n - 1
            if (at <= time(i + 1)) exit
        end do
        v = value(i) + (at - time(i))/(time(i + 1) - time(i))*(value(i + 1) - value(i))
    end function value_at
end module brz_time_table
