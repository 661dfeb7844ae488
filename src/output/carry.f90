! SPDX-License-Identifier: MIT
!> Carry state to a checkpoint or back from it with one and the same list of calls, so that what
!> is written and what is read cannot differ.
module brz_carry
    use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use brz_errors, only: error_t, exit_io, failed, raise
    use brz_hdf5_array, only: h5_read, h5_write
    use brz_hdf5_file, only: h5_t
    use brz_kinds, only: int8, int16, int32, int64, real32, real64
    implicit none
    private
    public :: carry

    !> Write a scalar or an array to a file that is being written, else read it from the file. An
    !> array must have the shape of what is in the file, and numbers must be finite.
    interface carry
        module procedure carry_real64, carry_real32, carry_int64, carry_int32, carry_int16, &
            carry_int8, carry_logical
    end interface carry

contains

    subroutine carry_real64(file, name, a, err)
        real(real64), intent(inout), target, contiguous :: a(..)
        real(real64), pointer :: values(:)

        include 'carry_reals.inc'
    end subroutine carry_real64

    subroutine carry_real32(file, name, a, err)
        real(real32), intent(inout), target, contiguous :: a(..)
        real(real32), pointer :: values(:)

        include 'carry_reals.inc'
    end subroutine carry_real32

    subroutine carry_int64(file, name, a, err)
        integer(int64), intent(inout), contiguous :: a(..)

        include 'carry_integers.inc'
    end subroutine carry_int64

    subroutine carry_int32(file, name, a, err)
        integer(int32), intent(inout), contiguous :: a(..)

        include 'carry_integers.inc'
    end subroutine carry_int32

    !> As int32 in the file.
    subroutine carry_int16(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        integer(int16), intent(inout) :: a(:)
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: number(:)

        allocate (number(size(a)), source=int(a, int32))
        call carry_int32(file, name, number, err)
        a = int(number, int16)
    end subroutine carry_int16

    subroutine carry_int8(file, name, a, err)
        integer(int8), intent(inout), contiguous :: a(..)

        include 'carry_integers.inc'
    end subroutine carry_int8

    subroutine carry_logical(file, name, a, err)
        type(h5_t), intent(in) :: file
        character(*), intent(in) :: name
        logical, intent(inout) :: a
        type(error_t), intent(inout) :: err
        integer(int8) :: number

        number = merge(1_int8, 0_int8, a)
        call carry_int8(file, name, number, err)
        a = number == 1
    end subroutine carry_logical
end module brz_carry
