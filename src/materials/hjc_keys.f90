! SPDX-License-Identifier: MIT
!> The keys of the Holmquist-Johnson-Cook concrete.
module brz_hjc_keys
    use brz_hjc_pressure, only: n_keys, p_a, p_b, p_c, p_crack_rate, p_d1, p_d2, p_density, &
                                p_dilatancy, p_efmin, p_erosion, p_fc, p_floor, p_ft, p_gf, &
                                p_k1, p_k2, p_k3, p_limit, p_mu_crush, p_mu_lock, p_n, p_p_crush, &
                                p_p_lock, p_rate, p_rate_law, p_shear, p_smax, p_surface, p_t, &
                                p_unload
    use brz_key, only: key_t, none, required
    use brz_kinds, only: dp
    use brz_model, only: real_key, text_key, usual
    implicit none
    private
    public :: hjc_keys

contains

    !> All keys; `name` is that of the model.
    subroutine hjc_keys(name, keys)
        character(*), intent(in) :: name
        type(key_t), allocatable, intent(out) :: keys(:)

        allocate (keys(n_keys))
        call describe_strength(name, keys)
        call describe_pressure(name, keys)
        call describe_options(name, keys)
    end subroutine hjc_keys

    subroutine describe_strength(name, keys)
        character(*), intent(in) :: name
        type(key_t), intent(inout) :: keys(:)

        keys(p_density) = number(name, 'density', 'kg/m3', 'unloaded density', &
            [1000.0_dp, 5000.0_dp])
        keys(p_shear) = number(name, 'shear_modulus', 'Pa', 'shear modulus', &
            [1e8_dp, 1e11_dp])
        keys(p_a) = number(name, 'a', '-', 'cohesive strength over fc', &
            [0.05_dp, 5.0_dp])
        keys(p_b) = number(name, 'b', '-', 'pressure hardening over fc', &
            [0.1_dp, 10.0_dp])
        keys(p_n) = number(name, 'n', '-', 'exponent of the pressure hardening', &
            [0.05_dp, 2.0_dp])
        keys(p_c) = real_key(name, 'c', '-', required, 'rate coefficient', 0.0_dp)
        keys(p_fc) = number(name, 'fc', 'Pa', 'strength to which stresses are referred', &
            [2e6_dp, 5e8_dp])
        keys(p_t) = number(name, 't', 'Pa', 'largest mean tension (hydrostatic, not uniaxial)', &
            [10000.0_dp, 1e8_dp])
        keys(p_rate) = real_key(name, 'reference_rate', '1/s', '1', &
                                      'rate at which the rate factor is 1', 0.0_dp, &
                                      open_lower=.true.)
        keys(p_efmin) = number(name, 'efmin', '-', 'least plastic strain to fracture', &
            [1e-5_dp, 1.0_dp])
        keys(p_smax) = number(name, 'smax', '-', 'largest strength over fc', &
            [1.0_dp, 100.0_dp])
        keys(p_d1) = number(name, 'd1', '-', 'damage constant', &
            [0.0001_dp, 1.0_dp])
        keys(p_d2) = number(name, 'd2', '-', 'damage exponent', &
            [0.1_dp, 5.0_dp])
        keys(p_d1)%failure = .true.
    end subroutine describe_strength

    subroutine describe_pressure(name, keys)
        character(*), intent(in) :: name
        type(key_t), intent(inout) :: keys(:)

        keys(p_p_crush) = number(name, 'p_crush', 'Pa', 'pressure at which crushing starts', &
            [100000.0_dp, 1e9_dp])
        keys(p_mu_crush) = number(name, 'mu_crush', '-', 'compression at which crushing starts', &
            [1e-5_dp, 0.05_dp])
        keys(p_p_lock) = number(name, 'p_lock', 'Pa', 'pressure at which crushing is complete', &
            [1e7_dp, 1e11_dp])
        keys(p_mu_lock) = number(name, 'mu_lock', '-', &
                                       'compression of the crushed material at zero pressure', &
            [0.001_dp, 1.0_dp])
        keys(p_k1) = number(name, 'k1', 'Pa', 'first modulus of the crushed material', &
            [1e9_dp, 1e12_dp])
        keys(p_k2) = real_key(name, 'k2', 'Pa', required, 'its second modulus')
        keys(p_k3) = real_key(name, 'k3', 'Pa', required, 'its third modulus')
    end subroutine describe_pressure

    subroutine describe_options(name, keys)
        character(*), intent(in) :: name
        type(key_t), intent(inout) :: keys(:)

        keys(p_floor) = real_key(name, 'rate_floor', '-', '1', &
            'least rate over reference_rate that the rate factor sees', 0.0_dp, open_lower=.true.)
        keys(p_unload) = text_key(name, 'unload', 'paper', 'paper|reversible', &
            'beyond p_lock: back on a line of slope k1, or on the curve of loading')
        keys(p_erosion) = text_key(name, 'erosion', 'none', 'none|tension|strain', &
            'no stress but pressure, for ever: never; pulled apart at full damage; at a strain')
        keys(p_limit) = real_key(name, 'erosion_strain', '-', none, &
            "erosion='strain': plastic strain at which it erodes", 0.0_dp, open_lower=.true.)
        keys(p_ft) = usual(real_key(name, 'ft', 'Pa', none, &
            'uniaxial tensile strength; absent: no cracks, t alone limits the tension', 0.0_dp, &
            open_lower=.true.), 1e5_dp, 5e7_dp)
        keys(p_gf) = usual(real_key(name, 'gf', 'J/m2', none, &
            'fracture energy of a crack; absent: 73 (fc/MPa)^0.18', 0.0_dp, &
            open_lower=.true.), 1.0_dp, 1e4_dp)
        keys(p_crack_rate) = text_key(name, 'rate_tension', 'none', 'none|malvar', &
            'strength of cracks by rate: none, or that of Malvar and Ross')
        keys(p_surface) = text_key(name, 'surface', 'hjc', 'hjc|malvar', &
            'strength: a, b, n; or that of Malvar et al. by fc and ft, whose cylinder carries fc')
        keys(p_rate_law) = text_key(name, 'rate_law', 'log', 'log|fib', &
            'by rate: 1 + c ln(rate/reference_rate), or (rate/3e-5)^0.014 of Model Code 2010')
        keys(p_dilatancy) = real_key(name, 'dilatancy', '-', none, &
            "surface='malvar', share of associated flow by which shear makes volume; absent: 0.5", &
            0.0_dp, 1.0_dp)
    end subroutine describe_options

    !> A number that must be given, and be positive.
    pure function number(name, key, unit, meaning, likely) result(row)
        character(*), intent(in) :: name, key, unit, meaning
        real(dp), intent(in) :: likely(2)
        type(key_t) :: row

        row = usual(real_key(name, key, unit, required, meaning, 0.0_dp, open_lower=.true.), &
            likely(1), likely(2))
    end function number
end module brz_hjc_keys
