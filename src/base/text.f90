! SPDX-License-Identifier: MIT
!> Texts: numbers as texts, lower case, nearest word, lists of words.
module brz_text
    use brz_kinds, only: int32, int64, real32, real64
    implicit none
    private
    public :: string_t, to_text, lower, same_text, edit_distance, nearest, split, printable
    public :: digits_only

    !> A text of its own length, for arrays of texts.
    type :: string_t
        character(:), allocatable :: s
    end type string_t

    !> A number as text. A real gives the shortest decimal that reads back to the same bits.
    interface to_text
        module procedure :: int32_text, int64_text, real32_text, real64_text, logical_text
    end interface to_text

    !> Place of the word of a list that is nearest to a word, 0 where none is near.
    interface nearest
        module procedure :: nearest_word
    end interface nearest

contains

    pure function int32_text(i) result(text)
        integer(int32), intent(in) :: i
        character(:), allocatable :: text

        text = int64_text(int(i, int64))
    end function int32_text

    pure function int64_text(i) result(text)
        integer(int64), intent(in) :: i
        character(:), allocatable :: text
        character(24) :: buffer

        write (buffer, '(i0)') i
        text = trim(buffer)
    end function int64_text

    pure function logical_text(l) result(text)
        logical, intent(in) :: l
        character(:), allocatable :: text

        if (l) then
            text = '.true.'
        else
            text = '.false.'
        end if
    end function logical_text

    pure function real64_text(x) result(text)
        real(real64), intent(in) :: x
        character(:), allocatable :: text
        character(40) :: buffer
        real(real64) :: back
        integer :: digits, status

        do digits = merge(17, 1, abs(x) > 1e307_real64), 17 ! rounding up must not overflow
            write (buffer, scientific(digits)) x
            read (buffer, *, iostat=status) back
            if (status /= 0) exit
            if (back >= x .and. back <= x) exit
        end do
        text = plain_number(trim(adjustl(buffer)))
    end function real64_text

    pure function real32_text(x) result(text)
        real(real32), intent(in) :: x
        character(:), allocatable :: text
        character(40) :: buffer
        real(real32) :: back
        integer :: digits, status

        do digits = merge(9, 1, abs(x) > 1e37_real32), 9 ! rounding up must not overflow
            write (buffer, scientific(digits)) x
            read (buffer, *, iostat=status) back
            if (status /= 0) exit
            if (back >= x .and. back <= x) exit
        end do
        text = plain_number(trim(adjustl(buffer)))
    end function real32_text

    !> Edit descriptor for a number of so many significant digits.
    pure function scientific(digits) result(form)
        integer, intent(in) :: digits
        character(:), allocatable :: form

        form = '(es40.'//int32_text(digits - 1)//'e3)'
    end function scientific

    !> Rewrite [-]d.ddddE+eee as 12.5, 0.001, 3.0 or 1.5e-9; anything else is returned as it is.
    pure function plain_number(number) result(text)
        character(*), intent(in) :: number
        character(:), allocatable :: text, digits, sign
        integer :: e, power, status

        text = number
        e = index(number, 'E')
        if (e == 0) return
        read (number(e + 1:), *, iostat=status) power
        if (status /= 0) return
        sign = ''
        digits = number(:e - 1)
        if (digits(1:1) == '-') then
            sign = '-'
            digits = digits(2:)
        end if
        digits = digits(1:1)//digits(3:)
        do while (len(digits) > 1 .and. digits(len(digits):) == '0')
            digits = digits(:len(digits) - 1)
        end do
        text = sign//place_point(digits, power)
    end function plain_number

    !> Digits d1 d2 d3 ... times 10**power, where d1 stands before the point.
    pure function place_point(digits, power) result(text)
        character(*), intent(in) :: digits
        integer, intent(in) :: power
        character(:), allocatable :: text

        if (power < -3 .or. power > 5) then
            text = digits(1:1)
            if (len(digits) > 1) text = text//'.'//digits(2:)
            text = text//'e'//int32_text(power)
        else if (power < 0) then
            text = '0.'//repeat('0', -power - 1)//digits
        else if (len(digits) <= power + 1) then
            text = digits//repeat('0', power + 1 - len(digits))//'.0'
        else
            text = digits(:power + 1)//'.'//digits(power + 2:)
        end if
    end function place_point

    !> The text in lower case (ASCII letters).
    pure function lower(text) result(low)
        character(*), intent(in) :: text
        character(len(text)) :: low
        integer :: i

        low = text
        do i = 1, len(text)
            if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') low(i:i) = achar(iachar(text(i:i)) + 32)
        end do
    end function lower

    !> Equal but for the case of the letters and for blanks at the end.
    pure logical function same_text(a, b)
        character(*), intent(in) :: a, b

        same_text = lower(a) == lower(b)
    end function same_text

    !> True for a text of one or more digits and nothing else.
    pure logical function digits_only(text)
        character(*), intent(in) :: text

        digits_only = len(text) > 0 .and. verify(text, '0123456789') == 0
    end function digits_only

    !> Number of insertions, deletions, changes and swaps of neighbours that turn a into b.
    pure integer function edit_distance(a, b) result(distance)
        character(*), intent(in) :: a, b
        integer :: row(-1:len(b), 3)
        integer :: i, j, change

        row(:, 2) = [(j, j=-1, len(b))]
        row(:, 1) = row(:, 2)
        do i = 1, len(a)
            row(0, 3) = i
            do j = 1, len(b)
                change = merge(0, 1, a(i:i) == b(j:j))
                row(j, 3) = min(row(j - 1, 3) + 1, row(j, 2) + 1, row(j - 1, 2) + change)
                if (i > 1 .and. j > 1) then
                    if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) &
                        row(j, 3) = min(row(j, 3), row(j - 2, 1) + 1)
                end if
            end do
            row(:, 1) = row(:, 2)
            row(:, 2) = row(:, 3)
        end do
        distance = row(len(b), 2)
    end function edit_distance

    !> Place of the word of the list that is nearest to `word`, or 0 where none is near.
    !>
    !> Near: about one wrong letter in three, or `word` is the beginning of the other.
    pure integer function nearest_word(word, list) result(best)
        character(*), intent(in) :: word
        character(*), intent(in) :: list(:)
        integer :: i, distance, least, n

        best = 0
        n = min(len_trim(word), 64)
        if (n == 0) return
        least = max(1, (n + 1)/3) + 1
        do i = 1, size(list)
            if (len_trim(list(i)) == 0) cycle
            distance = edit_distance(lower(word(:n)), lower(trim(list(i))))
            if (n >= 3 .and. index(lower(trim(list(i))), lower(word(:n))) == 1) &
                distance = min(distance, 1)
            if (distance >= least) cycle
            least = distance
            best = i
        end do
    end function nearest_word

    !> Parts of a text between separators, blanks around them taken off.
    pure subroutine split(text, separator, parts)
        character(*), intent(in) :: text
        character(1), intent(in) :: separator
        type(string_t), allocatable, intent(inout) :: parts(:) !! at least one, may be empty
        integer :: i, n, first

        n = 1
        do i = 1, len(text)
            if (text(i:i) == separator) n = n + 1
        end do
        if (allocated(parts)) deallocate (parts)
        allocate (parts(n))
        n = 0
        first = 1
        do i = 1, len(text) + 1
            if (i <= len(text)) then
                if (text(i:i) /= separator) cycle
            end if
            n = n + 1
            parts(n)%s = trim(adjustl(text(first:i - 1)))
            first = i + 1
        end do
    end subroutine split

    !> At most `longest` characters of a text, fit for a message: unprintable ones become '?'.
    pure function printable(text, longest) result(shown)
        character(*), intent(in) :: text
        integer, intent(in) :: longest
        character(:), allocatable :: shown
        integer :: i

        if (len(text) > longest) then
            shown = text(:longest)//'...'
        else
            shown = text
        end if
        do i = 1, len(shown)
            if (iachar(shown(i:i)) < 32 .or. iachar(shown(i:i)) > 126) shown(i:i) = '?'
        end do
    end function printable
end module brz_text
