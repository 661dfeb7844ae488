! SPDX-License-Identifier: MIT
!> Solid with the Mie-Grueneisen equation of state and a constant yield stress.
!>
!> Deck:    &material model='gruneisen'
!> Method:  deviator as in linear_elastic, radial return to the yield stress, pressure and energy
!>          implicit in closed form; without a yield stress a fluid
!> Source:  Wilkins 1964 (radial return); Steinberg UCRL-MA-106439 (constants)
!> History: plastic strain [-]
module brz_gruneisen
    use brz_eos_keys, only: cutoff_key, gruneisen_block, gruneisen_keys, n_gruneisen
    use brz_equation_of_state, only: n_block, unloaded_bulk
    use brz_isotropic, only: begin_step, end_step, no_cutoff, stride_t
    use brz_key, only: required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_metal, material_t, point_t
    use brz_model, only: model_t, real_key, usual
    implicit none
    private
    public :: gruneisen, describe_gruneisen, update_gruneisen

    integer, parameter :: gruneisen = 2, gruneisen_history = 1 !! code of the model
    character(*), parameter :: name = 'gruneisen'
    integer, parameter :: p_density = 1, p_eos = 2, p_cutoff = 8, p_shear = 9, p_yield = 10
    integer, parameter :: p_block = 11 !! first of the block of the equation of state
    integer, parameter :: h_strain = 1 !! history: plastic strain

contains

    subroutine describe_gruneisen(model)
        type(model_t), intent(inout) :: model

        model%code = gruneisen
        model%class = class_metal
        model%name = name
        allocate (model%keys(10))
        model%keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.), &
                                             10.0_dp, 25000.0_dp)
        model%keys(p_eos:p_eos + n_gruneisen - 1) = gruneisen_keys(name, required)
        model%keys(p_cutoff) = cutoff_key(name)
        model%keys(p_shear) = usual(real_key(name, 'shear_modulus', 'Pa', '0', 'shear modulus', &
            0.0_dp), 1e4_dp, 1e12_dp)
        model%keys(p_yield) = usual(real_key(name, 'yield_stress', 'Pa', '0', &
            'constant yield stress of von Mises; 0: a fluid', 0.0_dp), 1e3_dp, 1e11_dp)
        model%n_hist = gruneisen_history
        model%history(h_strain) = 'plastic_strain'
        model%derive => derive
    end subroutine describe_gruneisen

    subroutine derive(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(out) :: fault

        if (material%par(p_yield) > 0 .and. .not. material%par(p_shear) > 0) then
            fault = 'yield_stress needs shear_modulus'
            return
        end if
        if (.not. given(p_cutoff)) material%par(p_cutoff) = no_cutoff
        material%density = material%par(p_density)
        material%par(p_block:p_block + n_block - 1) = &
            gruneisen_block(material%density, material%par(p_eos:p_eos + n_gruneisen - 1))
        material%bulk = unloaded_bulk(material%par(p_block:p_block + n_block - 1))
        material%shear = merge(material%par(p_shear), 0.0_rk, material%par(p_yield) > 0)
        if (material%shear > 0) material%yields = material%par(p_yield)/(3*material%shear)
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
        type(stride_t) :: step
        real(rk) :: keep, strain

        call begin_step(material, dt, l, point, step)
        keep = 1
        strain = 0
        if (step%mises > material%par(p_yield)) then
            keep = material%par(p_yield)/step%mises
            if (material%shear > 0) strain = (step%mises - material%par(p_yield))/(3*material%shear)
        end if
        call end_step(material, material%par(p_block), material%par(p_cutoff), keep, step, point, &
                      status)
        if (status > 0) return
        point%damage = 0
        point%hist(h_strain) = point%hist(h_strain) + strain
    end subroutine update_gruneisen
end module brz_gruneisen
