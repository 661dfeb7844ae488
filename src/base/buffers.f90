! SPDX-License-Identifier: MIT
!> Memory of the GPU as the host sees it, and the arguments of a launch.
module brz_buffers
    use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_float, c_int, &
        c_int64_t, c_intptr_t, c_loc, c_null_char, c_size_t
    use brz_kinds, only: rk
    implicit none
    private
    public :: buffer_t, reals_t, doubles_t, integers_t, bytes_t, from
    public :: arguments_t, most_arguments, not_present

    integer(c_intptr_t), parameter :: not_present = -huge(1_c_intptr_t)
    !! the address of a copy that is not on the GPU, see brz_present_table
    integer, parameter :: most_arguments = 40
    integer, parameter :: most_words = 200 !! of eight bytes, for all arguments of a launch

    type :: buffer_t
        integer(c_intptr_t) :: address = 0
        integer(c_size_t) :: bytes = 0
    end type buffer_t

    !> The same, with the kind of number that it holds: what launches of loop bodies take.
    type, extends(buffer_t) :: reals_t !! real(rk)
    end type reals_t

    type, extends(buffer_t) :: doubles_t !! real(dp)
    end type doubles_t

    type, extends(buffer_t) :: integers_t !! integer(int32)
    end type integers_t

    type, extends(buffer_t) :: bytes_t !! integer(int8)
    end type bytes_t

    !> A part of a buffer, from one of its numbers on.
    interface from
        module procedure from_real, from_double, from_integer
    end interface from

    !> Values for one launch, in the order and of the types of the arguments of the kernel.
    type :: arguments_t
        integer :: n = 0
        integer :: missing = 0 !! an argument that is not on the GPU, or 0
        integer :: first(most_arguments + 1) = 1 !! word of each argument
        integer(c_int64_t) :: value(most_words) = 0
    contains
        procedure :: add_structure
        procedure, private :: add_integer, add_long, add_single, add_double, add_buffer
        generic :: add => add_integer, add_long, add_single, add_double, add_buffer
    end type arguments_t

contains

    subroutine add_integer(self, x)
        class(arguments_t), intent(inout) :: self
        integer(c_int), intent(in) :: x

        call self%add_long(int(x, c_int64_t)) ! little endian: the low word comes first
    end subroutine add_integer

    subroutine add_long(self, x)
        class(arguments_t), intent(inout) :: self
        integer(c_int64_t), intent(in) :: x

        self%value(self%first(self%n + 1)) = x
        self%n = self%n + 1
        self%first(self%n + 1) = self%first(self%n) + 1
    end subroutine add_long

    !> Add a structure of plain data, which the kernel takes with the attribute `value`.
    subroutine add_structure(self, x, bytes)
        class(arguments_t), intent(inout) :: self
        type(*), intent(in), target, contiguous :: x(..)
        integer, intent(in) :: bytes
        character(kind=c_char), pointer :: from(:)
        integer :: words

        words = (bytes - 1)/8 + 1
        call c_f_pointer(c_loc(x), from, [bytes])
        self%value(self%first(self%n + 1):self%first(self%n + 1) + words - 1) = &
            transfer([from, spread(c_null_char, 1, 8*words - bytes)], self%value)
        self%n = self%n + 1
        self%first(self%n + 1) = self%first(self%n) + words
    end subroutine add_structure

    subroutine add_single(self, x)
        class(arguments_t), intent(inout) :: self
        real(c_float), intent(in) :: x

        call self%add_integer(transfer(x, 0_c_int))
    end subroutine add_single

    subroutine add_double(self, x)
        class(arguments_t), intent(inout) :: self
        real(c_double), intent(in) :: x

        call self%add_long(transfer(x, 0_c_int64_t))
    end subroutine add_double

    subroutine add_buffer(self, x)
        class(arguments_t), intent(inout) :: self
        class(buffer_t), intent(in) :: x

        call self%add_long(int(x%address, c_int64_t))
        if (x%address == not_present) self%missing = self%n
    end subroutine add_buffer

    pure type(reals_t) function from_real(whole, first) result(part)
        type(reals_t), intent(in) :: whole
        integer(c_int64_t), intent(in) :: first !! number, from 1

        part = whole
        part%address = part%address + (first - 1)*(storage_size(1.0_rk)/8)
    end function from_real

    pure type(doubles_t) function from_double(whole, first) result(part)
        type(doubles_t), intent(in) :: whole
        integer(c_int64_t), intent(in) :: first !! number, from 1

        part = whole
        part%address = part%address + 8*(first - 1)
    end function from_double

    pure type(integers_t) function from_integer(whole, first) result(part)
        type(integers_t), intent(in) :: whole
        integer(c_int64_t), intent(in) :: first !! number, from 1

        part = whole
        part%address = part%address + 4*(first - 1)
    end function from_integer
end module brz_buffers
