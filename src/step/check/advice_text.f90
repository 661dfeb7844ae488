! SPDX-License-Identifier: MIT
!> Lines of advice, and the numbers in them.
module brz_advice_text
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_kinds, only: dp, real32
    use brz_text, only: to_text
    implicit none
    private
    public :: say_advice, say_more, point_text, length_text, millimetres, time_text

contains

    !> First line of an advice.
    subroutine say_advice(text)
        character(*), intent(in) :: text

        write (output_unit, '(2a)') 'advice       ', text
    end subroutine say_advice

    !> A further line of it.
    subroutine say_more(text)
        character(*), intent(in) :: text

        write (output_unit, '(2a)') '             ', text
    end subroutine say_more

    !> A point as a deck has it.
    function point_text(x) result(text)
        real(dp), intent(in) :: x(3)
        character(:), allocatable :: text

        text = to_text(real(x(1), real32))//', '//to_text(real(x(2), real32))//', '// &
               to_text(real(x(3), real32))
    end function point_text

    !> A length in mm: '327 mm'.
    function length_text(length) result(text)
        real(dp), intent(in) :: length !! [m]
        character(:), allocatable :: text

        text = to_text(nint(1e3_dp*length))//' mm'
    end function length_text

    !> A time with two digits: '0.16 ms', '2.5 s', '25 s', '12 min', '3.1 h'.
    function time_text(seconds) result(text)
        real(dp), intent(in) :: seconds
        character(:), allocatable :: text
        character(12) :: digits

        if (seconds < 0.1_dp) then
            write (digits, '(f0.2)') 1e3_dp*seconds
            text = trim(digits)//' ms'
        else if (seconds < 10) then
            write (digits, '(f0.1)') seconds
            text = trim(digits)//' s'
        else if (seconds < 100) then
            write (digits, '(i0)') nint(seconds)
            text = trim(digits)//' s'
        else if (seconds < 6000) then
            write (digits, '(i0)') nint(seconds/60)
            text = trim(digits)//' min'
        else
            write (digits, '(f0.1)') seconds/3600
            text = trim(digits)//' h'
        end if
        if (text(1:1) == '.') text = '0'//text
    end function time_text

    !> A length as text, to three digits.
    pure function millimetres(length) result(text)
        real(dp), intent(in) :: length !! [m]
        character(:), allocatable :: text
        real(dp) :: unit

        unit = 10.0_dp**(floor(log10(1e3_dp*length)) - 2)
        text = to_text(real(unit*anint(1e3_dp*length/unit), real32))//' mm'
    end function millimetres
end module brz_advice_text
