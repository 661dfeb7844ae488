! SPDX-License-Identifier: MIT
!> Metal of Zerilli and Armstrong: strength by the thermally activated glide of dislocations.
!>
!> Deck:    &material model='zerilli_armstrong'
!> Method:  Y = c0 + (c1 + c2 sqrt(eps_p)) exp(-(c3 - c4 ln rate) T) + c5 eps_p^n, the rate at least
!>          rate0; body-centred metals have c2 = 0, face-centred c1 = c5 = 0; the rest in metal.f90
!> Source:  Zerilli & Armstrong 1987
module brz_zerilli_armstrong
    use brz_kinds, only: dp, rk
    use brz_key, only: required
    use brz_material, only: material_t, n_par
    use brz_metal_keys, only: amount, derive_metal, describe_metal, m_rate0, m_room, m_start
    use brz_model, only: model_t
    implicit none
    private
    public :: zerilli_armstrong, describe_zerilli_armstrong, flow_zerilli_armstrong

    integer, parameter :: zerilli_armstrong = 13, zerilli_armstrong_history = 3 !! code of the model
    integer, parameter :: p_c0 = 1, p_c1 = 2, p_c2 = 3, p_c3 = 4, p_c4 = 5, p_c5 = 6, p_n = 7

contains

    subroutine describe_zerilli_armstrong(model)
        type(model_t), intent(inout) :: model
        real(dp), parameter :: low = 1e6_dp, high = 1e10_dp

        model%code = zerilli_armstrong
        model%name = 'zerilli_armstrong'
        model%n_hist = zerilli_armstrong_history
        call describe_metal(model, [ &
            amount('c0', 'Pa', required, 'athermal, of solutes and grains', low, high), &
            amount('c1', 'Pa', '0', 'thermal, without strain (body-centred)', low, high), &
            amount('c2', 'Pa', '0', 'thermal, over sqrt(strain) (face-centred)', low, high), &
            amount('c3', '1/K', required, 'fall with the temperature', 1e-4_dp, 0.05_dp), &
            amount('c4', '1/K', required, 'rise with ln(rate) T', 1e-5_dp, 5e-3_dp), &
            amount('c5', 'Pa', '0', 'athermal hardening (body-centred)', low, high), &
            amount('n', '-', '0.5', 'its exponent', 0.01_dp, 2.0_dp, positive=.true.)], &
            'gruneisen', '0.001', 'plastic rate below which the strength no longer falls')
        model%derive => derive
    end subroutine describe_zerilli_armstrong

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault
        real(rk) :: y, slope, by_rate

        associate (par => material%par)
            if (max(par(p_c1), par(p_c2)) <= 0) fault = 'without c1 and c2 neither rate nor '// &
                'heat acts: give c1 of a body-centred or c2 of a face-centred metal'
            if (par(p_c4)*log(1e3_rk) >= par(p_c3)) &
                fault = 'c4 is not far below c3: at 1e3 1/s the metal would harden when heated'
            if (allocated(fault)) return
            call flow_zerilli_armstrong(par, 0.0_rk, par(m_rate0), &
                                        merge(par(m_start), par(m_room), given(m_start)), &
                                        y, slope, by_rate)
            if (.not. y > 0) fault = 'there is no strength at the first yield: give c0 or c1'
        end associate
        if (.not. allocated(fault)) call derive_metal(material, given, y, fault)
    end subroutine derive

    !> Flow stress and its slopes, finite also at strain = 0.
    !@cuf attributes(host,device) &
    pure subroutine flow_zerilli_armstrong(par, strain, rate, heat, y, slope, by_rate)
        real(rk), intent(in) :: par(n_par), strain, rate
        real(rk), intent(in) :: heat !! temperature [K]
        real(rk), intent(out) :: y, slope, by_rate !! [Pa], per strain, per rate
        real(rk), parameter :: least = 1e-12_rk
        real(rk) :: thermal, hard

        thermal = exp(heat*(par(p_c4)*log(max(rate, par(m_rate0))) - par(p_c3)))
        y = par(p_c2)*sqrt(strain)*thermal
        slope = y/(2*(strain + least))
        y = y + par(p_c1)*thermal
        by_rate = 0
        if (rate > par(m_rate0)) by_rate = y*par(p_c4)*heat/rate
        y = y + par(p_c0)
        if (.not. par(p_c5) > 0) return
        hard = par(p_c5)*strain**par(p_n)
        y = y + hard
        slope = slope + par(p_n)*hard/(strain + least)
    end subroutine flow_zerilli_armstrong
end module brz_zerilli_armstrong
