! SPDX-License-Identifier: MIT
!> Descriptors of open files, as the system numbers them: open, close, write all.
module brz_descriptor
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_loc, c_ptr, c_size_t
    implicit none
    private
    public :: c_open, c_close, write_all, write_bytes

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

        good = .true.
        if (len(text) > 0) good = write_bytes(descriptor, c_loc(text), len(text, c_size_t))
    end function write_all

    !> The same for bytes anywhere in memory.
    logical function write_bytes(descriptor, from, bytes) result(good)
        integer(c_int), intent(in) :: descriptor
        type(c_ptr), intent(in) :: from
        integer(c_size_t), intent(in) :: bytes
        character(c_char), pointer :: text(:)
        integer(c_size_t) :: n, more

        call c_f_pointer(from, text, [bytes])
        n = 0
        more = 0
        do while (n < bytes .and. more >= 0)
            more = c_write(descriptor, c_loc(text(n + 1)), bytes - n)
            n = n + more
        end do
        good = more >= 0
    end function write_bytes
end module brz_descriptor
