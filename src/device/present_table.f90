! SPDX-License-Identifier: MIT
!> The present table: which array of the host has a copy on the GPU, and where. A loop body that is
!> launched on a GPU is called with the arrays of the host; here it finds the copies of these. Only
!> the places are kept in step: who attaches an array says when numbers are copied, and a copy may
!> lie otherwise than the array (leading dimensions and strides are arguments of the loop bodies).
!>
!> Entries go by the place of an array in memory, which moves along when allocatable arrays change
!> places by move_alloc. Whoever allocates an array anew must attach it anew.
module brz_present_table
    use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc, c_ptr
    use brz_buffers, only: buffer_t, not_present
    use brz_kinds, only: int32, int64, int8, real32, real64
    implicit none
    private
    public :: attach, attach_bytes, detach_all, buffer_of, copy_of, detach, on_device, one_on_device

    integer, parameter :: most = 1024 !! entries

    !> Ranges of memory of the host, from `first` up to `behind`, sorted; none overlaps another.
    integer(c_intptr_t), save :: first(most) = 0, behind(most) = 0
    type(buffer_t), save :: copy(most)
    integer, save :: n = 0

    !> Note where the copy of a contiguous array begins. What had a part of its memory before is
    !> forgotten.
    interface attach
        module procedure attach_singles, attach_doubles, attach_integers, attach_bytes_of_8
    end interface attach

contains

    subroutine attach_singles(x, buffer)
        real(real32), intent(in), target, contiguous :: x(..)
        class(buffer_t), intent(in) :: buffer

        call attach_bytes(x, 4*size(x, kind=int64), buffer)
    end subroutine attach_singles

    subroutine attach_doubles(x, buffer)
        real(real64), intent(in), target, contiguous :: x(..)
        class(buffer_t), intent(in) :: buffer

        call attach_bytes(x, 8*size(x, kind=int64), buffer)
    end subroutine attach_doubles

    subroutine attach_integers(x, buffer)
        integer(int32), intent(in), target, contiguous :: x(..)
        class(buffer_t), intent(in) :: buffer

        call attach_bytes(x, 4*size(x, kind=int64), buffer)
    end subroutine attach_integers

    subroutine attach_bytes_of_8(x, buffer)
        integer(int8), intent(in), target, contiguous :: x(..)
        class(buffer_t), intent(in) :: buffer

        call attach_bytes(x, size(x, kind=int64), buffer)
    end subroutine attach_bytes_of_8

    !> The same for an array, or one structure, of any type.
    subroutine attach_bytes(x, bytes, buffer)
        type(*), intent(in), target, contiguous :: x(..)
        integer(int64), intent(in) :: bytes !! of x on the host
        class(buffer_t), intent(in) :: buffer
        integer(c_intptr_t) :: at
        integer :: k, left

        at = transfer(c_loc(x), at)
        if (at == 0) return
        left = 0
        do k = 1, n
            if (first(k) < at + max(bytes, 1_int64) .and. behind(k) > at) cycle
            left = left + 1
            first(left) = first(k)
            behind(left) = behind(k)
            copy(left) = copy(k)
        end do
        n = left
        if (n == most) error stop 'present table: too many arrays: this is an error of the program'
        k = n
        do while (k > 0)
            if (first(k) < at) exit
            first(k + 1) = first(k)
            behind(k + 1) = behind(k)
            copy(k + 1) = copy(k)
            k = k - 1
        end do
        first(k + 1) = at
        behind(k + 1) = at + max(bytes, 1_int64)
        copy(k + 1)%address = buffer%address
        copy(k + 1)%bytes = buffer%bytes
        n = n + 1
    end subroutine attach_bytes

    !> An array has no copy any more.
    subroutine detach(x)
        type(*), intent(in), target :: x(*)
        integer(c_intptr_t) :: at
        integer :: k

        at = transfer(c_loc(x), at)
        k = entry_of(at)
        if (k == 0) return
        first(k:n - 1) = first(k + 1:n)
        behind(k:n - 1) = behind(k + 1:n)
        copy(k:n - 1) = copy(k + 1:n)
        n = n - 1
    end subroutine detach

    !> No array has a copy any more.
    subroutine detach_all()
        n = 0
    end subroutine detach_all

    !> Entry that a place in memory belongs to, or 0.
    pure integer function entry_of(at) result(low)
        integer(c_intptr_t), intent(in) :: at
        integer :: high, middle

        low = 0
        high = n + 1
        do while (high - low > 1)
            middle = (low + high)/2
            if (first(middle) <= at) then
                low = middle
            else
                high = middle
            end if
        end do
        if (low == 0) return
        if (at >= behind(low)) low = 0
    end function entry_of

    !> The copy of an array that begins where x does, 0 bytes at 0 if there is none.
    type(buffer_t) function buffer_of(x) result(buffer)
        type(*), intent(in), target :: x(*)
        integer(c_intptr_t) :: at
        integer :: k

        at = transfer(c_loc(x), at)
        k = entry_of(at)
        if (k == 0) return
        if (first(k) == at) buffer = copy(k)
    end function buffer_of

    !> Where the copy of an array, or of a part of it, begins: not_present if there is none, which
    !> a launch refuses.
    integer(c_intptr_t) function on_device(x) result(address)
        type(*), intent(in), target :: x(*)

        address = copy_of(c_loc(x))
    end function on_device

    !> The same of a structure.
    integer(c_intptr_t) function one_on_device(x) result(address)
        type(*), intent(in), target :: x

        address = copy_of(c_loc(x))
    end function one_on_device

    !> The same of what begins at a place of the host.
    integer(c_intptr_t) function copy_of(place) result(address)
        type(c_ptr), intent(in) :: place
        integer(c_intptr_t) :: at
        integer :: k

        at = transfer(place, at)
        k = entry_of(at)
        address = not_present
        if (k > 0) address = copy(k)%address + (at - first(k))
    end function copy_of
end module brz_present_table
