! SPDX-License-Identifier: MIT
!> Why the last HDF5 call failed, in a few words: the innermost entry of HDF5's own error stack.
module brz_hdf5_reason
    use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_funloc, c_funptr, &
                                           c_int, c_int64_t, c_null_char, c_ptr
    implicit none
    private
    public :: hdf5_reason

    integer(c_int64_t), parameter :: default_stack = 0
    integer(c_int), parameter :: innermost_first = 0
    integer, parameter :: longest = 400

    !> One entry of the error stack (H5E_error2_t).
    type, bind(c) :: fault_t
        integer(c_int64_t) :: class, major, minor
        integer(c_int) :: line
        type(c_ptr) :: function, file, text
    end type fault_t

    interface
        integer(c_int) function h5ewalk2(stack, direction, visit, target) bind(c, name='H5Ewalk2')
            import :: c_funptr, c_int, c_int64_t, c_ptr
            integer(c_int64_t), value :: stack
            integer(c_int), value :: direction
            type(c_funptr), value :: visit
            type(c_ptr), value :: target
        end function h5ewalk2
    end interface

    character(longest), save :: found = '' ! where `visit` leaves the text

contains

    !> The reason, without HDF5's wrapping: 'No space left on device' rather than a line of C.
    function hdf5_reason() result(text)
        use, intrinsic :: iso_c_binding, only: c_null_ptr
        character(:), allocatable :: text
        character(*), parameter :: mark = "error message = '"
        integer(c_int) :: status
        integer :: i, j

        found = ''
        status = h5ewalk2(default_stack, innermost_first, c_funloc(visit), c_null_ptr)
        i = index(found, mark)
        if (i > 0) then
            text = found(i + len(mark):)
            j = index(text, "'")
            if (j > 0) text = text(:j - 1)
        else if (found == '') then
            text = 'HDF5 gives no reason'
        else
            text = 'HDF5: '//trim(found)
        end if
    end function hdf5_reason

    integer(c_int) function visit(number, entry, target) bind(c, name='brz_hdf5_visit')
        integer(c_int), value :: number !! 0: the innermost
        type(fault_t), intent(in) :: entry
        type(c_ptr), value :: target
        character(c_char), pointer :: letters(:)
        integer :: i

        visit = 0
        if (number /= 0 .or. c_associated(target)) return
        call c_f_pointer(entry%text, letters, [longest])
        do i = 1, longest
            if (letters(i) == c_null_char) exit
            found(i:i) = letters(i)
        end do
    end function visit
end module brz_hdf5_reason
