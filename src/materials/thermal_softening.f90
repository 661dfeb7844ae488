! SPDX-License-Identifier: MIT
!> What heat leaves of the strength of a metal, 1 - T*^m. Point physics.
!>
!> Source: Johnson & Cook 1983
module brz_thermal_softening
    use brz_kinds, only: rk
    implicit none
    private
    public :: softened_by_heat

contains

    !@cuf attributes(host,device) &
    pure function softened_by_heat(hot, power) result(soft)
        real(rk), intent(in) :: hot !! T*, 0 at the reference temperature, 1 at melting [-]
        real(rk), intent(in) :: power !! m [-]
        real(rk) :: soft !! share of the strength [-]

        soft = 1
        if (hot > 0) soft = 1 - hot**power
    end function softened_by_heat
end module brz_thermal_softening
