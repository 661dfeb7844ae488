! SPDX-License-Identifier: MIT
!> Jones-Wilkins-Lee equation of state of the products of an explosive.
!>
!> With V = rho0/rho and E = rho0 e the energy per initial volume:
!>   p = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w E/V
!> An ideal gas is the case A = B = 0, w = gamma - 1. Always real64: the energy of expanded products
!> is a small part of what they started with. Point physics: compiled for the CPU and for the GPU.
!> Source: Lee, Hornig, Kury 1968, UCRL-50422.
module brz_jwl
    use brz_kinds, only: dp
    implicit none
    private
    public :: jwl_t, jwl_pressure, jwl_energy, jwl_sound_speed, jwl_isentrope, jwl_hugoniot, jwl_cj

    !> Constants of one explosive.
    type :: jwl_t
        real(dp) :: rho0 = 1 !! density of the explosive [kg/m3]
        real(dp) :: a = 0, b = 0 !! [Pa]
        real(dp) :: r1 = 1, r2 = 1 !! [-]
        real(dp) :: omega = 0.4_dp !! [-]
        real(dp) :: e0 = 0 !! energy per initial volume that detonation sets free [J/m3]
    end type jwl_t

contains

    !> The two exponentials A exp(-R1 V) and B exp(-R2 V) [Pa].
    !@cuf attributes(host,device) &
    pure subroutine exponentials(eos, v, first, second)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: v !! relative volume [-]
        real(dp), intent(out) :: first, second !! [Pa]

        first = 0
        second = 0
        if (eos%a > 0) first = eos%a*exp(-eos%r1*v)
        if (eos%b > 0) second = eos%b*exp(-eos%r2*v)
    end subroutine exponentials

    !> Pressure that the products would have without the energy term [Pa].
    !@cuf attributes(host,device) &
    pure function cold(eos, v) result(p)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: v !! relative volume [-]
        real(dp) :: p, first, second

        call exponentials(eos, v, first, second)
        p = first*(1 - eos%omega/(eos%r1*v)) + second*(1 - eos%omega/(eos%r2*v))
    end function cold

    !> Pressure [Pa].
    !@cuf attributes(host,device) &
    pure function jwl_pressure(eos, rho, e) result(p)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: rho !! density [kg/m3]
        real(dp), intent(in) :: e !! energy per mass [J/kg]
        real(dp) :: p

        p = cold(eos, eos%rho0/rho) + eos%omega*rho*e
    end function jwl_pressure

    !> Energy per mass [J/kg].
    !@cuf attributes(host,device) &
    pure function jwl_energy(eos, rho, p) result(e)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: rho !! density [kg/m3]
        real(dp), intent(in) :: p !! pressure [Pa]
        real(dp) :: e

        e = (p - cold(eos, eos%rho0/rho))/(eos%omega*rho)
    end function jwl_energy

    !> Speed of sound [m/s]; zero where the state is not stable.
    !@cuf attributes(host,device) &
    pure function jwl_sound_speed(eos, rho, p) result(c)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: rho !! density [kg/m3]
        real(dp), intent(in) :: p !! pressure [Pa]
        real(dp) :: c, v, first, second, c2

        v = eos%rho0/rho
        call exponentials(eos, v, first, second)
        c2 = (v*(eos%r1*first + eos%r2*second) + (1 + eos%omega)*(p - first - second))/rho
        c = sqrt(max(c2, 0.0_dp))
    end function jwl_sound_speed

    !> Pressure [Pa] after a change of density without shock.
    !@cuf attributes(host,device) &
    pure function jwl_isentrope(eos, rho, p, rho_new) result(p_new)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: rho !! density [kg/m3]
        real(dp), intent(in) :: p !! pressure [Pa]
        real(dp), intent(in) :: rho_new !! density afterwards [kg/m3]
        real(dp) :: p_new, first, second

        call exponentials(eos, eos%rho0/rho, first, second)
        p_new = (p - first - second)*(rho_new/rho)**(1 + eos%omega)
        call exponentials(eos, eos%rho0/rho_new, first, second)
        p_new = p_new + first + second
    end function jwl_isentrope

    !> Pressure [Pa] behind a shock that compresses a state (rho, p, e) to a density; with the
    !> explosive at rest as that state (rho0, 0, e0/rho0) the Hugoniot of the detonation. Negative
    !> beyond the largest compression that a shock can reach.
    !@cuf attributes(host,device) &
    pure function jwl_hugoniot(eos, rho, p, e, rho_new) result(p_new)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: rho, p, e !! state ahead [kg/m3, Pa, J/kg]
        real(dp), intent(in) :: rho_new !! density behind [kg/m3]
        real(dp) :: p_new, half, slope

        half = (1/rho - 1/rho_new)/2
        slope = 1/(eos%omega*rho_new) - half
        p_new = (cold(eos, eos%rho0/rho_new)/(eos%omega*rho_new) + e + half*p)/slope
    end function jwl_hugoniot

    !> Chapman-Jouguet state: the detonation of least speed, found by golden section.
    !@cuf attributes(host,device) &
    pure subroutine jwl_cj(eos, rho, p, d)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(out) :: rho !! density [kg/m3]
        real(dp), intent(out) :: p !! pressure [Pa]
        real(dp), intent(out) :: d !! speed of the detonation [m/s]
        real(dp), parameter :: golden = (sqrt(5.0_dp) - 1)/2
        real(dp) :: lo, hi, v(2), speed(2)
        integer :: m, k

        ! no shock compresses a gas further than w/(w + 2); all solid products lie well inside
        lo = eos%omega/(eos%omega + 2) + 1e-6_dp
        hi = 1 - 1e-6_dp
        v = [hi - golden*(hi - lo), lo + golden*(hi - lo)]
        do k = 1, 2
            speed(k) = detonation_speed(eos, v(k))
        end do
        do m = 1, 80
            if (speed(1) < speed(2)) then
                hi = v(2)
                v = [hi - golden*(hi - lo), v(1)]
                speed = [detonation_speed(eos, v(1)), speed(1)]
            else
                lo = v(1)
                v = [v(2), lo + golden*(hi - lo)]
                speed = [speed(2), detonation_speed(eos, v(2))]
            end if
        end do
        rho = eos%rho0/v(1)
        d = speed(1)
        p = eos%rho0*d**2*(1 - v(1))
    end subroutine jwl_cj

    !> Speed of a detonation that leaves the products at a relative volume [m/s].
    !@cuf attributes(host,device) &
    pure function detonation_speed(eos, v) result(d)
        type(jwl_t), intent(in) :: eos
        real(dp), intent(in) :: v !! relative volume [-]
        real(dp) :: d, p

        p = jwl_hugoniot(eos, eos%rho0, 0.0_dp, eos%e0/eos%rho0, eos%rho0/v)
        d = sqrt(max(p, 0.0_dp)/(eos%rho0*(1 - v)))
    end function detonation_speed
end module brz_jwl
