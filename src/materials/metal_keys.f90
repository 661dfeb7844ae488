! SPDX-License-Identifier: MIT
!> What all metals of von Mises have in the deck beside their flow stress: elastic constants, heat,
!> failure, an equation of state, and what follows from them.
!>
!> A metal has its own parameters in the slots 1, 2, ... up to `n_own`; those below follow.
module brz_metal_keys
    use brz_eos_keys, only: choice_keys, chosen_block, cutoff_key, n_choice
    use brz_equation_of_state, only: n_block, unloaded_bulk
    use brz_isotropic, only: no_cutoff, set_linear
    use brz_johnson_cook_failure, only: failure_fault, failure_lines, failure_warning
    use brz_key, only: key_t, none, required
    use brz_kinds, only: dp, rk
    use brz_material, only: class_metal, fails_at_once, material_t, n_par, point_t
    use brz_model, only: model_t, real_key, text_key, usual
    use brz_text, only: string_t
    implicit none
    private
    public :: describe_metal, derive_metal, amount

    integer, parameter, public :: n_own = n_par - 45 !! slots of a metal's own parameters
    integer, parameter, public :: m_density = n_own + 1, m_shear = n_own + 2, m_young = n_own + 3, &
        m_poisson = n_own + 4, m_rate = n_own + 5, m_rate0 = n_own + 6, m_room = n_own + 7, &
        m_melt = n_own + 8, m_start = n_own + 9, m_heat = n_own + 10, m_fraction = n_own + 11, &
        m_heating = n_own + 12, m_failure = n_own + 13, m_d1 = n_own + 14, m_least = n_own + 19, &
        m_eos = n_own + 20, m_cutoff = m_eos + n_choice
    integer, parameter, public :: m_fails = m_cutoff + 1, m_block = m_cutoff + 2 !! derived
    integer, parameter, public :: by_energy = 2, by_total_rate = 2 !! places of words of options
    integer, parameter, public :: fails_by_strain = 1, fails_by_johnson_cook = 2 !! in m_fails
    ! history: the first alone without heat, and how much of it a metal has that feels heat
    integer, parameter, public :: h_strain = 1, h_temperature = 2, h_isentrope = 3
    integer, parameter :: warm_history = 3

contains

    !> Row of a number that is not negative, of a metal; `positive`: nor zero.
    pure function amount(key, unit, default, meaning, low, high, positive) result(row)
        character(*), intent(in) :: key, unit, default, meaning
        real(dp), intent(in) :: low, high !! warned of beyond
        logical, intent(in), optional :: positive
        type(key_t) :: row

        row = usual(real_key('', key, unit, default, meaning, 0.0_dp, open_lower=positive), &
                    low, high)
    end function amount

    !> Keys, history and procedures of a metal, whose name, code and n_hist are there: it feels heat
    !> where n_hist is `warm_history`.
    !>
    !> Its own keys stand behind the elastic constants: with `eos='gruneisen'` (a default) the shear
    !> modulus, otherwise Young's modulus and Poisson's ratio; without `eos` p = K mu alone.
    subroutine describe_metal(model, own, eos, reference_rate, acts)
        type(model_t), intent(inout) :: model
        type(key_t), intent(in) :: own(:)
        character(*), intent(in) :: eos !! default of the key, '' for no choice
        character(*), intent(in) :: reference_rate, acts !! default, meaning
        integer :: i

        model%class = class_metal
        allocate (model%keys(0), model%slots(0))
        call add(model, m_density, [amount('density', 'kg/m3', required, 'unloaded density', &
                                           10.0_dp, 25000.0_dp, .true.)])
        if (eos == 'gruneisen') then
            call add(model, m_shear, [amount('shear_modulus', 'Pa', required, 'shear modulus', &
                                             1e6_dp, 1e12_dp, .true.)])
        else
            call add(model, m_young, [amount('youngs_modulus', 'Pa', required, &
                "Young's modulus", 1e6_dp, 1e12_dp, .true.), real_key('', 'poisson_ratio', '-', &
                required, "Poisson's ratio", -1.0_dp, 0.4999_dp, open_lower=.true.)])
        end if
        call add(model, 1, own)
        call add(model, m_rate, [text_key('', 'rate', 'plastic', 'plastic|total', &
            'rate in the strength: plastic, implicit; or total, explicit'), &
            real_key('', 'reference_rate', '1/s', reference_rate, acts, 0.0_dp, &
                     open_lower=.true.)])
        if (model%n_hist == warm_history) call add_heat(model)
        call add_failure(model)
        if (eos /= '') then
            call add(model, m_eos, choice_keys(''))
            model%keys(size(model%keys) - n_choice + 1)%default = eos
            call add(model, m_cutoff, [cutoff_key('')])
        end if
        do i = 1, size(model%keys)
            model%keys(i)%owner = model%name
        end do
        model%history(h_strain) = 'plastic_strain'
        model%rest => rest
        model%remark => remark
    end subroutine describe_metal

    !> Rows for the slots from `first` on.
    subroutine add(model, first, rows)
        type(model_t), intent(inout) :: model
        integer, intent(in) :: first
        type(key_t), intent(in) :: rows(:)
        integer :: i

        model%keys = [model%keys, rows]
        model%slots = [model%slots, (first + i - 1, i=1, size(rows))]
    end subroutine add

    subroutine add_heat(model)
        type(model_t), intent(inout) :: model
        type(key_t) :: melt

        melt = amount('melt_temperature', 'K', required, 'temperature without strength', &
                      550.0_dp, 4000.0_dp, .true.)
        call add(model, m_room, [amount('room_temperature', 'K', '293', &
            'temperature of the unloaded material, without softening', 200.0_dp, 400.0_dp, &
            .true.), melt, amount('initial_temperature', 'K', none, &
            'temperature at t = 0; absent: room_temperature', 50.0_dp, 4000.0_dp, .true.), &
            amount('specific_heat', 'J/(kg K)', required, 'specific heat', 80.0_dp, 4500.0_dp, &
                   .true.), real_key('', 'heat_fraction', '-', '0.9', &
            "heating='plastic_work': part of the plastic work that is heat", 0.0_dp, 1.0_dp), &
            text_key('', 'heating', 'plastic_work', 'plastic_work|energy', &
            'temperature from plastic work alone, or from the energy, with shock heating')])
        model%history(h_temperature) = 'temperature'
        model%history_unit(h_temperature) = 'K'
    end subroutine add_heat

    subroutine add_failure(model)
        type(model_t), intent(inout) :: model
        type(key_t) :: rows(7)

        rows(1) = amount('failure_strain', '-', none, &
            'plastic strain at which it breaks; absent: never, or by d1', 1e-4_dp, 5.0_dp, .true.)
        rows(2) = real_key('', 'd1', '-', none, 'failure strain of Johnson and Cook: constant '// &
                           'part; absent: no such failure')
        rows(3) = real_key('', 'd2', '-', '0', 'failure strain: triaxial part')
        rows(4) = real_key('', 'd3', '-', '0', 'its exponent, negative: tension weakens')
        rows(5) = real_key('', 'd4', '-', '0', 'failure strain: rate')
        rows(6) = real_key('', 'd5', '-', '0', 'failure strain: temperature')
        rows(3:6)%needs = 'd1'
        rows(:6)%failure = .true.
        rows(7) = real_key('', 'least_failure_strain', '-', '0.001', &
                           'failure strain by d1 is at least this', 0.0_dp, open_lower=.true.)
        if (model%n_hist == warm_history) then
            call add(model, m_failure, rows)
        else
            call add(model, m_failure, rows(:5))
            call add(model, m_least, rows(7:))
        end if
    end subroutine add_failure

    !> What follows from the keys of all metals; a metal calls it from its `derive`.
    subroutine derive_metal(material, given, yield, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:) !! by slot
        real(rk), intent(in) :: yield !! stress of the first yield at rest [Pa]
        character(:), allocatable, intent(inout) :: fault

        associate (par => material%par, d => material%par(m_d1:m_d1 + 4))
            if (par(m_room) > 0 .and. par(m_melt) <= par(m_room)) &
                fault = 'melt_temperature must be above room_temperature'
            if (any(given(m_d1 + 1:m_d1 + 4)) .and. .not. given(m_d1)) &
                fault = 'd2, d3, d4 and d5 need d1'
            if (given(m_failure) .and. given(m_d1)) &
                fault = 'failure_strain and d1 are two laws of failure: give one of them'
            if (allocated(fault)) return
            if (given(m_d1) .and. .not. given(m_least)) &
                call failure_fault(d, par(m_least), par(m_rate0), fault)
            if (.not. allocated(fault)) call derive_elasticity(material, given, fault)
            if (allocated(fault)) return
            if (given(m_failure)) par(m_fails) = fails_by_strain
            if (given(m_d1)) par(m_fails) = fails_by_johnson_cook
            material%fails = merge(fails_at_once, 0, par(m_fails) > 0)
            if (.not. given(m_start)) par(m_start) = par(m_room)
            if (.not. given(m_cutoff)) par(m_cutoff) = no_cutoff
            material%yields = yield/(3*material%shear)
            if (material%n_hist == warm_history .and. int(par(m_heating)) /= by_energy) &
                material%n_hist = h_isentrope - 1
        end associate
    end subroutine derive_metal

    !> Moduli, wave speed and equation of state.
    subroutine derive_elasticity(material, given, fault)
        type(material_t), intent(inout) :: material
        logical, intent(in) :: given(:)
        character(:), allocatable, intent(inout) :: fault
        integer, parameter :: bulk = m_eos + 7, linear = 3

        associate (par => material%par, block => material%par(m_block:m_block + n_block - 1))
            if (par(m_young) > 0) call set_linear(par(m_density), par(m_young), par(m_poisson), &
                                                  m_block, material)
            if (par(m_young) > 0 .and. int(par(m_eos)) == linear .and. given(bulk)) &
                fault = "eos='linear' takes no bulk_modulus beside youngs_modulus and "// &
                    'poisson_ratio: it follows from them'
            if (allocated(fault)) return
            if (par(m_young) > 0 .and. (.not. par(m_eos) > 0 .or. int(par(m_eos)) == linear)) return
            call chosen_block(par(m_density), par, given, m_eos, block, fault)
            if (allocated(fault)) return
            material%density = par(m_density)
            material%bulk = unloaded_bulk(block)
            if (.not. par(m_young) > 0) material%shear = par(m_shear)
            material%c_wave = sqrt((material%bulk + 4*material%shear/3)/material%density)
        end associate
    end subroutine derive_elasticity

    !> Failure strains, and whether they are at their floor.
    subroutine remark(material, lines, warning)
        type(material_t), intent(in) :: material
        type(string_t), allocatable, intent(out) :: lines(:)
        character(:), allocatable, intent(out) :: warning

        if (int(material%par(m_fails)) /= fails_by_johnson_cook) return
        associate (par => material%par, d => material%par(m_d1:m_d1 + 4))
            call failure_lines(d, par(m_least), par(m_rate0), lines)
            warning = failure_warning(d, par(m_least), par(m_rate0))
        end associate
    end subroutine remark

    subroutine rest(material, point)
        type(material_t), intent(in) :: material
        type(point_t), intent(inout) :: point

        if (material%n_hist >= h_temperature) point%hist(h_temperature) = material%par(m_start)
    end subroutine rest
end module brz_metal_keys
