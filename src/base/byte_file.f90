! SPDX-License-Identifier: MIT
!> Files as bytes: of any length, in pieces, ordinary files alone.
!>
!> A pipe, a terminal or a folder is refused, and never waited for. Every procedure does nothing
!> once an error is recorded.
module brz_byte_file
    use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_int, c_int64_t, c_loc, &
        c_null_char, c_ptr, c_size_t
    use brz_descriptor, only: c_close, c_open, write_all, write_bytes
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_kinds, only: int64
    use brz_system_reason, only: system_reason
    implicit none
    private
    public :: byte_file_t, open_bytes, close_bytes, read_bytes, add_bytes, put_bytes, cut_bytes
    public :: read_into, add_from, is_ordinary, sync_file, piece, to_read, to_change, to_make

    integer, parameter :: piece = 1048576 !! a good length to read at once [bytes]
    ! flags of open in Linux
    integer(c_int), parameter :: to_read = 0, to_change = 2, to_make = 2 + 64
    integer(c_int), parameter :: no_wait = 2048, not_for_programs = 524288
    integer(c_int), parameter :: everyone = int(o'666') ! the umask takes away what it must
    integer(c_int), parameter :: from_start = 0, from_end = 2

    type :: byte_file_t
        character(:), allocatable :: path
        integer(c_int) :: descriptor = -1
        integer(int64) :: size = 0 !! [bytes]
    end type byte_file_t

    interface
        integer(c_int64_t) function c_lseek(descriptor, place, whence) bind(c, name='lseek')
            import :: c_int, c_int64_t
            integer(c_int), value :: descriptor, whence
            integer(c_int64_t), value :: place
        end function c_lseek
        integer(c_size_t) function c_read(descriptor, data, n) bind(c, name='read')
            import :: c_int, c_ptr, c_size_t
            integer(c_int), value :: descriptor
            type(c_ptr), value :: data
            integer(c_size_t), value :: n
        end function c_read
        integer(c_size_t) function c_pread(descriptor, data, n, place) bind(c, name='pread')
            import :: c_int, c_int64_t, c_ptr, c_size_t
            integer(c_int), value :: descriptor
            type(c_ptr), value :: data
            integer(c_size_t), value :: n
            integer(c_int64_t), value :: place
        end function c_pread
        integer(c_int) function c_ftruncate(descriptor, length) bind(c, name='ftruncate')
            import :: c_int, c_int64_t
            integer(c_int), value :: descriptor
            integer(c_int64_t), value :: length
        end function c_ftruncate
        integer(c_int) function c_fsync(descriptor) bind(c, name='fsync')
            import :: c_int
            integer(c_int), value :: descriptor
        end function c_fsync
    end interface

contains

    !> Open a file at its first byte.
    subroutine open_bytes(file, path, access, err)
        type(byte_file_t), intent(out) :: file
        character(*), intent(in) :: path
        integer, intent(in) :: access !! to_read, to_change; to_make: if it is not there
        type(error_t), intent(inout) :: err
        character(1), target :: nothing
        integer(c_int64_t) :: place

        file%path = path
        if (failed(err)) return
        file%descriptor = c_open(path//c_null_char, access + no_wait + not_for_programs, everyone)
        if (file%descriptor < 0) then
            call raise(err, exit_io, path//': cannot open it: '//system_reason())
            return
        end if
        file%size = c_lseek(file%descriptor, 0_c_int64_t, from_end)
        if (file%size < 0) then
            call raise(err, exit_io, path//': is no ordinary file')
        else if (c_read(file%descriptor, c_loc(nothing), 0_c_size_t) < 0) then ! a folder
            call raise(err, exit_io, path//': cannot read it: '//system_reason())
        end if
        place = c_lseek(file%descriptor, 0_c_int64_t, from_start)
        if (.not. failed(err)) return
        file%size = 0
        call close_bytes(file, err)
    end subroutine open_bytes

    !> Close a file; with `sync` once it is on the disk.
    subroutine close_bytes(file, err, sync)
        type(byte_file_t), intent(inout) :: file
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: sync
        integer(c_int) :: status

        if (file%descriptor < 0) return
        status = 0
        if (present(sync)) then
            if (sync .and. .not. failed(err)) status = c_fsync(file%descriptor)
        end if
        if (status /= 0) call raise(err, exit_io, file%path//': cannot bring it to the disk: '// &
                                    system_reason())
        if (c_close(file%descriptor) /= 0) call raise(err, exit_io, file%path// &
            ': cannot write it: '//system_reason())
        file%descriptor = -1
    end subroutine close_bytes

    !> The next bytes, or those behind the first `before` of the file, as many as `text` takes: n of
    !> them, fewer at the end of the file alone.
    subroutine read_bytes(file, text, n, err, before)
        type(byte_file_t), intent(in) :: file
        character(*), intent(inout), target :: text
        integer(int64), intent(out) :: n
        type(error_t), intent(inout) :: err
        integer(int64), intent(in), optional :: before

        n = 0
        if (len(text) > 0) call read_into(file, c_loc(text), len(text, int64), n, err, before)
    end subroutine read_bytes

    !> The same to anywhere in memory.
    subroutine read_into(file, to, bytes, n, err, before)
        type(byte_file_t), intent(in) :: file
        type(c_ptr), intent(in) :: to
        integer(int64), intent(in) :: bytes
        integer(int64), intent(out) :: n
        type(error_t), intent(inout) :: err
        integer(int64), intent(in), optional :: before
        character(c_char), pointer :: text(:)
        integer(c_size_t) :: more

        call c_f_pointer(to, text, [bytes])
        n = 0
        do while (n < bytes .and. .not. failed(err))
            if (present(before)) then
                more = c_pread(file%descriptor, c_loc(text(n + 1)), bytes - n, before + n)
            else
                more = c_read(file%descriptor, c_loc(text(n + 1)), bytes - n)
            end if
            if (more < 0) call raise(err, exit_io, file%path//': cannot read it: '// &
                                     system_reason())
            if (more <= 0) exit
            n = n + more
        end do
    end subroutine read_into

    !> Append bytes from anywhere in memory.
    subroutine add_from(file, from, bytes, err)
        type(byte_file_t), intent(inout) :: file
        type(c_ptr), intent(in) :: from
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        logical :: good

        if (failed(err)) return
        good = c_lseek(file%descriptor, file%size, from_start) >= 0
        if (good) good = write_bytes(file%descriptor, from, bytes)
        if (.not. good) call raise(err, exit_io, file%path//': cannot write it: '//system_reason())
        if (good) file%size = file%size + bytes
    end subroutine add_from

    !> Append bytes.
    subroutine add_bytes(file, text, err)
        type(byte_file_t), intent(inout) :: file
        character(*), intent(in) :: text
        type(error_t), intent(inout) :: err

        call write_at(file, file%size, text, err)
        if (.not. failed(err)) file%size = file%size + len(text, int64)
    end subroutine add_bytes

    !> Put bytes in the place of the first ones.
    subroutine put_bytes(file, text, err)
        type(byte_file_t), intent(inout) :: file
        character(*), intent(in) :: text
        type(error_t), intent(inout) :: err

        call write_at(file, 0_int64, text, err)
        file%size = max(file%size, len(text, int64))
    end subroutine put_bytes

    subroutine write_at(file, place, text, err)
        type(byte_file_t), intent(in) :: file
        integer(int64), intent(in) :: place
        character(*), intent(in) :: text
        type(error_t), intent(inout) :: err
        logical :: good

        if (failed(err)) return
        good = c_lseek(file%descriptor, place, from_start) >= 0
        if (good) good = write_all(file%descriptor, text)
        if (.not. good) call raise(err, exit_io, file%path//': cannot write it: '//system_reason())
    end subroutine write_at

    !> Drop what lies behind the first `size` bytes.
    subroutine cut_bytes(file, size, err)
        type(byte_file_t), intent(inout) :: file
        integer(int64), intent(in) :: size !! [bytes]
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (c_ftruncate(file%descriptor, size) /= 0) then
            call raise(err, exit_io, file%path//': cannot cut it: '//system_reason())
        else
            file%size = size
        end if
    end subroutine cut_bytes

    !> Wait until a file or the names in a folder are on the disk: on some file systems a full disk
    !> shows only here.
    subroutine sync_file(path, err)
        character(*), intent(in) :: path
        type(error_t), intent(inout) :: err
        integer(c_int) :: descriptor, status

        if (failed(err)) return
        descriptor = c_open(path//c_null_char, to_read + not_for_programs, everyone)
        status = descriptor
        if (descriptor >= 0) status = c_fsync(descriptor)
        if (status < 0) call raise(err, exit_io, path//': cannot bring it to the disk: '// &
                                   system_reason())
        if (descriptor >= 0) status = c_close(descriptor)
    end subroutine sync_file

    !> False for a pipe, a terminal and the like: what reads them would wait.
    logical function is_ordinary(path)
        character(*), intent(in) :: path
        integer(c_int) :: descriptor, status

        is_ordinary = .true.
        descriptor = c_open(path//c_null_char, to_read + no_wait + not_for_programs, everyone)
        if (descriptor < 0) return
        is_ordinary = c_lseek(descriptor, 0_c_int64_t, from_end) >= 0
        status = c_close(descriptor)
    end function is_ordinary
end module brz_byte_file
