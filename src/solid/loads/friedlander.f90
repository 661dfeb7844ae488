! SPDX-License-Identifier: MIT
!> Impulse of a Friedlander wave, p (1 - t/T) exp(-b t/T).
module brz_friedlander
    use brz_kinds, only: dp
    implicit none
    private
    public :: friedlander_impulse

contains

    !> Impulse until a time after the arrival: that of the positive phase.
    !@cuf attributes(host,device) &
    pure function friedlander_impulse(peak, duration, b, t) result(impulse)
        real(dp), intent(in) :: peak, duration, b, t !! [Pa], [s], [-], [s]
        real(dp) :: impulse, x

        x = max(0.0_dp, min(1.0_dp, t/duration))
        if (abs(b) < 1e-4_dp) then
            impulse = x - x*x/2 - b*(x*x/2 - x*x*x/3)
        else
            impulse = (b - 1 + exp(-b*x)*(1 - b + b*x))/(b*b)
        end if
        impulse = impulse*peak*duration
    end function friedlander_impulse
end module brz_friedlander
