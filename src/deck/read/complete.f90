! SPDX-License-Identifier: MIT
!> Groups against the key table: known keys, converted values, defaults, what is missing or double.
module brz_complete
    use brz_deck, only: add_entry, add_error, add_group, add_warning, deck_t, drop_group, &
                        entry_t, find_entry, find_group, group_label, group_t
    use brz_errors, only: error_t, exit_internal, raise
    use brz_key, only: key_t, none, required
    use brz_key_text, only: alias_text, expectation, find_row, group_repeats, key_hint, present_name
    use brz_preset, only: expand_preset
    use brz_text, only: nearest, printable, to_text
    use brz_value_text, only: entry_from_text
    use brz_values, only: convert_entry, same_values
    implicit none
    private
    public :: convert_group, complete_group, parse_defaults, check_repeats, group_owner
    public :: ensure_group, list_owners, take_id, take_present_names

contains

    !> Convert the entries of a group; unknown and repeated keys are errors.
    subroutine convert_group(deck, keys, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g
        character(:), allocatable :: owner, label
        integer :: e, first

        if (.not. deck%groups(g)%known) return
        if (deck%groups(g)%broken) deck%groups(g)%bad = .true.
        call expand_preset(deck, keys, g)
        call check_owner(deck, keys, g)
        label = group_label(deck%groups(g))
        owner = group_owner(deck%groups(g))
        do e = 1, deck%groups(g)%n
            associate (entry => deck%groups(g)%entries(e))
                first = find_entry(deck%groups(g), trim(entry%key))
                entry%row = find_row(keys, trim(deck%groups(g)%name), trim(entry%key), owner)
                if (entry%row == 0) then
                    call complain_unknown(deck, keys, g, e)
                else if (first < e) then
                    entry%bad = .true.
                    call add_error(deck, entry%line, label//"key '"//trim(entry%key)// &
                                   "' stands twice, first at line "// &
                                   to_text(deck%groups(g)%entries(first)%line)//'; keep one')
                else
                    call convert_entry(deck, label, keys(entry%row), .false., entry)
                end if
                if (entry%bad) deck%groups(g)%bad = .true.
            end associate
        end do
    end subroutine convert_group

    !> Call the keys of a group by their present names, and tell of those that have another one.
    subroutine take_present_names(deck, keys, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g
        character(:), allocatable :: name
        integer :: e

        do e = 1, deck%groups(g)%n
            associate (entry => deck%groups(g)%entries(e))
                name = present_name(keys, trim(deck%groups(g)%name), trim(entry%key))
                if (name == entry%key) cycle
                call add_warning(deck, entry%line, group_label(deck%groups(g))// &
                                 alias_text(trim(entry%key), name))
                entry%key = name
            end associate
        end do
    end subroutine take_present_names

    !> Copy the id into the group, so that every message can name it.
    subroutine take_id(deck, g)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), parameter :: allowed = &
                                   'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'// &
                                             '0123456789_-.+'
        integer :: e

        e = find_entry(deck%groups(g), 'id')
        if (e == 0) return
        associate (entry => deck%groups(g)%entries(e))
            if (entry%n /= 1) return
            if (.not. entry%raw(1)%quoted) return
            deck%groups(g)%id = printable(entry%raw(1)%text, 32)
            if (verify(entry%raw(1)%text, allowed) == 0 .and. len(entry%raw(1)%text) <= 32 .and. &
                len(entry%raw(1)%text) > 0) return
            entry%bad = .true.
            call add_error(deck, entry%line, group_label(deck%groups(g))// &
                           'an id is 1 to 32 letters, digits or any of _ - . +')
        end associate
    end subroutine take_id

    !> The model of a group whose keys depend on it; empty where it has none.
    pure function group_owner(group) result(owner)
        type(group_t), intent(in) :: group
        character(:), allocatable :: owner
        integer :: e

        owner = ''
        e = find_entry(group, 'model')
        if (e == 0) return
        if (group%entries(e)%n /= 1) return
        owner = trim(group%entries(e)%raw(1)%text)
    end function group_owner

    !> An unknown model is told once, in place of all its keys.
    subroutine check_owner(deck, keys, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g
        character(:), allocatable :: owner, hint
        integer :: e, i

        e = find_entry(deck%groups(g), 'model')
        if (e == 0) return
        if (find_row(keys, trim(deck%groups(g)%name), 'model', '') == 0) return
        owner = group_owner(deck%groups(g))
        if (any(keys%group == deck%groups(g)%name .and. keys%owner == owner .and. &
                owner /= '')) return
        deck%groups(g)%bad = .true.
        deck%groups(g)%entries(e)%bad = .true.
        if (deck%groups(g)%entries(e)%n > 1) then
            call add_error(deck, deck%groups(g)%entries(e)%line, group_label(deck%groups(g))// &
                "key 'model' expects one text, found "//to_text(deck%groups(g)%entries(e)%n)// &
                " values: is a '=' missing behind the name of the next key?")
            return
        end if
        i = nearest(owner, pack(keys%owner, keys%group == deck%groups(g)%name))
        hint = ''
        if (i > 0) hint = '; did you mean '''//trim(nth_owner(keys, deck%groups(g)%name, i))//'''?'
        call add_error(deck, deck%groups(g)%entries(e)%line, group_label(deck%groups(g))// &
                       "unknown model '"//printable(owner, 40)//"'"//hint// &
                       ' Models: '//list_owners(keys, deck%groups(g)%name))
    end subroutine check_owner

    !> Owner of the i-th row of a group.
    pure function nth_owner(keys, group, i) result(owner)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group
        integer, intent(in) :: i
        character(len(keys%owner)) :: owner
        integer :: k, n

        n = 0
        owner = ''
        do k = 1, size(keys)
            if (keys(k)%group /= group) cycle
            n = n + 1
            owner = keys(k)%owner
            if (n == i) return
        end do
    end function nth_owner

    !> The models of a group, separated by commas.
    pure function list_owners(keys, group) result(text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group
        character(:), allocatable :: text
        integer :: i

        text = ''
        do i = 1, size(keys)
            if (keys(i)%group /= group .or. keys(i)%owner == '') cycle
            if (any(keys(:i - 1)%group == group .and. keys(:i - 1)%owner == keys(i)%owner)) cycle
            if (text /= '') text = text//', '
            text = text//trim(keys(i)%owner)
        end do
    end function list_owners

    !> A key that the table does not have, or not for this model.
    subroutine complain_unknown(deck, keys, g, e)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g, e
        character(:), allocatable :: owner, hint
        integer :: m

        associate (group => deck%groups(g), entry => deck%groups(g)%entries(e))
            entry%bad = .true.
            owner = group_owner(group)
            m = find_entry(group, 'model')
            if (find_row(keys, trim(group%name), 'model', '') > 0) then
                ! without a model nobody knows whether its keys are right
                if (m == 0) return
                if (group%entries(m)%bad) return
            end if
            hint = key_hint(keys, trim(group%name), owner, trim(entry%key))
            if (index(entry%key, '(') > 0) hint = '; give all values of a key in one list, '// &
                 'without index'
            call add_error(deck, entry%line, group_label(group)//"unknown key '"// &
                           printable(trim(entry%key), 32)//"'"//hint, entry%set)
        end associate
    end subroutine complain_unknown

    !> Defaults of all rows as converted entries; an error here is a fault of the table.
    subroutine parse_defaults(keys, defaults, err)
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(inout) :: defaults(:) !! as long as keys
        type(error_t), intent(inout) :: err
        character(:), allocatable :: message
        integer :: i

        do i = 1, size(keys)
            if (keys(i)%key == '') cycle
            if (keys(i)%default == required .or. keys(i)%default == none) cycle
            call entry_from_text(keys(i), trim(keys(i)%default), defaults(i), message)
            defaults(i)%row = i
            if (message /= '') call raise(err, exit_internal, 'key table: default of &'// &
                                          trim(keys(i)%group)//' '//trim(keys(i)%key)//': '// &
                                          message)
        end do
    end subroutine parse_defaults

    !> Fill in the defaults of a group, mark values that equal them, and tell what is missing.
    subroutine complete_group(deck, keys, defaults, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        integer, intent(in) :: g
        character(:), allocatable :: owner
        integer :: i, e

        if (.not. deck%groups(g)%known) return
        owner = group_owner(deck%groups(g))
        do i = 1, size(keys)
            if (keys(i)%group /= deck%groups(g)%name .or. keys(i)%key == '') cycle
            if (keys(i)%owner /= '' .and. keys(i)%owner /= owner) cycle
            e = find_entry(deck%groups(g), trim(keys(i)%key))
            if (e > 0) then
                associate (entry => deck%groups(g)%entries(e))
                    if (.not. entry%bad .and. defaults(i)%row == i) &
                        entry%default = same_values(entry, defaults(i))
                end associate
            else if (keys(i)%default == required) then
                call complain_missing(deck, keys(i), g)
            else if (defaults(i)%row == i) then
                call add_entry(deck%groups(g), trim(keys(i)%key), 0)
                deck%groups(g)%entries(deck%groups(g)%n) = defaults(i)
                deck%groups(g)%entries(deck%groups(g)%n)%default = .true.
            end if
        end do
    end subroutine complete_group

    subroutine complain_missing(deck, row, g)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: row
        integer, intent(in) :: g
        character(:), allocatable :: meaning

        deck%groups(g)%bad = .true.
        if (deck%groups(g)%broken) return
        meaning = trim(row%meaning)
        if (index(meaning, '.') == len(meaning)) meaning = meaning(:len(meaning) - 1)
        call add_error(deck, deck%groups(g)%line, group_label(deck%groups(g))//"key '"// &
                       trim(row%key)//"' is missing ("//meaning//'); it expects '// &
                       expectation(row))
    end subroutine complain_missing

    !> Groups that may stand once, and ids that may be used once. Of a group that may stand once the
    !> first alone is kept: what is filled from it has room for one.
    subroutine check_repeats(deck, keys)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        logical :: repeats
        integer :: g, first

        do g = deck%n, 1, -1
            if (.not. deck%groups(g)%known) cycle
            repeats = group_repeats(keys, trim(deck%groups(g)%name))
            if (repeats) then
                if (deck%groups(g)%id == '') cycle
                first = find_group(deck, trim(deck%groups(g)%name), deck%groups(g)%id)
                if (first < g) call add_error(deck, deck%groups(g)%line, &
                                              group_label(deck%groups(g))// &
                                              'this id is taken by the group at line '// &
                                              to_text(deck%groups(first)%line)//'; choose another')
            else
                first = find_group(deck, trim(deck%groups(g)%name))
                if (first < g) call add_error(deck, deck%groups(g)%line, &
                                              group_label(deck%groups(g))// &
                                              'this group may stand once, and stands already '// &
                                              'at line '// &
                                              to_text(deck%groups(first)%line)// &
                                              '; put the keys together')
            end if
            if (first < g) deck%groups(g)%bad = .true.
            if (first < g .and. .not. repeats) call drop_group(deck, g)
        end do
    end subroutine check_repeats

    !> Make sure that a group that may stand once is there, with its defaults.
    subroutine ensure_group(deck, keys, defaults, name)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(entry_t), intent(in) :: defaults(:)
        character(*), intent(in) :: name

        if (find_group(deck, name) > 0) return
        call add_group(deck, name, 0)
        call complete_group(deck, keys, defaults, deck%n)
    end subroutine ensure_group
end module brz_complete
