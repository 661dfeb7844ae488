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
    use brz_device, only: allocate_buffer, copy_in, copy_out, free_buffer, &
        wait_for_device
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, int64
    use brz_mail, only: greet, mail_t, post, tell_counts
    use brz_ranks, only: agree, least_of_all, ranks_t, several
    implicit none
    private
    public :: peers_t, begins

    integer(int64), parameter :: block = 2_int64**21
    !! bytes: the driver shares whole blocks of memory, so an arena fills its own
    integer(int64), parameter :: line = 256 !! bytes: where a half may begin

    type :: peers_t
        logical :: linked = .false. !! parcels go straight to the other GPUs
        integer :: turn = 0 !! half of the next exchange
        integer(int64) :: half = 0 !! its bytes, in all processes
        type(buffer_t) :: arena
        integer(c_intptr_t), allocatable :: place(:) !! (0:processes - 1) the arenas of all
    contains
        procedure :: open, reserve, close, aim_at, swap
    end type peers_t

contains

    !> Where the parcels of this process begin in the arenas of others, and what an arena must hold:
    !> elements, from how many each process sends to each.
    pure subroutine begins(rank, number, there, most)
        integer, intent(in) :: rank !! this one
        integer(int64), intent(in) :: number(0:, 0:) !! (to, from)
        integer(int64), allocatable, intent(out) :: there(:) !! (0:processes - 1) before them
        integer(int64), intent(out) :: most

        allocate (there(0:ubound(number, 1)))
        there = sum(number(:, :rank - 1), dim=2)
        most = maxval(sum(number, dim=2))
    end subroutine begins

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
        allocate (self%place(0:ranks%n - 1), source=0_c_intptr_t)
        self%half = (bytes + line - 1)/line*line
        call allocate_buffer(self%arena, max(2*self%half + block - 1, block)/block*block, err)
        good = 0
        if (ranks%here == ranks%n .and. .not. (failed(err) .or. by_mpi())) &
            good = merge(1, 0, cu_ipc_export(handle, self%arena%address) == 0)
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
        if (good(1) <= 0) call self%close(ranks)
    end subroutine open

    !> Room for so many bytes in a half, the same in all processes. Where there is less all link
    !> anew, with some to spare.
    subroutine reserve(self, ranks, bytes, err)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err

        if (.not. self%linked .or. bytes <= self%half) return
        call self%close(ranks)
        call self%open(ranks, bytes + bytes/2, err)
    end subroutine reserve

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
        deallocate (self%place)
        self%linked = .false.
    end subroutine close

    !> Where a parcel to another process is to be written: into its arena, or, where parcels go by
    !> the host, into a row of them.
    subroutine aim_at(self, r, bytes, here, parcel)
        class(peers_t), intent(in) :: self
        integer, intent(in) :: r !! process
        integer(int64), intent(in) :: bytes !! before the parcel in the other arena
        class(buffer_t), intent(in) :: here !! its place in the row
        class(buffer_t), intent(inout) :: parcel !! its address is set

        parcel%address = here%address
        if (self%linked) parcel%address = self%place(r) + self%turn*self%half + bytes
    end subroutine aim_at

    !> Wait until every parcel that has been written is with its process, and tell where those of
    !> others have come to. Who has an error takes part with what there is.
    subroutine swap(self, ranks, mail, parcels, came, err)
        class(peers_t), intent(inout) :: self
        type(ranks_t), intent(in) :: ranks
        type(mail_t), intent(inout) :: mail !! says how long the parcels are
        class(buffer_t), intent(in) :: parcels
        !! where they go by the host: one after the other; room for those that come
        class(buffer_t), intent(inout) :: came !! its address is set
        type(error_t), intent(inout) :: err

        if (.not. self%linked) then
            call copy_out(parcels, mail%out, mail%out_first(ranks%n) - 1, err)
            call post(ranks, mail)
            call copy_in(mail%in, parcels, mail%in_first(ranks%n) - 1, err)
            came%address = parcels%address
            return
        end if
        call wait_for_device(err)
        call greet(ranks, mail)
        came%address = self%arena%address + self%turn*self%half
        self%turn = 1 - self%turn
    end subroutine swap

    !> Parcels are to go by the host.
    logical function by_mpi()
        character(8) :: value

        call get_environment_variable('BRISANCE_TRANSPORT', value)
        by_mpi = value == 'mpi'
    end function by_mpi
end module brz_gpu_peers
