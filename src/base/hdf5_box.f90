! SPDX-License-Identifier: MIT
!> Parts of arrays in HDF5 files: reading a box of one, and arrays that lie in other files.
!>
!> A virtual array looks like any other, and its elements stay where they were written. A part that
!> is missing reads as zeros without a word: who reads must look whether all files are there.
module brz_hdf5_box
    use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
    use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_hdf5_array, only: h5_make, h5_shape
    use brz_hdf5_file, only: h5_fail, h5_t
    use brz_kinds, only: int8, int64, real32, real64
    use hdf5, only: hid_t, hsize_t, h5dclose_f, h5dget_space_f, h5dopen_f, h5dread_f, &
                    h5kind_to_type, h5_integer_kind, h5_real_kind, h5p_dataset_create_f, &
                    h5pclose_f, h5pcreate_f, &
                    h5pset_virtual_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, &
                    h5sselect_all_f, h5sselect_hyperslab_f
    implicit none
    private
    public :: h5_read_box, h5_virtual, h5_piece_t, kind_real32, kind_int8

    integer, parameter :: kind_real32 = 1, kind_int8 = 2 !! of virtual arrays

    !> Where a part of a virtual array lies.
    type :: h5_piece_t
        character(:), allocatable :: file !! in the same folder
        character(:), allocatable :: name !! of the array there, the whole of which is the part
        integer, allocatable :: lo(:), extent(:) !! first element in the virtual array; elements
    end type h5_piece_t

    !> Read the elements from `lo` on that fill an array.
    interface h5_read_box
        module procedure read_box_real64, read_box_real32, read_box_int8
    end interface h5_read_box

contains

    subroutine read_elements(file, name, data, lo, extents, type, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        type(c_ptr), intent(inout) :: data
        integer, intent(in) :: lo(:) !! first element, from 1
        integer, intent(in) :: extents(:)
        integer(hid_t), intent(in) :: type
        type(error_t), intent(inout) :: err
        integer(int64), allocatable :: there(:)
        integer(hid_t) :: set, space, memory
        integer :: status

        call h5_shape(file, name, there, err)
        if (failed(err)) return
        if (size(there) /= size(lo)) then
            call raise(err, exit_io, file%path//": '"//name//"' has another number of dimensions")
        else if (any(lo < 1 .or. lo + extents - 1 > there)) then
            call raise(err, exit_io, file%path//": '"//name//"' is too small for its box")
        end if
        if (failed(err) .or. product(extents) == 0) return
        call h5dopen_f(file%id, name, set, status)
        call h5dget_space_f(set, space, status)
        call h5sselect_hyperslab_f(space, h5s_select_set_f, int(lo - 1, hsize_t), &
                                   int(extents, hsize_t), status)
        call h5screate_simple_f(size(lo), int(extents, hsize_t), memory, status)
        call h5dread_f(set, type, data, status, mem_space_id=memory, file_space_id=space)
        if (status /= 0) call h5_fail(file, "cannot read '"//name//"', it may be damaged", err)
        call h5sclose_f(memory, status)
        call h5sclose_f(space, status)
        call h5dclose_f(set, status)
    end subroutine read_elements

    subroutine read_box_real64(file, name, lo, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer, intent(in) :: lo(:)
        real(real64), intent(inout), target, contiguous :: a(:, :, :, :)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, lo, shape(a), h5kind_to_type(real64, h5_real_kind), &
                           err)
        if (.not. all(ieee_is_finite(a))) call raise(err, exit_io, file%path//": '"//name// &
            "' holds what is no number")
    end subroutine read_box_real64

    subroutine read_box_real32(file, name, lo, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer, intent(in) :: lo(:)
        real(real32), intent(inout), target, contiguous :: a(:, :, :, :)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, lo, shape(a), h5kind_to_type(real32, h5_real_kind), &
                           err)
        if (.not. all(ieee_is_finite(a))) call raise(err, exit_io, file%path//": '"//name// &
            "' holds what is no number")
    end subroutine read_box_real32

    subroutine read_box_int8(file, name, lo, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer, intent(in) :: lo(:)
        integer(int8), intent(inout), target, contiguous :: a(:, :, :)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, lo, shape(a), h5kind_to_type(int8, h5_integer_kind), &
                           err)
    end subroutine read_box_int8

    !> Make an array whose parts lie in other files.
    subroutine h5_virtual(file, name, kind_of, dims, pieces, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer, intent(in) :: kind_of !! kind_real32, kind_int8
        integer, intent(in) :: dims(:) !! in Fortran order
        type(h5_piece_t), intent(in) :: pieces(:)
        type(error_t), intent(inout) :: err
        integer(hid_t) :: create, set, space, type, part
        integer :: i, status

        if (failed(err)) return
        type = h5kind_to_type(real32, h5_real_kind)
        if (kind_of == kind_int8) type = h5kind_to_type(int8, h5_integer_kind)
        call h5screate_simple_f(size(dims), int(dims, hsize_t), space, status)
        call h5pcreate_f(h5p_dataset_create_f, create, status)
        do i = 1, size(pieces)
            associate (piece => pieces(i))
                call h5screate_simple_f(size(dims), int(piece%extent, hsize_t), part, status)
                call h5sselect_hyperslab_f(space, h5s_select_set_f, int(piece%lo - 1, hsize_t), &
                                           int(piece%extent, hsize_t), status)
                call h5pset_virtual_f(create, space, piece%file, piece%name, part, status)
                if (status /= 0) call h5_fail(file, "cannot make '"//name//"' of parts", err)
                call h5sclose_f(part, status)
            end associate
        end do
        call h5sselect_all_f(space, status)
        call h5_make(file, name, type, space, create, set, err)
        if (set >= 0) call h5dclose_f(set, status)
        call h5pclose_f(create, status)
        call h5sclose_f(space, status)
    end subroutine h5_virtual
end module brz_hdf5_box
