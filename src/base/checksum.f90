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

    integer, parameter :: at_once = 64 !! pieces of a file between which threads choose

    interface
        integer(c_long) function c_crc32(before, data, n) bind(c, name='crc32')
            import :: c_int, c_long, c_ptr
            integer(c_long), value :: before
            type(c_ptr), value :: data
            integer(c_int), value :: n
        end function c_crc32
        integer(c_long) function c_crc32_combine(before, after, n) bind(c, name='crc32_combine')
            import :: c_long
            integer(c_long), value :: before, after, n
        end function c_crc32_combine
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

    !> Add `bytes` of a file, those behind its first ones, to a checksum. Threads share the pieces.
    subroutine add_to_checksum(file, before, bytes, obey, sum, err)
        type(byte_file_t), intent(in) :: file
        integer(int64), intent(in) :: before !! how many bytes of the file are left out
        integer(int64), intent(in) :: bytes
        logical, intent(in) :: obey !! a signal that asks for a stop
        integer(int64), intent(inout) :: sum
        type(error_t), intent(inout) :: err
        integer(int64) :: done, sums(at_once), length(at_once)
        type(error_t) :: faults(at_once)
        character(:), allocatable :: why
        integer :: k, n

        done = 0
        do while (done < bytes .and. .not. failed(err))
            n = int(min(int(at_once, int64), (bytes - done - 1)/piece + 1))
            length(:n) = piece
            length(n) = min(int(piece, int64), bytes - done - (n - 1_int64)*piece)
            !$omp parallel do schedule(dynamic) if (n > 1)
            do k = 1, n
                call sum_piece(file, before + done + (k - 1_int64)*piece, length(k), sums(k), &
                               faults(k))
            end do
            do k = 1, n
                if (failed(faults(k)) .and. .not. failed(err)) err = faults(k)
                sum = c_crc32_combine(int(sum, c_long), int(sums(k), c_long), &
                                      int(length(k), c_long))
                done = done + length(k)
            end do
            if (.not. obey .or. failed(err)) cycle
            if (stop_asked(why)) call raise(err, exit_stopped, 'stopped by '//why// &
                ' while '//file%path//' was read; nothing has changed')
        end do
    end subroutine add_to_checksum

    !> Checksum of one piece of a file.
    subroutine sum_piece(file, before, bytes, sum, err)
        type(byte_file_t), intent(in) :: file
        integer(int64), intent(in) :: before, bytes !! of the file: left out, summed
        integer(int64), intent(out) :: sum
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        integer(int64) :: n

        allocate (character(bytes) :: text)
        call read_bytes(file, text, n, err, before)
        if (n < bytes) call raise(err, exit_io, file%path//': ends too early')
        sum = checksum(text(:n), 0_int64)
    end subroutine sum_piece
end module brz_checksum
