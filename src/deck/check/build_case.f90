! SPDX-License-Identifier: MIT
!> From the deck as read to the validated scene: values, references, what is present.
module brz_build_case
    use brz_case, only: case_t, material_case_t
    use brz_check_aspect, only: check_meeting
    use brz_check_bodies, only: check_bodies
    use brz_check_air, only: check_air, check_charges, check_gas
    use brz_check_inflow, only: check_inflows
    use brz_check_interactions, only: check_interactions
    use brz_check_loads, only: check_loads
    use brz_check_motions, only: check_motions
    use brz_check_plausible, only: check_plausible
    use brz_check_directions, only: check_directions
    use brz_check_gauges, only: check_gauges
    use brz_check_idle, only: check_idle
    use brz_complete, only: ensure_group, parse_defaults
    use brz_deck, only: add_error, add_warning, deck_t, entry_t, find_entry, find_group, &
         group_label, &
                        group_t, may_be_misspelt, max_shown, place, report_errors
    use brz_echo, only: echo_deck
    use brz_errors, only: error_t, failed
    use brz_fill_case, only: fill_air, fill_body, fill_charge, fill_gas, fill_gauge, fill_run, &
                             fill_settings
    use brz_key, only: key_t
    use brz_laminates, only: expand_laminates
    use brz_mirror_images, only: leave_out_images
    use brz_text, only: string_t
    implicit none
    private
    public :: build_case, fill_material, take_warnings

contains

    !> Fill a case from a deck. Raises all errors of the deck together, those of `read_deck` too.
    subroutine build_case(deck, keys, case, err)
        type(deck_t), intent(inout) :: deck !! settings that are absent are added
        type(key_t), intent(in) :: keys(:)
        type(case_t), intent(out) :: case
        type(error_t), intent(inout) :: err
        type(entry_t), allocatable :: defaults(:)

        allocate (case%warnings(0))
        if (failed(err)) return
        allocate (defaults(size(keys)))
        call parse_defaults(keys, defaults, err)
        if (failed(err)) return
        call check_presence(deck)
        call add_settings(deck, keys, defaults)
        call fill_run(deck, case%run)
        call leave_out_images(deck, case%run%symmetry)
        call expand_laminates(deck, keys, defaults, case%run%symmetry)
        call allocate_lists(deck, case)
        call fill_groups(deck, keys, case)
        call fill_settings(deck, case)
        call check_air(deck, case)
        call check_gas(deck, case)
        call check_charges(deck, case)
        call check_inflows(deck, case)
        call check_bodies(deck, case)
        call check_directions(deck, case)
        call check_interactions(deck, case)
        call check_meeting(deck, case)
        call check_loads(deck, case)
        call check_motions(deck, case)
        call check_gauges(deck, case)
        call check_plausible(deck, keys)
        call check_use(deck, case)
        call check_idle(deck, case)
        call take_warnings(deck, case%warnings)
        call report_errors(deck, err)
        if (failed(err)) return
        call echo_deck(deck, keys, case%echo)
    end subroutine build_case

    !> A scene needs &run, and something to compute.
    subroutine check_presence(deck)
        type(deck_t), intent(inout) :: deck

        if (may_be_misspelt(deck)) return
        if (find_group(deck, 'run') == 0) &
            call add_error(deck, 0, "the group &run is missing; write at least &run t_end=1e-3 /")
        if (find_group(deck, 'air') == 0 .and. find_group(deck, 'body') == 0) &
            call add_error(deck, 0, 'neither &air nor &body is there: nothing to compute; add '// &
            'one of them')
    end subroutine check_presence

    !> Groups of settings that the scene uses but the deck leaves out.
    subroutine add_settings(deck, keys, defaults)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        logical :: air, body

        air = find_group(deck, 'air') > 0
        body = find_group(deck, 'body') > 0
        if (body) call ensure_group(deck, keys, defaults, 'solid')
        if (air .and. body) call ensure_group(deck, keys, defaults, 'coupling')
        call ensure_group(deck, keys, defaults, 'output')
    end subroutine add_settings

    subroutine allocate_lists(deck, case)
        type(deck_t), intent(in) :: deck
        type(case_t), intent(inout) :: case

        allocate (case%gas(count(deck%groups(:deck%n)%name == 'gas')))
        allocate (case%charges(count(deck%groups(:deck%n)%name == 'charge')))
        allocate (case%materials(count(deck%groups(:deck%n)%name == 'material')))
        allocate (case%bodies(count(deck%groups(:deck%n)%name == 'body')))
        allocate (case%gauges(count(deck%groups(:deck%n)%name == 'gauge')))
    end subroutine allocate_lists

    !> All groups that describe objects, in the order of the deck.
    subroutine fill_groups(deck, keys, case)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(case_t), intent(inout) :: case
        integer :: g, gas, charges, materials, bodies, gauges

        gas = 0
        charges = 0
        materials = 0
        bodies = 0
        gauges = 0
        do g = 1, deck%n
            select case (deck%groups(g)%name)
            case ('air')
                call fill_air(deck, g, case)
            case ('gas')
                gas = gas + 1
                call fill_gas(deck, g, case%gas(gas))
            case ('charge')
                charges = charges + 1
                call fill_charge(deck, deck%groups(g), case%charges(charges))
            case ('material')
                materials = materials + 1
                call fill_material(deck, deck%groups(g), keys, case%materials(materials))
            case ('body')
                bodies = bodies + 1
                call fill_body(deck, g, case%bodies(bodies))
            case ('gauge')
                gauges = gauges + 1
                call fill_gauge(deck, deck%groups(g), case%gauges(gauges))
            end select
        end do
    end subroutine fill_groups

    !> The keys of the model, complete and in the order of the table.
    subroutine fill_material(deck, group, keys, material)
        type(deck_t), intent(in) :: deck
        type(group_t), intent(in) :: group
        type(key_t), intent(in) :: keys(:)
        type(material_case_t), intent(inout) :: material
        integer :: e, i, n

        material%id = group%id
        material%unconfirmed = ''
        material%place = place(deck, group%line)
        e = find_entry(group, 'model')
        if (e == 0) return
        if (group%entries(e)%bad) return
        material%model = group%entries(e)%word(1)%s
        n = count(keys%group == 'material' .and. keys%owner == material%model .and. keys%key /= '')
        material%n = n
        allocate (material%key(n), material%value(n), material%word(n), material%given(n))
        n = 0
        do i = 1, size(keys)
            if (keys(i)%group /= 'material' .or. keys(i)%owner /= material%model) cycle
            if (keys(i)%key == '') cycle
            n = n + 1
            material%key(n) = keys(i)%key
            material%value(n) = 0
            material%word(n) = ''
            material%given(n) = .false.
            e = find_entry(group, trim(keys(i)%key))
            if (e == 0) cycle
            if (group%entries(e)%bad) cycle
            material%value(n) = group%entries(e)%number(1)
            material%word(n) = group%entries(e)%word(1)%s
            material%given(n) = .not. group%entries(e)%default
            if (group%entries(e)%unconfirmed) &
                material%unconfirmed = material%unconfirmed//' '//trim(keys(i)%key)
            if (group%entries(e)%unconfirmed .and. keys(i)%failure) material%doubtful = .true.
        end do
    end subroutine fill_material

    !> Groups that have no effect.
    subroutine check_use(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: g

        do g = 1, deck%n
            if (deck%groups(g)%line == 0) cycle
            select case (deck%groups(g)%name)
            case ('material')
                if (any(case%bodies%material == deck%groups(g)%id)) cycle
                call no_effect(deck, g, 'no body is made of it')
            case ('coupling')
                if (.not. case%coupling%present) call no_effect(deck, g, &
                     'it needs both &air and &body')
            case ('solid')
                if (.not. case%solid%present) call no_effect(deck, g, 'there is no &body')
            case ('point', 'segment')
                call no_effect(deck, g, 'only `brisance mat` drives a material point')
            end select
        end do
    end subroutine check_use

    subroutine no_effect(deck, g, why)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), intent(in) :: why

        call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                         'has no effect: '//why)
    end subroutine no_effect

    !> The warnings as texts, in the order in which they were found.
    subroutine take_warnings(deck, warnings)
        type(deck_t), intent(in) :: deck
        type(string_t), allocatable, intent(out) :: warnings(:)
        integer :: i

        allocate (warnings(min(deck%n_warnings, max_shown)))
        do i = 1, size(warnings)
            warnings(i)%s = deck%warnings(i)%text
        end do
    end subroutine take_warnings
end module brz_build_case
