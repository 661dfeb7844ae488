! SPDX-License-Identifier: MIT
!> Descriptors of open files, as the system numbers them: open, close, write all.
module brz_descriptor
    use, intrinsic :: iso_c_binding, only: c_char, c_int, c_loc, c_ptr, c_size_t
    implicit none
    private
    public :: c_open, c_close, write_all

    interface
        integer(c_int) function c_open(path, flags, mode) bind(c, name='open')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), value :: flags, mode
        end function c_open
        integer(c_int) function c_close(descriptor) bind(c, name='close')
            import :: c_int
            integer(c_int), value :: descriptor
        end function c_close
        integer(c_size_t) function c_write(descriptor, data, n) bind(c, name='write')
            import :: c_int, c_ptr, c_size_t
            integer(c_int), value :: descriptor
            type(c_ptr), value :: data
            integer(c_size_t), value :: n
        end function c_write
    end interface

contains

    !> Write a whole text, in as many pieces as the system takes. False where it fails: then
    !> system_reason says why, and part of the text may be written.
    logical function write_all(descriptor, text) result(good)
        integer(c_int), intent(in) :: descriptor
        character(*), intent(in), target :: text
        integer(c_size_t) :: n, more

        n = 0
        more = 0
        do while (n < len(text, c_size_t) .and. more >= 0)
            more = c_write(descriptor, c_loc(text(n + 1:n + 1)), len(text, c_size_t) - n)
            n = n + more
        end do
        good = more >= 0
    end function write_all
end module brz_descriptor
