! SPDX-License-Identifier: MIT
!> One step of an isotropic material with an equation of state: all but its strength.
!>
!> A model calls `begin_step`, decides from the trial stress which part of the deviator to keep, and
!> calls `end_step`. Pressure and energy are solved together (pressure_step); the deviator is that
!> of deviator.f90. Point physics: compiled for the CPU and for the GPU.
module brz_isotropic
    use brz_deviator, only: trial_deviator, return_deviator, mises_stress
    use brz_equation_of_state, only: eos_linear, eos_terms_t, eos_terms, k_a1, k_density, k_kind, &
        n_block
    use brz_kinds, only: rk
    use brz_kinematics, only: volume_step
    use brz_material, only: material_t, point_t, material_ok, material_clamped, &
                            material_step_too_large
    use brz_mie_gruneisen, only: pressure_step
    implicit none
    private
    public :: stride_t, set_linear, begin_step, end_step, fail_step, no_cutoff, on_surface

    real(rk), parameter :: no_cutoff = -1e15_rk !! least pressure where tension has no limit [Pa]
    !> A returned stress that is off the yield stress by this part of it is good enough.
    real(rk), parameter :: on_surface = 1e-10_rk + 16*epsilon(1.0_rk)

    !> A step between its elastic trial and its end.
    type :: stride_t
        real(rk) :: mises !! equivalent stress of the elastic trial [Pa]
        real(rk) :: rate !! total equivalent deviatoric rate sqrt(2/3 d':d') [1/s]
        real(rk) :: mu !! compression at the end
        real(rk) :: dv, v_mid !! change and mean of the specific volume [m3/kg]
        real(rk) :: p_old, p !! pressure at the start and at the end [Pa]
        real(rk) :: plastic !! plastic work, or what a failure releases [J/kg]
        real(rk) :: s(6), trial(6), de(6), q(3, 3) !! see deviator.f90
    end type stride_t

contains

    !> What follows from the elastic constants of a model whose pressure is linear in compression.
    pure subroutine set_linear(density, young, poisson, block, material)
        real(rk), intent(in) :: density, young, poisson !! [kg/m3], [Pa], [-]
        integer, intent(in) :: block !! where its equation of state begins among the parameters
        type(material_t), intent(inout) :: material

        material%density = density
        material%bulk = young/(3*(1 - 2*poisson))
        material%shear = young/(2*(1 + poisson))
        material%c_wave = sqrt((material%bulk + 4*material%shear/3)/material%density)
        associate (par => material%par(block:block + n_block - 1))
            par = 0
            par(k_kind) = eos_linear
            par(k_density) = material%density
            par(k_a1) = material%bulk
        end associate
    end subroutine set_linear

    !> New volume and elastic trial.
    !@cuf attributes(host,device) &
    pure subroutine begin_step(material, dt, l, point, step)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(in) :: point
        type(stride_t), intent(out) :: step
        integer :: i

        step%mu = point%mu
        call volume_step(material%density, l, dt, step%mu, step%dv, step%v_mid)
        step%p_old = -(point%stress(1) + point%stress(2) + point%stress(3))/3
        do i = 1, 3
            step%s(i) = point%stress(i) + step%p_old
            step%s(i + 3) = point%stress(i + 3)
        end do
        call trial_deviator(material%shear, dt, l, step%s, step%q, step%de, step%trial)
        step%mises = mises_stress(step%trial)
        step%rate = 2*mises_stress(step%de)/(3*max(dt, tiny(dt)))
    end subroutine begin_step

    !> Return, pressure, energy, stress, wave speeds. On a positive status the point is as it was.
    !@cuf attributes(host,device) &
    pure subroutine end_step(material, eos, least, keep, step, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: eos(n_block)
        real(rk), intent(in) :: least !! the pressure never falls below this [Pa]
        real(rk), intent(in) :: keep !! yield stress over trial stress; 1: elastic
        type(stride_t), intent(inout) :: step
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        type(eos_terms_t) :: terms
        real(rk) :: energy, work
        integer :: i
        logical :: ok

        call return_deviator(material%shear, keep, step%de, step%trial, step%q, step%s, work, &
                             step%plastic)
        step%plastic = step%plastic*step%v_mid
        energy = point%energy + work*step%v_mid
        call eos_terms(eos, step%mu, terms)
        call pressure_step(terms%a, terms%b*material%density, least, step%dv, step%p_old, energy, &
                           step%p, ok)
        status = material_step_too_large
        if (.not. ok) return
        status = material_ok
        if (terms%clamped) status = material_clamped
        do i = 1, 3
            point%stress(i) = step%s(i) - step%p
            point%stress(i + 3) = step%s(i + 3)
        end do
        point%mu = step%mu
        point%energy = energy
        point%work(1) = step%plastic
        point%work(2) = 0
        call wave_speeds(material, terms, step%p, point)
    end subroutine end_step

    !> Record what material that fails in this step lets go: its shear stress, and its mean tension.
    !>
    !> The tension holds the energy of the elastic expansion, and at the cut-off that of the opening
    !> beyond it, which closing would give back.
    !@cuf attributes(host,device) &
    pure subroutine fail_step(material, eos, before, step, point)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: eos(n_block)
        type(point_t), intent(in) :: before !! at the start of the step
        type(stride_t), intent(in) :: step
        type(point_t), intent(inout) :: point !! at its end
        type(eos_terms_t) :: terms
        real(rk) :: curve, opening

        point%work(1) = 0
        point%work(2) = step%plastic
        if (.not. step%p_old < 0) return
        call eos_terms(eos, before%mu, terms)
        curve = terms%a + terms%b*material%density*before%energy
        opening = max(step%p_old - curve, 0.0_rk)
        point%work(2) = point%work(2) - step%p_old*(opening - step%p_old/2) &
                        /(max(terms%a_slope, material%bulk/4)*material%density*(1 + before%mu))
    end subroutine fail_step

    !> Wave speeds; never below half of the unloaded one, which acts again when a cut-off ends.
    !> Where a material is spread out it has less mass, and waves of shear are faster, unless it has
    !> failed.
    !@cuf attributes(host,device) &
    pure subroutine wave_speeds(material, terms, p, point)
        type(material_t), intent(in) :: material
        type(eos_terms_t), intent(in) :: terms
        real(rk), intent(in) :: p
        type(point_t), intent(inout) :: point
        real(rk) :: k, ratio, spread

        ratio = 1 + point%mu
        spread = max(ratio, merge(1.0_rk, 0.5_rk, point%damage >= 1))
        k = terms%a_slope + terms%b_slope*material%density*point%energy + terms%b*p/ratio**2
        k = max(k, material%bulk/4)
        point%c_bulk = sqrt(k/material%density)
        point%c_wave = sqrt((k + 4*material%shear/(3*spread))/material%density)
    end subroutine wave_speeds
end module brz_isotropic
