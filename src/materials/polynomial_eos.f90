! SPDX-License-Identifier: MIT
!> Liquid with a polynomial equation of state, such as water.
!>
!> Deck:    &material model='polynomial'
!> Method:  pressure and energy implicit in closed form; no strength
!> History: none
module brz_polynomial_eos
    use brz_eos_keys, only: cutoff_key, n_polynomial, polynomial_block, polynomial_keys
    use brz_equation_of_state, only: n_block, unloaded_bulk
    use brz_isotropic, only: begin_step, end_step, no_cutoff, stride_t
    use brz_key, only: required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_fluid, material_t, point_t
    use brz_model, only: model_t, real_key, usual
    implicit none
    private
    public :: polynomial_eos, describe_polynomial_eos, update_polynomial_eos

    integer, parameter :: polynomial_eos = 4 !! code of the model
    character(*), parameter :: name = 'polynomial'
    integer, parameter :: p_density = 1, p_eos = 2, p_t1 = p_eos + 5, &
                          p_cutoff = p_eos + n_polynomial, p_block = p_cutoff + 1

contains

    subroutine describe_polynomial_eos(model)
        type(model_t), intent(inout) :: model

        model%code = polynomial_eos
        model%class = class_fluid
        model%name = name
        allocate (model%keys(p_cutoff))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.), &
                                             10.0_dp, 25000.0_dp)
        model%keys(p_eos:p_cutoff - 1) = polynomial_keys(name, required)
        model%keys(p_cutoff) = cutoff_key(name)
        model%derive => derive
    end subroutine describe_polynomial_eos

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        if (.not. given(p_cutoff)) material%par(p_cutoff) = no_cutoff
        material%density = material%par(p_density)
        call polynomial_block(material%density, material%par(p_eos:p_cutoff - 1), given(p_t1), &
                              material%par(p_block:p_block + n_block - 1), fault)
        material%bulk = unloaded_bulk(material%par(p_block:p_block + n_block - 1))
        material%c_wave = sqrt(material%bulk/material%density)
    end subroutine derive

    !> One step of one material point; see `update_material` for the contract.
    !@cuf attributes(host,device) &
    pure subroutine update_polynomial_eos(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt !! [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j at mid-step [1/s]
        type(point_t), intent(inout) :: point
        integer, intent(out) :: status
        type(stride_t) :: step

        call begin_step(material, dt, l, point, step)
        call end_step(material, material%par(p_block), material%par(p_cutoff), 0.0_rk, step, &
                      point, status)
    end subroutine update_polynomial_eos
end module brz_polynomial_eos
