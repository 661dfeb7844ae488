! SPDX-License-Identifier: MIT
!> Read through a whole HDF5 file, so that every checksum in it is compared.
module brz_hdf5_verify
    use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
    use brz_errors, only: error_t, failed
    use brz_hdf5_file, only: h5_t, h5_close, h5_fail, h5_open
    use brz_kinds, only: int8
    use hdf5, only: hid_t, hsize_t, size_t, h5dclose_f, h5dget_space_f, h5dget_type_f, h5dopen_f, &
                    h5dread_f, h5gget_obj_info_idx_f, h5gn_members_f, h5g_dataset_f, &
                    h5g_group_f, h5sclose_f, h5sget_simple_extent_npoints_f, h5tclose_f, &
                    h5tget_size_f
    implicit none
    private
    public :: h5_verify

    integer, parameter :: longest_name = 128

contains

    !> Raise an error if anything in the file cannot be read.
    subroutine h5_verify(path, err)
        character(*), intent(in) :: path
        type(error_t), intent(inout) :: err
        type(h5_t) :: file

        call h5_open(file, path, err)
        if (.not. failed(err)) call verify_group(file, '/', err)
        call h5_close(file, err)
    end subroutine h5_verify

    recursive subroutine verify_group(file, group, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: group !! ends with a slash
        type(error_t), intent(inout) :: err
        character(longest_name) :: name
        integer :: i, n, kind, status

        call h5gn_members_f(file%id, group, n, status)
        if (status /= 0) call h5_fail(file, "cannot read group '"//group//"'", err)
        if (failed(err)) return
        do i = 0, n - 1
            call h5gget_obj_info_idx_f(file%id, group, i, name, kind, status)
            if (status /= 0) call h5_fail(file, "cannot read group '"//group//"'", err)
            if (failed(err)) return
            if (kind == h5g_group_f) call verify_group(file, group//trim(name)//'/', err)
            if (kind == h5g_dataset_f) call verify_array(file, group//trim(name), err)
        end do
    end subroutine verify_group

    subroutine verify_array(file, name, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        type(error_t), intent(inout) :: err
        integer(int8), allocatable, target :: bytes(:)
        integer(hid_t) :: set, space, type
        integer(hsize_t) :: n
        integer(size_t) :: element
        integer :: status
        type(c_ptr) :: data

        if (failed(err)) return
        call h5dopen_f(file%id, name, set, status)
        if (status /= 0) then
            call h5_fail(file, "cannot read '"//name//"'", err)
            return
        end if
        call h5dget_space_f(set, space, status)
        call h5dget_type_f(set, type, status)
        call h5sget_simple_extent_npoints_f(space, n, status)
        call h5tget_size_f(type, element, status)
        allocate (bytes(n*element))
        data = c_loc(bytes)
        if (n > 0) call h5dread_f(set, type, data, status)
        if (status /= 0) call h5_fail(file, "cannot read '"//name//"'", err)
        call h5tclose_f(type, status)
        call h5sclose_f(space, status)
        call h5dclose_f(set, status)
    end subroutine verify_array
end module brz_hdf5_verify
