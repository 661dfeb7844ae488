! SPDX-License-Identifier: MIT
!> The inside of a group, from tokens to keys with raw values.
module brz_entries
    use brz_deck, only: add_entry, add_error, deck_t, entry_t, group_label, max_entries, &
                        max_values
    use brz_reader, only: max_token, next_token, reader_t, token_comma, token_end, token_group, &
                          token_key, token_open_quote, token_quoted, token_slash, token_stray, &
                          token_t, token_word
    use brz_text, only: lower, printable, to_text
    implicit none
    private
    public :: read_entries

contains

    !> Read keys and values up to the slash that closes the group, or to where it should have been.
    subroutine read_entries(reader, deck, g)
        type(reader_t), intent(inout) :: reader
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the deck that is filled
        type(token_t) :: token
        integer :: e, last
        logical :: told

        e = 0
        last = token_key
        told = .false.
        do
            call next_token(reader, token)
            select case (token%kind)
            case (token_slash)
                call check_behind_slash(reader, deck, g)
                exit
            case (token_end, token_group)
                call complain_open(reader, deck, g)
                exit
            case (token_key)
                call start_entry(deck, g, token, told, e)
            case (token_comma)
                if (e > 0 .and. last /= token_word .and. last /= token_quoted) &
                    call add_value(deck, g, e, empty_like(token))
            case (token_word, token_quoted)
                if (e > 0) call add_value(deck, g, e, token)
                if (e == 0) call complain(deck, g, told, token, &
                                          "belongs to no key: write key=value")
            case (token_stray)
                call complain(deck, g, told, token, 'has no place here: write key=value, '// &
                     'key=value ... /')
            case (token_open_quote)
                call add_error(deck, token%line, group_label(deck%groups(g))// &
                               'the quote of a text is not closed on this line: '// &
                               printable(token%text(:token%n), 40))
                deck%groups(g)%broken = .true.
                if (e > 0) deck%groups(g)%entries(e)%bad = .true.
                token%kind = token_quoted
            end select
            last = token%kind
        end do
    end subroutine read_entries

    !> An empty value at the place of a comma.
    pure function empty_like(token) result(empty)
        type(token_t), intent(in) :: token
        type(token_t) :: empty

        empty%kind = token_word
        empty%line = token%line
    end function empty_like

    !> Open the entry of a key; e = 0 where the group is full already, which is told once.
    subroutine start_entry(deck, g, token, told, e)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(token_t), intent(in) :: token
        logical, intent(inout) :: told
        integer, intent(out) :: e

        associate (group => deck%groups(g))
            e = 0
            if (group%n == max_entries) then
                if (group%known .and. .not. told) &
                    call add_error(deck, group%line, group_label(group)//'more than '// &
                                   to_text(max_entries)//' keys, up to line '// &
                                   to_text(token%line)//": is a '/' missing?")
                told = .true.
                group%broken = .true.
            end if
            if (group%n >= max_entries .or. .not. group%known) return
            call add_entry(group, lower(token%text(:min(token%n, 32))), token%line)
            e = group%n
            allocate (group%entries(e)%raw(1))
        end associate
    end subroutine start_entry

    !> Append a value as often as its repeat count says; more than is kept is counted only.
    subroutine add_value(deck, g, e, token)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, e
        type(token_t), intent(in) :: token
        integer :: i, n

        associate (entry => deck%groups(g)%entries(e))
            if (token%cut) then
                entry%bad = .true.
                call add_error(deck, token%line, group_label(deck%groups(g))//"key '"// &
                               trim(entry%key)//"': a value is longer than "//to_text(max_token)// &
                               ' characters: '//printable(token%text(:40), 40)//'...')
            end if
            n = entry%n
            entry%n = min(n + token%repeat, 1000000000)
            do i = n + 1, min(entry%n, max_values)
                call make_room(entry, i)
                entry%raw(i)%text = token%text(:token%n)
                entry%raw(i)%quoted = token%kind == token_quoted
            end do
        end associate
    end subroutine add_value

    !> Make the array of raw values long enough for n of them.
    subroutine make_room(entry, n)
        type(entry_t), intent(inout) :: entry
        integer, intent(in) :: n
        type(entry_t) :: grown

        if (n <= size(entry%raw)) return
        allocate (grown%raw(min(max_values, 4*n)))
        grown%raw(:size(entry%raw)) = entry%raw
        call move_alloc(grown%raw, entry%raw)
    end subroutine make_room

    !> Tell once per group of what cannot be read; the first fault is the one that counts.
    subroutine complain(deck, g, told, token, what)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        logical, intent(inout) :: told
        type(token_t), intent(in) :: token
        character(*), intent(in) :: what

        deck%groups(g)%broken = .true.
        if (told .or. .not. deck%groups(g)%known) return
        told = .true.
        call add_error(deck, token%line, group_label(deck%groups(g))//"'"// &
                       printable(token%text(:token%n), 40)//"' "//what)
    end subroutine complain

    !> The group is not closed.
    subroutine complain_open(reader, deck, g)
        type(reader_t), intent(in) :: reader
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(:), allocatable :: where

        if (reader%bad_byte >= 0 .or. .not. deck%groups(g)%known) return
        where = 'the end of the deck'
        if (.not. reader%end) where = 'the group that starts at line '//to_text(reader%line)
        deck%groups(g)%broken = .true.
        call add_error(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                       "the closing '/' is missing before "//where)
    end subroutine complain_open

    !> '1/2' and 'a/b' without quotes end the group early: say so.
    subroutine check_behind_slash(reader, deck, g)
        type(reader_t), intent(in) :: reader
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g

        if (reader%end .or. .not. deck%groups(g)%known) return
        if (index(' !&'//achar(9)//achar(10), reader%c) > 0) return
        deck%groups(g)%broken = .true.
        call add_error(deck, reader%line, group_label(deck%groups(g))//"'"// &
                       printable(reader%c, 1)//"' stands right behind the '/' that closes the "// &
                       "group; "// &
                       "write fractions as numbers, and put a text that holds '/' in quotes")
    end subroutine check_behind_slash
end module brz_entries
