! SPDX-License-Identifier: MIT
!> Steel with linear hardening, rate dependence after Cowper and Symonds, and a failure strain.
!>
!> Deck:    &material model='bilinear_j2'
!> Method:  p = K mu; radial return to Y = (fy + H eps_p) (1 + (rate/D)^(1/P)), implicit in the
!>          plastic rate; H = E Et/(E - Et)
!> Source:  Cowper & Symonds 1957
!> History: plastic strain [-]; the damage of the point is plastic over failure strain
module brz_bilinear_j2
    use brz_equation_of_state, only: n_block
    use brz_isotropic, only: begin_step, end_step, fail_step, no_cutoff, on_surface, &
                             refine_root, set_linear, step_t
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_metal, fails_at_once, material_t, point_t, n_par
    use brz_model, only: model_t, real_key, usual
    implicit none
    private
    public :: bilinear_j2, describe_bilinear_j2, update_bilinear_j2

    integer, parameter :: bilinear_j2 = 5 !! code of the model
    character(*), parameter :: name = 'bilinear_j2'
    integer, parameter :: p_density = 1, p_young = 2, p_poisson = 3, p_yield = 4, p_tangent = 5, &
                          p_rate = 6, p_exponent = 7, p_failure = 8, n_keys = 8
    integer, parameter :: p_hardening = 9, p_power = 10, p_block = 11 !! derived
    integer, parameter :: h_strain = 1 !! history: plastic strain
    integer, parameter :: most_passes = 50

contains

    subroutine describe_bilinear_j2(model)
        type(model_t), intent(inout) :: model

        model%code = bilinear_j2
        model%class = class_metal
        model%name = name
        allocate (model%keys(n_keys))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.), &
                                             10.0_dp, 25000.0_dp)
        model%keys(p_young) = usual(real_key(name, 'youngs_modulus', 'Pa', required, &
                                       "Young's modulus", 0.0_dp, open_lower=.true.), 1e6_dp, &
                                           1e12_dp)
        model%keys(p_poisson) = real_key(name, 'poisson_ratio', '-', required, &
                                         "Poisson's ratio", -1.0_dp, 0.4999_dp, open_lower=.true.)
        model%keys(p_yield) = usual(real_key(name, 'yield_stress', 'Pa', required, &
                                       'yield stress at rest', 0.0_dp, open_lower=.true.), &
                                           1e5_dp, 1e10_dp)
        model%keys(p_tangent) = real_key(name, 'tangent_modulus', 'Pa', '0', &
                                         'slope of the uniaxial curve after yield', 0.0_dp)
        model%keys(p_rate) = usual(real_key(name, 'cowper_symonds_d', '1/s', none, &
            'rate at which the yield stress doubles; absent: no rate dependence', 0.0_dp, &
            open_lower=.true.), 0.1_dp, 1e8_dp)
        model%keys(p_exponent) = real_key(name, 'cowper_symonds_p', '-', '5', &
                                          'the rate acts with the power 1/p', 1.0_dp)
        model%keys(p_failure) = usual(real_key(name, 'failure_strain', '-', none, &
            'plastic strain at which it breaks; absent: never', 0.0_dp, open_lower=.true.), &
                1e-4_dp, 5.0_dp)
        model%keys(p_failure)%failure = .true.
        model%n_hist = 1
        model%history(h_strain) = 'plastic_strain'
        model%derive => derive
    end subroutine describe_bilinear_j2

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        associate (par => material%par)
            if (par(p_tangent) >= par(p_young)) then
                fault = 'tangent_modulus must be below youngs_modulus'
                return
            end if
            if (.not. given(p_rate)) par(p_rate) = 0
            material%fails = merge(fails_at_once, 0, given(p_failure))
            if (.not. given(p_failure)) par(p_failure) = huge(1.0_rk)
            par(p_hardening) = par(p_tangent)*par(p_young)/(par(p_young) - par(p_tangent))
            par(p_power) = 1/par(p_exponent)
        end associate
        call set_linear(material%par(p_density), material%par(p_young), material%par(p_poisson), &
                        p_block, material)
        material%yields = material%par(p_yield)/(3*material%shear)
    end subroutine derive

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_bilinear_j2(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        type(step_t) :: step
        type(point_t) :: before
        real(rk) :: keep, strain, least
        logical :: failed

        call begin_step(material, dt, l, point, step)
        failed = point%damage >= 1
        keep = 0
        strain = 0
        least = 0
        if (.not. failed) then
            strain = plastic_increment(material%par, 3*material%shear, dt, step, &
                                       point%hist(h_strain))
            keep = 1
            if (strain > 0) keep = max(0.0_rk, 1 - 3*material%shear*strain/step%mises)
            least = no_cutoff
        end if
        before = point
        call end_step(material, material%par(p_block), least, keep, step, point, status)
        if (status > 0) return
        point%hist(h_strain) = point%hist(h_strain) + strain
        if (failed) then
            call fail_step(material, material%par(p_block), before, step, point)
        else
            point%damage = min(1.0_rk, point%hist(h_strain)/material%par(p_failure))
        end if
    end subroutine update_bilinear_j2

    !> Plastic strain x of a step: q - 3G x = Y(eps_p + x, x/dt), 0 where the trial is elastic.
    !@cuf attributes(host,device) &
    pure function plastic_increment(par, g3, dt, step, before) result(x)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: g3 !! three times the shear modulus [Pa]
        real(rk), intent(in) :: dt !! [s]
        type(step_t), intent(in) :: step
        real(rk), intent(in) :: before !! plastic strain at the start
        real(rk) :: x, excess, low, high, static, factor
        integer :: pass

        x = 0
        static = par(p_yield) + par(p_hardening)*before
        excess = step%mises - static
        if (excess <= 0) return
        high = excess/(g3 + par(p_hardening))
        x = high
        if (par(p_rate) <= 0 .or. dt <= 0) return
        ! at first: all of the rate is plastic, or where that is too much, none of the stress is
        factor = (step%rate/par(p_rate))**par(p_power)
        x = (excess - static*factor)/(g3 + par(p_hardening)*(1 + factor))
        if (.not. x > 0) x = min(high, dt*par(p_rate)*(excess/static)**par(p_exponent))
        low = 0
        do pass = 1, most_passes
            static = par(p_yield) + par(p_hardening)*(before + x)
            factor = (x/(dt*par(p_rate)))**par(p_power)
            excess = step%mises - g3*x - static*(1 + factor)
            if (abs(excess) <= on_surface*static + 4*epsilon(x)*step%mises) exit
            call refine_root(excess, -g3 - par(p_hardening)*(1 + factor) &
                             - static*factor*par(p_power)/x, low, high, x)
        end do
    end function plastic_increment
end module brz_bilinear_j2
