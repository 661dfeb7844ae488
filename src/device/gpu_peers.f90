! SPDX-License-Identifier: MIT
!> Messages between the GPUs of several processes: written straight into each other's memory on one
!> machine (CUDA IPC), or by way of the host and MPI, which always works.
!>
!> Every process has an arena for what comes to it, in two halves that take turns. In each exchange
!> all processes greet each other, or vote, after their GPUs have written the messages and before
!> any is unpacked. So nobody writes into a half before its owner has unpacked what lay there.
!> Where a GPU cannot see the memory of another one, or BRISANCE_TRANSPORT=mpi is set, `linked` is
!> false in all processes, and messages go by the host.
module brz_gpu_peers
    use, intrinsic :: iso_c_binding, only: c_intptr_t
    use brz_buffers, only: buffer_t
    use brz_cuda_driver, only: cu_ipc_close, cu_ipc_export, cu_ipc_open, ipc_handle_t, ipc_lazily
    use brz_device, only: allocate_buffer, copy_in, copy_out, free_buffer, reserve_buffer, &
        wait_for_device
    use brz_device_events, only: event_t, record_event, wait_for_event
    use brz_errors, only: error_t, failed
    use brz_lists, only: put_changed_table
    use brz_kinds, only: dp, int64
    use brz_message_exchange, only: greet, message_exchange_t, make_room, post, tell_counts
    use brz_place_loop_bodies, only: tile
    use brz_places, only: message_buffers_t
    use brz_ranks, only: reduce_errors, least_of_all, ranks_t, several
    implicit none
    private
    public :: peers_t

    integer(int64), parameter :: block = 2_int64**21
    !! bytes: the driver shares whole blocks of memory, so an arena fills its own
    integer(int64), parameter :: line = 256 !! bytes: where a half may begin

    type :: peers_t
        type(ranks_t) :: ranks
        logical :: linked = .false. !! messages go straight to the other GPUs
        integer :: turn = 0 !! half of the next exchange
        integer(int64) :: half = 0 !! its bytes, in all processes
        type(buffer_t) :: arena
        integer(c_intptr_t), allocatable :: place(:) !! (0:processes - 1) the arenas of all
        type(event_t) :: written !! the messages of this exchange are
        type(message_exchange_t) :: exchange
        type(buffer_t) :: words !! of messages, where they go by the host
    contains
        procedure :: open, close, aim, begin, finish, swap
    end type peers_t

contains

    !> Link all processes, with halves of so many bytes in all of them; all must call.
    subroutine open (self, ranks, bytes, err)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in) :: bytes !! the same in all processes
        type(error_t), intent(inout) :: err
        type(ipc_handle_t) :: handle
        integer(int64), dimension(8, 0:ranks%n - 1) :: told, heard
        real(dp) :: good(1)
        integer :: r

        if (.not. several(ranks)) return
        self%ranks = ranks
        allocate (self%place(0:ranks%n - 1), source=0_c_intptr_t)
        self%half = (bytes + line - 1)/line*line
        call allocate_buffer(self%arena, max(2*self%half + block - 1, block)/block*block, err)
        call wait_for_device(err) ! it is zero before anybody writes there
        good = 0
        if (ranks%here == ranks%n .and. .not. failed(err)) then
            if (.not. by_mpi()) good = merge(1, 0, cu_ipc_export(handle, self%arena%address) == 0)
        end if
        told = spread(handle%word, 2, ranks%n)
        call tell_counts(ranks, told, heard)
        call least_of_all(ranks, good) ! who has no handle is asked for nothing
        self%place(ranks%rank) = self%arena%address
        do r = 0, ranks%n - 1
            handle%word = heard(:, r)
            if (good(1) <= 0 .or. r == ranks%rank) cycle
            if (cu_ipc_open(self%place(r), handle, ipc_lazily) == 0) cycle
            self%place(r) = 0
            good = 0
        end do
        call least_of_all(ranks, good)
        self%linked = .true.
        if (good(1) <= 0) call self%close()
    end subroutine open

    !> Let go of the memory of the others, then of this one's; all must call.
    subroutine close (self)
        class(peers_t), intent(inout) :: self
        type(error_t) :: none
        integer :: code, r

        if (.not. self%linked) return
        do r = 0, self%ranks%n - 1
            if (self%place(r) /= 0 .and. r /= self%ranks%rank) code = cu_ipc_close(self%place(r))
        end do
        call reduce_errors(self%ranks, none)
        call free_buffer(self%arena)
        deallocate (self%place)
        self%linked = .false.
    end subroutine close

    !> Get ready to send a list of which all processes know how many entries go from each to each;
    !> all must call. Where halves are too short for it all link anew, with some to spare.
    subroutine aim(self, number, bytes, list, err)
        class(peers_t), intent(inout) :: self
        integer(int64), intent(in) :: number(:, :) !! (to processes, from processes)
        integer, intent(in) :: bytes !! of an entry at most
        type(message_buffers_t), intent(inout) :: list
        type(error_t), intent(inout) :: err
        integer(int64), dimension(0:size(number, 1) - 1, 0:size(number, 1) - 1) :: tiled
        integer(int64) :: half
        integer :: r

        tiled = in_tiles(number)
        do r = 0, merge(-1, self%ranks%n - 1, list%all)
            tiled(r, r) = 0
        end do
        if (.not. allocated(list%there)) allocate (list%there(0:self%ranks%n - 1))
        list%there = sum(tiled(:, :self%ranks%rank - 1), dim=2)
        half = bytes*maxval(sum(tiled, dim=2))
        if (.not. self%linked .or. half <= self%half) return
        call self%close()
        call self%open(self%ranks, half + half/2, err)
    end subroutine aim

    !> Begin an exchange of entries of so many bytes: messages go from a list, which all have aimed,
    !> to the other one, and are written and read from `row` on.
    subroutine begin(self, out, in, bytes, row, err)
        class(peers_t), intent(inout) :: self
        type(message_buffers_t), intent(inout) :: out, in
        integer, intent(in) :: bytes
        class(buffer_t), intent(inout) :: row !! its address is set
        type(error_t), intent(inout) :: err
        integer(int64), dimension(self%ranks%n) :: goes, comes

        call tell_messages(self, out, goes, err)
        call tell_messages(self, in, comes, err)
        call make_room(self%ranks, bytes*goes, bytes*comes, self%exchange, elsewhere=self%linked)
        row%address = self%arena%address + self%turn*self%half
        if (self%linked) return
        call reserve_buffer(self%words, bytes*max(sum(goes), sum(comes)), err)
        row%address = self%words%address
    end subroutine begin

    !> The kernel that writes the messages has been launched.
    subroutine finish(self, err)
        class(peers_t), intent(inout) :: self
        type(error_t), intent(inout) :: err

        if (self%linked) call record_event(self%written, err)
    end subroutine finish

    !> Tell kernels where the messages of a list lie, see brz_place_loop_bodies.
    subroutine tell_messages(self, list, tiled, err)
        class(peers_t), intent(in) :: self
        type(message_buffers_t), intent(inout) :: list
        integer(int64), intent(out) :: tiled(0:) !! (processes) places in the tiles of each message
        type(error_t), intent(inout) :: err
        integer(int64) :: before, message(5, 0:ubound(tiled, 1))
        integer :: r

        before = 0
        do r = 0, ubound(tiled, 1)
            tiled(r) = in_tiles(int(list%first(r + 1) - list%first(r), int64))
            if (r == self%ranks%rank .and. .not. list%all) tiled(r) = 0
            message(:3, r) = [before + tiled(r), list%first(r) - before, &
                             int(list%first(r + 1) - 1, int64)]
            message(4:, r) = 0
            if (self%linked .and. allocated(list%there)) &
                message(4:, r) = [self%place(r) - self%arena%address, list%there(r) - before]
            before = before + tiled(r)
        end do
        list%tiled = int(before)
        call put_changed_table(transfer(message, [0]), list%messages_there, list%messages, err)
    end subroutine tell_messages

    !> Entries, rounded up to whole tiles.
    elemental integer(int64) function in_tiles(n)
        integer(int64), intent(in) :: n

        in_tiles = (n + tile - 1)/tile*tile
    end function in_tiles

    !> Wait until every message that has been written is with its process, and those of others are
    !> here. Who has an error takes part with what there is.
    subroutine swap(self, met, err)
        class(peers_t), intent(inout) :: self
        logical, intent(in) :: met !! all processes have since their GPUs had written the messages
        type(error_t), intent(inout) :: err

        associate (ranks => self%ranks, exchange => self%exchange)
            if (self%linked) then
                if (.not. met) call wait_for_event(self%written, err)
                if (.not. met) call greet(ranks)
                self%turn = 1 - self%turn
            else
                call copy_out(self%words, exchange%out, exchange%out_first(ranks%n) - 1, err)
                call post(ranks, exchange)
                call copy_in(exchange%in, self%words, exchange%in_first(ranks%n) - 1, err)
            end if
        end associate
    end subroutine swap

    !> Messages are to go by the host.
    logical function by_mpi()
        character(8) :: value

        call get_environment_variable('BRISANCE_TRANSPORT', value)
        by_mpi = value == 'mpi'
    end function by_mpi
end module brz_gpu_peers
