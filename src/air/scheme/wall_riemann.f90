! SPDX-License-Identifier: MIT
!> Gas against a moving wall, the immersed boundary: the exact state at the wall, and the flux
!> through a fixed face.
!>
!> The wall is a piston to the gas: a shock runs into the gas where it is compressed, a rarefaction
!> where the wall withdraws. Point physics.
module brz_wall_riemann
    use brz_kinds, only: rk
    implicit none
    private
    public :: wall_star, wall_flux

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

    !> Flux through a fixed face where gas meets a wall; the gas slips along it.
    !>
    !> What passes is the state that comes to stand at the face: that at the wall, carried at the
    !> velocity of the wall, unless the wall withdraws so fast that its wave follows it. Where the
    !> shock or all of the rarefaction leaves the gas through the face, the gas goes as it comes;
    !> where the rarefaction stands across the face, its sonic state. The state at the wall would
    !> take more gas than comes and empty the cell. The pressure on the wall is p_star in all cases.
    !@cuf attributes(host,device) &
    pure subroutine wall_flux(gamma, w, v, side, f, p_star)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: w(5) !! density, velocity (normal in slot 2), pressure of the gas
        real(rk), intent(in) :: v !! normal velocity of the wall [m/s]
        integer, intent(in) :: side !! +1: the wall is above the gas, -1: below
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk), intent(out) :: p_star !! pressure on the wall [Pa]
        real(rk) :: p, rho, rho_star, u

        call wall_star(gamma, w(1), w(5), side*(w(2) - v), p_star, rho_star)
        p = p_star
        rho = rho_star
        u = v
        if (side*v > 0) call stand_at_face(gamma, w, v, side, rho, u, p)
        f(1) = rho*u
        f(2) = f(1)*u + p
        f(3) = f(1)*w(3)
        f(4) = f(1)*w(4)
        f(5) = u*(p*(gamma/(gamma - 1)) + rho*(u*u + w(3)*w(3) + w(4)*w(4))/2)
    end subroutine wall_flux

    !> The state at a fixed face from that at a wall which withdraws from it.
    !>
    !> Speeds are towards the wall: that of the shock, or u - c at the two ends of a rarefaction.
    !@cuf attributes(host,device) &
    pure subroutine stand_at_face(gamma, w, v, side, rho, u, p)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: w(5) !! density, velocity (normal in slot 2), pressure of the gas
        real(rk), intent(in) :: v !! normal velocity of the wall [m/s]
        integer, intent(in) :: side !! +1: the wall is above the gas, -1: below
        real(rk), intent(inout) :: rho, u, p !! at the wall; on return at the face
        real(rk) :: a, before, behind, c, sonic

        c = sqrt(gamma*max(w(5), least)/w(1))
        if (side*(w(2) - v) >= 0) then
            a = (gamma + 1)/4*side*(w(2) - v)
            before = side*w(2) - (a + sqrt(a*a + c*c))
            behind = before
        else
            before = side*w(2) - c
            behind = side*v - sqrt(gamma*p/rho)
        end if
        if (before >= 0) then
            rho = w(1)
            u = w(2)
            p = w(5)
        else if (behind > 0) then
            sonic = max((2*c + (gamma - 1)*side*w(2))/(gamma + 1), vacuum*c)
            rho = w(1)*(sonic/c)**(2/(gamma - 1))
            u = side*sonic
            p = w(5)*(sonic/c)**(2*gamma/(gamma - 1))
        end if
    end subroutine stand_at_face
end module brz_wall_riemann
