! SPDX-License-Identifier: MIT
!> The equations of state that solids and liquids choose from, all of the form p = A(mu) + B(mu) E.
!>
!> mu = rho/rho0 - 1 and E = rho0 e, energy per INITIAL volume. As all are linear in the energy,
!> pressure and energy of a step are solved together in closed form (pressure_step).
!>     gruneisen   a shock Hugoniot, see mie_gruneisen.f90
!>     polynomial  A = a1 mu + a2 mu^2 + a3 mu^3 in compression, t1 mu + t2 mu^2 in tension,
!>                 B = b0 + b1 mu in compression, b0 in tension
!>     linear      A = K mu, B = 0
!> Point physics: compiled for the CPU and for the GPU.
module brz_equation_of_state
    use brz_kinds, only: rk
    use brz_mie_gruneisen, only: mie_gruneisen, eos_a
    implicit none
    private
    public :: eos_terms_t, eos_terms, unloaded_bulk, n_block
    public :: eos_gruneisen, eos_polynomial, eos_linear
    public :: k_kind, k_density, k_a1, k_a2, k_a3, k_b0, k_b1, k_t1, k_t2, k_mu_max

    integer, parameter :: eos_gruneisen = 1, eos_polynomial = 2, eos_linear = 3

    ! Slots of the block of parameters. Behind its kind, that of Grueneisen is as in
    ! mie_gruneisen.f90.
    integer, parameter :: k_kind = 1, k_density = 2
    integer, parameter :: k_a1 = 3, k_a2 = 4, k_a3 = 5, k_b0 = 6, k_b1 = 7, k_t1 = 8, k_t2 = 9
    integer, parameter :: k_mu_max = 10 !! polynomial: A is evaluated at this compression at most
    integer, parameter :: n_block = 10

    type :: eos_terms_t
        real(rk) :: a, b !! A [Pa], B [-]
        real(rk) :: a_slope, b_slope !! dA/dmu [Pa], dB/dmu [-]
        logical :: clamped !! mu beyond the range of the equation, A held at its edge
    end type eos_terms_t

contains

    !> A and B with their slopes.
    !@cuf attributes(host,device) &
    pure subroutine eos_terms(eos, mu, terms)
        real(rk), intent(in) :: eos(n_block) !! slots above
        real(rk), intent(in) :: mu
        type(eos_terms_t), intent(out) :: terms

        terms%clamped = .false.
        select case (int(eos(k_kind)))
        case (eos_gruneisen)
            call mie_gruneisen(eos(k_density), mu, terms%a, terms%b, terms%a_slope, terms%clamped)
            terms%b_slope = eos(k_density + eos_a - 1)
        case (eos_polynomial)
            call polynomial(eos, mu, terms)
        case default
            terms%a = eos(k_a1)*mu
            terms%a_slope = eos(k_a1)
            terms%b = 0
            terms%b_slope = 0
        end select
    end subroutine eos_terms

    !> Bulk modulus of the unloaded material [Pa].
    !@cuf attributes(host,device) &
    pure function unloaded_bulk(eos) result(bulk)
        real(rk), intent(in) :: eos(n_block)
        real(rk) :: bulk
        type(eos_terms_t) :: terms

        call eos_terms(eos, 0.0_rk, terms)
        bulk = terms%a_slope
    end function unloaded_bulk

    !@cuf attributes(host,device) &
    pure subroutine polynomial(eos, mu, terms)
        real(rk), intent(in) :: eos(n_block), mu
        type(eos_terms_t), intent(inout) :: terms
        real(rk) :: m

        if (mu > 0) then
            terms%clamped = mu > eos(k_mu_max)
            m = min(mu, eos(k_mu_max))
            terms%a = m*(eos(k_a1) + m*(eos(k_a2) + m*eos(k_a3)))
            terms%a_slope = eos(k_a1) + m*(2*eos(k_a2) + 3*m*eos(k_a3))
            terms%b = eos(k_b0) + eos(k_b1)*mu
            terms%b_slope = eos(k_b1)
        else
            terms%a = mu*(eos(k_t1) + mu*eos(k_t2))
            terms%a_slope = eos(k_t1) + 2*mu*eos(k_t2)
            terms%b = eos(k_b0)
            terms%b_slope = 0
        end if
    end subroutine polynomial
end module brz_equation_of_state
