! SPDX-License-Identifier: MIT
!> Metal of Johnson and Cook: strength by strain, rate and temperature.
!>
!> Deck:    &material model='johnson_cook'
!> Method:  Y = (a + b eps_p^n) (1 + c ln max(rate/rate0, 1)) (1 - T*^m); the rest in metal.f90
!> Source:  Johnson & Cook 1983
module brz_johnson_cook
    use brz_key, only: required
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t, n_par
    use brz_metal_keys, only: amount, derive_metal, describe_metal, m_rate0
    use brz_model, only: model_t
    use brz_thermal_softening, only: softened_by_heat
    implicit none
    private
    public :: johnson_cook, describe_johnson_cook, heat_johnson_cook, flow_johnson_cook

    integer, parameter :: johnson_cook = 6, johnson_cook_history = 3 !! code of the model
    integer, parameter :: p_a = 1, p_b = 2, p_n = 3, p_c = 4, p_m = 5

contains

    subroutine describe_johnson_cook(model)
        type(model_t), intent(inout) :: model

        model%code = johnson_cook
        model%name = 'johnson_cook'
        model%n_hist = johnson_cook_history
        call describe_metal(model, [ &
            amount('a', 'Pa', required, 'yield stress', 1e6_dp, 1e10_dp, positive=.true.), &
            amount('b', 'Pa', required, 'hardening', 1e5_dp, 1e10_dp), &
            amount('n', '-', required, 'exponent of the hardening', 0.01_dp, 2.0_dp), &
            amount('c', '-', required, 'rate coefficient', 1e-5_dp, 0.5_dp), &
            amount('m', '-', required, 'exponent of thermal softening', 0.1_dp, 5.0_dp, &
                   positive=.true.)], 'gruneisen', '1', &
            'plastic rate at which the rate factor is 1; below it stays 1')
        model%derive => derive
    end subroutine describe_johnson_cook

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        call derive_metal(material, given, material%par(p_a), fault)
    end subroutine derive

    !> What heat leaves of the strength.
    !@cuf attributes(host,device) &
    pure function heat_johnson_cook(par, hot) result(soft)
        real(rk), intent(in) :: par(n_par), hot !! T*
        real(rk) :: soft

        soft = softened_by_heat(hot, par(p_m))
    end function heat_johnson_cook

    !> Flow stress and its slopes, finite also at strain = 0.
    !@cuf attributes(host,device) &
    pure subroutine flow_johnson_cook(par, strain, rate, heat, y, slope, by_rate)
        real(rk), intent(in) :: par(n_par), strain, rate, heat
        real(rk), intent(out) :: y, slope, by_rate !! [Pa], per strain, per rate
        real(rk), parameter :: least = 1e-12_rk
        real(rk) :: factor

        y = par(p_b)
        if (par(p_n) > 0) y = par(p_b)*strain**par(p_n)
        slope = par(p_n)*y/(strain + least)
        y = par(p_a) + y
        factor = heat
        by_rate = 0
        if (rate > par(m_rate0)) then
            factor = heat*(1 + par(p_c)*log(rate/par(m_rate0)))
            by_rate = y*heat*par(p_c)/rate
        end if
        y = y*factor
        slope = slope*factor
    end subroutine flow_johnson_cook
end module brz_johnson_cook
