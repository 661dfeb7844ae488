! SPDX-License-Identifier: MIT
!> Concrete of Holmquist, Johnson and Cook: crushing pressure, strength by pressure, damage.
!>
!> Deck:    &material model='hjc'
!> Method:  pressure as a function of compression and its largest value (hjc_pressure.f90), radial
!>          return to Y = fc min(([A (1 - D) + B (p/fc)^N] (1 + C ln rate), SMAX), damage by plastic
!>          and crushing strain; see docs/theory/concrete.md
!> Source:  Holmquist, Johnson & Cook 1993; tension as in docs/theory/concrete.md
!> History: see hjc_softening.f90; the damage is that of the point
module brz_hjc
    use brz_kinds, only: dp, rk
    use brz_algebra, only: double_dot
    use brz_deviator, only: mises_stress, return_deviator, third_invariant, trial_deviator
    use brz_hjc_crack_flow, only: flow_with_cracks
    use brz_hjc_cracks, only: cracks_t, follow_rate, open_cracks
    use brz_hjc_curve, only: check_dense, check_slopes, lock_compression
    use brz_hjc_growth, only: concrete_alone, flow_t, grow
    use brz_hjc_keys, only: hjc_keys
    use brz_hjc_pressure, only: crushing_strain, crushing_work, densest, full_modulus, &
                                hjc_pressure, opening, p_a, p_b, p_crack_rate, p_density, &
                                p_dilatancy, p_erosion, p_fc, p_ft, p_full, p_gf, p_k_el, &
                                p_k_tran, p_limit, p_mu_crush, p_mu_lock, p_mu_plock, p_n, &
                                p_p_crush, p_p_lock, p_shear, p_smax, p_surface, p_t, p_young
    use brz_hjc_softening, only: by_malvar, h_damage, h_eroded, h_grown, h_mu_max, h_plastic, &
                                 h_rate, h_tension, rate_factor, widest_crack
    use brz_hjc_strength, only: add_damage, by_malvar_surface, most, rate_effect, strength
    use brz_kinematics, only: volume_step
    use brz_material, only: class_crumbling, fails_by_degrees, material_t, point_t, material_ok, &
                            material_clamped, n_hist, n_par
    use brz_model, only: derived_t, model_t
    use brz_text, only: string_t, to_text
    implicit none
    private
    public :: hjc, describe_hjc, update_hjc

    integer, parameter :: hjc = 9, hjc_history = 7 !! code of the model
    character(*), parameter :: name = 'hjc'
    integer, parameter :: erosion_tension = 2, erosion_strain = 3
    real(rk), parameter :: usual_dilatancy = 0.5_rk !! of surface='malvar'

contains

    subroutine describe_hjc(model)
        type(model_t), intent(inout) :: model

        model%code = hjc
        model%class = class_crumbling
        model%name = name
        call hjc_keys(name, model%keys)
        model%n_hist = hjc_history
        model%history(h_plastic) = 'plastic_strain'
        model%history(h_mu_max) = 'mu_max'
        model%history(h_eroded) = 'eroded'
        model%history(h_tension) = 'damage_tension'
        model%history(h_damage) = 'damage_hjc'
        model%history(h_rate) = 'crack_rate'
        model%history_unit(h_rate) = '1/s'
        model%history(h_grown) = 'grown'
        model%derive => derive
        model%report => report
        model%remark => remark
    end subroutine describe_hjc

    !> Slopes of the pressure curve; refuses a curve that is not monotone or makes energy.
    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        associate (par => material%par)
            if (given(p_limit) .neqv. int(par(p_erosion)) == erosion_strain) then
                fault = "erosion_strain and erosion='strain' belong together"
                return
            end if
            call check_dense(par, fault)
            if (allocated(fault)) return
            par(p_k_el) = par(p_p_crush)/par(p_mu_crush)
            par(p_mu_plock) = lock_compression(par)
            if (par(p_mu_plock) <= par(p_mu_crush) .or. par(p_p_lock) <= par(p_p_crush)) then
                fault = 'crushing must end (p_lock, mu_lock) above where it starts '// &
                        '(p_crush, mu_crush)'
                return
            end if
            par(p_k_tran) = (par(p_p_lock) - par(p_p_crush))/(par(p_mu_plock) - par(p_mu_crush))
            par(p_full) = full_modulus(par)
            call check_slopes(par, fault)
            call derive_cracks(material, given, fault)
            call derive_growth(material, given, fault)
            material%density = par(p_density)
            material%bulk = par(p_k_el)
            material%fails = fails_by_degrees
            material%shear = par(p_shear)
            material%c_wave = sqrt((par(p_k_el) + 4*par(p_shear)/3)/par(p_density))
        end associate
    end subroutine derive

    !> Strength and energy of cracks; without `ft` there are none.
    subroutine derive_cracks(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(inout) :: fault

        associate (par => material%par)
            par(p_young) = 9*par(p_k_el)*par(p_shear)/(3*par(p_k_el) + par(p_shear))
            if (.not. given(p_ft)) then
                if (given(p_gf) .or. int(par(p_crack_rate)) > 1) &
                    fault = 'gf and rate_tension need ft'
                if (int(par(p_surface)) == by_malvar_surface) fault = "surface='malvar' needs ft"
            else if (int(par(p_surface)) == by_malvar_surface .and. par(p_ft) > most*par(p_fc)) then
                fault = "surface='malvar' needs an ft of at most fc/4"
            else if (int(par(p_surface)) /= by_malvar_surface &
                     .and. par(p_ft) >= bar_strength(par)) then
                fault = 'ft, '//to_text(par(p_ft))//' Pa, is not below what a bar carries '// &
                        'without it, '//to_text(bar_strength(par))//' Pa'
            else if (.not. given(p_gf)) then
                par(p_gf) = 73*(par(p_fc)/1e6_rk)**0.18_rk ! fib Model Code 2010
            end if
            material%n_hist = h_eroded
            if (.not. given(p_ft)) return
            material%crack = widest_crack(par)
            material%n_hist = merge(h_rate, h_damage, int(par(p_crack_rate)) == by_malvar)
        end associate
    end subroutine derive_cracks

    !> The surface of Malvar et al. comes with its dilatancy, that of the model has none.
    subroutine derive_growth(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(inout) :: fault

        associate (par => material%par)
            if (int(par(p_surface)) /= by_malvar_surface) then
                if (given(p_dilatancy)) fault = "dilatancy needs surface='malvar'"
                par(p_dilatancy) = 0
            else if (.not. given(p_dilatancy)) then
                par(p_dilatancy) = usual_dilatancy
            end if
            if (par(p_dilatancy) > 0) material%n_hist = h_grown
        end associate
    end subroutine derive_growth

    !> Strength of a bar by the surface alone, without damage [Pa]; that of Malvar has it at ft.
    pure function bar_strength(par) result(strength)
        real(rk), intent(in) :: par(n_par)
        real(rk) :: strength

        strength = par(p_ft)
        if (int(par(p_surface)) == by_malvar_surface) return
        strength = 1/(1/(par(p_a)*par(p_fc)) + 1/(3*par(p_t)))
    end function bar_strength

    !> Slopes of the pressure, elastic constants, what a cylinder and a bar carry without damage.
    subroutine report(material, list)
        type(material_t), intent(in) :: material
        type(derived_t), allocatable, intent(out) :: list(:)
        real(dp) :: k, g, q
        integer :: i

        k = material%par(p_k_el)
        g = material%par(p_shear)
        q = 1
        do i = 1, 200
            q = material%par(p_a) + material%par(p_b)*(q/3)**material%par(p_n)
        end do
        if (int(material%par(p_surface)) == by_malvar_surface) q = 1
        list = [derived_t('K_el', 'Pa', k), &
                derived_t('K_tran', 'Pa', material%par(p_k_tran)), &
                derived_t('K_unload', 'Pa', material%par(p_full)), &
                derived_t('mu_plock', '', material%par(p_mu_plock)), &
                derived_t('E', 'Pa', 9*k*g/(3*k + g)), &
                derived_t('nu', '', (3*k - 2*g)/(6*k + 2*g)), &
                derived_t('cylinder', 'Pa', min(q, real(material%par(p_smax), dp)) &
                          *material%par(p_fc)), &
                derived_t('bar', 'Pa', bar_strength(material%par))]
        if (material%par(p_ft) > 0) list = [list, &
            derived_t('gf', 'J/m2', material%par(p_gf)), &
            derived_t('widest crack', 'm', widest_crack(material%par))]
    end subroutine report

    !> Cracks that know no rate.
    subroutine remark(material, lines, warning)
        type(material_t), intent(in) :: material
        type(string_t), allocatable, intent(out) :: lines(:)
        character(:), allocatable, intent(out) :: warning
        character(40) :: factors

        warning = ''
        if (.not. material%par(p_ft) > 0 .or. int(material%par(p_crack_rate)) == by_malvar) return
        write (factors, '(f0.1, 2(", ", f0.1))') rate_factor(material%par(p_fc), 1.0_rk), &
            rate_factor(material%par(p_fc), 10.0_rk), rate_factor(material%par(p_fc), 100.0_rk)
        lines = [string_t('cracks open at the static ft at any rate; under blast and impact '// &
                          'tests have '//trim(factors)), &
                 string_t("times that at 1, 10, 100 1/s: rate_tension = 'malvar' takes it")]
    end subroutine remark

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_hjc(material, dt, crack, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, crack !! time step [s], width of a smeared crack [m]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        real(rk) :: s(6), q(3, 3), de(6), trial(6), mu, mu_max, mu_old, dv, v_mid, p_old, p_eos, p
        real(rk) :: damage, work, plastic, crushed, released, rate, grown, alone
        type(cracks_t) :: cracks
        type(flow_t) :: flow
        integer :: i

        damage = min(max(point%damage, 0.0_rk), 1.0_rk)
        if (material%par(p_ft) > 0) damage = point%hist(h_damage)
        mu_old = max(point%hist(h_mu_max), 0.0_rk)
        mu = point%mu
        call volume_step(material%density, l, dt, mu, dv, v_mid)
        grown = 0
        if (material%par(p_dilatancy) > 0) grown = point%hist(h_grown)
        point%mu = concrete_alone(point%mu, grown) ! that of the concrete, until the end
        call hjc_pressure(material%par, concrete_alone(mu, grown), mu_old, p_eos, flow%stiffest)
        p_old = -(point%stress(1) + point%stress(2) + point%stress(3))/3
        do i = 1, 6
            s(i) = point%stress(i)
            if (i <= 3) s(i) = s(i) + p_old
        end do
        call trial_deviator(material%par(p_shear), dt, l, s, q, de, trial)
        released = 0
        cracks%damage = 0
        if (material%par(p_ft) > 0) then
            call follow_rate(material%par, crack, dt, l, point%hist)
            call crack_point(material%par, crack, s, trial, point, p_eos, cracks)
            released = cracks%released*v_mid
            if (point%hist(h_eroded) > 0) cracks%damage = 0 ! no strength, with cracks or without
        end if
        rate = rate_effect(material%par, sqrt(double_dot(de, de)*2/3), dt)
        flow%p = p_eos
        call meet_surface(material%par, damage, rate, point%hist, cracks, trial, flow)
        grown = 0
        if (material%par(p_dilatancy) > 0) then
            if (flow%strain > 0 .and. .not. cracks%damage > 0) then
                call grow(material%par, mu, damage, rate, trial, point%hist, flow)
                flow%lost = -(p_old + flow%p)/2*flow%more/(material%density*v_mid)
                if (flow%more > 0) p_eos = flow%p
            end if
            grown = point%hist(h_grown)
        end if
        alone = concrete_alone(mu, grown)
        mu_max = max(mu_old, alone)
        crushed = 0
        if (mu_max > mu_old) crushed = max(0.0_rk, crushing_strain(material%par, mu_max) &
                                           - crushing_strain(material%par, mu_old))
        point%work(1) = crushing_work(material%par, mu_old, mu_max) &
                        /(material%density*(1 + point%mu)*(1 + alone))
        call return_deviator(material%par(p_shear), flow%keep, de, trial, q, s, work, plastic)
        call add_damage(material%par, (p_old + flow%p)/2, flow%strain + crushed, damage)
        p = flow%p
        if (.not. cracks%damage > 0) p = max(p_eos, -material%par(p_t)*(1 - damage))
        if (point%hist(h_eroded) > 0) p = max(p, 0.0_rk)
        if (.not. (material%par(p_ft) > 0 .and. point%hist(h_tension) > 0)) &
            call release_tension(material%par, point, alone, mu_max, p_eos, p, damage, released)
        point%hist(h_plastic) = point%hist(h_plastic) + flow%strain
        point%hist(h_mu_max) = mu_max
        call erode(material%par, p_eos, damage, point%hist(h_plastic), point%hist(h_eroded))
        do i = 1, 3
            point%stress(i) = s(i) - p
            point%stress(i + 3) = s(i + 3)
        end do
        point%work(2) = released
        ! flow under tension is cracking; under pressure it is friction, less what makes pressure
        i = merge(1, 2, p > 0)
        point%work(i) = point%work(i) + (plastic + flow%lost)*v_mid
        point%mu = mu
        point%energy = point%energy + work*v_mid - (p_old + p)/2*dv
        point%damage = damage
        call finish(material, alone, flow%stiffest, point, status)
    end subroutine update_hjc

    !> Flow back to the surface at one volume, beside cracks where there are some.
    !@cuf attributes(host,device) &
    pure subroutine meet_surface(par, damage, rate, hist, cracks, trial, flow)
        real(rk), intent(in) :: par(n_par), damage, rate !! for `strength`
        real(rk), intent(in) :: hist(n_hist)
        type(cracks_t), intent(in) :: cracks
        real(rk), intent(inout) :: trial(6) !! deviator [Pa]
        type(flow_t), intent(inout) :: flow !! pressure of the curve and of cracks in
        real(rk) :: mises, yield, p_eos

        p_eos = flow%p
        flow%p = max(p_eos, -par(p_t)*(1 - damage))
        mises = mises_stress(trial)
        yield = strength(par, flow%p, damage, rate, hist(h_rate), mises, third_invariant(trial))
        if (hist(h_eroded) > 0) yield = 0
        flow%keep = 1
        flow%strain = 0
        flow%lost = 0
        if (cracks%damage > 0) then
            if (mises > yield .or. flow%p > p_eos) call flow_with_cracks( &
                par, damage, rate, cracks, trial, flow%p, flow%strain, flow%lost)
        else if (mises > yield) then
            flow%keep = yield/mises
            flow%strain = (mises - yield)/(3*par(p_shear))
        end if
    end subroutine meet_surface

    !> Cracks open and close: the pressure that the point would have without them is asked for only
    !> where there are some.
    !@cuf attributes(host,device) &
    pure subroutine crack_point(par, crack, s, trial, point, p, cracks)
        real(rk), intent(in) :: par(n_par), crack !! width of a smeared crack [m]
        real(rk), intent(in) :: s(6) !! deviator at the start, in the axes of mid-step [Pa]
        real(rk), intent(inout) :: trial(6), p !! see `open_cracks`
        type(point_t), intent(inout) :: point !! at the start; its history of cracks goes on
        type(cracks_t), intent(out) :: cracks
        real(rk) :: before(2), slope !! pressure with and without cracks; its slope [Pa]

        before(1) = -(point%stress(1) + point%stress(2) + point%stress(3))/3
        before(2) = 0
        if (point%hist(h_tension) > 0) &
            call hjc_pressure(par, point%mu, max(point%hist(h_mu_max), 0.0_rk), before(2), slope)
        call open_cracks(par, crack, s, before, trial, p, point%hist, cracks)
    end subroutine crack_point

    !> Damage with that of cracks, wave speeds, and whether the point is beyond the curve of crushed
    !> material. Waves of shear are faster where it is spread out, as it has less mass, unless
    !> nothing of its strength is left there.
    !@cuf attributes(host,device) &
    pure subroutine finish(material, mu, stiffest, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: mu, stiffest !! compression; slope of the pressure [Pa]
        type(point_t), intent(inout) :: point !! its damage: without that of cracks in
        integer, intent(out) :: status
        real(rk) :: spread

        spread = max(1 + mu, merge(1.0_rk, 0.5_rk, point%damage >= 1))
        if (material%par(p_ft) > 0) then
            point%hist(h_damage) = point%damage
            point%damage = point%damage + (1 - point%damage)*point%hist(h_tension)
        end if
        point%c_bulk = sqrt(stiffest/material%density)
        point%c_wave = sqrt((stiffest + 4*material%par(p_shear)/(3*spread))/material%density)
        status = material_ok
        if (mu > material%par(p_mu_lock) + densest*(1 + material%par(p_mu_lock))) &
            status = material_clamped
    end subroutine finish

    !> Energy of the mean tension that a falling cut-off lets go: the fall over the opening.
    !>
    !> At constant damage an opening gives back what it took, as the pressure is a function of mu.
    !@cuf attributes(host,device) &
    pure subroutine release_tension(par, before, mu, mu_max, p_eos, p, damage, released)
        real(rk), intent(in) :: par(n_par)
        type(point_t), intent(in) :: before !! the point at the start of the step
        real(rk), intent(in) :: mu, mu_max !! at the end
        real(rk), intent(in) :: p_eos, p !! pressure of the curve and with the cut-off, at the end
        real(rk), intent(in) :: damage !! at the end
        real(rk), intent(out) :: released !! [J/kg]
        real(rk) :: fall, last, p_old, p_start, stiffest

        released = 0
        last = before%hist(h_mu_max)
        p_old = -(before%stress(1) + before%stress(2) + before%stress(3))/3
        if (before%hist(h_eroded) > 0) then
            fall = max(-p_old, 0.0_rk)
        else
            fall = par(p_t)*(damage - min(max(before%damage, 0.0_rk), 1.0_rk))
        end if
        if (.not. fall > 0) return
        call hjc_pressure(par, before%mu, last, p_start, stiffest)
        released = fall/2*(opening(par, before%mu, last, p_start, p_old) &
                           + opening(par, mu, mu_max, p_eos, p))
    end subroutine release_tension

    !> Erosion, from the next step on.
    !@cuf attributes(host,device) &
    pure subroutine erode(par, p_eos, damage, plastic, eroded)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: p_eos !! pressure without the cut-off [Pa]
        real(rk), intent(in) :: damage, plastic
        real(rk), intent(inout) :: eroded

        select case (int(par(p_erosion)))
        case (erosion_tension)
            if (damage >= 1 .and. p_eos < -par(p_t)) eroded = 1
        case (erosion_strain)
            if (plastic > par(p_limit)) eroded = 1
        end select
    end subroutine erode
end module brz_hjc
