! SPDX-License-Identifier: MIT
!> Steel with linear hardening, and rate dependence after Cowper and Symonds.
!>
!> Deck:    &material model='bilinear_j2'
!> Method:  p = K mu; Y = (fy + H eps_p) (1 + (rate/D)^(1/P)), H = E Et/(E - Et); the rest in
!>          metal.f90
!> Source:  Cowper & Symonds 1957
module brz_bilinear_j2
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t, n_par
    use brz_metal_keys, only: amount, derive_metal, describe_metal, m_young
    use brz_model, only: model_t, real_key
    use brz_rate_factor, only: apply_rate_factor
    implicit none
    private
    public :: bilinear_j2, describe_bilinear_j2, flow_bilinear_j2

    integer, parameter :: bilinear_j2 = 5, bilinear_j2_history = 1 !! code of the model
    integer, parameter :: p_yield = 1, p_tangent = 2, p_rate = 3, p_exponent = 4
    integer, parameter :: p_hardening = 5, p_power = 6 !! derived

contains

    subroutine describe_bilinear_j2(model)
        type(model_t), intent(inout) :: model

        model%code = bilinear_j2
        model%name = 'bilinear_j2'
        model%n_hist = bilinear_j2_history
        call describe_metal(model, [ &
            amount('yield_stress', 'Pa', required, 'yield stress at rest', 1e5_dp, 1e10_dp, &
                   positive=.true.), &
            real_key('', 'tangent_modulus', 'Pa', '0', &
                     'slope of the uniaxial curve after yield', 0.0_dp), &
            amount('cowper_symonds_d', '1/s', none, &
                   'rate at which the yield stress doubles; absent: no rate dependence', &
                   0.1_dp, 1e8_dp, positive=.true.), &
            real_key('', 'cowper_symonds_p', '-', '5', 'the rate acts with the power 1/p', &
                     1.0_dp)], '', '1', 'reference rate of d4')
        model%derive => derive
    end subroutine describe_bilinear_j2

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        associate (par => material%par)
            if (par(p_tangent) >= par(m_young)) then
                fault = 'tangent_modulus must be below youngs_modulus'
                return
            end if
            if (.not. given(p_rate)) par(p_rate) = 0
            par(p_hardening) = par(p_tangent)*par(m_young)/(par(m_young) - par(p_tangent))
            par(p_power) = 1/par(p_exponent)
        end associate
        call derive_metal(material, given, material%par(p_yield), fault)
    end subroutine derive

    !> Flow stress and its slopes.
    !@cuf attributes(host,device) &
    pure subroutine flow_bilinear_j2(par, strain, rate, y, slope, by_rate)
        real(rk), intent(in) :: par(n_par), strain, rate
        real(rk), intent(out) :: y, slope, by_rate !! [Pa], per strain, per rate

        y = par(p_yield) + par(p_hardening)*strain
        slope = par(p_hardening)
        by_rate = 0
        if (par(p_rate) > 0) &
            call apply_rate_factor(par(p_rate), par(p_power), rate, y, slope, by_rate)
    end subroutine flow_bilinear_j2
end module brz_bilinear_j2
