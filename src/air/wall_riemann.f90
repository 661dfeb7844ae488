! SPDX-License-Identifier: MIT
!> Gas against a moving wall: the exact state at the wall, and the flux through a fixed face.
!>
!> The wall is a piston to the gas: a shock runs into the gas where it is compressed, a rarefaction
!> where the wall withdraws. Point physics.
module brz_wall_riemann
    use brz_kinds, only: rk
    implicit none
    private
    public :: wall_star, wall_flux

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

        pc = max(p, tiny(p)*1e6_rk)
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

    !> Flux through a fixed face where gas meets a wall: the state at the wall, carried at the
    !> velocity of the wall; the gas slips along it.
    !@cuf attributes(host,device) &
    pure subroutine wall_flux(gamma, w, v, side, f, p_star)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: w(5) !! density, velocity (normal in slot 2), pressure of the gas
        real(rk), intent(in) :: v !! normal velocity of the wall [m/s]
        integer, intent(in) :: side !! +1: the wall is above the gas, -1: below
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk), intent(out) :: p_star !! pressure on the wall [Pa]
        real(rk) :: rho_star

        call wall_star(gamma, w(1), w(5), side*(w(2) - v), p_star, rho_star)
        f(1) = rho_star*v
        f(2) = f(1)*v + p_star
        f(3) = f(1)*w(3)
        f(4) = f(1)*w(4)
        f(5) = v*(p_star*(gamma/(gamma - 1)) + rho_star*(v*v + w(3)*w(3) + w(4)*w(4))/2)
    end subroutine wall_flux
end module brz_wall_riemann
