! SPDX-License-Identifier: MIT
!> The echo: a complete runnable deck with all defaults filled in and marked.
!>
!> It depends on the values alone, not on the file they came from, and a value that equals its
!> default is marked as one: so the echo of an echo is the same, byte for byte.
module brz_echo
    use brz_complete, only: group_owner
    use brz_deck, only: deck_t, entry_t, find_entry
    use brz_key, only: key_t, kind_integer, kind_logical, kind_text
    use brz_kinds, only: int64
    use brz_text, only: to_text
    implicit none
    private
    public :: echo_deck

    character(*), parameter :: lf = new_line('a')

contains

    !> The echo of a deck without errors: groups in the order of the table.
    subroutine echo_deck(deck, keys, text)
        type(deck_t), intent(in) :: deck
        type(key_t), intent(in) :: keys(:)
        character(:), allocatable, intent(out) :: text
        character(:), allocatable :: part
        integer :: i, g, n

        text = 'Complete deck in SI units; values that are defaults are marked.'//lf
        n = len(text)
        do i = 1, size(keys)
            if (any(keys(:i - 1)%group == keys(i)%group)) cycle
            do g = 1, deck%n
                if (deck%groups(g)%name /= keys(i)%group) cycle
                call echo_group(deck, keys, g, part)
                call append(part, text, n)
            end do
        end do
        text = text(:n)
    end subroutine echo_deck

    !> Append to a text of which n characters are used; its room doubles, so that many groups
    !> cost no more than their length.
    subroutine append(part, text, n)
        character(*), intent(in) :: part
        character(:), allocatable, intent(inout) :: text
        integer, intent(inout) :: n

        if (n + len(part) > len(text)) text = text(:n)//repeat(' ', n + len(part))
        text(n + 1:n + len(part)) = part
        n = n + len(part)
    end subroutine append

    !> One group, keys in the order of the table.
    subroutine echo_group(deck, keys, g, text)
        type(deck_t), intent(in) :: deck
        type(key_t), intent(in) :: keys(:)
        integer, intent(in) :: g
        character(:), allocatable, intent(out) :: text
        character(:), allocatable :: owner
        integer :: i, e

        text = lf//'&'//trim(deck%groups(g)%name)//lf
        owner = group_owner(deck%groups(g))
        do i = 1, size(keys)
            if (keys(i)%group /= deck%groups(g)%name .or. keys(i)%key == '') cycle
            if (keys(i)%owner /= '' .and. keys(i)%owner /= owner) cycle
            e = find_entry(deck%groups(g), trim(keys(i)%key))
            if (e > 0) call echo_entry(keys(i), deck%groups(g)%entries(e), text)
        end do
        text = text//'/'//lf
    end subroutine echo_group

    subroutine echo_entry(row, entry, text)
        type(key_t), intent(in) :: row
        type(entry_t), intent(in) :: entry
        character(:), allocatable, intent(inout) :: text
        integer :: i

        text = text//'  '//trim(row%key)//' = '
        do i = 1, entry%n
            if (i > 1) text = text//', '
            select case (row%kind)
            case (kind_text)
                text = text//quoted(entry%word(i)%s)
            case (kind_logical)
                text = text//to_text(entry%number(i) > 0)
            case (kind_integer)
                text = text//to_text(nint(entry%number(i), int64))
            case default
                text = text//to_text(entry%number(i))
            end select
        end do
        if (entry%default) text = text//' ! default'
        text = text//lf
    end subroutine echo_entry

    !> A text in quotes, quotes in it doubled.
    pure function quoted(word) result(text)
        character(*), intent(in) :: word
        character(:), allocatable :: text
        integer :: i

        text = "'"
        do i = 1, len(word)
            text = text//word(i:i)
            if (word(i:i) == "'") text = text//"'"
        end do
        text = text//"'"
    end function quoted
end module brz_echo
