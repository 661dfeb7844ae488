! SPDX-License-Identifier: MIT
!> Named arrays in HDF5 files: scalars and arrays of up to 4 dimensions, of five kinds; lists of
!> texts.
!>
!> Arrays keep their Fortran order: a(nx, ny, nz) is [nz, ny, nx] to a reader in C or Python.
module brz_hdf5_array
    use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_hdf5_file, only: h5_t, h5_fail, h5_plain
    use brz_hdf5_packed, only: choose_chunk, deflate_level, write_chunks
    use brz_kinds, only: int8, int32, int64, real32, real64
    use hdf5, only: hid_t, hsize_t, h5pcreate_f, h5pclose_f, h5pset_chunk_f, h5pset_shuffle_f, &
                    h5pset_deflate_f, h5pset_create_inter_group_f, &
                    h5p_dataset_create_f, h5p_link_create_f, h5screate_f, h5screate_simple_f, &
                    h5sclose_f, h5s_scalar_f, h5sget_simple_extent_dims_f, &
                    h5sget_simple_extent_ndims_f, h5dcreate_f, h5dopen_f, h5dwrite_f, h5dread_f, &
                    h5dclose_f, h5dget_space_f, h5kind_to_type, h5_integer_kind, h5_real_kind, &
                    h5t_string
    implicit none
    private
    public :: h5_write, h5_read, h5_shape, h5_make

    integer(int64), parameter :: worth_packing = 256 !! elements

    !> Write a scalar or an array as a new entry of the file, with the groups above it.
    interface h5_write
        module procedure write_real64, write_real32, write_int64, write_int32, write_int8, &
            write_texts
    end interface h5_write

    !> Read into a scalar or an array that has the shape of what is in the file.
    interface h5_read
        module procedure read_real64, read_real32, read_int64, read_int32, read_int8
    end interface h5_read

contains

    !> Shape of an array in the file, in Fortran order.
    subroutine h5_shape(file, name, dims, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int64), allocatable, intent(out) :: dims(:)
        type(error_t), intent(inout) :: err
        integer(hid_t) :: set, space
        integer :: status

        allocate (dims(0))
        if (failed(err)) return
        call h5dopen_f(file%id, name, set, status)
        if (status /= 0) then
            call h5_fail(file, "cannot find '"//name//"'", err)
            return
        end if
        call h5dget_space_f(set, space, status)
        call space_shape(space, dims)
        call h5sclose_f(space, status)
        call h5dclose_f(set, status)
    end subroutine h5_shape

    subroutine space_shape(space, dims)
        integer(hid_t), intent(in) :: space
        integer(int64), allocatable, intent(out) :: dims(:)
        integer(hsize_t), allocatable :: now(:), most(:)
        integer :: n, status

        call h5sget_simple_extent_ndims_f(space, n, status)
        allocate (now(n), most(n))
        if (n > 0) call h5sget_simple_extent_dims_f(space, now, most, status)
        dims = int(now, int64)
    end subroutine space_shape

    !> Write the elements at `data` as a new array.
    subroutine write_elements(file, name, data, extents, type, width, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        type(c_ptr), intent(in) :: data
        integer(int64), intent(in) :: extents(:) !! gfortran 12 gives -1 for some empty sections
        integer(hid_t), intent(in) :: type
        integer, intent(in) :: width !! of an element, 0: not to be packed [bytes]
        type(error_t), intent(inout) :: err
        integer(int64) :: chunk(size(extents)), dims(size(extents))
        integer(hid_t) :: space, create, set
        integer :: status, closed
        logical :: packs

        if (failed(err)) return
        dims = max(extents, 0_int64)
        packs = file%filter /= h5_plain .and. width > 0 .and. size(dims) > 0 .and. &
                product(dims) >= worth_packing
        if (size(dims) == 0) then
            call h5screate_f(h5s_scalar_f, space, status)
        else
            call h5screate_simple_f(size(dims), int(dims, hsize_t), space, status)
        end if
        call h5pcreate_f(h5p_dataset_create_f, create, status)
        if (packs) then
            chunk = choose_chunk(dims)
            call h5pset_chunk_f(create, size(dims), int(chunk, hsize_t), status)
            call h5pset_shuffle_f(create, status)
            call h5pset_deflate_f(create, deflate_level, status)
        end if
        call h5_make(file, name, type, space, create, set, err)
        if (set >= 0) then
            status = 0
            if (packs) then
                call write_chunks(set, data, dims, chunk, width, status)
            else if (product(dims) > 0) then
                call h5dwrite_f(set, type, data, status)
            end if
            if (status /= 0) call h5_fail(file, "cannot write '"//name//"'", err)
            call h5dclose_f(set, closed)
            if (closed /= 0) call h5_fail(file, "cannot write '"//name//"'", err)
        end if
        call h5pclose_f(create, status)
        call h5sclose_f(space, status)
    end subroutine write_elements

    !> Make an array, with the groups in its name.
    subroutine h5_make(file, name, type, space, create, set, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(hid_t), intent(in) :: type, space, create !! of an element, its shape, how it lies
        integer(hid_t), intent(out) :: set !! open; -1 where an error is raised
        type(error_t), intent(inout) :: err
        integer(hid_t) :: link
        integer :: status, closed

        call h5pcreate_f(h5p_link_create_f, link, status)
        call h5pset_create_inter_group_f(link, 1, status)
        call h5dcreate_f(file%id, name, type, space, set, status, dcpl_id=create, lcpl_id=link)
        if (status /= 0) then
            call h5_fail(file, "cannot make '"//name//"'", err)
            set = -1
        end if
        call h5pclose_f(link, closed)
    end subroutine h5_make

    !> Read an array of known shape to `data`.
    subroutine read_elements(file, name, data, extents, type, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        type(c_ptr), intent(inout) :: data
        integer(int64), intent(in) :: extents(:) !! see write_elements
        integer(hid_t), intent(in) :: type
        type(error_t), intent(inout) :: err
        integer(int64) :: dims(size(extents))
        integer(int64), allocatable :: there(:)
        integer(hid_t) :: set
        integer :: status

        dims = max(extents, 0_int64)
        call h5_shape(file, name, there, err)
        if (failed(err)) return
        if (size(there) /= size(dims)) then
            call raise(err, exit_io, file%path//": '"//name//"' has another number of dimensions")
        else if (any(there /= dims)) then
            call raise(err, exit_io, file%path//": '"//name//"' is "//shape_text(there)// &
                       ', expected '//shape_text(dims))
        end if
        if (failed(err) .or. product(dims) == 0) return
        call h5dopen_f(file%id, name, set, status)
        call h5dread_f(set, type, data, status)
        if (status /= 0) call h5_fail(file, "cannot read '"//name//"', it may be damaged", err)
        call h5dclose_f(set, status)
    end subroutine read_elements

    !> A shape as text.
    pure function shape_text(dims) result(text)
        integer(int64), intent(in) :: dims(:)
        character(:), allocatable :: text
        character(20) :: number
        integer :: i

        text = '('
        do i = 1, size(dims)
            write (number, '(i0)') dims(i)
            if (i > 1) text = text//', '
            text = text//trim(number)
        end do
        text = text//')'
    end function shape_text

    subroutine write_real64(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        real(real64), intent(in), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call write_elements(file, name, c_loc(a), shape(a, int64), &
                            h5kind_to_type(real64, h5_real_kind), 8, err)
    end subroutine write_real64

    subroutine write_real32(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        real(real32), intent(in), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call write_elements(file, name, c_loc(a), shape(a, int64), &
                            h5kind_to_type(real32, h5_real_kind), 4, err)
    end subroutine write_real32

    subroutine write_int64(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int64), intent(in), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call write_elements(file, name, c_loc(a), shape(a, int64), &
                            h5kind_to_type(int64, h5_integer_kind), 8, err)
    end subroutine write_int64

    subroutine write_int32(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int32), intent(in), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call write_elements(file, name, c_loc(a), shape(a, int64), &
                            h5kind_to_type(int32, h5_integer_kind), 4, err)
    end subroutine write_int32

    subroutine write_int8(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int8), intent(in), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err

        call write_elements(file, name, c_loc(a), shape(a, int64), &
                            h5kind_to_type(int8, h5_integer_kind), 1, err)
    end subroutine write_int8

    !> Texts without their trailing blanks. VTK reads none but those of variable length.
    subroutine write_texts(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        character(*), intent(in) :: a(:)
        type(error_t), intent(inout) :: err
        character(len(a) + 1, c_char), target :: ended(size(a))
        type(c_ptr), target :: text(size(a))
        integer :: i

        do i = 1, size(a)
            ended(i) = trim(a(i))//c_null_char
            text(i) = c_loc(ended(i))
        end do
        call write_elements(file, name, c_loc(text), shape(a, int64), h5t_string, 0, err)
    end subroutine write_texts

    subroutine read_real64(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        real(real64), intent(inout), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, shape(a, int64), &
                           h5kind_to_type(real64, h5_real_kind), err)
    end subroutine read_real64

    subroutine read_real32(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        real(real32), intent(inout), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, shape(a, int64), &
                           h5kind_to_type(real32, h5_real_kind), err)
    end subroutine read_real32

    subroutine read_int64(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int64), intent(inout), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, shape(a, int64), &
                           h5kind_to_type(int64, h5_integer_kind), err)
    end subroutine read_int64

    subroutine read_int32(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int32), intent(inout), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, shape(a, int64), &
                           h5kind_to_type(int32, h5_integer_kind), err)
    end subroutine read_int32

    subroutine read_int8(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int8), intent(inout), target, contiguous :: a(..)
        type(error_t), intent(inout) :: err
        type(c_ptr) :: data

        data = c_loc(a)
        call read_elements(file, name, data, shape(a, int64), &
                           h5kind_to_type(int8, h5_integer_kind), err)
    end subroutine read_int8
end module brz_hdf5_array
