! SPDX-License-Identifier: MIT
!> Why the last call of the system failed, in its own words.
module brz_system_reason
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_ptr, c_size_t
    implicit none
    private
    public :: system_reason, last_error

    interface
        type(c_ptr) function c_errno() bind(c, name='__errno_location')
            import :: c_ptr
        end function c_errno
        type(c_ptr) function c_strerror(number) bind(c, name='strerror')
            import :: c_int, c_ptr
            integer(c_int), value :: number
        end function c_strerror
        integer(c_size_t) function c_strlen(text) bind(c, name='strlen')
            import :: c_ptr, c_size_t
            type(c_ptr), value :: text
        end function c_strlen
    end interface

contains

    !> What the system says about the call that failed last.
    function system_reason() result(text)
        character(:), allocatable :: text
        character(c_char), pointer :: letters(:)
        type(c_ptr) :: message
        integer :: i

        message = c_strerror(int(last_error(), c_int))
        call c_f_pointer(message, letters, [c_strlen(message)])
        allocate (character(size(letters)) :: text)
        do i = 1, size(letters)
            text(i:i) = letters(i)
        end do
    end function system_reason

    !> Its number (errno).
    integer function last_error()
        integer(c_int), pointer :: number

        call c_f_pointer(c_errno(), number)
        last_error = number
    end function last_error
end module brz_system_reason
