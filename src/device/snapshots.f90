! SPDX-License-Identifier: MIT
!> Memory of the GPU put by on the host, for a copy of this process that writes it: such a copy
!> cannot ask the GPU, and a process that brought the state into its own arrays would have to copy
!> every page that it shares with the copies that still write.
!>
!> The rooms are memory that processes share (POSIX mmap), pinned where the driver can. A copy gives
!> its room back by a word in it.
module brz_snapshots
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int, c_intptr_t, c_loc, c_null_ptr, &
        c_ptr, c_size_t
    use brz_buffers, only: buffer_t
    use brz_cuda_driver, only: cu_host_register, cu_host_unregister, cu_to_host
    use brz_kinds, only: dp, int64, int8
    use brz_memory, only: free_memory
    implicit none
    private
    public :: snapshot_t, use_snapshot, snapshot_in_use, read_snapshot, carry_on

    integer, parameter :: most_parts = 32
    integer, parameter :: most_rooms = 8
    integer(int64), parameter :: ahead = 4096 !! bytes before the first part: the word
    integer(int64), parameter :: line = 256 !! bytes: parts begin at a multiple

    !> Parts of the memory of the GPU, and the room that they are in.
    type :: snapshot_t
        integer :: n = 0 !! parts
        integer :: room = 0 !! 0: not taken
        integer(c_intptr_t) :: address(most_parts) = 0
        integer(int64) :: bytes(most_parts) = 0
        integer(int64) :: offset(most_parts) = 0 !! in the room
    contains
        procedure :: note, take, give_back
    end type snapshot_t

    type :: room_t
        type(c_ptr) :: memory = c_null_ptr
        integer(int64) :: bytes = 0
    end type room_t

    type(room_t), save :: rooms(most_rooms)
    type(snapshot_t), save :: used !! what this process reads in place of the GPU

    integer(c_int), parameter :: read_write = 3, shared_anonymous = 33 ! of Linux

    interface
        type(c_ptr) function c_map(where, bytes, access, flags, file, offset) bind(c, name='mmap')
            import :: c_int, c_ptr, c_size_t
            type(c_ptr), value :: where
            integer(c_size_t), value :: bytes, offset
            integer(c_int), value :: access, flags, file
        end function c_map
        integer(c_int) function c_unmap(where, bytes) bind(c, name='munmap')
            import :: c_int, c_ptr, c_size_t
            type(c_ptr), value :: where
            integer(c_size_t), value :: bytes
        end function c_unmap
    end interface

contains

    !> More parts of the snapshot, whole buffers; none where one holds nothing.
    subroutine note(self, buffers)
        class(snapshot_t), intent(inout) :: self
        type(buffer_t), intent(in) :: buffers(:)
        integer :: k

        do k = 1, size(buffers)
            if (buffers(k)%bytes == 0) cycle
            if (self%n == most_parts) error stop 'brz_snapshots: most_parts is too small'
            self%n = self%n + 1
            self%address(self%n) = buffers(k)%address
            self%bytes(self%n) = buffers(k)%bytes
            self%offset(self%n) = ahead
            if (self%n == 1) cycle
            associate (before => self%offset(self%n - 1) + self%bytes(self%n - 1))
                self%offset(self%n) = (before + line - 1)/line*line
            end associate
        end do
    end subroutine note

    !> Copy all parts from the GPU; waits for all work before. Not taken where there is no room, or
    !> the GPU has an error, which is met again by whoever asks it next.
    subroutine take(self)
        class(snapshot_t), intent(inout) :: self
        integer(int8), pointer, contiguous :: to(:)
        integer(c_int), pointer :: busy
        integer :: k, room

        self%room = 0
        if (self%n == 0) return
        room = free_room(self%offset(self%n) + self%bytes(self%n))
        if (room == 0) return
        call c_f_pointer(rooms(room)%memory, to, [rooms(room)%bytes])
        do k = 1, self%n
            if (cu_to_host(c_loc(to(self%offset(k) + 1)), self%address(k), &
                           int(self%bytes(k), c_size_t)) /= 0) return
        end do
        call c_f_pointer(rooms(room)%memory, busy)
        busy = 1
        self%room = room
    end subroutine take

    !> A room for so many bytes that nobody reads, 0 if there is none: one that is large enough,
    !> else the first is made anew, where the machine has memory for it.
    integer function free_room(bytes) result(room)
        integer(int64), intent(in) :: bytes
        integer :: k

        room = 0
        do k = 1, most_rooms
            if (is_busy(k)) cycle
            if (room == 0) room = k
            if (rooms(k)%bytes < bytes) cycle
            room = k
            return
        end do
        if (room == 0) return
        call make_room(rooms(room), bytes + bytes/8) ! what lists take grows
        if (rooms(room)%bytes == 0) room = 0
    end function free_room

    !> Give a room other memory; bytes = 0 where the machine has none.
    subroutine make_room(room, bytes)
        type(room_t), intent(inout) :: room
        integer(int64), intent(in) :: bytes
        integer(c_int) :: code

        if (room%bytes > 0) then
            code = cu_host_unregister(room%memory)
            code = c_unmap(room%memory, int(room%bytes, c_size_t))
        end if
        room%bytes = 0
        if (.not. 2.0_dp*bytes < free_memory()) return
        room%memory = c_map(c_null_ptr, int(bytes, c_size_t), read_write, shared_anonymous, &
                            -1_c_int, 0_c_size_t)
        if (transfer(room%memory, 0_c_intptr_t) == -1) return
        room%bytes = bytes
        code = cu_host_register(room%memory, int(bytes, c_size_t), 0_c_int)
    end subroutine make_room

    logical function is_busy(room)
        integer, intent(in) :: room
        integer(c_int), pointer :: busy

        is_busy = .false.
        if (rooms(room)%bytes == 0) return
        call c_f_pointer(rooms(room)%memory, busy)
        is_busy = busy /= 0
    end function is_busy

    !> Nobody reads the snapshot any more.
    subroutine give_back(self)
        class(snapshot_t), intent(inout) :: self
        integer(c_int), pointer :: busy

        if (self%room == 0) return
        call c_f_pointer(rooms(self%room)%memory, busy)
        busy = 0
        self%room = 0
    end subroutine give_back

    !> From now on what is read from the GPU comes from a snapshot; with one that is not taken from
    !> the GPU again.
    subroutine use_snapshot(snapshot)
        type(snapshot_t), intent(in) :: snapshot

        used = snapshot
    end subroutine use_snapshot

    logical function snapshot_in_use()
        snapshot_in_use = used%room > 0
    end function snapshot_in_use

    !> Copy a part of the snapshot in use, 0 if it is there: else 1, as for a wrong address.
    integer(c_int) function read_snapshot(to, address) result(code)
        integer(int8), intent(out), contiguous :: to(:)
        integer(c_intptr_t), intent(in) :: address !! on the GPU
        integer(int8), pointer, contiguous :: from(:)
        integer(int64) :: first
        integer :: k

        code = 1
        do k = 1, used%n
            first = address - used%address(k)
            if (first < 0 .or. first + size(to, kind=int64) > used%bytes(k)) cycle
            call c_f_pointer(rooms(used%room)%memory, from, [rooms(used%room)%bytes])
            first = used%offset(k) + first
            call carry_on(from(first + 1:first + size(to, kind=int64)), to)
            code = 0
            return
        end do
    end function read_snapshot

    !> Copy bytes, a piece by each thread.
    subroutine carry_on(from, to)
        integer(int8), intent(in), contiguous :: from(:)
        integer(int8), intent(out), contiguous :: to(:)
        integer(int64), parameter :: piece = 2_int64**18 ! that a thread takes at a time
        integer(int64) :: k, last

        !$omp parallel do private(last) if(size(to, kind=int64) > piece) schedule(static)
        do k = 1, size(to, kind=int64), piece
            last = min(k + piece - 1, size(to, kind=int64))
            to(k:last) = from(k:last)
        end do
    end subroutine carry_on
end module brz_snapshots
