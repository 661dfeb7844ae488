! SPDX-License-Identifier: MIT
!> Finding rows of the key table, and saying in words what a row expects.
module brz_key_text
    use brz_key, only: key_t, kind_integer, kind_logical, kind_real, kind_text, level_basic, &
                       level_expert, required
    use brz_text, only: nearest, string_t, split, to_text
    implicit none
    private
    public :: find_row, group_known, group_repeats, expectation, range_text, unit_text, choice_text
    public :: key_hint, group_hint, choice_hint, default_text, list_keys, same_value_count
    public :: alias_text, meaning_text, present_name, level_name

contains

    !> Row of a key: one of the model `owner`, or one of every model. 0 where there is none.
    pure integer function find_row(keys, group, key, owner) result(row)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group, key, owner

        do row = 1, size(keys)
            if (keys(row)%group /= group .or. keys(row)%key /= key) cycle
            if (keys(row)%owner == '' .or. keys(row)%owner == owner) return
        end do
        row = 0
    end function find_row

    !> The name of a key: the present one where an older one is given.
    pure function present_name(keys, group, key) result(name)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group, key
        character(:), allocatable :: name
        integer :: row

        name = key
        do row = 1, size(keys)
            if (key == '' .or. keys(row)%group /= group .or. keys(row)%alias /= key) cycle
            name = trim(keys(row)%key)
        end do
    end function present_name

    !> What is said of an older name that is read as the present one.
    pure function alias_text(old, new) result(text)
        character(*), intent(in) :: old, new
        character(:), allocatable :: text

        text = "key '"//old//"' is called '"//new//"' now; the old name is read for two versions"
    end function alias_text

    !> What a key means, and what else it is called.
    pure function meaning_text(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = trim(row%meaning)
        if (row%alias /= '') text = text//' Also read as '//trim(row%alias)//', its old name.'
    end function meaning_text

    pure logical function group_known(keys, group)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group

        group_known = any(keys%group == group)
    end function group_known

    !> Groups whose objects carry an id may stand many times.
    pure logical function group_repeats(keys, group)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group

        group_repeats = find_row(keys, group, 'id', '') > 0
    end function group_repeats

    !> What a key takes, in words: '3 integers >= 1', 'a number > 0.0 [kg/m3]', 'a text in quotes'.
    pure function expectation(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        if (row%n_max == 1) then
            select case (row%kind)
            case (kind_integer)
                text = 'an integer'
            case (kind_real)
                text = 'a number'
            case (kind_logical)
                text = 'a logical (.true. or .false.)'
            case default
                text = 'a text in quotes'
            end select
        else
            text = same_value_count(row)
            select case (row%kind)
            case (kind_integer)
                text = text//' integers'
            case (kind_real)
                text = text//' numbers'
            case (kind_logical)
                text = text//' logicals (.true. or .false.)'
            case default
                text = text//' texts in quotes'
            end select
        end if
        if (range_text(row) /= '') text = text//' '//range_text(row)
        text = text//unit_text(row)
        if (row%choices /= '') text = text//' out of '//choice_text(row)
    end function expectation

    !> How many values a key takes: '3' or '1 to 6'.
    pure function same_value_count(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = to_text(row%n_max)
        if (row%n_min /= row%n_max) text = to_text(row%n_min)//' to '//text
    end function same_value_count

    !> The range of a number: '> 0.0', '>= 1', '> 0.0 and <= 1.0'; empty where it has none.
    pure function range_text(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = ''
        if (row%kind /= kind_real .and. row%kind /= kind_integer) return
        if (row%lower > -huge(row%lower)) then
            text = '>= '
            if (row%open_lower) text = '> '
            text = text//bound_text(row, row%lower)
        end if
        if (row%upper < huge(row%upper)) then
            if (text /= '') text = text//' and '
            text = text//'<= '//bound_text(row, row%upper)
        end if
    end function range_text

    pure function bound_text(row, bound) result(text)
        type(key_t), intent(in) :: row
        real(kind(row%lower)), intent(in) :: bound
        character(:), allocatable :: text

        if (row%kind == kind_integer) then
            text = to_text(nint(bound))
        else
            text = to_text(bound)
        end if
    end function bound_text

    !> Who needs a key: 'basic', a first deck (so what is required); 'advanced', some decks;
    !> 'expert', studies of the method.
    pure function level_name(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = 'advanced'
        if (row%level == level_expert) text = 'expert'
        if (row%level == level_basic .or. row%default == required) text = 'basic'
    end function level_name

    !> ' [kg/m3]', or nothing.
    pure function unit_text(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = ''
        if (row%unit /= '-' .and. row%unit /= '') text = ' ['//trim(row%unit)//']'
    end function unit_text

    !> The allowed words: 'a', 'b' or 'c'.
    pure function choice_text(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text
        type(string_t), allocatable :: parts(:)
        integer :: i

        text = ''
        if (row%choices == '') return
        call split(trim(row%choices), '|', parts)
        do i = 1, size(parts)
            if (i > 1 .and. i == size(parts)) then
                text = text//' or '
            else if (i > 1) then
                text = text//', '
            end if
            text = text//"'"//parts(i)%s//"'"
        end do
    end function choice_text

    !> The default as a reader wants to see it; texts without quotes in the table get them here.
    pure function default_text(row) result(text)
        type(key_t), intent(in) :: row
        character(:), allocatable :: text

        text = trim(row%default)
        if (row%kind /= kind_text .or. text(1:min(1, len(text))) == '(') return
        if (scan(text, '''",') == 0) text = "'"//text//"'"
    end function default_text

    !> '; did you mean ...?' for an unknown key, or where else the key belongs, or the known keys.
    pure function key_hint(keys, group, owner, key) result(text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group, owner, key
        character(:), allocatable :: text
        character(len(keys%key)) :: names(size(keys))
        integer :: i

        i = findloc(keys%group == group .and. keys%former == key .and. key /= '', .true., 1)
        if (i > 0) then
            text = "; it is '"//trim(keys(i)%key)//"' now: "//trim(keys(i)%meaning)
            return
        end if
        names = keys%key
        where (keys%group /= group .or. (keys%owner /= '' .and. keys%owner /= owner)) names = ''
        i = nearest(key, names)
        if (i > 0) then
            text = "; did you mean '"//trim(names(i))//"'"//unit_text(keys(i))//'?'
            return
        end if
        do i = 1, size(keys)
            if (keys(i)%key /= key .or. key == 'id') cycle
            text = '; it is a key of &'//trim(keys(i)%group)
            if (keys(i)%owner /= '') text = text//" with model='"//trim(keys(i)%owner)//"'"
            return
        end do
        text = '; known keys: '//list_keys(keys, group, owner)
    end function key_hint

    !> The keys of a group, separated by commas.
    pure function list_keys(keys, group, owner) result(text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group, owner
        character(:), allocatable :: text
        integer :: i

        text = ''
        do i = 1, size(keys)
            if (keys(i)%group /= group .or. keys(i)%key == '') cycle
            if (keys(i)%owner /= '' .and. keys(i)%owner /= owner) cycle
            if (text /= '') text = text//', '
            text = text//trim(keys(i)%key)
        end do
    end function list_keys

    !> '; did you mean &body?' for an unknown group, or the known groups.
    pure function group_hint(keys, group) result(text)
        type(key_t), intent(in) :: keys(:)
        character(*), intent(in) :: group
        character(:), allocatable :: text
        integer :: i

        i = nearest(group, keys%group)
        if (i > 0) then
            text = '; did you mean &'//trim(keys(i)%group)//'?'
            return
        end if
        text = '; known groups:'
        do i = 1, size(keys)
            if (any(keys(:i - 1)%group == keys(i)%group)) cycle
            text = text//' &'//trim(keys(i)%group)
        end do
    end function group_hint

    !> '; did you mean 'wall'?' for a word that is no choice, or nothing.
    pure function choice_hint(row, word) result(text)
        type(key_t), intent(in) :: row
        character(*), intent(in) :: word
        character(:), allocatable :: text
        type(string_t), allocatable :: parts(:)
        character(len(row%choices)), allocatable :: words(:)
        integer :: i

        text = ''
        call split(trim(row%choices), '|', parts)
        allocate (words(size(parts)))
        do i = 1, size(parts)
            words(i) = parts(i)%s
        end do
        i = nearest(word, words)
        if (i > 0) text = "; did you mean '"//trim(words(i))//"'?"
    end function choice_hint
end module brz_key_text
