! SPDX-License-Identifier: MIT
!> The strain rate factor of Cowper and Symonds, 1 + (rate/D)^(1/q). Point physics.
!>
!> Source: Cowper & Symonds 1957
module brz_rate_factor
    use brz_kinds, only: rk
    implicit none
    private
    public :: apply_rate_factor

contains

    !> Multiply a flow stress at rest and its slope by the factor; its slope per rate.
    !@cuf attributes(host,device) &
    pure subroutine apply_rate_factor(d, power, rate, y, slope, by_rate)
        real(rk), intent(in) :: d, power !! rate that doubles the stress [1/s], 1/q
        real(rk), intent(in) :: rate !! of plastic strain [1/s]; 0: nothing is changed
        real(rk), intent(inout) :: y, slope !! [Pa], per strain
        real(rk), intent(out) :: by_rate !! per rate [Pa s]
        real(rk) :: factor

        by_rate = 0
        if (.not. rate > 0) return
        factor = (rate/d)**power
        by_rate = y*factor*power/rate
        y = y*(1 + factor)
        slope = slope*(1 + factor)
    end subroutine apply_rate_factor
end module brz_rate_factor
