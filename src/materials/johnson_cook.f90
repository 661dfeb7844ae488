! SPDX-License-Identifier: MIT
!> Metal of Johnson and Cook: strength by strain, rate and temperature, and failure.
!>
!> Deck:    &material model='johnson_cook'
!> Method:  radial return to Y = (a + b eps_p^n) (1 + c ln max(rate/rate0, 1)) (1 - T*^m), implicit
!>          in the plastic strain and its rate; heat from plastic work or from the energy; damage
!>          by plastic over failure strain; choice of equations of state
!> Source:  Johnson & Cook 1983 (strength), 1985 (failure)
!> History: plastic strain, temperature, energy on the isentrope; damage is that of the point
module brz_johnson_cook
    use brz_algebra, only: double_dot
    use brz_eos_keys, only: chosen_block, choice_keys, cutoff_key, n_choice
    use brz_equation_of_state, only: n_block, unloaded_bulk
    use brz_isentrope, only: isentrope_step, isentrope_temperature
    use brz_isotropic, only: begin_step, end_step, fail_step, no_cutoff, on_surface, &
                             refine_root, step_t
    use brz_johnson_cook_failure, only: failure_fault, failure_lines, failure_strain, &
                                        failure_warning
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_metal, fails_at_once, material_t, point_t, n_par
    use brz_model, only: model_t, real_key, text_key, usual
    use brz_text, only: string_t
    implicit none
    private
    public :: johnson_cook, describe_johnson_cook, update_johnson_cook

    integer, parameter :: johnson_cook = 6 !! code of the model
    character(*), parameter :: name = 'johnson_cook'
    integer, parameter :: p_density = 1, p_shear = 2, p_a = 3, p_b = 4, p_n = 5, p_c = 6, p_m = 7, &
                          p_rate0 = 8, p_room = 9, p_melt = 10, p_start = 11, p_heat = 12, &
                          p_fraction = 13, p_heating = 14, p_rate = 15, p_d1 = 16, p_least = 21, &
                          p_eos = 22, p_cutoff = p_eos + n_choice, n_keys = p_cutoff
    integer, parameter :: p_fails = n_keys + 1, p_block = n_keys + 2 !! derived
    integer, parameter :: by_energy = 2, by_total_rate = 2 !! places of the words of the options
    integer, parameter :: h_strain = 1, h_temperature = 2, h_isentrope = 3
    integer, parameter :: most_passes = 50

contains

    subroutine describe_johnson_cook(model)
        type(model_t), intent(inout) :: model

        model%code = johnson_cook
        model%class = class_metal
        model%name = name
        allocate (model%keys(n_keys))
        call describe_strength(model)
        call describe_heat(model)
        call describe_failure(model)
        model%keys(p_eos:p_cutoff - 1) = choice_keys(name)
        model%keys(p_cutoff) = cutoff_key(name)
        model%n_hist = h_isentrope
        model%history(h_strain) = 'plastic_strain'
        model%history(h_temperature) = 'temperature'
        model%history_unit(h_temperature) = 'K'
        model%derive => derive
        model%rest => rest
        model%remark => remark
    end subroutine describe_johnson_cook

    subroutine describe_strength(model)
        type(model_t), intent(inout) :: model

        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.), &
                                             10.0_dp, 25000.0_dp)
        model%keys(p_shear) = usual(real_key(name, 'shear_modulus', 'Pa', required, &
            'shear modulus', &
                                       0.0_dp, open_lower=.true.), 1e6_dp, 1e12_dp)
        model%keys(p_a) = usual(real_key(name, 'a', 'Pa', required, 'yield stress', 0.0_dp, &
                                   open_lower=.true.), 1e6_dp, 1e10_dp)
        model%keys(p_b) = usual(real_key(name, 'b', 'Pa', required, 'hardening', 0.0_dp), &
            1e5_dp, 1e10_dp)
        model%keys(p_n) = usual(real_key(name, 'n', '-', required, 'exponent of the hardening', &
            0.0_dp), 0.01_dp, 2.0_dp)
        model%keys(p_c) = usual(real_key(name, 'c', '-', required, 'rate coefficient', 0.0_dp), &
            1e-5_dp, 0.5_dp)
        model%keys(p_m) = usual(real_key(name, 'm', '-', required, &
            'exponent of thermal softening', &
                                   0.0_dp, open_lower=.true.), 0.1_dp, 5.0_dp)
        model%keys(p_rate0) = real_key(name, 'reference_rate', '1/s', '1', &
            'plastic rate at which the rate factor is 1; below it stays 1', 0.0_dp, &
            open_lower=.true.)
        model%keys(p_rate) = text_key(name, 'rate', 'plastic', 'plastic|total', &
            'rate in the strength: plastic, implicit; or total, explicit')
    end subroutine describe_strength

    subroutine describe_heat(model)
        type(model_t), intent(inout) :: model

        model%keys(p_room) = usual(real_key(name, 'room_temperature', 'K', '293', &
            'temperature of the unloaded material, without softening', 0.0_dp, &
                open_lower=.true.), 200.0_dp, 400.0_dp)
        model%keys(p_melt) = usual(real_key(name, 'melt_temperature', 'K', required, &
                                      'temperature without strength', 0.0_dp, &
                                          open_lower=.true.), 550.0_dp, 4000.0_dp)
        model%keys(p_start) = usual(real_key(name, 'initial_temperature', 'K', none, &
            'temperature at t = 0; absent: room_temperature', 0.0_dp, open_lower=.true.), &
                50.0_dp, 4000.0_dp)
        model%keys(p_heat) = usual(real_key(name, 'specific_heat', 'J/(kg K)', required, &
                                      'specific heat', 0.0_dp, open_lower=.true.), 80.0_dp, &
                                          4500.0_dp)
        model%keys(p_fraction) = real_key(name, 'heat_fraction', '-', '0.9', &
            "heating='plastic_work': part of the plastic work that is heat", 0.0_dp, 1.0_dp)
        model%keys(p_heating) = text_key(name, 'heating', 'plastic_work', 'plastic_work|energy', &
            'temperature from plastic work alone, or from the energy, with shock heating')
    end subroutine describe_heat

    subroutine describe_failure(model)
        type(model_t), intent(inout) :: model

        model%keys(p_d1) = real_key(name, 'd1', '-', none, 'failure strain: constant part; '// &
                                    'absent: no failure')
        model%keys(p_d1 + 1) = real_key(name, 'd2', '-', '0', 'failure strain: triaxial part')
        model%keys(p_d1 + 2) = real_key(name, 'd3', '-', '0', &
                                        'its exponent, negative: tension weakens')
        model%keys(p_d1 + 3) = real_key(name, 'd4', '-', '0', 'failure strain: rate')
        model%keys(p_d1 + 4) = real_key(name, 'd5', '-', '0', 'failure strain: temperature')
        model%keys(p_d1 + 1:p_d1 + 4)%needs = 'd1'
        model%keys(p_d1:p_d1 + 4)%failure = .true.
        model%keys(p_least) = real_key(name, 'least_failure_strain', '-', '0.001', &
                                       'failure strain is at least this', 0.0_dp, open_lower=.true.)
    end subroutine describe_failure

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        associate (par => material%par, block => material%par(p_block:p_block + n_block - 1))
            if (par(p_melt) <= par(p_room)) then
                fault = 'melt_temperature must be above room_temperature'
                return
            end if
            if (any(given(p_d1 + 1:p_d1 + 4)) .and. .not. given(p_d1)) then
                fault = 'd2, d3, d4 and d5 need d1'
                return
            end if
            if (given(p_d1) .and. .not. given(p_least)) &
                call failure_fault(par(p_d1:p_d1 + 4), par(p_least), par(p_rate0), fault)
            if (allocated(fault)) return
            call chosen_block(par, given, p_eos, block, fault)
            if (allocated(fault)) return
            if (.not. given(p_start)) par(p_start) = par(p_room)
            if (.not. given(p_cutoff)) par(p_cutoff) = no_cutoff
            par(p_fails) = merge(1, 0, given(p_d1))
            material%fails = merge(fails_at_once, 0, given(p_d1))
            material%density = par(p_density)
            material%bulk = unloaded_bulk(block)
            material%shear = par(p_shear)
            material%yields = par(p_a)/(3*material%shear)
            material%c_wave = sqrt((material%bulk + 4*material%shear/3)/material%density)
            if (int(par(p_heating)) /= by_energy) material%n_hist = h_isentrope - 1
        end associate
    end subroutine derive

    !> Failure strains, and whether they are at their floor.
    subroutine remark(material, lines, warning)
        type(material_t), intent(in) :: material
        type(string_t), allocatable, intent(out) :: lines(:)
        character(:), allocatable, intent(out) :: warning

        if (.not. material%par(p_fails) > 0) return
        associate (par => material%par)
            call failure_lines(par(p_d1:p_d1 + 4), par(p_least), par(p_rate0), lines)
            warning = failure_warning(par(p_d1:p_d1 + 4), par(p_least), par(p_rate0))
        end associate
    end subroutine remark

    subroutine rest(material, point)
        type(material_t), intent(in) :: material
        type(point_t), intent(inout) :: point

        point%hist(h_temperature) = material%par(p_start)
    end subroutine rest

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_johnson_cook(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        type(step_t) :: step
        type(point_t) :: before
        real(rk) :: keep, strain, least, hot
        logical :: failed

        call begin_step(material, dt, l, point, step)
        failed = point%damage >= 1
        hot = warmth(material%par, point%hist(h_temperature))
        keep = 0
        strain = 0
        least = max(material%par(p_cutoff), 0.0_rk)
        if (.not. failed .and. hot < 1) then
            call plastic_return(material, dt, step, point%hist(h_strain), hot, strain, keep)
            least = material%par(p_cutoff)
        end if
        before = point
        call end_step(material, material%par(p_block), least, keep, step, point, status)
        if (status > 0) return
        if (failed) call fail_step(material, material%par(p_block), before, step, point)
        point%hist(h_strain) = point%hist(h_strain) + strain
        call heat(material, before%mu, step, point)
        if (material%par(p_fails) > 0 .and. strain > 0) &
            call add_damage(material%par, dt, strain, keep*step%mises, step%p, hot, point%damage)
    end subroutine update_johnson_cook

    !> Homologous temperature T*, 0 at room temperature and 1 where it melts.
    !@cuf attributes(host,device) &
    pure function warmth(par, temperature) result(hot)
        real(rk), intent(in) :: par(n_par), temperature
        real(rk) :: hot

        hot = min(max((temperature - par(p_room))/(par(p_melt) - par(p_room)), 0.0_rk), 1.0_rk)
    end function warmth

    !> Increment of plastic strain, and the part of the trial stress that is kept.
    !@cuf attributes(host,device) &
    pure subroutine plastic_return(material, dt, step, before, hot, strain, keep)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, before, hot !! step [s], plastic strain, T*
        type(step_t), intent(in) :: step
        real(rk), intent(out) :: strain, keep
        real(rk) :: soft, y, slope, g3, low, high, excess
        integer :: pass

        g3 = 3*material%shear
        strain = 0
        keep = 1
        soft = 1
        if (hot > 0) soft = 1 - hot**material%par(p_m)
        call hardening(material%par, before, y, slope)
        if (int(material%par(p_rate)) == by_total_rate) then
            y = y*soft*rate_factor(material%par, step%rate)
            if (step%mises > y) strain = (step%mises - y)/g3
        else if (step%mises > y*soft) then
            low = 0
            high = step%mises/g3
            strain = (step%mises - y*soft*rate_factor(material%par, step%rate))/g3
            if (.not. strain > 0) strain = (step%mises - y*soft)/g3
            do pass = 1, most_passes
                call flow_stress(material%par, before, strain, dt, soft, y, slope)
                excess = step%mises - g3*strain - y
                if (abs(excess) <= on_surface*y + 4*epsilon(y)*step%mises) exit
                call refine_root(excess, -g3 - slope, low, high, strain)
            end do
        end if
        if (strain > 0) keep = max(0.0_rk, 1 - g3*strain/step%mises)
    end subroutine plastic_return

    !> Flow stress after an increment of plastic strain within dt, and its slope by the increment.
    !@cuf attributes(host,device) &
    pure subroutine flow_stress(par, before, x, dt, soft, y, slope)
        real(rk), intent(in) :: par(n_par), before, x
        real(rk), intent(in) :: dt, soft !! step [s], thermal factor
        real(rk), intent(out) :: y, slope !! [Pa]
        real(rk) :: factor, hard

        call hardening(par, before + x, hard, slope)
        factor = soft
        slope = slope*soft
        if (x > par(p_rate0)*dt .and. dt > 0) then
            factor = soft*(1 + par(p_c)*log(x/(par(p_rate0)*dt)))
            slope = slope*factor/soft + hard*soft*par(p_c)/x
        end if
        y = hard*factor
    end subroutine flow_stress

    !> a + b eps_p^n and its slope, finite also at eps_p = 0.
    !@cuf attributes(host,device) &
    pure subroutine hardening(par, strain, hard, slope)
        real(rk), intent(in) :: par(n_par), strain
        real(rk), intent(out) :: hard, slope !! [Pa]
        real(rk), parameter :: least = 1e-12_rk

        hard = par(p_b)
        if (par(p_n) > 0) hard = par(p_b)*strain**par(p_n)
        slope = par(p_n)*hard/(strain + least)
        hard = par(p_a) + hard
    end subroutine hardening

    !@cuf attributes(host,device) &
    pure function rate_factor(par, rate) result(factor)
        real(rk), intent(in) :: par(n_par), rate
        real(rk) :: factor

        factor = 1
        if (rate > par(p_rate0)) factor = 1 + par(p_c)*log(rate/par(p_rate0))
    end function rate_factor

    !> Temperature at the end of the step.
    !@cuf attributes(host,device) &
    pure subroutine heat(material, mu_old, step, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: mu_old !! compression at the start
        type(step_t), intent(in) :: step
        type(point_t), intent(inout) :: point
        real(rk) :: elastic, cold

        if (int(material%par(p_heating)) /= by_energy) then
            point%hist(h_temperature) = point%hist(h_temperature) + &
                                        material%par(p_fraction)*point%work(1)/material%par(p_heat)
            return
        end if
        call isentrope_step(material%par(p_block), mu_old, step%mu, point%hist(h_isentrope))
        cold = isentrope_temperature(material%par(p_block), step%mu, material%par(p_start))
        elastic = double_dot(step%s, step%s)/(4*material%shear*material%density*(1 + step%mu))
        point%hist(h_temperature) = max(0.0_rk, cold + (point%energy - elastic - &
                                        point%hist(h_isentrope))/material%par(p_heat))
    end subroutine heat

    !> Damage D grows by plastic strain over failure strain; at 1 the material has failed.
    !@cuf attributes(host,device) &
    pure subroutine add_damage(par, dt, strain, mises, p, hot, damage)
        real(rk), intent(in) :: par(n_par), dt, strain
        real(rk), intent(in) :: mises, p !! at the end of the step [Pa]
        real(rk), intent(in) :: hot !! T*
        real(rk), intent(inout) :: damage
        real(rk) :: triaxiality, ratio
        real(rk), parameter :: lowest = -10, highest = 1.5_rk

        triaxiality = lowest
        if (p < -highest*mises) triaxiality = highest
        if (abs(p) < -lowest*mises) triaxiality = min(-p/mises, highest)
        ratio = 0
        if (dt > 0) ratio = strain/(par(p_rate0)*dt)
        damage = min(1.0_rk, damage + strain/ &
                     failure_strain(par(p_d1), par(p_least), triaxiality, ratio, hot))
    end subroutine add_damage
end module brz_johnson_cook
