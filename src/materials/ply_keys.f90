! SPDX-License-Identifier: MIT
!> The keys of the orthotropic ply.
module brz_ply_keys
    use brz_kinds, only: dp
    use brz_key, only: key_t, none, required
    use brz_model, only: real_key, switch_key, text_key, usual
    use brz_ply_stress, only: n_keys, fibre_tension, fibre_compression, matrix_cracking, &
                              matrix_crushing, delamination, p_density, p_e1, p_e2, p_e3, &
                              p_nu12, p_nu13, p_nu23, p_g12, p_g13, p_g23, p_xt, p_xc, p_yt, &
                              p_yc, p_zt, p_s12, p_s13, p_s23, p_shear_weight, p_woven, p_axes, &
                              p_degradation, p_time, p_limit, p_retain, p_pressure, p_slope, &
                              p_gamma, p_friction, p_energy
    implicit none
    private
    public :: ply_keys

contains

    !> All keys; `name` is that of the model.
    subroutine ply_keys(name, keys)
        character(*), intent(in) :: name
        type(key_t), allocatable, intent(out) :: keys(:)

        allocate (keys(n_keys))
        call describe_stiffness(name, keys)
        call describe_strength(name, keys)
        call describe_options(name, keys)
    end subroutine ply_keys

    subroutine describe_stiffness(name, keys)
        character(*), intent(in) :: name
        type(key_t), intent(inout) :: keys(:)

        keys(p_density) = usual(real_key(name, 'density', 'kg/m3', required, &
                                         'unloaded density', 0.0_dp, open_lower=.true.), &
                                             10.0_dp, 25000.0_dp)
        keys(p_e1) = modulus(name, 'e1', "Young's modulus along the fibres")
        keys(p_e2) = modulus(name, 'e2', "Young's modulus across the fibres, in the ply")
        keys(p_e3) = modulus(name, 'e3', "Young's modulus normal to the ply")
        keys(p_nu12) = real_key(name, 'nu12', '-', required, &
                                      'strain in 2 by tension in 1, major ratio')
        keys(p_nu13) = real_key(name, 'nu13', '-', required, &
                                      'strain in 3 by tension in 1, major ratio')
        keys(p_nu23) = real_key(name, 'nu23', '-', required, &
                                      'strain in 3 by tension in 2, major ratio')
        keys(p_g12) = modulus(name, 'g12', 'shear modulus in the ply')
        keys(p_g13) = modulus(name, 'g13', 'shear modulus between fibre and normal')
        keys(p_g23) = modulus(name, 'g23', 'shear modulus between 2 and the normal')
    end subroutine describe_stiffness

    subroutine describe_strength(name, keys)
        character(*), intent(in) :: name
        type(key_t), intent(inout) :: keys(:)

        keys(p_xt) = strength(name, 'xt', 'tensile strength along the fibres')
        keys(p_xc) = strength(name, 'xc', 'compressive strength along the fibres')
        keys(p_yt) = strength(name, 'yt', 'tensile strength across the fibres')
        keys(p_yc) = strength(name, 'yc', 'compressive strength across the fibres')
        keys(p_zt) = strength(name, 'zt', 'tensile strength normal to the ply')
        keys(p_s12) = strength(name, 's12', 'shear strength in the ply')
        keys(p_s13) = strength(name, 's13', 'shear strength between fibre and normal')
        keys(p_s23) = strength(name, 's23', 'shear strength between 2 and the normal')
        keys(p_energy + fibre_tension) = toughness(name, 'gft', 'fibre tension')
        keys(p_energy + fibre_compression) = toughness(name, 'gfc', 'fibre compression')
        keys(p_energy + matrix_cracking) = toughness(name, 'gmt', 'matrix cracking')
        keys(p_energy + matrix_crushing) = toughness(name, 'gmc', 'matrix crushing')
        keys(p_energy + delamination) = toughness(name, 'gdl', 'delamination')
        keys([p_xt, p_xc, p_yt, p_yc, p_zt, p_s12, p_s13, p_s23])%failure = .true.
        keys(p_energy + [fibre_tension, fibre_compression, matrix_cracking, matrix_crushing, &
                         delamination])%failure = .true.
    end subroutine describe_strength

    subroutine describe_options(name, keys)
        character(*), intent(in) :: name
        type(key_t), intent(inout) :: keys(:)

        keys(p_shear_weight) = real_key(name, 'shear_weight', '-', '1', &
            'weight of the shear stress in the criterion of the fibres', 0.0_dp, 1.0_dp)
        keys(p_friction) = real_key(name, 'friction', '-', '0', &
            'pressure across a ply adds so much of itself to s13 and s23', 0.0_dp, 10.0_dp)
        keys(p_woven) = switch_key(name, 'woven', '.false.', &
            'a fabric: direction 2 is a fibre direction and fails as one')
        keys(p_axes) = text_key(name, 'axes', 'polar', 'polar|spin|fibre', &
            'axes turn with the polar rotation, with the spin, or stay on the fibres')
        keys(p_degradation) = text_key(name, 'degradation', 'compliance', &
            'compliance|zeroing', 'how damage lowers the stiffness')
        keys(p_time) = real_key(name, 'relaxation_time', 's', none, &
            'a failed mode lets go in this time; absent: half a crack over wave speed', 0.0_dp, &
            open_lower=.true.)
        keys(p_limit) = real_key(name, 'damage_limit', '-', '0.999', &
            'largest damage of a mode', 0.0_dp, 0.99999_dp, open_lower=.true.)
        keys(p_retain) = switch_key(name, 'retain_bulk', '.true.', &
            'crushed material still resists a loss of volume')
        keys(p_pressure) = text_key(name, 'pressure', 'linear', 'linear|anderson', &
            'pressure of the stiffness, or corrected by a shock Hugoniot')
        keys(p_slope) = real_key(name, 'hugoniot_slope', '-', '1.5', &
            "pressure='anderson': slope of the Hugoniot", 0.0_dp)
        keys(p_gamma) = real_key(name, 'gruneisen_gamma', '-', '0.85', &
            "pressure='anderson': Grueneisen's gamma", 0.0_dp)
    end subroutine describe_options

    pure function modulus(name, key, meaning) result(row)
        character(*), intent(in) :: name, key, meaning
        type(key_t) :: row

        row = usual(real_key(name, key, 'Pa', required, meaning, 0.0_dp, open_lower=.true.), &
            1e6_dp, 1e12_dp)
    end function modulus

    pure function strength(name, key, meaning) result(row)
        character(*), intent(in) :: name, key, meaning
        type(key_t) :: row

        row = usual(real_key(name, key, 'Pa', none, meaning//'; absent: never reached', 0.0_dp, &
                       open_lower=.true.), 1e5_dp, 1e11_dp)
    end function strength

    pure function toughness(name, key, mode) result(row)
        character(*), intent(in) :: name, key, mode
        type(key_t) :: row

        row = usual(real_key(name, key, 'J/m2', none, 'fracture energy of '//mode// &
                       '; absent: the stress relaxes in time instead', 0.0_dp, &
                           open_lower=.true.), 1.0_dp, 1e7_dp)
    end function toughness
end module brz_ply_keys
