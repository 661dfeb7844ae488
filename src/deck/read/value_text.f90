! SPDX-License-Identifier: MIT
!> Values that do not come from the deck file: defaults of the key table and `--set`.
module brz_value_text
    use brz_deck, only: add_entry, add_group, deck_t, entry_t, max_values
    use brz_entries, only: read_entries
    use brz_key, only: key_t, kind_text
    use brz_reader, only: open_text, reader_t
    use brz_text, only: split, string_t
    use brz_values, only: convert_entry
    implicit none
    private
    public :: entry_from_text

contains

    !> Entry of a value as it would stand in a deck; texts may go without quotes.
    subroutine entry_from_text(row, value, entry, message)
        type(key_t), intent(in) :: row
        character(*), intent(in) :: value
        type(entry_t), intent(out) :: entry !! converted, with line 0
        character(:), allocatable, intent(out) :: message !! empty if all is well
        type(deck_t) :: scratch
        type(reader_t) :: reader

        scratch%file = ''
        call add_group(scratch, trim(row%group), 0)
        if (row%kind == kind_text .and. scan(value, '''"') == 0) then
            call bare_words(row, value, scratch)
        else
            call open_text(reader, trim(row%key)//'='//value//' /')
            call read_entries(reader, scratch, 1)
            if (.not. reader%end .and. scratch%n_errors == 0) scratch%groups(1)%broken = .true.
        end if
        message = ''
        if (scratch%n_errors == 0 .and. scratch%groups(1)%n == 1) then
            entry = scratch%groups(1)%entries(1)
            entry%line = 0
            call convert_entry(scratch, '', row, .true., entry)
        end if
        if (scratch%n_errors > 0) then
            message = scratch%errors(1)%text
            message = message(index(message, ': ') + 2:)
        else if (scratch%groups(1)%n /= 1 .or. scratch%groups(1)%broken) then
            message = 'this is not one value, or a list with commas'
        end if
    end subroutine entry_from_text

    !> Words without quotes, separated by commas; a key for one text takes the whole.
    subroutine bare_words(row, value, scratch)
        type(key_t), intent(in) :: row
        character(*), intent(in) :: value
        type(deck_t), intent(inout) :: scratch
        type(string_t), allocatable :: parts(:)
        integer :: i

        if (row%n_max == 1) then
            allocate (parts(1))
            parts(1)%s = value
        else
            call split(value, ',', parts)
        end if
        call add_entry(scratch%groups(1), trim(row%key), 0)
        associate (entry => scratch%groups(1)%entries(1))
            entry%n = size(parts)
            allocate (entry%raw(min(entry%n, max_values)))
            do i = 1, size(entry%raw)
                entry%raw(i)%text = parts(i)%s
                entry%raw(i)%quoted = .true.
            end do
        end associate
    end subroutine bare_words
end module brz_value_text
