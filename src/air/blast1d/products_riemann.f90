! SPDX-License-Identifier: MIT
!> The face between the products of an explosive and air: exact solution of the jump.
!>
!> Products (JWL) lie below, air (ideal gas) above. The wave into the products is followed along
!> their isentrope or Hugoniot with the density behind it as parameter; where its pressure and
!> velocity meet the curve of the air lies the contact. Exact for jumps of any strength, which at
!> the surface of a charge means 8 GPa against 0.1 MPa.
module brz_products_riemann
    use brz_jwl, only: jwl_hugoniot, jwl_isentrope, jwl_sound_speed, jwl_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: products_riemann, behind_air_wave, behind_products_wave

    integer, parameter :: most_steps = 100
    real(dp), parameter :: exact = 1e-13_dp !! of the logarithm of the density

contains

    !> Pressure and velocity of the contact.
    !@cuf attributes(host,device) &
    pure subroutine products_riemann(eos, gamma, below, above, p, u)
        type(jwl_t), intent(in) :: eos !! of the products
        real(dp), intent(in) :: gamma !! of the air [-]
        real(dp), intent(in) :: below(4) !! products: density, velocity, pressure, energy per mass
        real(dp), intent(in) :: above(3) !! air: density, velocity, pressure
        real(dp), intent(out) :: p !! pressure [Pa]
        real(dp), intent(out) :: u !! velocity [m/s]
        real(dp) :: x, lo, hi, gap, rho, slope, du, c, change, last
        integer :: m

        ! x = ln(density behind the wave in the products); the gap of velocities falls with x
        hi = log(below(1)) + 2
        lo = log(below(1)) - 40
        x = log(below(1))
        last = hi - lo
        do m = 1, most_steps
            rho = exp(x)
            call behind_products_wave(eos, below, rho, p, u)
            if (.not. p > 0) then ! beyond the largest compression, or beyond rupture
                if (rho > below(1)) hi = x
                if (.not. rho > below(1)) lo = x
                x = (lo + hi)/2
                cycle
            end if
            call behind_air_wave(gamma, above, p, du, slope)
            gap = u - du
            if (gap > 0) lo = x
            if (.not. gap > 0) hi = x
            c = jwl_sound_speed(eos, rho, p)
            change = gap/(c + slope*rho*c**2)
            if (abs(change) <= exact) exit
            if (abs(change) > 0.75_dp*last .or. x + change <= lo .or. x + change >= hi) &
                change = (lo + hi)/2 - x
            last = abs(change)
            x = x + change
        end do
    end subroutine products_riemann

    !> Pressure and velocity of the products behind the wave that brings them to a density.
    !@cuf attributes(host,device) &
    pure subroutine behind_products_wave(eos, state, rho, p, u)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: state(4) !! ahead: density, velocity, pressure, energy per mass
        real(dp), intent(in) :: rho !! density behind [kg/m3]
        real(dp), intent(out) :: p !! [Pa]; not positive: there is no such wave
        real(dp), intent(out) :: u !! [m/s]
        real(dp), parameter :: x(4) = [0.1834346424956498_dp, 0.5255324099163290_dp, &
            0.7966664774136267_dp, 0.9602898564975363_dp] ! Gauss, eight points
        real(dp), parameter :: weight(4) = [0.3626837833783620_dp, 0.3137066458778873_dp, &
            0.2223810344533745_dp, 0.1012285362903763_dp]
        real(dp) :: span, part, total, density
        integer :: i, k, piece, pieces

        u = state(2)
        if (rho > state(1)) then
            p = jwl_hugoniot(eos, state(1), state(3), state(4), rho)
            if (p > state(3)) u = u - sqrt((p - state(3))*(1/state(1) - 1/rho))
            return
        end if
        p = jwl_isentrope(eos, state(1), state(3), rho)
        ! u rises by the integral of c d(ln rho), in pieces of less than a factor of e
        span = log(state(1)/rho)
        pieces = int(span) + 1
        part = span/pieces
        total = 0
        do piece = 1, pieces
            do i = 1, 4
                do k = -1, 1, 2
                    density = rho*exp(part*(piece - 0.5_dp*(1 + k*x(i))))
                    total = total + weight(i)*jwl_sound_speed(eos, density, &
                        jwl_isentrope(eos, state(1), state(3), density))
                end do
            end do
        end do
        u = u + total*part/2
    end subroutine behind_products_wave

    !> Velocity of the air behind the wave that brings it to a pressure, and its slope du/dp.
    !@cuf attributes(host,device) &
    pure subroutine behind_air_wave(gamma, state, p, u, slope)
        real(dp), intent(in) :: gamma !! [-]
        real(dp), intent(in) :: state(3) !! ahead: density, velocity, pressure
        real(dp), intent(in) :: p !! pressure behind [Pa]
        real(dp), intent(out) :: u !! [m/s]
        real(dp), intent(out) :: slope !! [m/(s Pa)]
        real(dp) :: a, b, c

        if (p > state(3)) then
            a = 2/((gamma + 1)*state(1))
            b = (gamma - 1)/(gamma + 1)*state(3)
            u = state(2) + (p - state(3))*sqrt(a/(p + b))
            slope = sqrt(a/(p + b))*(1 - (p - state(3))/(2*(p + b)))
        else
            c = sqrt(gamma*state(3)/state(1))
            a = (p/state(3))**((gamma - 1)/(2*gamma))
            u = state(2) + 2*c/(gamma - 1)*(a - 1)
            slope = c*a/(gamma*p)
        end if
    end subroutine behind_air_wave
end module brz_products_riemann
