! SPDX-License-Identifier: MIT
!> The seal of a file: a first block that tells what the file is, its length and the checksum of all
!> that follows, so that damage is found before anything else reads the file.
!>
!> The block is text; HDF5 knows it as a user block and begins behind it.
module brz_seal
    use brz_byte_file, only: byte_file_t, close_bytes, open_bytes, put_bytes, read_bytes, &
                             to_change, to_read
    use brz_checksum, only: add_to_checksum
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_kinds, only: int64
    use brz_text, only: to_text
    implicit none
    private
    public :: put_seal, check_seal, seal_bytes

    integer, parameter :: seal_bytes = 512
    character(*), parameter :: line_end = new_line('a')

contains

    !> Seal a complete file whose first block is free.
    subroutine put_seal(path, title, err)
        character(*), intent(in) :: path
        character(*), intent(in) :: title !! what the file is
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(seal_bytes) :: block
        integer(int64) :: n, sum

        call open_bytes(file, path, to_change, err)
        call read_bytes(file, block, n, err)
        sum = 0
        call add_to_checksum(file, n, file%size - n, .false., sum, err)
        call put_bytes(file, sealed(title, file%size, sum), err)
        call close_bytes(file, err)
    end subroutine put_seal

    !> Raise an error if a file is not what was sealed.
    subroutine check_seal(path, title, err)
        character(*), intent(in) :: path
        character(*), intent(in) :: title !! what the file should be
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(seal_bytes) :: block
        integer(int64) :: n, sum

        block = ''
        call open_bytes(file, path, to_read, err)
        call read_bytes(file, block, n, err)
        if (.not. failed(err) .and. index(block, title//line_end) /= 1) then
            call raise(err, exit_io, path//': does not begin with "'//title//'": a file of '// &
                       'another version, which has to go on with it, another file, or damaged')
        end if
        sum = 0
        call add_to_checksum(file, n, file%size - n, .true., sum, err)
        if (block /= sealed(title, file%size, sum)) call raise(err, exit_io, path// &
            ': is damaged: it is not what was written (length '//to_text(file%size)// &
            ', checksum '//hexadecimal(sum)//'; its first lines tell the right ones)')
        call close_bytes(file, err)
    end subroutine check_seal

    !> The first block of a file.
    function sealed(title, size, sum) result(block)
        character(*), intent(in) :: title
        integer(int64), intent(in) :: size !! of the whole file [bytes]
        integer(int64), intent(in) :: sum !! CRC-32 behind the first block
        character(seal_bytes) :: block

        block = title//line_end//'length '//to_text(size)//line_end//'crc32 '//hexadecimal(sum)// &
                ' from byte '//to_text(seal_bytes)//line_end
        block(seal_bytes:) = line_end
    end function sealed

    function hexadecimal(number) result(digits)
        integer(int64), intent(in) :: number
        character(8) :: digits

        write (digits, '(z8.8)') number
    end function hexadecimal
end module brz_seal
