! SPDX-License-Identifier: MIT
!> Metal with linear hardening and the rate factor of Cowper and Symonds on all of its strength.
!>
!> Deck:    &material model='cowper_symonds'
!> Method:  Y = min(fy + H eps_p, fu) (1 + (rate/D)^(1/q)), H = E Et/(E - Et); the rest in metal.f90
!> Source:  Cowper & Symonds 1957; Jones 1989
module brz_cowper_symonds
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t, n_par
    use brz_metal_keys, only: amount, derive_metal, describe_metal, m_young
    use brz_model, only: model_t, real_key
    use brz_rate_factor, only: apply_rate_factor
    implicit none
    private
    public :: cowper_symonds, describe_cowper_symonds, flow_cowper_symonds

    integer, parameter :: cowper_symonds = 12, cowper_symonds_history = 1 !! code of the model
    integer, parameter :: p_yield = 1, p_tangent = 2, p_ultimate = 3, p_d = 4, p_q = 5
    integer, parameter :: p_hardening = 6, p_power = 7 !! derived

contains

    subroutine describe_cowper_symonds(model)
        type(model_t), intent(inout) :: model

        model%code = cowper_symonds
        model%name = 'cowper_symonds'
        model%n_hist = cowper_symonds_history
        call describe_metal(model, [ &
            amount('yield_stress', 'Pa', required, 'yield stress at rest', 1e6_dp, 1e10_dp, &
                   positive=.true.), &
            real_key('', 'tangent_modulus', 'Pa', '0', &
                     'slope of the uniaxial curve at rest after yield', 0.0_dp), &
            amount('ultimate_stress', 'Pa', none, &
                   'true stress at rest at which hardening ends; absent: never', 1e6_dp, 1e10_dp, &
                   positive=.true.), &
            amount('d', '1/s', required, 'rate at which the strength is twice that at rest', &
                   0.1_dp, 1e8_dp, positive=.true.), &
            amount('q', '-', required, 'the rate acts with the power 1/q', 1.0_dp, 20.0_dp, &
                   positive=.true.)], 'linear', '1', 'reference rate of d4')
        model%derive => derive
    end subroutine describe_cowper_symonds

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        associate (par => material%par)
            if (.not. given(p_ultimate)) par(p_ultimate) = huge(1.0_rk)
            if (par(p_tangent) >= par(m_young)) &
                fault = 'tangent_modulus must be below youngs_modulus'
            if (par(p_ultimate) < par(p_yield)) fault = 'ultimate_stress lies below yield_stress'
            if (par(p_q) < 1) fault = 'q is below 1: the law is (rate/d)**(1/q), 5 for mild steel'
            if (allocated(fault)) return
            par(p_hardening) = par(p_tangent)*par(m_young)/(par(m_young) - par(p_tangent))
            par(p_power) = 1/par(p_q)
        end associate
        call derive_metal(material, given, material%par(p_yield), fault)
    end subroutine derive

    !> Flow stress and its slopes.
    !@cuf attributes(host,device) &
    pure subroutine flow_cowper_symonds(par, strain, rate, y, slope, by_rate)
        real(rk), intent(in) :: par(n_par), strain, rate
        real(rk), intent(out) :: y, slope, by_rate !! [Pa], per strain, per rate

        slope = par(p_hardening)
        y = par(p_yield) + slope*strain
        if (y >= par(p_ultimate)) slope = 0
        y = min(y, par(p_ultimate))
        call apply_rate_factor(par(p_d), par(p_power), rate, y, slope, by_rate)
    end subroutine flow_cowper_symonds
end module brz_cowper_symonds
