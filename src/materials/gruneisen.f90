! SPDX-License-Identifier: MIT
!> Solid with the Mie-Grueneisen equation of state and a constant yield stress.
!>
!> Deck:    &material model='gruneisen'
!> Method:  deviator as in linear_elastic, radial return to the yield stress, pressure and energy
!>          implicit in closed form; without a yield stress a fluid
!> Source:  Wilkins 1964 (radial return); Steinberg UCRL-MA-106439 (constants)
!> History: plastic strain [-]
module brz_gruneisen
    use brz_kinds, only: dp, rk
    use brz_deviator, only: mises_stress, return_deviator, trial_deviator
    use brz_key, only: none, required
    use brz_kinematics, only: volume_step
    use brz_material, only: material_t, point_t, material_ok, material_clamped, &
                            material_step_too_large
    use brz_mie_gruneisen, only: mie_gruneisen, pressure_step, hugoniot_limit, n_eos, eos_mu_max
    use brz_model, only: model_t, real_key
    implicit none
    private
    public :: gruneisen, describe_gruneisen, update_gruneisen

    integer, parameter :: gruneisen = 2 !! code of the model
    character(*), parameter :: name = 'gruneisen'
    ! slots of the keys; the first seven are those of the equation of state, in its order
    integer, parameter :: p_density = 1, p_c0 = 2, p_s1 = 3, p_s2 = 4, p_s3 = 5, p_gamma = 6, &
                          p_a = 7, p_cutoff = 8, p_shear = 9, p_yield = 10
    integer, parameter :: p_eos = 11 !! first of the block of the equation of state
    integer, parameter :: h_strain = 1 !! history: plastic strain

contains

    subroutine describe_gruneisen(model)
        type(model_t), intent(inout) :: model

        model%code = gruneisen
        model%name = name
        allocate (model%keys(10))
        model%keys(p_density) = real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.)
        model%keys(p_c0) = real_key(name, 'sound_speed', 'm/s', required, &
            'c0 of the Hugoniot us = c0 + s1 up + ...', 0.0_dp, open_lower=.true.)
        model%keys(p_s1) = real_key(name, 's1', '-', required, 'slope of the Hugoniot', 0.0_dp)
        model%keys(p_s2) = real_key(name, 's2', '-', '0', 'second coefficient of the Hugoniot')
        model%keys(p_s3) = real_key(name, 's3', '-', '0', 'third coefficient of the Hugoniot')
        model%keys(p_gamma) = real_key(name, 'gruneisen_gamma', '-', required, &
                                       "Grueneisen's gamma at the unloaded density", 0.0_dp)
        model%keys(p_a) = real_key(name, 'gruneisen_a', '-', '0', &
                                   'first-order volume correction of gamma')
        model%keys(p_cutoff) = real_key(name, 'pressure_cutoff', 'Pa', none, &
            'least pressure, negative (spall); absent: no limit', upper=0.0_dp)
        model%keys(p_shear) = real_key(name, 'shear_modulus', 'Pa', '0', 'shear modulus', 0.0_dp)
        model%keys(p_yield) = real_key(name, 'yield_stress', 'Pa', '0', &
            'constant yield stress of von Mises; 0: a fluid', 0.0_dp)
        model%n_hist = 1
        model%history(h_strain) = 'plastic_strain'
        model%derive => derive
    end subroutine describe_gruneisen

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault
        integer :: i

        if (material%par(p_yield) > 0 .and. .not. material%par(p_shear) > 0) then
            fault = 'yield_stress needs shear_modulus'
            return
        end if
        if (.not. given(p_cutoff)) material%par(p_cutoff) = -1e15_rk
        do i = 1, n_eos - 1
            material%par(p_eos + i - 1) = material%par(i)
        end do
        material%par(p_eos + eos_mu_max - 1) = &
            hugoniot_limit(material%par(p_s1), material%par(p_s2), material%par(p_s3))
        material%density = material%par(p_density)
        material%bulk = material%density*material%par(p_c0)**2
        material%shear = merge(material%par(p_shear), 0.0_rk, material%par(p_yield) > 0)
        material%c_wave = sqrt((material%bulk + 4*material%shear/3)/material%density)
    end subroutine derive

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_gruneisen(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        real(rk) :: s(6), mu, energy, p_old, p, a, b, slope, dv, v_mid, work, plastic, strain
        integer :: i
        logical :: clamped, ok

        mu = point%mu
        call volume_step(material%density, l, dt, mu, dv, v_mid)
        p_old = -(point%stress(1) + point%stress(2) + point%stress(3))/3
        do i = 1, 6
            s(i) = point%stress(i)
        end do
        do i = 1, 3
            s(i) = s(i) + p_old
        end do
        call deviator_step(material%shear, material%par(p_yield), dt, l, s, work, plastic, strain)
        energy = point%energy + work*v_mid
        call mie_gruneisen(material%par(p_eos), mu, a, b, slope, clamped)
        call pressure_step(a, b*material%density, material%par(p_cutoff), dv, p_old, energy, p, ok)
        status = material_step_too_large
        if (.not. ok) return
        status = material_ok
        if (clamped) status = material_clamped
        do i = 1, 3
            point%stress(i) = s(i) - p
            point%stress(i + 3) = s(i + 3)
        end do
        point%mu = mu
        point%energy = energy
        point%damage = 0
        point%work(1) = plastic*v_mid
        point%work(2) = 0
        point%hist(h_strain) = point%hist(h_strain) + strain
        call wave_speeds(material, slope, b, p, point)
    end subroutine update_gruneisen

    !> Deviator over one step: rotated exactly, elastic increment, radial return.
    !@cuf attributes(host,device) &
    pure subroutine deviator_step(g, yield, dt, l, s, work, plastic, strain)
        real(rk), intent(in) :: g, yield, dt, l(3, 3)
        real(rk), intent(inout) :: s(6) !! deviatoric stress [Pa]
        real(rk), intent(out) :: work !! done by it, per volume, stress after the return [J/m3]
        real(rk), intent(out) :: plastic !! the part of `work` that is plastic [J/m3]
        real(rk), intent(out) :: strain !! increment of plastic strain
        real(rk) :: q(3, 3), de(6), trial(6), mises, keep

        call trial_deviator(g, dt, l, s, q, de, trial)
        mises = mises_stress(trial)
        keep = 1
        strain = 0
        if (mises > yield) then
            keep = yield/mises
            if (g > 0) strain = (mises - yield)/(3*g)
        end if
        call return_deviator(g, keep, de, trial, q, s, work, plastic)
    end subroutine deviator_step

    !> Wave speeds; never below half of c0, which acts again as soon as a cut-off ends.
    !@cuf attributes(host,device) &
    pure subroutine wave_speeds(material, slope, b, p, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: slope, b, p
        type(point_t), intent(inout) :: point
        real(rk) :: c2, ratio

        ratio = 1 + point%mu
        c2 = (slope + material%par(p_eos + 6)*material%density*point%energy + b*p/ratio**2) &
             /material%density
        c2 = max(c2, material%par(p_c0)**2/4)
        point%c_bulk = sqrt(c2)
        point%c_wave = sqrt(c2 + 4*material%shear/(3*material%density*max(ratio, 0.5_rk)))
    end subroutine wave_speeds
end module brz_gruneisen
