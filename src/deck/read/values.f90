! SPDX-License-Identifier: MIT
!> Values of the deck against their row of the key table: type, count, range, choice.
module brz_values
    use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
    use brz_deck, only: add_error, deck_t, entry_t, max_values, raw_t
    use brz_key, only: key_t, kind_integer, kind_logical, kind_real, kind_text
    use brz_key_text, only: choice_hint, choice_text, expectation
    use brz_kinds, only: dp, int64
    use brz_text, only: digits_only, lower, printable, split, string_t, to_text
    implicit none
    private
    public :: convert_entry, same_values

    character(*), parameter :: digits = '0123456789'

contains

    !> Turn the raw values of an entry into numbers or words; errors are collected in the deck.
    subroutine convert_entry(deck, label, row, bare, entry)
        type(deck_t), intent(inout) :: deck
        character(*), intent(in) :: label !! of the group, for messages
        type(key_t), intent(in) :: row !! of the key table
        logical, intent(in) :: bare !! texts may stand without quotes (command line)
        type(entry_t), intent(inout) :: entry
        character(:), allocatable :: problem, start
        integer :: i, n

        start = label//"key '"//trim(row%key)//"' expects "//expectation(row)//', found '
        n = min(entry%n, max_values)
        allocate (entry%number(n), entry%word(n))
        entry%number = 0
        if (entry%bad) return
        if (entry%n < row%n_min .or. entry%n > row%n_max) then
            entry%bad = .true.
            call add_error(deck, entry%line, start//count_text(entry%n)//count_hint(row, entry), &
                           entry%set)
        end if
        do i = 1, min(n, row%n_max)
            call convert_value(row, bare, entry%raw(i), entry%number(i), entry%word(i), problem)
            if (problem == '') cycle
            entry%bad = .true.
            call add_error(deck, entry%line, start//problem, entry%set)
            exit
        end do
    end subroutine convert_entry

    !> What may be behind a wrong number of values.
    pure function count_hint(row, entry) result(text)
        type(key_t), intent(in) :: row
        type(entry_t), intent(in) :: entry
        character(:), allocatable :: text
        integer :: i

        text = ''
        if (entry%n == 0) text = ": nothing stands behind '='"
        do i = 1, min(entry%n, max_values)
            if (entry%raw(i)%quoted .or. row%kind == kind_text) cycle
            if (scan(entry%raw(i)%text, ';') > 0) then
                text = '; put commas between the values'
                return
            else if (starts_with_letter(entry%raw(i)%text)) then
                text = "; is a '=' missing behind "//shown(entry%raw(i))//'?'
                return
            end if
        end do
        if (row%kind /= kind_real .or. row%n_max > 1 .or. entry%n /= 2) return
        if (entry%raw(1)%quoted .or. entry%raw(2)%quoted) return
        if (digits_only(entry%raw(1)%text) .and. digits_only(entry%raw(2)%text)) &
            text = ': a decimal point is a point, '//entry%raw(1)%text//'.'//entry%raw(2)%text
    end function count_hint

    pure logical function starts_with_letter(text)
        character(*), intent(in) :: text

        starts_with_letter = scan(lower(text), 'abcdefghijklmnopqrstuvwxyz') == 1
    end function starts_with_letter

    pure function count_text(n) result(text)
        integer, intent(in) :: n
        character(:), allocatable :: text

        text = to_text(n)//' values'
        if (n == 0) text = 'none'
        if (n == 1) text = '1 value'
    end function count_text

    !> One value. `problem` says what was found and what to do, and is empty if all is well.
    subroutine convert_value(row, bare, raw, number, word, problem)
        type(key_t), intent(in) :: row
        logical, intent(in) :: bare
        type(raw_t), intent(in) :: raw
        real(dp), intent(out) :: number
        type(string_t), intent(inout) :: word
        character(:), allocatable, intent(out) :: problem

        number = 0
        word%s = ''
        problem = ''
        if (len(raw%text) == 0 .and. .not. raw%quoted) then
            problem = 'an empty value between commas or behind a repeat count'
            return
        end if
        select case (row%kind)
        case (kind_text)
            call convert_text(row, bare .or. row%bare, raw, word, problem)
        case (kind_logical)
            call convert_logical(raw, number, problem)
        case default
            if (raw%quoted) then
                problem = shown(raw)//'; take the quotes off'
            else if (row%kind == kind_integer) then
                call convert_integer(raw, number, problem)
            else
                call convert_real(raw, number, problem)
            end if
            if (problem == '') call check_range(row, raw, number, problem)
        end select
    end subroutine convert_value

    subroutine convert_text(row, bare, raw, word, problem)
        type(key_t), intent(in) :: row
        logical, intent(in) :: bare
        type(raw_t), intent(in) :: raw
        type(string_t), intent(inout) :: word
        character(:), allocatable, intent(inout) :: problem
        integer :: i

        word%s = raw%text
        if (len(raw%text) > row%longest) then
            problem = shown(raw)//', which is longer than '//to_text(row%longest)//' characters'
            return
        end if
        do i = 1, len(word%s)
            if (iachar(word%s(i:i)) < 32) word%s(i:i) = ' '
        end do
        if (row%choices /= '') then
            word%s = lower(trim(adjustl(word%s)))
            if (.not. is_choice(row, word%s)) problem = shown(raw)//choice_hint(row, word%s)
        end if
        if (problem == '' .and. .not. raw%quoted .and. .not. bare) &
            problem = shown(raw)//' without quotes'
    end subroutine convert_text

    pure logical function is_choice(row, word)
        type(key_t), intent(in) :: row
        character(*), intent(in) :: word
        type(string_t), allocatable :: parts(:)
        integer :: i

        call split(trim(row%choices), '|', parts)
        is_choice = .true.
        do i = 1, size(parts)
            if (parts(i)%s == word) return
        end do
        is_choice = .false.
    end function is_choice

    subroutine convert_logical(raw, number, problem)
        type(raw_t), intent(in) :: raw
        real(dp), intent(inout) :: number
        character(:), allocatable, intent(inout) :: problem

        if (.not. raw%quoted) then
            select case (lower(raw%text))
            case ('t', 'true', '.true.', '.t.')
                number = 1
                return
            case ('f', 'false', '.false.', '.f.')
                number = 0
                return
            end select
        end if
        problem = shown(raw)
    end subroutine convert_logical

    subroutine convert_integer(raw, number, problem)
        type(raw_t), intent(in) :: raw
        real(dp), intent(inout) :: number
        character(:), allocatable, intent(inout) :: problem
        integer :: first, status

        first = 1
        if (scan(raw%text(1:1), '+-') == 1) first = 2
        if (first > len(raw%text) .or. verify(raw%text(first:), digits) > 0) then
            problem = shown(raw)
            if (is_real(raw%text)) problem = problem//'; write it without point and exponent'
            return
        end if
        status = 0
        if (len(raw%text) > 20) status = 1
        if (status == 0) read (raw%text, *, iostat=status) number
        if (status /= 0 .or. abs(number) > huge(1)) &
            problem = shown(raw)//', which is too large: the largest integer is '//to_text(huge(1))
    end subroutine convert_integer

    subroutine convert_real(raw, number, problem)
        type(raw_t), intent(in) :: raw
        real(dp), intent(inout) :: number
        character(:), allocatable, intent(inout) :: problem
        character(:), allocatable :: low
        integer :: status

        low = lower(raw%text)
        if (scan(low(1:1), '+-') == 1) low = low(2:)
        if (low == 'inf' .or. low == 'infinity' .or. index(low, 'nan') == 1) then
            problem = shown(raw)//', which is not a finite number'
        else if (.not. is_real(raw%text)) then
            problem = shown(raw)
        else if (magnitude(raw%text) > 306) then
            problem = shown(raw)//', which is too large for a real number'
        else if (magnitude(raw%text) > -306) then
            read (raw%text, *, iostat=status) number
            if (status /= 0 .or. .not. ieee_is_finite(number)) problem = shown(raw)
        end if
        if (problem /= '') number = 0
    end subroutine convert_real

    subroutine check_range(row, raw, number, problem)
        type(key_t), intent(in) :: row
        type(raw_t), intent(in) :: raw
        real(dp), intent(in) :: number
        character(:), allocatable, intent(inout) :: problem

        if (number >= row%lower .and. number <= row%upper) then
            if (number > row%lower .or. .not. row%open_lower) return
        end if
        problem = printable(raw%text, 40)
    end subroutine check_range

    !> A value as messages show it.
    pure function shown(raw) result(text)
        type(raw_t), intent(in) :: raw
        character(:), allocatable :: text

        if (raw%quoted) then
            text = "the text '"//printable(raw%text, 40)//"'"
        else
            text = "'"//printable(raw%text, 40)//"'"
        end if
    end function shown

    !> True for a real number as Fortran writes it: 1, -1.5, .5, 1.e-3, 1d-3.
    pure logical function is_real(text)
        character(*), intent(in) :: text
        integer :: i, k, n

        is_real = .false.
        i = 1
        if (scan(text(1:1), '+-') == 1) i = 2
        n = 0
        call skip_digits(text, i, n)
        if (text(i:min(i, len(text))) == '.') then
            i = i + 1
            call skip_digits(text, i, n)
        end if
        if (n == 0) return
        if (i <= len(text)) then
            if (scan(text(i:i), 'eEdD') == 0) return
            i = i + 1
            if (scan(text(i:min(i, len(text))), '+-') == 1) i = i + 1
            k = 0
            call skip_digits(text, i, k)
            if (k == 0) return
        end if
        is_real = i > len(text)
    end function is_real

    !> Power of ten of the first digit of a real number that is not zero; -1000 for zero.
    pure integer function magnitude(text) result(power)
        character(*), intent(in) :: text
        integer :: e, first, point, status

        power = -1000
        e = scan(text, 'eEdD')
        if (e == 0) e = len(text) + 1
        first = scan(text(:e - 1), '123456789')
        if (first == 0) return
        point = index(text(:e - 1), '.')
        if (point == 0) point = e
        power = 0
        ! seven digits of the exponent are enough to see that it is too much
        if (e < len(text)) read (text(e + 1:min(len(text), e + 8)), *, iostat=status) power
        power = power + point - first
        if (point > first) power = power - 1
    end function magnitude

    !> Move i behind the digits that begin there and count them in n.
    pure subroutine skip_digits(text, i, n)
        character(*), intent(in) :: text
        integer, intent(inout) :: i, n

        do while (i <= len(text))
            if (index(digits, text(i:i)) == 0) return
            i = i + 1
            n = n + 1
        end do
    end subroutine skip_digits

    !> True if two converted entries hold the same values, bit for bit.
    pure logical function same_values(a, b)
        type(entry_t), intent(in) :: a, b
        integer :: i

        same_values = .false.
        if (size(a%number) /= size(b%number)) return
        do i = 1, size(a%number)
            if (transfer(a%number(i), 0_int64) /= transfer(b%number(i), 0_int64)) return
            if (a%word(i)%s /= b%word(i)%s .or. len(a%word(i)%s) /= len(b%word(i)%s)) return
        end do
        same_values = .true.
    end function same_values
end module brz_values
