! SPDX-License-Identifier: MIT
!> Rows of the key table, one function for each kind of value.
module brz_key_rows
    use brz_key, only: key_t, kind_integer, kind_logical, kind_text, level_basic, level_expert
    use brz_kinds, only: dp
    use brz_text, only: split, string_t
    implicit none
    private
    public :: add_group, add_rows, also_called, number, whole_number, flag, words

contains

    !> Append a group: what it is for, and its keys.
    pure subroutine add_group(keys, group, meaning, rows, basic, expert)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), intent(in) :: group, meaning
        type(key_t), intent(in) :: rows(:)
        character(*), intent(in), optional :: basic, expert !! as of `add_rows`

        call add_rows(keys, group, [key_t(meaning=meaning), rows], basic, expert)
    end subroutine add_group

    !> Append keys to a group.
    pure subroutine add_rows(keys, group, rows, basic, expert)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), intent(in) :: group
        type(key_t), intent(in) :: rows(:)
        !> Keys that a first deck needs, and those that are for studies of the method: names
        !> separated by blanks. All others are advanced.
        character(*), intent(in), optional :: basic, expert
        integer :: n

        n = size(keys)
        keys = [keys, rows]
        keys(n + 1:)%group = group
        if (present(basic)) call set_level(keys(n + 1:), basic, level_basic)
        if (present(expert)) call set_level(keys(n + 1:), expert, level_expert)
    end subroutine add_rows

    !> Give the level to the rows whose keys are named; a name without a row is an error here.
    pure subroutine set_level(rows, names, level)
        type(key_t), intent(inout) :: rows(:)
        character(*), intent(in) :: names
        integer, intent(in) :: level
        type(string_t), allocatable :: parts(:)
        integer :: i

        call split(names, ' ', parts)
        do i = 1, size(parts)
            if (.not. any(rows%key == parts(i)%s)) error stop 'key table: a level without its key'
            where (rows%key == parts(i)%s) rows%level = level
        end do
    end subroutine set_level

    !> A real number, or several.
    pure function number(key, unit, meaning, default, lower, above, upper, likely, n, n_min, &
                         n_max, former) result(row)
        character(*), intent(in) :: key, unit, meaning
        character(*), intent(in), optional :: default
        real(dp), intent(in), optional :: lower, above, upper !! `above`: this itself is too low
        real(dp), intent(in), optional :: likely(2)
        integer, intent(in), optional :: n, n_min, n_max !! how many: n is both bounds
        character(*), intent(in), optional :: former !! name, see key_t
        type(key_t) :: row

        row = key_t(key=key, unit=unit, meaning=meaning)
        if (present(default)) row%default = default
        if (present(lower)) row%lower = lower
        if (present(above)) row%lower = above
        row%open_lower = present(above)
        if (present(upper)) row%upper = upper
        if (present(likely)) row%likely = likely
        if (present(n)) row%n_min = n
        if (present(n)) row%n_max = n
        if (present(n_min)) row%n_min = n_min
        if (present(n_max)) row%n_max = n_max
        if (present(former)) row%former = former
    end function number

    !> A key that is read by an older name, too.
    pure function also_called(alias, row) result(same)
        character(*), intent(in) :: alias
        type(key_t), intent(in) :: row
        type(key_t) :: same

        same = row
        same%alias = alias
    end function also_called

    !> An integer, or `n` of them.
    pure function whole_number(key, meaning, lower, upper, default, n) result(row)
        character(*), intent(in) :: key, meaning
        real(dp), intent(in) :: lower, upper
        character(*), intent(in), optional :: default
        integer, intent(in), optional :: n
        type(key_t) :: row

        row = number(key, '-', meaning, default, lower, upper=upper, n=n)
        row%kind = kind_integer
    end function whole_number

    !> Yes or no.
    pure function flag(key, meaning, default) result(row)
        character(*), intent(in) :: key, meaning, default
        type(key_t) :: row

        row = key_t(key=key, kind=kind_logical, meaning=meaning, default=default)
    end function flag

    !> A text, or up to `n_max` of them.
    pure function words(key, meaning, default, choices, unit, n_max, longest, bare) result(row)
        character(*), intent(in) :: key, meaning
        character(*), intent(in), optional :: default, choices, unit
        integer, intent(in), optional :: n_max, longest
        logical, intent(in), optional :: bare !! may stand without quotes
        type(key_t) :: row

        row = key_t(key=key, kind=kind_text, meaning=meaning)
        if (present(default)) row%default = default
        if (present(choices)) row%choices = choices
        if (present(unit)) row%unit = unit
        if (present(n_max)) row%n_max = n_max
        if (present(longest)) row%longest = longest
        if (present(bare)) row%bare = bare
    end function words
end module brz_key_rows
