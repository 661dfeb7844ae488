! SPDX-License-Identifier: MIT
!> Arrays of particles made longer or shorter, keeping what they hold of the first ones.
module brz_resize
    use brz_kinds, only: int16, int32, int8, real32, real64
    implicit none
    private
    public :: resize

    !> Give the last extent of an array another size; new elements are 0. An array without elements
    !> is one that a scene does not need, and stays.
    interface resize
        module procedure resize_doubles, resize_singles, resize_double, resize_single, &
            resize_integer, resize_short, resize_byte
    end interface resize

contains

    pure subroutine resize_doubles(a, n)
        real(real64), allocatable, intent(inout) :: a(:, :)
        real(real64), allocatable :: b(:, :)

        include 'resize_columns.inc'
    end subroutine resize_doubles

    pure subroutine resize_singles(a, n)
        real(real32), allocatable, intent(inout) :: a(:, :)
        real(real32), allocatable :: b(:, :)

        include 'resize_columns.inc'
    end subroutine resize_singles

    pure subroutine resize_double(a, n)
        real(real64), allocatable, intent(inout) :: a(:)
        real(real64), allocatable :: b(:)

        include 'resize_list.inc'
    end subroutine resize_double

    pure subroutine resize_single(a, n)
        real(real32), allocatable, intent(inout) :: a(:)
        real(real32), allocatable :: b(:)

        include 'resize_list.inc'
    end subroutine resize_single

    pure subroutine resize_integer(a, n)
        integer(int32), allocatable, intent(inout) :: a(:)
        integer(int32), allocatable :: b(:)

        include 'resize_list.inc'
    end subroutine resize_integer

    pure subroutine resize_short(a, n)
        integer(int16), allocatable, intent(inout) :: a(:)
        integer(int16), allocatable :: b(:)

        include 'resize_list.inc'
    end subroutine resize_short

    pure subroutine resize_byte(a, n)
        integer(int8), allocatable, intent(inout) :: a(:)
        integer(int8), allocatable :: b(:)

        include 'resize_list.inc'
    end subroutine resize_byte
end module brz_resize
