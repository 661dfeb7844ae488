! SPDX-License-Identifier: MIT
!> The standard output, and whether what was printed got there.
!>
!> The run-time library of gfortran 12 keeps quiet about a full disk or a closed pipe. Lines that
!> are written here go through the system, behind what Fortran has written: the progress lines and
!> the last line of every command. The first failure is kept, and told when the command has ended.
module brz_screen
    use, intrinsic :: iso_c_binding, only: c_int, c_null_char
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_descriptor, only: c_close, c_open, write_all
    use brz_errors, only: error_t, exit_io, raise
    use brz_system_reason, only: system_reason
    use brz_text, only: string_t
    implicit none
    private
    public :: say, show, warn, check_screen, hold_standard_units

    integer(c_int), parameter :: standard_output = 1, standard_error = 2
    integer(c_int), parameter :: to_read_and_write = 2 !! flag of open in Linux
    character(:), allocatable, save :: lost !! why something was not printed

contains

    !> Before anything is opened: a program that was started without standard units would print into
    !> the first files that it opens. They get a place where nothing is kept.
    subroutine hold_standard_units()
        integer(c_int) :: descriptor

        do
            descriptor = c_open('/dev/null'//c_null_char, to_read_and_write, 0_c_int)
            if (descriptor < 0 .or. descriptor > standard_error) exit
        end do
        if (descriptor >= 0) descriptor = c_close(descriptor)
    end subroutine hold_standard_units

    !> Print lines on the error unit.
    subroutine warn(lines)
        type(string_t), intent(in) :: lines(:)
        integer :: i

        do i = 1, size(lines)
            write (error_unit, '(a)') lines(i)%s
        end do
    end subroutine warn

    !> Print a line.
    subroutine say(line)
        character(*), intent(in) :: line

        call show(line//new_line('a'))
    end subroutine say

    !> Print a text as it is, with its line ends.
    subroutine show(text)
        character(*), intent(in) :: text

        flush (output_unit)
        if (write_all(standard_output, text)) return
        if (.not. allocated(lost)) lost = system_reason()
    end subroutine show

    !> Raise an error if something was not printed.
    subroutine check_screen(err)
        type(error_t), intent(inout) :: err

        flush (output_unit)
        if (allocated(lost)) call raise(err, exit_io, 'standard output: '//lost// &
            '; what was printed is not complete there, files are')
    end subroutine check_screen
end module brz_screen
