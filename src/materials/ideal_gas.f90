! SPDX-License-Identifier: MIT
!> Ideal gas, such as the balloon that stands for an explosive.
!>
!> Deck:    &material model='ideal_gas'
!> Method:  p = (gamma - 1) rho e, the case A = B = 0 of the products of an explosive
!> History: none
module brz_ideal_gas
    use brz_detonation_products, only: gas_derive, gas_start, gas_step
    use brz_jwl, only: jwl_t
    use brz_key, only: none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_fluid, material_t, point_t, n_par
    use brz_model, only: model_t, real_key, usual
    implicit none
    private
    public :: ideal_gas, describe_ideal_gas, update_ideal_gas

    integer, parameter :: ideal_gas = 7 !! code of the model
    character(*), parameter :: name = 'ideal_gas'
    integer, parameter :: p_density = 1, p_gamma = 2, p_energy = 3, &
                          p_pressure = 4

contains

    subroutine describe_ideal_gas(model)
        type(model_t), intent(inout) :: model

        model%code = ideal_gas
        model%class = class_fluid
        model%name = name
        allocate (model%keys(4))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                               'density at t = 0', 0.0_dp, open_lower=.true.), &
                                      0.01_dp, 25000.0_dp)
        model%keys(p_gamma) = real_key(name, 'gamma', '-', required, &
                                       'ratio of the specific heats', 1.0_dp, 5.0_dp, &
                                       open_lower=.true.)
        model%keys(p_energy) = real_key(name, 'energy', 'J/kg', none, &
                                        'energy at t = 0, or pressure', 0.0_dp, open_lower=.true.)
        model%keys(p_pressure) = real_key(name, 'pressure', 'Pa', none, &
                                          'pressure at t = 0, or energy', 0.0_dp, open_lower=.true.)
        model%derive => derive
        model%rest => rest
    end subroutine describe_ideal_gas

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        if (given(p_energy) .eqv. given(p_pressure)) then
            fault = 'give either energy or pressure'
            return
        end if
        if (given(p_pressure)) material%par(p_energy) = &
            material%par(p_pressure)/((material%par(p_gamma) - 1)*material%par(p_density))
        call gas_derive(gas(material%par), material)
    end subroutine derive

    subroutine rest(material, point)
        type(material_t), intent(in) :: material
        type(point_t), intent(inout) :: point

        call gas_start(gas(material%par), point)
    end subroutine rest

    !@cuf attributes(host,device) &
    pure function gas(par) result(eos)
        real(rk), intent(in) :: par(n_par)
        type(jwl_t) :: eos

        eos%rho0 = par(p_density)
        eos%a = 0
        eos%b = 0
        eos%r1 = 1
        eos%r2 = 1
        eos%omega = par(p_gamma) - 1
        eos%e0 = par(p_density)*par(p_energy)
    end function gas

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_ideal_gas(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status

        call gas_step(gas(material%par), dt, l, point, status)
    end subroutine update_ideal_gas
end module brz_ideal_gas
