! SPDX-License-Identifier: MIT
!> Keys of the equations of state, the same for every model, and what follows from them.
module brz_eos_keys
    use brz_equation_of_state, only: eos_terms, eos_terms_t, n_block, eos_gruneisen, &
                                     eos_polynomial, eos_linear, k_kind, k_density, k_a1, k_a2, &
                                     k_a3, k_b0, k_b1, k_t1, k_t2, k_mu_max
    use brz_key, only: key_t, none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: n_par
    use brz_mie_gruneisen, only: hugoniot_limit, eos_c0, eos_mu_max, n_eos
    use brz_model, only: real_key, text_key, usual
    implicit none
    private
    public :: gruneisen_keys, polynomial_keys, choice_keys, cutoff_key
    public :: gruneisen_block, polynomial_block, chosen_block
    public :: n_gruneisen, n_polynomial, n_choice

    integer, parameter :: n_gruneisen = 6 !! sound_speed, s1, s2, s3, gruneisen_gamma, gruneisen_a
    integer, parameter :: n_polynomial = 7 !! bulk_modulus, a2, a3, b0, b1, t1, t2
    integer, parameter :: n_choice = 1 + n_gruneisen + n_polynomial !! eos, then all of them

contains

    !> Keys of the shock Hugoniot.
    pure function gruneisen_keys(name, default) result(keys)
        character(*), intent(in) :: name !! of the model
        character(*), intent(in) :: default !! `required`, or `none` where there is a choice
        type(key_t) :: keys(n_gruneisen)

        keys(1) = usual(real_key(name, 'sound_speed', 'm/s', default, &
                           'c0 of the Hugoniot us = c0 + s1 up + ...', 0.0_dp, &
                               open_lower=.true.), 200.0_dp, 20000.0_dp)
        keys(2) = usual(real_key(name, 's1', '-', default, 'slope of the Hugoniot', 0.0_dp), &
            0.3_dp, 5.0_dp)
        keys(3) = real_key(name, 's2', '-', '0', 'second coefficient of the Hugoniot')
        keys(4) = real_key(name, 's3', '-', '0', 'third coefficient of the Hugoniot')
        keys(5) = usual(real_key(name, 'gruneisen_gamma', '-', default, &
                           "Grueneisen's gamma at the unloaded density", 0.0_dp), 0.05_dp, 6.0_dp)
        keys(6) = real_key(name, 'gruneisen_a', '-', '0', 'first-order volume correction of gamma')
    end function gruneisen_keys

    !> Keys of the polynomial.
    pure function polynomial_keys(name, default) result(keys)
        character(*), intent(in) :: name, default !! as above
        type(key_t) :: keys(n_polynomial)

        keys(1) = usual(real_key(name, 'bulk_modulus', 'Pa', default, &
                           'factor of mu, bulk modulus of the unloaded material', 0.0_dp, &
                           open_lower=.true.), 1e6_dp, 1e12_dp)
        keys(2) = real_key(name, 'a2', 'Pa', '0', 'factor of mu^2 in compression')
        keys(3) = real_key(name, 'a3', 'Pa', '0', 'factor of mu^3 in compression')
        keys(4) = real_key(name, 'b0', '-', '0', 'factor of the energy', 0.0_dp)
        keys(5) = real_key(name, 'b1', '-', '0', 'factor of mu times energy in compression', 0.0_dp)
        keys(6) = usual(real_key(name, 't1', 'Pa', none, &
                                 'factor of mu in tension; absent: bulk_modulus', 0.0_dp, &
                                 open_lower=.true.), 1e4_dp, 1e12_dp)
        keys(7) = real_key(name, 't2', 'Pa', '0', 'factor of mu^2 in tension', upper=0.0_dp)
    end function polynomial_keys

    !> The choice between them, in the order of the codes.
    pure function choice_keys(name) result(keys)
        character(*), intent(in) :: name
        type(key_t) :: keys(n_choice)

        keys(1) = text_key(name, 'eos', 'gruneisen', 'gruneisen|polynomial|linear', &
                           'equation of state; linear: p = bulk_modulus mu')
        keys(2:1 + n_gruneisen) = gruneisen_keys(name, none)
        keys(2 + n_gruneisen:) = polynomial_keys(name, none)
    end function choice_keys

    pure function cutoff_key(name) result(key)
        character(*), intent(in) :: name
        type(key_t) :: key

        key = real_key(name, 'pressure_cutoff', 'Pa', none, &
                       'least pressure, negative (spall); absent: no limit', upper=0.0_dp)
    end function cutoff_key

    !> Block of the shock Hugoniot.
    pure function gruneisen_block(density, par) result(numbers)
        real(rk), intent(in) :: density, par(n_gruneisen)
        real(rk) :: numbers(n_block)
        integer, parameter :: c0 = k_density + eos_c0 - 1

        numbers = 0
        numbers(k_kind) = eos_gruneisen
        numbers(k_density) = density
        numbers(c0:c0 + n_gruneisen - 1) = par
        numbers(k_density + eos_mu_max - 1) = &
            hugoniot_limit(numbers(k_density:k_density + n_eos - 1))
    end function gruneisen_block

    !> Block of the polynomial; refuses one that does not rise at small strains.
    pure subroutine polynomial_block(density, par, tension_given, numbers, fault)
        real(rk), intent(in) :: density, par(n_polynomial)
        logical, intent(in) :: tension_given
        real(rk), intent(out) :: numbers(n_block)
        character(:), allocatable, intent(inout) :: fault
        real(rk), parameter :: most = 10, least_range = 0.2_rk
        integer, parameter :: steps = 2000
        type(eos_terms_t) :: terms
        integer :: i

        numbers = 0
        numbers(k_kind) = eos_polynomial
        numbers(k_density) = density
        numbers([k_a1, k_a2, k_a3, k_b0, k_b1, k_t1, k_t2]) = par
        if (.not. tension_given) numbers(k_t1) = numbers(k_a1)
        numbers(k_mu_max) = most
        do i = 1, steps
            call eos_terms(numbers, most*i/steps, terms)
            if (terms%a_slope > 0) cycle
            numbers(k_mu_max) = most*(i - 1)/steps
            exit
        end do
        if (numbers(k_mu_max) < least_range) fault = 'the pressure falls with compression from '// &
            'mu < 0.2 on: a2 and a3 are too negative'
    end subroutine polynomial_block

    !> Block of the equation that the deck chooses; keys of another one are refused.
    subroutine chosen_block(density, par, given, first, numbers, fault)
        real(rk), intent(in) :: density !! unloaded [kg/m3]
        real(rk), intent(in) :: par(n_par)
        logical, intent(in) :: given(:)
        integer, intent(in) :: first !! slot of the key `eos`
        real(rk), intent(out) :: numbers(n_block)
        character(:), allocatable, intent(inout) :: fault
        integer :: g, p

        g = first + 1
        p = g + n_gruneisen
        numbers = 0
        select case (int(par(first)))
        case (eos_gruneisen)
            if (.not. all(given([g, g + 1, g + 4]))) &
                fault = "eos='gruneisen' needs sound_speed, s1 and gruneisen_gamma"
            if (any(given(p:p + n_polynomial - 1))) fault = "eos='gruneisen' takes no "// &
                'bulk_modulus, a2, a3, b0, b1, t1, t2'
            if (.not. allocated(fault)) numbers = gruneisen_block(density, par(g:p - 1))
        case (eos_polynomial)
            if (.not. given(p)) fault = "eos='polynomial' needs bulk_modulus"
            call refuse_gruneisen('polynomial', given(g:p - 1), fault)
            if (.not. allocated(fault)) call polynomial_block(density, &
                par(p:p + n_polynomial - 1), given(p + 5), numbers, fault)
        case default
            if (.not. given(p)) fault = "eos='linear' needs bulk_modulus"
            call refuse_gruneisen('linear', given(g:p - 1), fault)
            if (any(given(p + 1:p + n_polynomial - 1))) fault = "eos='linear' takes no "// &
                'a2, a3, b0, b1, t1, t2'
            numbers(k_kind) = eos_linear
            numbers(k_density) = density
            numbers(k_a1) = par(p)
        end select
    end subroutine chosen_block

    subroutine refuse_gruneisen(eos, given, fault)
        character(*), intent(in) :: eos
        logical, intent(in) :: given(n_gruneisen)
        character(:), allocatable, intent(inout) :: fault

        if (any(given)) fault = "eos='"//eos//"' takes no sound_speed, s1, s2, s3, "// &
                                'gruneisen_gamma, gruneisen_a'
    end subroutine refuse_gruneisen
end module brz_eos_keys
