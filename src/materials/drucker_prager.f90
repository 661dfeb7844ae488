! SPDX-License-Identifier: MIT
!> Soil, sand, rubble: strength by cohesion and friction, no more.
!>
!> Deck:    &material model='drucker_prager'
!> Method:  p = K mu, not below the limit of tension; radial return at that pressure to
!>          Y = min(A + M p, strength): plastic flow keeps its volume. A = 6 c cos(phi)/(3 -
!>          sin(phi)) and M = 6 sin(phi)/(3 - sin(phi)) are Mohr and Coulomb's in compression
!> Source:  Drucker & Prager 1952
!> History: plastic strain [-]
module brz_drucker_prager
    use brz_equation_of_state, only: n_block
    use brz_isotropic, only: begin_step, end_step, set_linear, stride_t
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_crumbling, material_t, point_t
    use brz_model, only: derived_t, model_t, real_key, usual
    implicit none
    private
    public :: drucker_prager, describe_drucker_prager, update_drucker_prager

    integer, parameter :: drucker_prager = 11, drucker_prager_history = 1 !! code of the model
    character(*), parameter :: name = 'drucker_prager'
    integer, parameter :: p_density = 1, p_young = 2, p_poisson = 3, p_cohesion = 4, p_angle = 5, &
                          p_strength = 6, p_tension = 7, n_keys = 7
    integer, parameter :: p_base = 8, p_slope = 9, p_block = 10 !! derived: A, M
    integer, parameter :: h_strain = 1 !! history: plastic strain

contains

    subroutine describe_drucker_prager(model)
        type(model_t), intent(inout) :: model

        model%code = drucker_prager
        model%class = class_crumbling
        model%name = name
        allocate (model%keys(n_keys))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
            'unloaded density', 0.0_dp, open_lower=.true.), 10.0_dp, 25000.0_dp)
        model%keys(p_young) = usual(real_key(name, 'youngs_modulus', 'Pa', required, &
            "Young's modulus", 0.0_dp, open_lower=.true.), 1e5_dp, 1e12_dp)
        model%keys(p_poisson) = real_key(name, 'poisson_ratio', '-', required, &
            "Poisson's ratio", -1.0_dp, 0.4999_dp, open_lower=.true.)
        model%keys(p_cohesion) = usual(real_key(name, 'cohesion', 'Pa', '0', &
            'shear strength without pressure', 0.0_dp), 0.0_dp, 1e9_dp)
        model%keys(p_angle) = real_key(name, 'friction_angle', 'deg', required, &
            'angle of internal friction, of compression tests', 0.0_dp, 89.0_dp)
        model%keys(p_strength) = usual(real_key(name, 'max_strength', 'Pa', none, &
            'equivalent stress that no pressure raises; absent: no limit', 0.0_dp, &
            open_lower=.true.), 1e3_dp, 1e11_dp)
        model%keys(p_tension) = usual(real_key(name, 'tension_limit', 'Pa', '0', &
            'mean tension that it bears; at most where its strength vanishes', 0.0_dp), &
            1.0_dp, 1e9_dp)
        model%n_hist = drucker_prager_history
        model%history(h_strain) = 'plastic_strain'
        model%derive => derive
        model%report => report
    end subroutine describe_drucker_prager

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault
        real(dp) :: phi

        associate (par => material%par)
            phi = acos(-1.0_dp)/180*par(p_angle)
            par(p_base) = real(6*par(p_cohesion)*cos(phi)/(3 - sin(phi)), rk)
            par(p_slope) = real(6*sin(phi)/(3 - sin(phi)), rk)
            if (.not. given(p_strength)) par(p_strength) = huge(1.0_rk)
            if (par(p_base) <= 0 .and. par(p_slope) <= 0) then
                fault = 'without cohesion and friction there is no strength; give one of them'
            else if (par(p_tension)*par(p_slope) > par(p_base)) then
                fault = 'tension_limit lies beyond cohesion/tan(friction_angle), where no '// &
                    'strength is left; lower it'
            end if
            if (allocated(fault)) return
        end associate
        call set_linear(material%par(p_density), material%par(p_young), material%par(p_poisson), &
                        p_block, material)
    end subroutine derive

    !> What a cylinder carries without pressure on its sides.
    subroutine report(material, list)
        type(material_t), intent(in) :: material
        type(derived_t), allocatable, intent(out) :: list(:)
        real(dp) :: base, slope

        base = real(material%par(p_base), dp)
        slope = real(material%par(p_slope), dp)
        list = [derived_t('unconfined', 'Pa', &
                          min(3*base/(3 - slope), real(material%par(p_strength), dp)))]
    end subroutine report

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_drucker_prager(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        type(stride_t) :: step
        real(rk) :: pressure, yield, keep

        call begin_step(material, dt, l, point, step)
        pressure = max(material%bulk*step%mu, -material%par(p_tension))
        yield = min(material%par(p_base) + material%par(p_slope)*pressure, &
                    material%par(p_strength))
        keep = 1
        if (step%mises > yield) keep = max(yield, 0.0_rk)/step%mises
        call end_step(material, material%par(p_block), -material%par(p_tension), keep, step, &
                      point, status)
        if (status > 0) return
        point%hist(h_strain) = point%hist(h_strain) + (1 - keep)*step%mises/(3*material%shear)
        point%damage = 0
    end subroutine update_drucker_prager
end module brz_drucker_prager
