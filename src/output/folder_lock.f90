! SPDX-License-Identifier: MIT
!> One run at a time in a folder.
!>
!> The lock is one of the system on a file in the folder, held by the process (flock): it ends with
!> the process, however that ends, and a file that was left behind locks nothing. On NFS Linux asks
!> the server for it. A copy of the process that still writes keeps it.
module brz_folder_lock
    use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_size_t
    use brz_byte_file, only: add_bytes, byte_file_t, close_bytes, cut_bytes, open_bytes, &
                             read_bytes, to_make
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_files, only: make_folder
    use brz_kinds, only: int64
    use brz_system_reason, only: last_error, system_reason
    use brz_text, only: to_text
    implicit none
    private
    public :: lock_folder

    character(*), parameter :: lock_name = '.brisance.lock'
    integer(c_int), parameter :: exclusive = 2, at_once = 4
    integer, parameter :: would_wait = 11 !! EWOULDBLOCK

    interface
        integer(c_int) function c_flock(descriptor, operation) bind(c, name='flock')
            import :: c_int
            integer(c_int), value :: descriptor, operation
        end function c_flock
        integer(c_int) function c_getpid() bind(c, name='getpid')
            import :: c_int
        end function c_getpid
        integer(c_int) function c_gethostname(name, length) bind(c, name='gethostname')
            import :: c_char, c_int, c_size_t
            character(c_char), intent(out) :: name(*)
            integer(c_size_t), value :: length
        end function c_gethostname
    end interface

contains

    !> Make a folder that is not there, and take its lock until this process ends. An error if
    !> another process has it. Where the file system has no locks `note` says so.
    subroutine lock_folder(folder, note, err)
        character(*), intent(in) :: folder
        character(:), allocatable, intent(out) :: note !! '' if all is well
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(200) :: holder
        integer(int64) :: n

        note = ''
        if (failed(err)) return
        call make_folder(folder, err)
        call open_bytes(file, folder//'/'//lock_name, to_make, err)
        if (failed(err)) return
        if (c_flock(file%descriptor, exclusive + at_once) /= 0) then
            if (last_error() /= would_wait) then
                note = folder//': cannot be locked ('//system_reason()// &
                       '); see to it that no other run writes there'
                return
            end if
            holder = ''
            call read_bytes(file, holder, n, err)
            call raise(err, exit_io, folder//': another run is at work in it ('//trim(holder)// &
                       '); wait for its end, stop it, or take another folder with --out')
            call close_bytes(file, err)
            return
        end if
        call cut_bytes(file, 0_int64, err)
        call add_bytes(file, 'process '//to_text(int(c_getpid()))//' on '//host_name(), err)
    end subroutine lock_folder

    function host_name() result(name)
        character(:), allocatable :: name
        character(256) :: letters
        integer :: n

        letters = ''
        if (c_gethostname(letters, len(letters, c_size_t)) /= 0) letters = 'a host without a name'
        n = index(letters, c_null_char)
        if (n > 0) letters(n:) = ''
        name = trim(letters)
    end function host_name
end module brz_folder_lock
