! SPDX-License-Identifier: MIT
!> Metal of Voce: hardening that saturates, in two steps; strength by rate and temperature.
!>
!> Deck:    &material model='voce'
!> Method:  Y = (a + sum of q (1 - exp(-theta/q eps_p))) (1 + rate/rate0)^c (1 - T*^m) over q1,
!>          theta1 and q2, theta2; the rest in metal.f90
!> Source:  Voce 1948; rate and temperature as in Borvik, Hopperstad, Berstad & Langseth 2001
module brz_voce
    use brz_key, only: required
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t, n_par
    use brz_metal_keys, only: amount, derive_metal, describe_metal, m_rate0
    use brz_model, only: model_t, real_key
    use brz_thermal_softening, only: softened_by_heat
    implicit none
    private
    public :: voce, describe_voce, heat_voce, flow_voce

    integer, parameter :: voce = 14, voce_history = 3 !! code of the model
    integer, parameter :: p_a = 1, p_q1 = 2, p_theta1 = 3, p_q2 = 4, p_theta2 = 5, p_c = 6, &
        p_m = 7
    integer, parameter :: p_b1 = 8, p_b2 = 9 !! derived: theta/q

contains

    subroutine describe_voce(model)
        type(model_t), intent(inout) :: model

        model%code = voce
        model%name = 'voce'
        model%n_hist = voce_history
        call describe_metal(model, [ &
            amount('a', 'Pa', required, 'yield stress', 1e6_dp, 1e10_dp, positive=.true.), &
            amount('q1', 'Pa', required, 'gain of the first step of hardening', 1e5_dp, 1e10_dp, &
                   positive=.true.), &
            amount('theta1', 'Pa', required, 'its slope where it begins', 1e6_dp, 1e12_dp), &
            real_key('', 'q2', 'Pa', '0', 'gain of the second step of hardening', 0.0_dp), &
            real_key('', 'theta2', 'Pa', '0', 'its slope where it begins', 0.0_dp), &
            real_key('', 'c', '-', '0', 'exponent of the rate factor', 0.0_dp, 0.5_dp), &
            amount('m', '-', required, 'exponent of thermal softening', 0.1_dp, 5.0_dp, &
                   positive=.true.)], 'gruneisen', '1', &
            'plastic rate at which the rate factor is 2^c')
        model%derive => derive
    end subroutine describe_voce

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        associate (par => material%par)
            if ((par(p_q2) > 0) .neqv. (par(p_theta2) > 0)) then
                fault = 'q2 and theta2 belong together: a second step of hardening has both'
                return
            end if
            par(p_b1) = par(p_theta1)/par(p_q1)
            par(p_b2) = par(p_theta2)/max(par(p_q2), tiny(par(p_q2)))
        end associate
        call derive_metal(material, given, material%par(p_a), fault)
    end subroutine derive

    !> What heat leaves of the strength.
    !@cuf attributes(host,device) &
    pure function heat_voce(par, hot) result(soft)
        real(rk), intent(in) :: par(n_par), hot !! T*
        real(rk) :: soft

        soft = softened_by_heat(hot, par(p_m))
    end function heat_voce

    !> Flow stress and its slopes.
    !@cuf attributes(host,device) &
    pure subroutine flow_voce(par, strain, rate, heat, y, slope, by_rate)
        real(rk), intent(in) :: par(n_par), strain, rate, heat
        real(rk), intent(out) :: y, slope, by_rate !! [Pa], per strain, per rate
        real(rk) :: factor, first, second

        first = par(p_q1)*exp(-par(p_b1)*strain)
        second = par(p_q2)*exp(-par(p_b2)*strain)
        factor = heat
        if (par(p_c) > 0) factor = heat*(1 + rate/par(m_rate0))**par(p_c)
        y = (par(p_a) + (par(p_q1) - first) + (par(p_q2) - second))*factor
        slope = (par(p_b1)*first + par(p_b2)*second)*factor
        by_rate = y*par(p_c)/(par(m_rate0) + rate)
    end subroutine flow_voce
end module brz_voce
