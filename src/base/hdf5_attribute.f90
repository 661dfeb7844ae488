! SPDX-License-Identifier: MIT
!> Attributes of HDF5 objects: texts of fixed length and small lists of numbers.
module brz_hdf5_attribute
    use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_ptr
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_hdf5_file, only: h5_t
    use brz_hdf5_reason, only: hdf5_reason
    use brz_kinds, only: int32, real64
    use hdf5, only: hid_t, hsize_t, size_t, h5acreate_by_name_f, h5aopen_by_name_f, h5awrite_f, &
                    h5aread_f, h5aclose_f, h5aget_space_f, h5aget_type_f, h5kind_to_type, &
                    h5_integer_kind, h5_real_kind, h5s_scalar_f, h5screate_f, h5screate_simple_f, &
                    h5sclose_f, h5sget_simple_extent_npoints_f, h5t_c_s1, h5t_cset_ascii_f, &
                    h5t_cset_utf8_f, h5t_str_nullpad_f, h5tclose_f, h5tcopy_f, h5tget_size_f, &
                    h5tset_cset_f, h5tset_size_f, h5tset_strpad_f
    implicit none
    private
    public :: h5_put, h5_get

    !> Give an object an attribute.
    interface h5_put
        module procedure put_text, put_int32, put_real64
    end interface h5_put

    !> Read an attribute.
    interface h5_get
        module procedure get_text, get_int32, get_real64
    end interface h5_get

contains

    !> A text; ASCII where it is, else marked as UTF-8.
    subroutine put_text(file, object, name, text, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object !! group or array
        character(*), intent(in) :: name, text
        type(error_t), intent(inout) :: err
        character(max(1, len(text)), c_char), target :: letters
        integer(hid_t) :: type
        integer :: status, i

        if (failed(err)) return
        letters = text
        if (len(text) == 0) letters = achar(0)
        call h5tcopy_f(h5t_c_s1, type, status)
        call h5tset_size_f(type, int(len(letters), size_t), status)
        call h5tset_strpad_f(type, h5t_str_nullpad_f, status)
        call h5tset_cset_f(type, h5t_cset_ascii_f, status)
        do i = 1, len(text)
            if (iachar(text(i:i)) > 127) call h5tset_cset_f(type, h5t_cset_utf8_f, status)
        end do
        call put_elements(file, object, name, c_loc(letters), -1, type, err)
        call h5tclose_f(type, status)
    end subroutine put_text

    subroutine put_int32(file, object, name, values, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        integer(int32), intent(in), target :: values(:)
        type(error_t), intent(inout) :: err
        integer(int32), target :: copy(size(values))

        copy = values
        call put_elements(file, object, name, c_loc(copy), size(values), &
                          h5kind_to_type(int32, h5_integer_kind), err)
    end subroutine put_int32

    subroutine put_real64(file, object, name, values, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        real(real64), intent(in), target :: values(:)
        type(error_t), intent(inout) :: err
        real(real64), target :: copy(size(values))

        copy = values
        call put_elements(file, object, name, c_loc(copy), size(values), &
                          h5kind_to_type(real64, h5_real_kind), err)
    end subroutine put_real64

    subroutine put_elements(file, object, name, data, n, type, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        type(c_ptr), intent(in) :: data
        integer, intent(in) :: n !! elements; -1: a scalar
        integer(hid_t), intent(in) :: type
        type(error_t), intent(inout) :: err
        integer(hid_t) :: space, attribute
        integer :: status

        if (failed(err)) return
        if (n < 0) then
            call h5screate_f(h5s_scalar_f, space, status)
        else
            call h5screate_simple_f(1, [int(n, hsize_t)], space, status)
        end if
        call h5acreate_by_name_f(file%id, object, name, type, space, attribute, status)
        if (status == 0) call h5awrite_f(attribute, type, data, status)
        if (status /= 0) then
            call raise(err, exit_io, file%path//": cannot write attribute '"//name//"': "// &
                       hdf5_reason())
        else
            call h5aclose_f(attribute, status)
        end if
        call h5sclose_f(space, status)
    end subroutine put_elements

    !> A text of fixed length; '' with an error if there is none.
    subroutine get_text(file, object, name, text, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        character(:), allocatable, intent(out) :: text
        type(error_t), intent(inout) :: err
        character(1, c_char), allocatable, target :: letters(:)
        integer(hid_t) :: attribute, type
        integer(size_t) :: n
        integer :: status, i
        type(c_ptr) :: data

        text = ''
        call open_attribute(file, object, name, attribute, err)
        if (failed(err)) return
        call h5aget_type_f(attribute, type, status)
        call h5tget_size_f(type, n, status)
        allocate (letters(n))
        data = c_loc(letters)
        call h5aread_f(attribute, type, data, status)
        if (status /= 0) call no_attribute(file, name, err)
        text = repeat(' ', int(n))
        do i = 1, int(n)
            if (letters(i) == achar(0)) exit
            text(i:i) = letters(i)
        end do
        text = text(:i - 1)
        call h5tclose_f(type, status)
        call h5aclose_f(attribute, status)
    end subroutine get_text

    !> Numbers; their count must be that of the attribute.
    subroutine get_int32(file, object, name, values, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        integer(int32), intent(out), target, contiguous :: values(:)
        type(error_t), intent(inout) :: err

        values = 0
        call get_elements(file, object, name, c_loc(values), size(values), &
                          h5kind_to_type(int32, h5_integer_kind), err)
    end subroutine get_int32

    subroutine get_real64(file, object, name, values, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        real(real64), intent(out), target, contiguous :: values(:)
        type(error_t), intent(inout) :: err

        values = 0
        call get_elements(file, object, name, c_loc(values), size(values), &
                          h5kind_to_type(real64, h5_real_kind), err)
    end subroutine get_real64

    subroutine get_elements(file, object, name, data, count, type, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        type(c_ptr), intent(in) :: data
        integer, intent(in) :: count !! elements
        integer(hid_t), intent(in) :: type
        type(error_t), intent(inout) :: err
        integer(hid_t) :: attribute, space
        integer(hsize_t) :: n
        integer :: status
        type(c_ptr) :: place

        call open_attribute(file, object, name, attribute, err)
        if (failed(err)) return
        place = data
        call h5aget_space_f(attribute, space, status)
        call h5sget_simple_extent_npoints_f(space, n, status)
        call h5sclose_f(space, status)
        if (n == count) then
            call h5aread_f(attribute, type, place, status)
        else
            status = -1
        end if
        if (status /= 0) call no_attribute(file, name, err)
        call h5aclose_f(attribute, status)
    end subroutine get_elements

    subroutine open_attribute(file, object, name, attribute, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: object, name
        integer(hid_t), intent(out) :: attribute
        type(error_t), intent(inout) :: err
        integer :: status

        attribute = -1
        if (failed(err)) return
        call h5aopen_by_name_f(file%id, object, name, attribute, status)
        if (status /= 0) call no_attribute(file, name, err)
    end subroutine open_attribute

    subroutine no_attribute(file, name, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        type(error_t), intent(inout) :: err

        call raise(err, exit_io, file%path//": cannot read attribute '"//name// &
                   "': the file is damaged, or not one of Brisance")
    end subroutine no_attribute
end module brz_hdf5_attribute
