! SPDX-License-Identifier: MIT
!> Angles of the plies of a laminate from a text: '0/45/-45/90', '7*(0/90)', '[0/90]s'.
!>
!> layup = loop body {'/' loop body}; loop body = [count '*'] (angle | bracket); bracket = '(' layup
!> ')' ['s'], or with square brackets. The letter s behind a bracket adds its mirror image.
module brz_layup
    use brz_kinds, only: dp
    use brz_text, only: printable, to_text
    implicit none
    private
    public :: parse_layup

    integer, parameter :: deepest = 8 !! brackets within brackets

contains

    !> Read a layup. `message` is empty if all is well.
    subroutine parse_layup(text, angles, n, message)
        character(*), intent(in) :: text
        real(dp), intent(inout) :: angles(:) !! [deg], the size is the most that is allowed
        integer, intent(out) :: n
        character(:), allocatable, intent(out) :: message
        integer :: i

        n = 0
        i = 1
        message = ''
        call parse_list(text, 0, i, angles, n, message)
        if (message == '' .and. i <= len_trim(text)) call complain(text, i, message)
        if (message == '' .and. any(abs(angles(:n)) > 360)) message = 'an angle is beyond 360 '// &
             'degrees'
        if (message /= '') n = 0
    end subroutine parse_layup

    !> Loop bodies separated by slashes, from text(i:) on.
    recursive subroutine parse_list(text, depth, i, angles, n, message)
        character(*), intent(in) :: text
        integer, intent(in) :: depth
        integer, intent(inout) :: i !! next character
        real(dp), intent(inout) :: angles(:)
        integer, intent(inout) :: n !! plies so far
        character(:), allocatable, intent(inout) :: message

        do
            call parse_item(text, depth, i, angles, n, message)
            if (message /= '') return
            if (next(text, i) /= '/') return
            i = i + 1
        end do
    end subroutine parse_list

    !> An angle or a bracket, with its count.
    recursive subroutine parse_item(text, depth, i, angles, n, message)
        character(*), intent(in) :: text
        integer, intent(in) :: depth
        integer, intent(inout) :: i, n
        real(dp), intent(inout) :: angles(:)
        character(:), allocatable, intent(inout) :: message
        real(dp) :: number
        integer :: times, first, k
        logical :: ok

        times = 1
        first = n
        if (scan(next(text, i), '([') == 0) then
            call take_number(text, i, number, ok)
            if (.not. ok) then
                call complain(text, i, message)
                return
            end if
            if (next(text, i) == '*') then
                i = i + 1
                times = -1
                if (number >= 1 .and. number <= size(angles)) times = nint(number)
                if (times < 1 .or. abs(number - times) > 0) then
                    message = 'a count of plies must be an integer from 1 to '// &
                         to_text(size(angles))
                    return
                end if
            else
                call append(number, angles, n, message)
                return
            end if
        end if
        if (scan(next(text, i), '([') == 1) then
            call parse_bracket(text, depth + 1, i, angles, n, message)
        else
            call take_number(text, i, number, ok)
            if (ok) call append(number, angles, n, message)
            if (.not. ok) call complain(text, i, message)
        end if
        if (message /= '') return
        do k = 1, (times - 1)*(n - first)
            call append(angles(first + k), angles, n, message)
            if (message /= '') return
        end do
    end subroutine parse_item

    !> '(' layup ')' with an optional s.
    recursive subroutine parse_bracket(text, depth, i, angles, n, message)
        character(*), intent(in) :: text
        integer, intent(in) :: depth
        integer, intent(inout) :: i, n
        real(dp), intent(inout) :: angles(:)
        character(:), allocatable, intent(inout) :: message
        character(1) :: closing
        integer :: first, last, k

        if (depth > deepest) then
            message = 'brackets are nested more than '//to_text(deepest)//' deep'
            return
        end if
        closing = ')'
        if (next(text, i) == '[') closing = ']'
        i = i + 1
        first = n + 1
        call parse_list(text, depth, i, angles, n, message)
        if (message /= '') return
        if (next(text, i) /= closing) then
            call complain(text, i, message)
            return
        end if
        i = i + 1
        if (scan(next(text, i), 'sS') == 0) return
        i = i + 1
        last = n
        do k = last, first, -1
            call append(angles(k), angles, n, message)
            if (message /= '') return
        end do
    end subroutine parse_bracket

    subroutine append(angle, angles, n, message)
        real(dp), value :: angle
        real(dp), intent(inout) :: angles(:)
        integer, intent(inout) :: n
        character(:), allocatable, intent(inout) :: message

        if (n == size(angles)) then
            message = 'more than '//to_text(size(angles))//' plies'
            return
        end if
        n = n + 1
        angles(n) = angle
    end subroutine append

    !> The next character that is no blank; i moves there. A blank at the end of the text.
    character(1) function next(text, i)
        character(*), intent(in) :: text
        integer, intent(inout) :: i

        next = ' '
        do while (i <= len(text))
            next = text(i:i)
            if (next /= ' ') return
            i = i + 1
        end do
    end function next

    !> A number at text(i:); i moves behind it.
    subroutine take_number(text, i, number, ok)
        character(*), intent(in) :: text
        integer, intent(inout) :: i
        real(dp), intent(out) :: number
        logical, intent(out) :: ok
        integer :: n, status

        number = 0
        ok = scan(next(text, i), '+-.0123456789') == 1
        if (.not. ok) return
        n = verify(text(i + 1:), '.0123456789')
        if (n == 0) n = len(text) - i + 1
        ok = scan(text(i:i + n - 1), '0123456789') > 0 .and. n <= 20
        if (.not. ok) return
        read (text(i:i + n - 1), '(f20.0)', iostat=status) number
        ok = status == 0
        i = i + n
    end subroutine take_number

    subroutine complain(text, i, message)
        character(*), intent(in) :: text
        integer, intent(in) :: i
        character(:), allocatable, intent(inout) :: message

        if (i > len_trim(text)) then
            message = 'the layup ends too early'
        else
            message = "'"//printable(text(i:i), 1)//"' at place "//to_text(i)//' is not understood'
        end if
        message = message//": write angles with '/' between them, such as '0/45/-45/90' or "// &
             "'7*(0/90)'"
    end subroutine complain
end module brz_layup
