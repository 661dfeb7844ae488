! SPDX-License-Identifier: MIT
!> HDF5 files: created, opened and closed, with errors in words.
!>
!> Every procedure does nothing once an error is recorded, so a caller asks at the end only. A
!> file is written under `path`.tmp and gets its name when it is complete and closed; if anything
!> fails, the temporary file is removed and a file that had the name stays as it was.
module brz_hdf5_file
    use brz_byte_file, only: byte_file_t, close_bytes, open_bytes, sync_file, to_read
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_files, only: remove_file, rename_file
    use brz_hdf5_reason, only: hdf5_reason
    use brz_seal, only: put_seal, seal_bytes
    use hdf5, only: hid_t, hsize_t, h5open_f, h5dont_atexit_f, h5eset_auto_f, h5fcreate_f, &
                    h5fopen_f, h5fclose_f, h5f_acc_trunc_f, h5f_acc_rdonly_f, h5pcreate_f, &
                    h5pclose_f, &
                    h5pset_libver_bounds_f, h5pset_create_inter_group_f, h5p_file_access_f, &
                    h5p_link_create_f, h5p_file_create_f, h5pset_userblock_f, &
                    h5f_libver_v18_f, h5f_libver_latest_f, h5gcreate_f, h5gclose_f, h5lexists_f
    implicit none
    private
    public :: h5_t, h5_create, h5_open, h5_close, h5_fail, h5_group, h5_has
    public :: h5_plain, h5_packed

    integer, parameter :: h5_plain = 0 !! arrays as they are
    integer, parameter :: h5_packed = 1 !! shuffled and deflated: for dumps

    type :: h5_t
        integer(hid_t) :: id = -1
        character(:), allocatable :: path !! final name
        logical :: writing = .false.
        logical :: unnamed = .false. !! it stays path.tmp when it is closed: another gives the name
        integer :: filter = h5_plain !! of the arrays to be written
        character(:), allocatable :: seal !! title of a file that is sealed, see brz_seal
    end type h5_t

    logical, save :: started = .false.

contains

    !> Start HDF5 once, without its messages on the terminal. Nothing is left to its exit handler,
    !> which would try once more to write to a full disk.
    subroutine start_hdf5()
        integer :: status

        if (started) return
        call h5dont_atexit_f(status)
        call h5open_f(status)
        call h5eset_auto_f(0, status)
        started = .true.
    end subroutine start_hdf5

    !> Begin a file for writing.
    subroutine h5_create(file, path, filter, err, seal)
        type(h5_t), intent(out) :: file
        character(*), intent(in) :: path
        integer, intent(in) :: filter !! h5_plain, h5_packed
        type(error_t), intent(inout) :: err
        character(*), intent(in), optional :: seal !! what the file is, see brz_seal
        integer(hid_t) :: access, create
        integer :: status

        file%path = path
        if (failed(err)) return
        call start_hdf5()
        file%writing = .true.
        file%filter = filter
        call remove_file(path//'.tmp')
        call h5pcreate_f(h5p_file_access_f, access, status)
        ! this format has room for attributes of any length (the deck) and checks its own tables
        call h5pset_libver_bounds_f(access, h5f_libver_v18_f, h5f_libver_latest_f, status)
        call h5pcreate_f(h5p_file_create_f, create, status)
        if (present(seal)) then
            file%seal = seal
            call h5pset_userblock_f(create, int(seal_bytes, hsize_t), status)
        end if
        call h5fcreate_f(path//'.tmp', h5f_acc_trunc_f, file%id, status, creation_prp=create, &
                         access_prp=access)
        if (status /= 0) then
            call h5_fail(file, 'cannot create it', err)
            file%id = -1
        end if
        call h5pclose_f(create, status)
        call h5pclose_f(access, status)
    end subroutine h5_create

    !> Open a file for reading.
    subroutine h5_open(file, path, err)
        type(h5_t), intent(out) :: file
        character(*), intent(in) :: path
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: bytes
        integer :: status

        file%path = path
        call open_bytes(bytes, path, to_read, err) ! HDF5 would wait for a pipe
        call close_bytes(bytes, err)
        if (failed(err)) return
        call start_hdf5()
        call h5fopen_f(path, h5f_acc_rdonly_f, file%id, status)
        if (status == 0) return
        call h5_fail(file, 'cannot open it, or it is damaged', err)
        file%id = -1
    end subroutine h5_open

    !> Close a file. One that was written gets its name once it is on the disk, or is removed if an
    !> error is recorded.
    subroutine h5_close(file, err)
        type(h5_t), intent(inout) :: file
        type(error_t), intent(inout) :: err
        integer :: status

        if (file%id >= 0) then
            call h5fclose_f(file%id, status)
            if (status /= 0) call h5_fail(file, 'cannot complete it', err)
        end if
        file%id = -1
        if (.not. file%writing) return
        if (allocated(file%seal)) call put_seal(file%path//'.tmp', file%seal, err)
        call sync_file(file%path//'.tmp', err)
        if (.not. (failed(err) .or. file%unnamed)) &
            call rename_file(file%path//'.tmp', file%path, err)
        if (failed(err)) call remove_file(file%path//'.tmp')
        file%writing = .false.
    end subroutine h5_close

    !> Record what cannot be done to the file and why. To be called right after the failed call.
    subroutine h5_fail(file, what, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: what
        type(error_t), intent(inout) :: err

        call raise(err, exit_io, file%path//': '//what//': '//hdf5_reason())
    end subroutine h5_fail

    !> Make a group, with the groups above it.
    subroutine h5_group(file, name, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        type(error_t), intent(inout) :: err
        integer(hid_t) :: group, link
        integer :: status

        if (failed(err)) return
        call h5pcreate_f(h5p_link_create_f, link, status)
        call h5pset_create_inter_group_f(link, 1, status)
        call h5gcreate_f(file%id, name, group, status, lcpl_id=link)
        if (status /= 0) call h5_fail(file, "cannot make group '"//name//"'", err)
        call h5pclose_f(link, status)
        if (.not. failed(err)) call h5gclose_f(group, status)
    end subroutine h5_group

    !> True if the file has this object. Every group above it must be there.
    logical function h5_has(file, name)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer :: status

        h5_has = .false.
        if (file%id >= 0) call h5lexists_f(file%id, name, h5_has, status)
    end function h5_has
end module brz_hdf5_file
