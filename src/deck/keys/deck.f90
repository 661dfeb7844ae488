! SPDX-License-Identifier: MIT
!> The deck as it was read: groups with their keys and values, and the messages collected so far.
module brz_deck
    use brz_kinds, only: dp
    use brz_errors, only: error_t, exit_deck, raise
    use brz_text, only: string_t, to_text
    implicit none
    private
    public :: deck_t, group_t, entry_t, raw_t, message_t
    public :: add_error, add_warning, report_errors, place, group_label, find_entry, find_group
    public :: add_group, add_entry, drop_group, entry_line, complain, move_group
    public :: may_be_misspelt, max_shown, max_groups, max_entries, max_values

    integer, parameter :: max_shown = 50 !! messages that are kept, the rest is counted
    integer, parameter :: max_groups = 10000 !! groups of one deck
    integer, parameter :: max_entries = 200 !! keys of one group
    integer, parameter :: max_values = 32 !! values of one key that are kept

    !> One value as it stands in the deck.
    type :: raw_t
        character(:), allocatable :: text !! without its quotes
        logical :: quoted = .false.
    end type raw_t

    !> One key of one group with its values.
    type :: entry_t
        character(32) :: key = '' !! in lower case; a longer name is cut
        integer :: line = 0 !! in the deck; 0: from the command line or a default
        integer :: set = 0 !! number of the override that gave it; 0: the deck
        integer :: row = 0 !! row of the key table, 0 while unknown
        logical :: bad = .false. !! its value is in error and must not be used
        logical :: unconfirmed = .false. !! from a preset whose source says so
        logical :: default = .false. !! not in the deck, or the same there as the default
        integer :: n = 0 !! values given (repeat counts expanded); `raw` keeps at most max_values
        type(raw_t), allocatable :: raw(:) !! as written
        real(dp), allocatable :: number(:) !! (n) numbers; a logical is 0 or 1; 0 for a text
        type(string_t), allocatable :: word(:) !! (n) texts; empty for a number
    end type entry_t

    type :: group_t
        character(16) :: name = '' !! in lower case, without the ampersand
        character(:), allocatable :: id !! '' where the group has none
        integer :: line = 0 !! where the group opens; 0: not in the deck, all defaults
        logical :: known = .true. !! false: no such group in the key table
        logical :: broken = .false. !! keys may be lost by an error of form
        logical :: bad = .false. !! at least one entry is in error or missing
        integer :: n = 0
        type(entry_t), allocatable :: entries(:) !! (n used)
    end type group_t

    type :: message_t
        integer :: line = 0
        character(:), allocatable :: text
    end type message_t

    type :: deck_t
        character(:), allocatable :: file !! as the user gave it
        integer :: n = 0
        type(group_t), allocatable :: groups(:) !! (n used), in the order of the deck
        type(string_t), allocatable :: overrides(:) !! of the command line, as given
        integer :: n_errors = 0, n_warnings = 0 !! all of them, also those that are not kept
        type(message_t) :: errors(max_shown)
        type(message_t) :: warnings(max_shown)
    end type deck_t

contains

    !> Collect an error. The text comes without the place, which stands in front of it later.
    subroutine add_error(deck, line, text, set)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: line !! in the deck; 0: none
        character(*), intent(in) :: text !! what was found, what is expected, the remedy
        integer, intent(in), optional :: set !! number of the override it comes from

        deck%n_errors = deck%n_errors + 1
        if (deck%n_errors > max_shown) return
        deck%errors(deck%n_errors)%line = line
        deck%errors(deck%n_errors)%text = place(deck, line, set)//text
    end subroutine add_error

    !> Collect a warning: the deck can be run, but may not mean what its author thinks.
    subroutine add_warning(deck, line, text)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: line
        character(*), intent(in) :: text

        deck%n_warnings = deck%n_warnings + 1
        if (deck%n_warnings > max_shown) return
        deck%warnings(deck%n_warnings)%line = line
        deck%warnings(deck%n_warnings)%text = place(deck, line)//'warning: '//text
    end subroutine add_warning

    !> Raise `err` with all errors collected, sorted by line. Does nothing where there are none.
    subroutine report_errors(deck, err)
        type(deck_t), intent(in) :: deck
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        logical :: done(max_shown)
        integer :: i, k, n

        if (deck%n_errors == 0) return
        n = min(deck%n_errors, max_shown)
        done = .false.
        text = ''
        do i = 1, n
            k = next_by_line(deck%errors(:n), done(:n))
            done(k) = .true.
            if (i > 1) text = text//new_line('a')
            text = text//deck%errors(k)%text
        end do
        if (deck%n_errors > n) text = text//new_line('a')//'... and '// &
                                      to_text(deck%n_errors - n)//' more errors'
        call raise(err, exit_deck, text)
    end subroutine report_errors

    !> The message with the lowest line that is not done yet; line 0 comes last.
    pure integer function next_by_line(messages, done) result(best)
        type(message_t), intent(in) :: messages(:)
        logical, intent(in) :: done(:)
        integer :: i, line, least

        best = 1
        least = huge(1)
        do i = size(messages), 1, -1
            if (done(i)) cycle
            line = messages(i)%line
            if (line == 0) line = huge(1)
            if (line > least) cycle
            least = line
            best = i
        end do
    end function next_by_line

    !> The place in front of a message: 'deck.nml:14: ', or the override.
    pure function place(deck, line, set) result(text)
        type(deck_t), intent(in) :: deck
        integer, intent(in) :: line
        integer, intent(in), optional :: set
        character(:), allocatable :: text

        if (present(set)) then
            if (set > 0) then
                text = '--set '//deck%overrides(set)%s//': '
                return
            end if
        end if
        text = deck%file//':'
        if (line > 0) text = text//to_text(line)//':'
        text = text//' '
    end function place

    !> How messages name a group: '&material id='cf': '.
    pure function group_label(group) result(text)
        type(group_t), intent(in) :: group
        character(:), allocatable :: text

        text = '&'//trim(group%name)
        if (allocated(group%id)) then
            if (len(group%id) > 0) text = text//" id='"//group%id//"'"
        end if
        text = text//': '
    end function group_label

    !> Place of a key in a group, 0 where it is absent.
    pure integer function find_entry(group, key) result(place)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key

        do place = 1, group%n
            if (group%entries(place)%key == key) return
        end do
        place = 0
    end function find_entry

    !> Place of the first group of a name (and of an id, where one is given), 0 where there is none.
    pure integer function find_group(deck, name, id) result(place)
        type(deck_t), intent(in) :: deck
        character(*), intent(in) :: name
        character(*), intent(in), optional :: id

        do place = 1, deck%n
            if (deck%groups(place)%name /= name) cycle
            if (.not. present(id)) return
            if (deck%groups(place)%id == id) return
        end do
        place = 0
    end function find_group

    !> True if a group is not known: a group that seems to be missing may stand there misspelt.
    pure logical function may_be_misspelt(deck)
        type(deck_t), intent(in) :: deck

        may_be_misspelt = .false.
        if (deck%n > 0) may_be_misspelt = .not. all(deck%groups(:deck%n)%known)
    end function may_be_misspelt

    !> Line of a key in the deck, or of its group where the key is not in the deck.
    pure integer function entry_line(group, key) result(line)
        type(group_t), intent(in) :: group
        character(*), intent(in) :: key
        integer :: e

        line = group%line
        e = find_entry(group, key)
        if (e == 0) return
        if (group%entries(e)%line > 0) line = group%entries(e)%line
    end function entry_line

    !> Collect an error about a key of a group; later checks leave this group alone.
    subroutine complain(deck, g, key, text)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), intent(in) :: key, text
        integer :: e, set

        set = 0
        e = find_entry(deck%groups(g), key)
        if (e > 0) set = deck%groups(g)%entries(e)%set
        deck%groups(g)%bad = .true.
        call add_error(deck, entry_line(deck%groups(g), key), group_label(deck%groups(g))//text, &
                       set)
    end subroutine complain

    !> Append an empty group. The caller has made sure that there is room.
    subroutine add_group(deck, name, line)
        type(deck_t), intent(inout) :: deck
        character(*), intent(in) :: name !! in lower case
        integer, intent(in) :: line
        type(group_t), allocatable :: grown(:)
        integer :: i

        if (.not. allocated(deck%groups)) allocate (deck%groups(16))
        if (deck%n == size(deck%groups)) then
            allocate (grown(2*deck%n))
            do i = 1, deck%n
                call move_group(deck%groups(i), grown(i))
            end do
            call move_alloc(grown, deck%groups)
        end if
        deck%n = deck%n + 1
        deck%groups(deck%n)%name = name
        deck%groups(deck%n)%id = ''
        deck%groups(deck%n)%line = line
        allocate (deck%groups(deck%n)%entries(8))
    end subroutine add_group

    !> Move a group without copying its entries.
    subroutine move_group(from, to)
        type(group_t), intent(inout) :: from
        type(group_t), intent(inout) :: to

        to%name = from%name
        to%line = from%line
        to%known = from%known
        to%broken = from%broken
        to%bad = from%bad
        to%n = from%n
        call move_alloc(from%id, to%id)
        call move_alloc(from%entries, to%entries)
    end subroutine move_group

    !> Take a group out of the deck.
    subroutine drop_group(deck, g)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        integer :: k

        do k = g, deck%n - 1
            call move_group(deck%groups(k + 1), deck%groups(k))
        end do
        deck%groups(deck%n) = group_t()
        deck%n = deck%n - 1
    end subroutine drop_group

    !> Append an empty entry.
    subroutine add_entry(group, key, line)
        type(group_t), intent(inout) :: group
        character(*), intent(in) :: key !! in lower case
        integer, intent(in) :: line
        type(entry_t), allocatable :: grown(:)

        if (group%n == size(group%entries)) then
            allocate (grown(2*group%n))
            grown(:group%n) = group%entries
            call move_alloc(grown, group%entries)
        end if
        group%n = group%n + 1
        group%entries(group%n)%key = key
        group%entries(group%n)%line = line
    end subroutine add_entry
end module brz_deck
