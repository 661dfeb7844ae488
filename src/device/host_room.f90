! SPDX-License-Identifier: MIT
!> Large arrays from the GPU by way of pinned memory: the driver writes there at the speed of the
!> bus, all threads carry on from there. To memory that is not pinned it copies with one thread.
!>
!> The pinned memory is the driver's, so that copies of the process (POSIX fork) never share it.
module brz_host_room
    use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_intptr_t, &
        c_null_ptr, c_ptr, c_size_t
    use brz_cuda_driver, only: cu_host_allocate, cu_to_host
    use brz_kinds, only: int64, int8
    use brz_snapshots, only: carry_on, read_snapshot, snapshot_in_use
    implicit none
    private
    public :: read_memory

    integer(int64), parameter :: room_bytes = 2_int64**25
    integer(int64), parameter :: worth = 2_int64**20 !! less is copied as fast without
    type(c_ptr), save :: room = c_null_ptr
    logical, save :: asked = .false. !! for the room

contains

    !> Copy from the GPU to the host, or from a snapshot where one is in use; waits for all work
    !> before it. What the driver says: 0 if done.
    integer(c_int) function read_memory(host, address, bytes) result(code)
        type(c_ptr), intent(in) :: host
        integer(c_intptr_t), intent(in) :: address
        integer(int64), intent(in) :: bytes
        integer(int8), pointer, contiguous :: from(:), to(:)
        integer(int64) :: first, n

        if (snapshot_in_use()) then
            call c_f_pointer(host, to, [bytes])
            code = read_snapshot(to, address)
            return
        end if
        if (bytes >= worth .and. .not. asked) then
            asked = .true.
            if (cu_host_allocate(room, int(room_bytes, c_size_t)) /= 0) room = c_null_ptr
        end if
        if (bytes < worth .or. .not. c_associated(room)) then
            code = cu_to_host(host, address, int(bytes, c_size_t))
            return
        end if
        call c_f_pointer(room, from, [room_bytes])
        call c_f_pointer(host, to, [bytes])
        code = 0
        do first = 0, bytes - 1, room_bytes
            n = min(room_bytes, bytes - first)
            code = cu_to_host(room, address + first, int(n, c_size_t))
            if (code /= 0) return
            call carry_on(from(:n), to(first + 1:first + n))
        end do
    end function read_memory
end module brz_host_room
