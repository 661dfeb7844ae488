! SPDX-License-Identifier: MIT
!> `--set group.key=value` and `--set group(id).key=value`: the command line over the deck.
module brz_overrides
    use brz_deck, only: add_entry, add_error, add_group, add_warning, deck_t, entry_t, &
                        find_entry, find_group
    use brz_complete, only: group_owner
    use brz_key, only: key_t, kind_text
    use brz_key_text, only: alias_text, find_row, group_hint, group_known, group_repeats, &
                            key_hint, present_name
    use brz_preset, only: take_back
    use brz_text, only: lower, to_text
    use brz_value_text, only: entry_from_text
    implicit none
    private
    public :: apply_overrides, choose_presets

contains

    !> Put the presets that overrides choose in place of those of the deck, before their keys are
    !> taken: what else the deck gives for the group stands.
    subroutine choose_presets(deck, keys)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        character(:), allocatable :: group, id, key, value, message
        type(entry_t) :: entry
        integer :: e, g, i, row

        do i = 1, size(deck%overrides)
            call take_apart(deck%overrides(i)%s, group, id, key, value)
            row = find_row(keys, group, 'preset', '')
            if (row == 0 .or. key /= 'preset') cycle
            call choose_group(deck, keys, i, group, id, g)
            if (g == 0) cycle
            call entry_from_text(keys(row), value, entry, message)
            if (message /= '') then
                call add_error(deck, 0, message, i)
                cycle
            end if
            e = find_entry(deck%groups(g), 'preset')
            if (e == 0) then
                call add_entry(deck%groups(g), key, 0)
                e = deck%groups(g)%n
            end if
            associate (chosen => deck%groups(g)%entries(e))
                chosen%line = deck%groups(g)%line
                chosen%set = i
                chosen%n = entry%n
                chosen%raw = entry%raw
            end associate
        end do
    end subroutine choose_presets

    !> Put all other overrides into the deck; errors are collected there.
    subroutine apply_overrides(deck, keys)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        character(:), allocatable :: group, id, key, value
        integer :: i, g

        do i = 1, size(deck%overrides)
            call take_apart(deck%overrides(i)%s, group, id, key, value)
            if (key == '') then
                call add_error(deck, 0, 'write group.key=value or group(id).key=value', i)
            else if (.not. group_known(keys, group)) then
                call add_error(deck, 0, 'unknown group &'//group//group_hint(keys, group), i)
            else if (key == 'preset' .and. find_row(keys, group, key, '') > 0) then
                cycle
            else if (key == 'id' .or. key == 'model') then
                call add_error(deck, 0, "'"//key//"' cannot be set here: change the deck", i)
            else
                call choose_group(deck, keys, i, group, id, g)
                if (g > 0) call override(deck, keys, i, g, present_name(keys, group, key), value)
                if (key /= present_name(keys, group, key)) call add_warning(deck, 0, &
                    '--set '//group//': '//alias_text(key, present_name(keys, group, key)))
            end if
        end do
    end subroutine apply_overrides

    !> Parts of 'group(id).key=value'; key is empty where the text has not this form.
    pure subroutine take_apart(text, group, id, key, value)
        character(*), intent(in) :: text
        character(:), allocatable, intent(out) :: group, id, key, value
        integer :: equal, dot, left, right

        group = ''
        id = ''
        key = ''
        value = ''
        equal = index(text, '=')
        if (equal == 0) return
        dot = index(text(:equal), '.')
        left = index(text(:equal), '(')
        if (left > 0 .and. left < dot) then
            right = index(text(:equal), ')')
            if (right < left) return
            id = text(left + 1:right - 1)
            dot = right + 1
            if (text(dot:dot) /= '.') return
        else
            left = dot
        end if
        if (left < 2) return
        group = trim(adjustl(lower(text(:left - 1))))
        if (group(1:1) == '&') group = group(2:)
        key = trim(adjustl(lower(text(dot + 1:equal - 1))))
        value = trim(adjustl(text(equal + 1:)))
    end subroutine take_apart

    !> The group that an override means; 0, and an error, where that is not clear.
    subroutine choose_group(deck, keys, i, group, id, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: i !! number of the override
        character(*), intent(in) :: group, id
        integer, intent(out) :: g
        integer :: n

        if (.not. group_repeats(keys, group)) then
            g = find_group(deck, group)
            if (g > 0) return
            call add_group(deck, group, 0)
            g = deck%n
        else if (id /= '') then
            g = find_group(deck, group, id)
            if (g == 0) call add_error(deck, 0, 'the deck has no &'//group//" with id='"//id// &
                                       "'", i)
        else
            g = find_group(deck, group)
            n = count(deck%groups(:deck%n)%name == group)
            if (n == 1) return
            g = 0
            call add_error(deck, 0, 'the deck has '//to_text(n)//' groups &'//group// &
                           ': write '//group//'(id).key=value', i)
        end if
    end subroutine choose_group

    !> Replace or add one value, or take it back ('none').
    subroutine override(deck, keys, i, g, key, value)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: i, g
        character(*), intent(in) :: key, value
        type(entry_t) :: entry
        character(:), allocatable :: message, owner
        integer :: e, row

        owner = group_owner(deck%groups(g))
        row = find_row(keys, trim(deck%groups(g)%name), key, owner)
        if (row == 0) then
            call add_error(deck, 0, "unknown key '"//key//"'"// &
                           key_hint(keys, trim(deck%groups(g)%name), owner, key), i)
            return
        end if
        e = find_entry(deck%groups(g), key)
        if (value == 'none' .and. keys(row)%kind /= kind_text .and. e > 0) then
            call take_back(keys, owner, e, 1, deck%groups(g))
            return
        end if
        call entry_from_text(keys(row), value, entry, message)
        if (message /= '') call add_error(deck, 0, message, i)
        if (e == 0) then
            call add_entry(deck%groups(g), key, 0)
            e = deck%groups(g)%n
        end if
        entry%key = key
        entry%row = row
        entry%set = i
        entry%bad = message /= ''
        deck%groups(g)%entries(e) = entry
        if (entry%bad) deck%groups(g)%bad = .true.
    end subroutine override
end module brz_overrides
