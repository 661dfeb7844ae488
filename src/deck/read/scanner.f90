! SPDX-License-Identifier: MIT
!> Reads a deck against the key table, with errors that an engineer can act on.
!>
!> A deck is free text with namelist groups: '&' at the start of a line, or behind the '/' of the
!> group before, opens a group, '/' closes it, '!' starts a comment. Errors are
!> collected in the deck: `build_case` (or `report_errors`) raises them all together, so that one
!> look at the deck repairs them all.
module brz_scanner
    use brz_complete, only: check_repeats, complete_group, convert_group, parse_defaults, &
                            take_id, take_present_names
    use brz_deck, only: add_error, add_group, deck_t, entry_t, max_groups, max_shown, report_errors
    use brz_entries, only: read_entries
    use brz_errors, only: error_t, failed
    use brz_key, only: key_t
    use brz_key_text, only: group_hint, group_known
    use brz_overrides, only: apply_overrides, choose_presets
    use brz_preset, only: leave_failure_out
    use brz_reader, only: close_reader, find_group_start, next_token, open_file, open_text, &
                          reader_t, token_key, token_slash, token_t
    use brz_text, only: printable, string_t, to_text
    implicit none
    private
    public :: read_deck, read_deck_text

contains

    !> Read a deck file. Raises an error only where there is nothing to read at all, or where
    !> the key table is wrong; all other errors wait in the deck for `build_case`.
    subroutine read_deck(file, keys, overrides, deck, err)
        character(*), intent(in) :: file
        type(key_t), intent(in) :: keys(:) !! the key table, models included
        type(string_t), intent(in) :: overrides(:) !! of --set, may be of size 0
        type(deck_t), intent(out) :: deck
        type(error_t), intent(inout) :: err
        type(reader_t) :: reader
        character(:), allocatable :: message

        deck%file = file
        call open_file(reader, file, message)
        if (message /= '') then
            call close_reader(reader)
            call add_error(deck, 0, message)
            call report_errors(deck, err)
            return
        end if
        call read_all(reader, keys, overrides, deck, err)
        call close_reader(reader)
    end subroutine read_deck

    !> Read a deck from a text in memory; `name` stands for the file in messages.
    subroutine read_deck_text(name, text, keys, overrides, deck, err)
        character(*), intent(in) :: name, text
        type(key_t), intent(in) :: keys(:)
        type(string_t), intent(in) :: overrides(:)
        type(deck_t), intent(out) :: deck
        type(error_t), intent(inout) :: err
        type(reader_t) :: reader

        deck%file = name
        call open_text(reader, text)
        call read_all(reader, keys, overrides, deck, err)
    end subroutine read_deck_text

    subroutine read_all(reader, keys, overrides, deck, err)
        type(reader_t), intent(inout) :: reader
        type(key_t), intent(in) :: keys(:)
        type(string_t), intent(in) :: overrides(:)
        type(deck_t), intent(inout) :: deck
        type(error_t), intent(inout) :: err
        type(entry_t), allocatable :: defaults(:)
        integer :: g

        allocate (defaults(size(keys)))
        call parse_defaults(keys, defaults, err)
        if (failed(err)) return
        allocate (deck%overrides(size(overrides)))
        deck%overrides = overrides
        allocate (deck%groups(16))
        call read_groups(reader, keys, deck)
        if (reader%bad_byte >= 0 .or. reader%read_failed) then
            call complain_end(reader, deck)
            call report_errors(deck, err)
            return
        end if
        if (deck%n == 0) then
            if (deck%n_errors == 0) call add_error(deck, 0, 'has no group; a group starts with '// &
                                                   "'&' as the first character of a line, for "// &
                                                   "example "// &
                                                   "&run title='...', t_end=1e-3 /")
            call report_errors(deck, err)
            return
        end if
        do g = 1, deck%n
            call take_id(deck, g)
            call take_present_names(deck, keys, g)
        end do
        call choose_presets(deck, keys)
        do g = 1, deck%n
            call convert_group(deck, keys, g)
        end do
        call apply_overrides(deck, keys)
        do g = 1, deck%n
            call leave_failure_out(deck, keys, g)
            call complete_group(deck, keys, defaults, g)
        end do
        call check_repeats(deck, keys)
    end subroutine read_all

    !> All groups up to the end of the file, with their raw values.
    subroutine read_groups(reader, keys, deck)
        type(reader_t), intent(inout) :: reader
        type(key_t), intent(in) :: keys(:)
        type(deck_t), intent(inout) :: deck
        character(32) :: name
        integer :: line
        logical :: found, opens

        do
            call find_group_start(reader, name, line, found, opens)
            if (.not. found) exit
            if (.not. opens) then
                if (group_known(keys, trim(name))) call judge_text(reader, trim(name), line, deck)
                cycle
            end if
            if (deck%n == max_groups) then
                call add_error(deck, line, 'more than '//to_text(max_groups)//' groups')
                exit
            end if
            call add_group(deck, name(:16), line)
            if (.not. group_known(keys, trim(name))) then
                deck%groups(deck%n)%known = .false.
                call complain_group(deck, keys, trim(name), line)
            end if
            call read_entries(reader, deck, deck%n)
        end do
    end subroutine read_groups

    !> A known name behind '&' within text is prose ('unless an &interaction says so'), but where a
    !> key or a '/' follows it is a group that would be passed over.
    subroutine judge_text(reader, name, line, deck)
        type(reader_t), intent(inout) :: reader
        character(*), intent(in) :: name
        integer, intent(in) :: line
        type(deck_t), intent(inout) :: deck
        type(token_t) :: token

        call next_token(reader, token)
        if (token%kind /= token_key .and. token%kind /= token_slash) return
        call add_error(deck, line, "'&"//name//"' stands within text, which is not read: begin "// &
                       "a line with it, or put '!' in front of the text")
    end subroutine judge_text

    subroutine complain_group(deck, keys, name, line)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: name
        integer, intent(in) :: line
        character(:), allocatable :: hint

        hint = ''
        if (deck%n_errors < max_shown) hint = group_hint(keys, name)
        if (name == 'end') hint = ": close a group with '/'"
        if (name == '') hint = ": a name must stand right behind '&'"//hint
        call add_error(deck, line, "unknown group '&"//printable(name, 32)//"'"//hint)
    end subroutine complain_group

    !> What ended the reading too early.
    subroutine complain_end(reader, deck)
        type(reader_t), intent(in) :: reader
        type(deck_t), intent(inout) :: deck

        if (reader%bad_byte >= 0) then
            call add_error(deck, reader%line, 'this is not a plain text file: here stands a '// &
                 'byte of code '// &
                           to_text(reader%bad_byte))
        else
            call add_error(deck, reader%line, 'the file cannot be read from here on')
        end if
    end subroutine complain_end
end module brz_scanner
