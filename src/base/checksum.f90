! SPDX-License-Identifier: MIT
!> CRC-32 of texts and files, as zlib, gzip and zip have it.
module brz_checksum
    use, intrinsic :: iso_c_binding, only: c_int, c_loc, c_long, c_ptr
    use brz_byte_file, only: byte_file_t, piece, read_bytes
    use brz_errors, only: error_t, exit_io, exit_stopped, failed, raise
    use brz_kinds, only: int64
    use brz_signals, only: stop_asked
    implicit none
    private
    public :: checksum, add_to_checksum

    interface
        integer(c_long) function c_crc32(before, data, n) bind(c, name='crc32')
            import :: c_int, c_long, c_ptr
            integer(c_long), value :: before
            type(c_ptr), value :: data
            integer(c_int), value :: n
        end function c_crc32
    end interface

contains

    !> Checksum of a text that follows what has the checksum `before` (0: nothing).
    integer(int64) function checksum(text, before)
        character(*), intent(in), target :: text
        integer(int64), intent(in) :: before
        integer(int64) :: i, n

        checksum = before
        do i = 1, len(text, int64), piece
            n = min(int(piece, int64), len(text, int64) - i + 1)
            checksum = c_crc32(int(checksum, c_long), c_loc(text(i:i)), int(n, c_int))
        end do
    end function checksum

    !> Add the next `bytes` of a file to a checksum.
    subroutine add_to_checksum(file, bytes, obey, sum, err)
        type(byte_file_t), intent(in) :: file
        integer(int64), intent(in) :: bytes
        logical, intent(in) :: obey !! a signal that asks for a stop
        integer(int64), intent(inout) :: sum
        type(error_t), intent(inout) :: err
        character(piece), allocatable :: text
        character(:), allocatable :: why
        integer(int64) :: left, n

        allocate (text)
        left = bytes
        do while (left > 0 .and. .not. failed(err))
            associate (want => min(left, int(piece, int64)))
                call read_bytes(file, text(:want), n, err)
                if (n < want) call raise(err, exit_io, file%path//': ends too early')
            end associate
            sum = checksum(text(:n), sum)
            left = left - n
            if (.not. obey) cycle
            if (stop_asked(why)) call raise(err, exit_stopped, 'stopped by '//why// &
                ' while '//file%path//' was read; nothing has changed')
        end do
    end subroutine add_to_checksum
end module brz_checksum
