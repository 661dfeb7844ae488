! SPDX-License-Identifier: MIT
!> Gas against a moving wall: the exact state at the wall.
!>
!> The wall is a piston to the gas: a shock runs into the gas where it is compressed, a rarefaction
!> where the wall withdraws. Point physics.
module brz_wall_riemann
    use brz_kinds, only: rk
    implicit none
    private
    public :: wall_star

    real(rk), parameter :: least = 1e6_rk*tiny(1.0_rk) !! pressure that counts as none [Pa]
    real(rk), parameter :: vacuum = 1e-6_rk !! least ratio of sound speeds across the rarefaction

contains

    !> Pressure and density of the gas at the wall.
    !@cuf attributes(host,device) &
    pure subroutine wall_star(gamma, rho, p, du, p_star, rho_star)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: rho !! density of the gas [kg/m3]
        real(rk), intent(in) :: p !! pressure of the gas, negative counts as zero [Pa]
        real(rk), intent(in) :: du !! speed of the gas towards the wall, as the wall sees it [m/s]
        real(rk), intent(out) :: p_star !! pressure on the wall [Pa]
        real(rk), intent(out) :: rho_star !! density at the wall [kg/m3]
        real(rk) :: pc, c, a, b, g

        pc = max(p, least)
        c = sqrt(gamma*pc/rho)
        if (du >= 0) then
            a = (gamma + 1)/4*du
            g = (gamma - 1)/(gamma + 1)
            p_star = pc + rho*du*(a + sqrt(a*a + c*c))
            rho_star = rho*(p_star + g*pc)/(g*p_star + pc)
        else
            b = max(1 + (gamma - 1)/2*du/c, vacuum)
            p_star = pc*b**(2*gamma/(gamma - 1))
            rho_star = rho*b**(2/(gamma - 1))
        end if
    end subroutine wall_star
end module brz_wall_riemann
