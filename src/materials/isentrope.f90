! SPDX-License-Identifier: MIT
!> Energy and temperature on the isentrope of the unloaded material, against which heat is measured.
!>
!> With a constant specific heat c and rho gamma a function of the density alone,
!>     T = T_s(mu) + (e - e_s(mu))/c,   T_s = T_0 exp(integral of B/(1 + mu)^2 dmu)
!> In expansion (mu < 0) the isentrope counts as that of no compression.
!> Point physics: compiled for the CPU and for the GPU.
module brz_isentrope
    use brz_equation_of_state, only: eos_terms, eos_terms_t, n_block, k_density
    use brz_kinds, only: rk
    use brz_mie_gruneisen, only: pressure_step
    implicit none
    private
    public :: isentrope_step, isentrope_temperature

contains

    !> Energy on the isentrope, carried from one compression to another (second order).
    !@cuf attributes(host,device) &
    pure subroutine isentrope_step(eos, mu_old, mu_new, energy)
        real(rk), intent(in) :: eos(n_block)
        real(rk), intent(in) :: mu_old, mu_new
        real(rk), intent(inout) :: energy !! e_s [J/kg]
        type(eos_terms_t) :: terms
        real(rk) :: m0, m1, p_old, p, dv
        logical :: ok

        m0 = max(mu_old, 0.0_rk)
        m1 = max(mu_new, 0.0_rk)
        call eos_terms(eos, m0, terms)
        p_old = terms%a + terms%b*eos(k_density)*energy
        call eos_terms(eos, m1, terms)
        dv = (m0 - m1)/(eos(k_density)*(1 + m0)*(1 + m1))
        call pressure_step(terms%a, terms%b*eos(k_density), -huge(p), dv, p_old, energy, p, ok)
        if (.not. m1 > 0) energy = 0
    end subroutine isentrope_step

    !> Temperature on the isentrope [K].
    !@cuf attributes(host,device) &
    pure function isentrope_temperature(eos, mu, start) result(temperature)
        real(rk), intent(in) :: eos(n_block), mu
        real(rk), intent(in) :: start !! at mu = 0 [K]
        real(rk) :: temperature
        type(eos_terms_t) :: terms
        real(rk) :: m

        ! B is linear in mu: B = (b - b_slope mu) + b_slope mu
        m = max(mu, 0.0_rk)
        call eos_terms(eos, m, terms)
        temperature = start*exp((terms%b - terms%b_slope*(1 + m))*m/(1 + m) + &
                                terms%b_slope*log(1 + m))
    end function isentrope_temperature
end module brz_isentrope
