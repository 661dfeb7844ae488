! SPDX-License-Identifier: MIT
!> Parcels between the GPUs of several processes: written straight into each other's memory on one
!> machine (CUDA IPC), or by way of the host and MPI, which always works.
!>
!> Every process has an arena for what comes to it, in two halves that take turns. After each
!> exchange partners greet each other, both ways, so that nobody writes into a half before its
!> owner has unpacked what lay there. Where a GPU cannot see the memory of another one, or
!> BRISANCE_TRANSPORT=mpi is set, `linked` is false in all processes, and parcels go by the host.
module brz_gpu_peers
    use, intrinsic :: iso_c_binding, only: c_intptr_t
    use brz_buffers, only: buffer_t
    use brz_cuda_driver, only: cu_ipc_close, cu_ipc_export, cu_ipc_open, ipc_handle_t, ipc_lazily
    use brz_device, only: allocate_buffer, copy_in, copy_out, copy_within, free_buffer, &
        wait_for_device
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, int64
    use brz_mail, only: greet, mail_t, post, tell_counts
    use brz_ranks, only: agree, least_of_all, ranks_t, several
    implicit none
    private
    public :: peers_t

    integer(int64), parameter :: block = 2_int64**21
    !! bytes: the driver shares whole blocks of memory, so an arena fills its own
    integer(int64), parameter :: line = 256 !! bytes: where a half may begin

    type :: peers_t
        logical :: linked = .false. !! parcels go straight to the other GPUs
        integer :: turn = 0 !! half of the next exchange
        type(buffer_t) :: arena
        integer(int64), allocatable :: out(:) !! (0:processes) first element for each of them
        integer(c_intptr_t), allocatable :: place(:) !! (0:processes - 1) their arenas, 0: no parcel
        integer(int64), allocatable :: first(:) !! elements before the parcel of this process there
        integer(int64), allocatable :: half(:) !! bytes of a half of theirs
    contains
        procedure :: open, aim, close, swap
    end type peers_t

contains

    !> Link all processes for parcels of elements of up to `most` bytes; all must call.
    subroutine open (self, ranks, out, in, most, err, anew)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in) :: out(0:), in(0:) !! (0:processes) first element, from 1
        integer, intent(in) :: most
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: anew !! others may get parcels later, by `aim`
        type(ipc_handle_t) :: handle
        integer(int64), allocatable :: told(:, :), heard(:, :)
        integer(int64) :: half
        real(dp) :: good(1)
        integer :: r
        logical :: direct

        if (.not. several(ranks)) return
        allocate (told(10, 0:ranks%n - 1), heard(10, 0:ranks%n - 1))
        allocate (self%place(0:ranks%n - 1), source=0_c_intptr_t)
        half = ((in(ranks%n) - 1)*most + line - 1)/line*line
        call allocate_buffer(self%arena, max(2*half + block - 1, block)/block*block, err)
        direct = .not. by_mpi()
        if (ranks%here < ranks%n .or. failed(err)) direct = .false.
        if (direct) direct = cu_ipc_export(handle, self%arena%address) == 0
        good = merge(1, 0, direct)
        do r = 0, ranks%n - 1
            told(:, r) = [handle%word, in(r) - 1, half]
        end do
        call tell_counts(ranks, told, heard)
        call least_of_all(ranks, good) ! who has no handle is asked for nothing
        allocate (self%out(0:ranks%n), source=out)
        allocate (self%first(0:ranks%n - 1), source=heard(9, :))
        allocate (self%half(0:ranks%n - 1), source=heard(10, :))
        do r = 0, ranks%n - 1
            if (good(1) <= 0) cycle
            if (out(r + 1) == out(r) .and. .not. present(anew)) cycle
            self%place(r) = self%arena%address
            if (r == ranks%rank) cycle
            handle%word = heard(:8, r)
            if (cu_ipc_open(self%place(r), handle, ipc_lazily) == 0) cycle
            self%place(r) = 0
            good = 0
        end do
        call least_of_all(ranks, good)
        self%linked = .true.
        if (good(1) <= 0) call self%close(ranks)
    end subroutine open

    !> Other parcels from now on; all must call. Where one lacks room all link anew, with some to
    !> spare.
    subroutine aim(self, ranks, out, in, most, err)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in) :: out(0:), in(0:) !! (0:processes) first element, from 1
        integer, intent(in) :: most !! bytes of an element
        type(error_t), intent(inout) :: err
        integer(int64) :: told(2, 0:ranks%n - 1), heard(2, 0:ranks%n - 1)

        if (.not. self%linked) return
        told(1, :) = in(0:ranks%n - 1) - 1
        told(2, :) = merge(1, 0, (in(ranks%n) - 1)*most > self%half(ranks%rank))
        call tell_counts(ranks, told, heard)
        if (any(heard(2, :) > 0)) then
            call self%close(ranks)
            call self%open(ranks, out, in, most + most/2, err, anew=.true.)
        else
            self%first = heard(1, :)
            self%out = out
        end if
    end subroutine aim

    !> Let go of the memory of the others, then of this one's; all must call.
    subroutine close (self, ranks)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(error_t) :: none
        integer :: code, r

        if (.not. self%linked) return
        do r = 0, ranks%n - 1
            if (self%place(r) /= 0 .and. r /= ranks%rank) code = cu_ipc_close(self%place(r))
        end do
        call agree(ranks, none)
        call free_buffer(self%arena)
        deallocate (self%place, self%out, self%first, self%half)
        self%linked = .false.
    end subroutine close

    !> Bring every parcel to its process, and tell where those of others have come to. Who has an
    !> error takes part with what there is.
    subroutine swap(self, ranks, mail, bytes, parcels, came, err)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(mail_t), intent(inout) :: mail !! says how long the parcels are
        integer, intent(in) :: bytes !! of an element
        class(buffer_t), intent(in) :: parcels !! one after the other; room for those that come
        class(buffer_t), intent(inout) :: came !! its address is set
        type(error_t), intent(inout) :: err
        type(buffer_t) :: from, to
        integer :: r

        if (.not. self%linked) then
            call copy_out(parcels, mail%out, mail%out_first(ranks%n) - 1, err)
            call post(ranks, mail)
            call copy_in(mail%in, parcels, mail%in_first(ranks%n) - 1, err)
            came%address = parcels%address
            return
        end if
        do r = 0, ranks%n - 1
            if (self%out(r + 1) == self%out(r)) cycle
            from%address = parcels%address + (self%out(r) - 1)*bytes
            to%address = self%place(r) + self%turn*self%half(r) + self%first(r)*bytes
            call copy_within(from, to, (self%out(r + 1) - self%out(r))*bytes, err)
        end do
        call wait_for_device(err)
        call greet(ranks, mail)
        came%address = self%arena%address + self%turn*self%half(ranks%rank)
        self%turn = 1 - self%turn
    end subroutine swap

    !> Parcels are to go by the host.
    logical function by_mpi()
        character(8) :: value

        call get_environment_variable('BRISANCE_TRANSPORT', value)
        by_mpi = value == 'mpi'
    end function by_mpi
end module brz_gpu_peers
