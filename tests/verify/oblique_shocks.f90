! SPDX-License-Identifier: MIT
!> Exact relations of shocks in an ideal gas of gamma 1.4: oblique shocks, regular reflection from
!> an inclined wall, the pitot pressure. Source: Ames Research Staff 1953, NACA Report 1135.
module oblique_shocks
    use brz_kinds, only: dp
    implicit none
    private
    public :: regular_reflection, pitot_ratio

    real(dp), parameter :: g = 1.4_dp

contains

    !> Pressure behind the regular reflection of a shock over that of the still gas ahead (two-shock
    !> theory, weak solution): in the frame of the point where it meets the wall the gas comes along
    !> the wall, is turned towards it by the first shock and back by the second.
    pure real(dp) function regular_reflection(mach, angle)
        real(dp), intent(in) :: mach !! of the shock
        real(dp), intent(in) :: angle !! between shock and wall, in 0..pi/2 [rad]
        real(dp) :: along, behind

        along = mach/sin(angle)
        behind = mach_behind(along, angle)
        regular_reflection = pressure_jump(along, angle) &
            *pressure_jump(behind, weak_shock(behind, turn(along, angle)))
    end function regular_reflection

    !> Angle by which an oblique shock turns the flow [rad].
    pure real(dp) function turn(mach, beta)
        real(dp), intent(in) :: mach, beta !! Mach number ahead, angle of the shock [rad]

        turn = atan(2/tan(beta)*((mach*sin(beta))**2 - 1)/(mach**2*(g + cos(2*beta)) + 2))
    end function turn

    !> Ratio of the pressures across an oblique shock.
    pure real(dp) function pressure_jump(mach, beta)
        real(dp), intent(in) :: mach, beta

        pressure_jump = 1 + 2*g/(g + 1)*((mach*sin(beta))**2 - 1)
    end function pressure_jump

    !> Mach number behind an oblique shock.
    pure real(dp) function mach_behind(mach, beta)
        real(dp), intent(in) :: mach, beta
        real(dp) :: normal2

        normal2 = (mach*sin(beta))**2
        mach_behind = sqrt((1 + (g - 1)/2*normal2)/(g*normal2 - (g - 1)/2)) &
            /sin(beta - turn(mach, beta))
    end function mach_behind

    !> Angle of the weak shock that turns a flow by an angle [rad].
    pure real(dp) function weak_shock(mach, delta)
        real(dp), intent(in) :: mach, delta
        real(dp) :: low, high
        integer :: m

        low = asin(1/mach)
        high = asin(sqrt(((g + 1)/4*mach**2 - 1 + sqrt((g + 1)*(1 + (g - 1)/2*mach**2 &
            + (g + 1)/16*mach**4)))/(g*mach**2))) ! turns it most
        do m = 1, 60
            weak_shock = (low + high)/2
            if (turn(mach, weak_shock) < delta) then
                low = weak_shock
            else
                high = weak_shock
            end if
        end do
    end function weak_shock

    !> Pressure where a supersonic flow comes to rest behind a normal shock, over that ahead.
    pure real(dp) function pitot_ratio(mach)
        real(dp), intent(in) :: mach

        pitot_ratio = ((g + 1)/2*mach**2)**(g/(g - 1)) &
            *((g + 1)/(2*g*mach**2 - (g - 1)))**(1/(g - 1))
    end function pitot_ratio
end module oblique_shocks
