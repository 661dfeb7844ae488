! SPDX-License-Identifier: MIT
!> Small dealings with the file system that Fortran lacks: folders, renaming, removal, listing.
!>
!> C library calls of 64-bit Linux. Failures are reported with the reason that the system gives.
!> Text is written by C as well: the run-time library of gfortran 12 keeps quiet about a full disk.
module brz_files
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_int, c_int8_t, &
                                           c_int16_t, c_int64_t, c_loc, c_null_char, c_ptr, &
                                           c_size_t
    use brz_byte_file, only: byte_file_t, close_bytes, open_bytes, read_bytes, sync_file, to_read
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_kinds, only: int64
    use brz_system_reason, only: system_reason
    implicit none
    private
    public :: file_exists, is_folder, make_folder, rename_file, remove_file, list_folder
    public :: write_text_file, read_text_file, program_path, name_len

    integer, parameter :: name_len = 255 !! longest name of a file without its folder

    !> One entry of a folder, as 64-bit Linux lays it out.
    type, bind(c) :: dirent_t
        integer(c_int64_t) :: inode, offset
        integer(c_int16_t) :: length
        integer(c_int8_t) :: kind
        character(c_char) :: name(name_len + 1)
    end type dirent_t

    interface
        integer(c_int) function c_mkdir(path, mode) bind(c, name='mkdir')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
            integer(c_int), value :: mode
        end function c_mkdir
        integer(c_int) function c_rename(from, to) bind(c, name='rename')
            import :: c_char, c_int
            character(c_char), intent(in) :: from(*), to(*)
        end function c_rename
        integer(c_size_t) function c_readlink(path, target, length) bind(c, name='readlink')
            import :: c_char, c_size_t
            character(kind=c_char), intent(in) :: path(*)
            character(kind=c_char), intent(out) :: target(*)
            integer(c_size_t), value :: length
        end function c_readlink
        integer(c_int) function c_unlink(path) bind(c, name='unlink')
            import :: c_char, c_int
            character(c_char), intent(in) :: path(*)
        end function c_unlink
        type(c_ptr) function c_opendir(path) bind(c, name='opendir')
            import :: c_char, c_ptr
            character(c_char), intent(in) :: path(*)
        end function c_opendir
        type(c_ptr) function c_readdir(folder) bind(c, name='readdir')
            import :: c_ptr
            type(c_ptr), value :: folder
        end function c_readdir
        integer(c_int) function c_closedir(folder) bind(c, name='closedir')
            import :: c_int, c_ptr
            type(c_ptr), value :: folder
        end function c_closedir
        type(c_ptr) function c_fopen(path, mode) bind(c, name='fopen')
            import :: c_char, c_ptr
            character(c_char), intent(in) :: path(*), mode(*)
        end function c_fopen
        integer(c_size_t) function c_fwrite(data, bytes, n, file) bind(c, name='fwrite')
            import :: c_ptr, c_size_t
            type(c_ptr), value :: data, file
            integer(c_size_t), value :: bytes, n
        end function c_fwrite
        integer(c_int) function c_fclose(file) bind(c, name='fclose')
            import :: c_int, c_ptr
            type(c_ptr), value :: file
        end function c_fclose
    end interface

contains

    !> True for a file that can be found, and for a folder.
    logical function file_exists(path)
        character(*), intent(in) :: path

        inquire (file=path, exist=file_exists)
    end function file_exists

    !> True for a folder that can be listed.
    logical function is_folder(path)
        character(*), intent(in) :: path
        type(c_ptr) :: folder
        integer(c_int) :: status

        folder = c_opendir(path//c_null_char)
        is_folder = c_associated(folder)
        if (is_folder) status = c_closedir(folder)
    end function is_folder

    !> Make a folder with all the folders above it; no error if it is there.
    subroutine make_folder(path, err)
        character(*), intent(in) :: path
        type(error_t), intent(inout) :: err
        integer, parameter :: everyone = int(o'777') ! the umask takes away what it must
        integer(c_int) :: status
        integer :: i

        do i = 2, len_trim(path)
            if (path(i:i) == '/' .and. i < len_trim(path)) then
                status = c_mkdir(path(:i - 1)//c_null_char, int(everyone, c_int))
            end if
        end do
        if (is_folder(trim(path))) return
        status = c_mkdir(trim(path)//c_null_char, int(everyone, c_int))
        if (status /= 0) &
            call raise(err, exit_io, trim(path)//': cannot make the folder: '//system_reason())
    end subroutine make_folder

    !> Give a file a new name in one indivisible step; a file that has the name is replaced.
    subroutine rename_file(from, to, err)
        character(*), intent(in) :: from, to
        type(error_t), intent(inout) :: err

        if (c_rename(from//c_null_char, to//c_null_char) /= 0) &
            call raise(err, exit_io, to//': cannot rename '//from//' to it: '//system_reason())
    end subroutine rename_file

    !> Remove a file; silent if it is not there.
    subroutine remove_file(path)
        character(*), intent(in) :: path
        integer(c_int) :: status

        status = c_unlink(path//c_null_char)
    end subroutine remove_file

    !> Names of the entries of a folder that begin and end with the given texts, unsorted.
    subroutine list_folder(path, begin, end, names)
        character(*), intent(in) :: path
        character(*), intent(in) :: begin, end !! '' takes every name
        character(name_len), allocatable, intent(out) :: names(:)
        type(c_ptr) :: folder, entry
        integer(c_int) :: status
        character(name_len) :: name

        allocate (names(0))
        folder = c_opendir(path//c_null_char)
        if (.not. c_associated(folder)) return
        do
            entry = c_readdir(folder)
            if (.not. c_associated(entry)) exit
            call entry_name(entry, name)
            if (len_trim(name) < len(begin) + len(end)) cycle
            if (index(name, begin) /= 1) cycle
            if (name(len_trim(name) - len(end) + 1:len_trim(name)) == end) names = [names, name]
        end do
        status = c_closedir(folder)
    end subroutine list_folder

    subroutine entry_name(entry, name)
        type(c_ptr), intent(in) :: entry
        character(*), intent(out) :: name
        type(dirent_t), pointer :: item
        integer :: i

        call c_f_pointer(entry, item)
        name = ''
        do i = 1, len(name)
            if (item%name(i) == c_null_char) exit
            name(i:i) = item%name(i)
        end do
    end subroutine entry_name

    !> Write a text to a file under a temporary name, then give it its name when it is on the disk:
    !> never half a file.
    subroutine write_text_file(path, text, err)
        character(*), intent(in) :: path
        character(*), intent(in) :: text !! with its line ends
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        call put_text(path//'.tmp', text, err)
        call sync_file(path//'.tmp', err)
        if (.not. failed(err)) call rename_file(path//'.tmp', path, err)
        if (failed(err)) call remove_file(path//'.tmp')
    end subroutine write_text_file

    subroutine put_text(path, text, err)
        character(*), intent(in) :: path
        character(*), intent(in), target :: text
        type(error_t), intent(inout) :: err
        type(c_ptr) :: file
        logical :: good

        file = c_fopen(path//c_null_char, 'wb'//c_null_char)
        good = c_associated(file)
        if (good) then
            good = c_fwrite(c_loc(text), 1_c_size_t, len(text, c_size_t), file) == len(text)
            if (.not. good) call raise(err, exit_io, path//': cannot write it: '//system_reason())
            good = c_fclose(file) == 0
        end if
        if (.not. good) call raise(err, exit_io, path//': cannot write it: '//system_reason())
    end subroutine put_text

    !> The whole of a file, byte for byte.
    subroutine read_text_file(path, text, err)
        character(*), intent(in) :: path
        character(:), allocatable, intent(out) :: text
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        integer(int64) :: n

        call open_bytes(file, path, to_read, err)
        allocate (character(file%size) :: text)
        call read_bytes(file, text, n, err)
        call close_bytes(file, err)
        if (failed(err)) n = 0
        text = text(:n)
    end subroutine read_text_file

    !> Path of the running program; '' where the system does not tell.
    function program_path() result(path)
        character(:), allocatable :: path
        character(4096) :: target
        integer(c_size_t) :: n

        n = c_readlink('/proc/self/exe'//c_null_char, target, len(target, c_size_t))
        path = ''
        if (n > 0) path = target(:n)
    end function program_path
end module brz_files
