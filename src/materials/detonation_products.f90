! SPDX-License-Identifier: MIT
!> Products of an explosive after Jones, Wilkins and Lee, all burnt at t = 0.
!>
!> Deck:    &material model='jwl'
!> Method:  pressure and energy implicit in closed form (jwl.f90, pressure_step); no strength
!> Source:  Lee, Hornig, Kury 1968, UCRL-50422
!> History: none
module brz_detonation_products
    use brz_jwl, only: jwl_t, jwl_cj, jwl_pressure, jwl_sound_speed
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_kinematics, only: volume_step
    use brz_material, only: class_fluid, material_t, point_t, material_ok, &
                            material_step_too_large, n_par
    use brz_mie_gruneisen, only: pressure_step
    use brz_model, only: model_t, real_key, usual
    implicit none
    private
    public :: detonation_products, describe_detonation_products, update_detonation_products
    public :: gas_step, gas_start, gas_derive

    integer, parameter :: detonation_products = 8 !! code of the model
    character(*), parameter :: name = 'jwl'
    integer, parameter :: p_density = 1, p_a = 2, p_b = 3, p_r1 = 4, p_r2 = 5, p_omega = 6, &
                          p_energy = 7, p_speed = 8

contains

    subroutine describe_detonation_products(model)
        type(model_t), intent(inout) :: model

        model%code = detonation_products
        model%class = class_fluid
        model%name = name
        allocate (model%keys(8))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                               'density of the explosive', 0.0_dp, &
                                               open_lower=.true.), 10.0_dp, 25000.0_dp)
        model%keys(p_a) = real_key(name, 'a', 'Pa', required, 'first constant', 0.0_dp)
        model%keys(p_b) = real_key(name, 'b', 'Pa', required, 'second constant', 0.0_dp)
        model%keys(p_r1) = real_key(name, 'r1', '-', required, 'first exponent', 0.0_dp, &
                                    open_lower=.true.)
        model%keys(p_r2) = real_key(name, 'r2', '-', required, 'second exponent', 0.0_dp, &
                                    open_lower=.true.)
        model%keys(p_omega) = real_key(name, 'omega', '-', required, &
            'gamma - 1 of the expanded products', 0.0_dp, 2.0_dp, open_lower=.true.)
        model%keys(p_energy) = real_key(name, 'energy_density', 'J/m3', required, &
            'energy that detonation sets free, per initial volume', 0.0_dp, open_lower=.true.)
        model%keys(p_speed) = real_key(name, 'detonation_speed', 'm/s', none, &
            'measured speed; refused where it is not that of the constants to 5 %', 0.0_dp, &
            open_lower=.true.)
        model%derive => derive
        model%rest => rest
    end subroutine describe_detonation_products

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault
        real(dp), parameter :: tolerance = 0.05_dp
        character(12) :: number
        real(dp) :: rho, p, d

        call gas_derive(products(material%par), material)
        if (.not. given(p_speed)) return
        call jwl_cj(products(material%par), rho, p, d)
        if (abs(d/material%par(p_speed) - 1) <= tolerance) return
        write (number, '(i0)') nint(d)
        fault = 'detonation_speed does not fit the constants, which give '//trim(number)//' m/s'
    end subroutine derive

    subroutine rest(material, point)
        type(material_t), intent(in) :: material
        type(point_t), intent(inout) :: point

        call gas_start(products(material%par), point)
    end subroutine rest

    !> Constants in the order of the keys.
    !@cuf attributes(host,device) &
    pure function products(par) result(eos)
        real(rk), intent(in) :: par(n_par)
        type(jwl_t) :: eos

        eos%rho0 = par(p_density)
        eos%a = par(p_a)
        eos%b = par(p_b)
        eos%r1 = par(p_r1)
        eos%r2 = par(p_r2)
        eos%omega = par(p_omega)
        eos%e0 = par(p_energy)
    end function products

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_detonation_products(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status

        call gas_step(products(material%par), dt, l, point, status)
    end subroutine update_detonation_products

    !> Density, moduli and wave speed of products or gas at rest.
    subroutine gas_derive(eos, material)
        type(jwl_t), intent(in) :: eos
        type(material_t), intent(inout) :: material
        real(dp) :: p, c

        p = jwl_pressure(eos, eos%rho0, eos%e0/eos%rho0)
        c = jwl_sound_speed(eos, eos%rho0, p)
        material%density = real(eos%rho0, rk)
        material%c_wave = real(c, rk)
        material%bulk = real(eos%rho0*c**2, rk)
    end subroutine gas_derive

    !> State at rest: the unloaded density under its own pressure.
    subroutine gas_start(eos, point)
        type(jwl_t), intent(in) :: eos
        type(point_t), intent(inout) :: point

        point%energy = real(eos%e0/eos%rho0, rk)
        point%stress(:3) = -real(jwl_pressure(eos, eos%rho0, eos%e0/eos%rho0), rk)
    end subroutine gas_start

    !> One step of a point without strength.
    !@cuf attributes(host,device) &
    pure subroutine gas_step(eos, dt, l, point, status)
        type(jwl_t), intent(in) :: eos
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        real(dp) :: rho
        real(rk) :: mu, dv, v_mid, p_old, p, cold, energy
        integer :: i
        logical :: ok

        mu = point%mu
        call volume_step(real(eos%rho0, rk), l, dt, mu, dv, v_mid)
        p_old = -(point%stress(1) + point%stress(2) + point%stress(3))/3
        rho = eos%rho0*(1 + mu)
        cold = real(jwl_pressure(eos, rho, 0.0_dp), rk)
        energy = point%energy
        call pressure_step(cold, real(eos%omega*rho, rk), 0.0_rk, dv, p_old, energy, p, ok)
        status = material_step_too_large
        if (.not. ok) return
        status = material_ok
        do i = 1, 3
            point%stress(i) = -p
            point%stress(i + 3) = 0
        end do
        point%mu = mu
        point%energy = energy
        point%damage = 0
        point%work(1) = 0
        point%work(2) = 0
        point%c_bulk = real(max(jwl_sound_speed(eos, rho, real(p, dp)), 1.0_dp), rk)
        point%c_wave = point%c_bulk
    end subroutine gas_step
end module brz_detonation_products
