! SPDX-License-Identifier: MIT
!> Data of the host on the GPU: a copy of an array enters, and either side is brought up to date.
!> (OpenACC calls these enter data, update device and update self.)
module brz_device_data
    use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
    use brz_buffers, only: buffer_t
    use brz_device, only: allocate_buffer, copy_in, copy_out
    use brz_errors, only: error_t
    use brz_kinds, only: int32, int64, int8, real32, real64
    use brz_present_table, only: attach_bytes, copy_of
    implicit none
    private
    public :: enter_data, enter_bytes, update_device, update_host, update_device_bytes

    !> Give an array a copy on the GPU with its numbers; one that is there already is renewed.
    interface enter_data
        module procedure enter_singles, enter_doubles, enter_integers, enter_bytes_of_8
    end interface enter_data

    !> Copy an array to its copy.
    interface update_device
        module procedure singles_there, doubles_there, integers_there, bytes_there
    end interface update_device

    !> Bring the numbers of the copy to the host, after all work before.
    interface update_host
        module procedure singles_here, doubles_here, integers_here, bytes_here
    end interface update_host

contains

    subroutine enter_singles(x, err)
        real(real32), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call enter_bytes(x, 4*size(x, kind=int64), err)
    end subroutine enter_singles

    subroutine enter_doubles(x, err)
        real(real64), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call enter_bytes(x, 8*size(x, kind=int64), err)
    end subroutine enter_doubles

    subroutine enter_integers(x, err)
        integer(int32), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call enter_bytes(x, 4*size(x, kind=int64), err)
    end subroutine enter_integers

    subroutine enter_bytes_of_8(x, err)
        integer(int8), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call enter_bytes(x, size(x, kind=int64), err)
    end subroutine enter_bytes_of_8

    !> The same of any type.
    subroutine enter_bytes(x, bytes, err)
        type(*), intent(in), target, contiguous :: x(..)
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        type(buffer_t) :: buffer

        call allocate_buffer(buffer, bytes, err)
        call copy_in(x, buffer, bytes, err)
        call attach_bytes(x, bytes, buffer)
    end subroutine enter_bytes

    subroutine singles_there(x, err)
        real(real32), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call update_device_bytes(x, 4*size(x, kind=int64), err)
    end subroutine singles_there

    subroutine doubles_there(x, err)
        real(real64), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call update_device_bytes(x, 8*size(x, kind=int64), err)
    end subroutine doubles_there

    subroutine integers_there(x, err)
        integer(int32), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call update_device_bytes(x, 4*size(x, kind=int64), err)
    end subroutine integers_there

    subroutine bytes_there(x, err)
        integer(int8), intent(in), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call update_device_bytes(x, size(x, kind=int64), err)
    end subroutine bytes_there

    !> The same of any type.
    subroutine update_device_bytes(x, bytes, err)
        type(*), intent(in), target, contiguous :: x(..)
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err

        call copy_in(x, copy_at(c_loc(x)), bytes, err)
    end subroutine update_device_bytes

    subroutine singles_here(x, err)
        real(real32), intent(inout), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call copy_out(copy_at(c_loc(x)), x, 4*size(x, kind=int64), err)
    end subroutine singles_here

    subroutine doubles_here(x, err)
        real(real64), intent(inout), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call copy_out(copy_at(c_loc(x)), x, 8*size(x, kind=int64), err)
    end subroutine doubles_here

    subroutine integers_here(x, err)
        integer(int32), intent(inout), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call copy_out(copy_at(c_loc(x)), x, 4*size(x, kind=int64), err)
    end subroutine integers_here

    subroutine bytes_here(x, err)
        integer(int8), intent(inout), target, contiguous :: x(..)
        type(error_t), intent(inout) :: err

        call copy_out(copy_at(c_loc(x)), x, size(x, kind=int64), err)
    end subroutine bytes_here

    type(buffer_t) function copy_at(place) result(buffer)
        type(c_ptr), intent(in) :: place

        buffer%address = copy_of(place)
    end function copy_at
end module brz_device_data
