! SPDX-License-Identifier: MIT
!> The wall clock.
module brz_timer
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: wall_seconds, lap

contains

    !> Wall clock [s]; only differences mean something.
    real(dp) function wall_seconds()
        integer(int64) :: count, count_rate

        call system_clock(count, count_rate)
        wall_seconds = real(count, dp)/real(count_rate, dp)
    end function wall_seconds

    !> Add the time since `mark` to `seconds`, and set the mark to now.
    subroutine lap(mark, seconds)
        real(dp), intent(inout) :: mark, seconds !! [s]
        real(dp) :: now

        now = wall_seconds()
        seconds = seconds + (now - mark)
        mark = now
    end subroutine lap
end module brz_timer
