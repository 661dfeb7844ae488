! SPDX-License-Identifier: MIT
!> How far two states of the solids are apart.
module gpu_difference
    use brz_kinds, only: dp, rk
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: difference

contains

    !> Largest difference of two states, relative to the largest value of a variable.
    real(dp) function difference(a, b)
        type(solid_t), intent(in) :: a, b
        real(dp) :: stress

        stress = maxval(abs(a%stress)) + tiny(1.0_rk)
        difference = maxval(abs(a%x - b%x))/maxval(abs(a%x))
        difference = max(difference, maxval(abs(a%v - b%v))/(maxval(abs(a%v)) + tiny(1.0_dp)))
        difference = max(difference, maxval(abs(a%stress - b%stress))/stress)
        difference = max(difference, maxval(abs(a%a - b%a))/(maxval(abs(a%a)) + tiny(1.0_dp)))
        difference = max(difference, maxval(abs(a%energy - b%energy)) &
            /(maxval(abs(a%energy)) + tiny(1.0_dp)))
        difference = max(difference, real(maxval(abs(a%mu - b%mu)) &
            /(maxval(abs(a%mu)) + tiny(1.0_rk)), dp))
        if (any(a%id /= b%id)) difference = huge(difference)
        if (.not. a%links%present) return
        if (any(a%links%bond /= b%links%bond)) difference = huge(difference)
        if (.not. a%cohesive%present) return
        associate (x => a%cohesive, y => b%cohesive)
            difference = max(difference, maxval(abs(x%damage - y%damage)), &
                maxval(abs(x%spent - y%spent))/(maxval(x%spent) + tiny(1.0_dp)), &
                maxval(abs(x%held - y%held))/(maxval(x%held) + tiny(1.0_dp)))
            if (any(x%place /= y%place)) difference = huge(difference)
        end associate
        if (any(a%links%joined /= b%links%joined)) difference = huge(difference)
    end function difference
end module gpu_difference
