! SPDX-License-Identifier: MIT
!> Send lists: places whose particles, cells or faces are in a message, process by process.
module brz_places
    use brz_buffers, only: buffer_t
    use brz_kinds, only: int32, int64
    implicit none
    private
    public :: message_buffers_t, marks_t, find_firsts, find_joined, find_pieces

    !> What is in a message: message r is entries first(r) to first(r + 1) - 1.
    type :: message_buffers_t
        integer(int32), allocatable :: place(:) !! of the particles
        integer, allocatable :: first(:) !! (0:processes)
        ! on a GPU; what a process has for itself mostly goes from array to array there
        integer(int64), allocatable :: there(:)
        !! (0:processes - 1) entries in the other arena before those of this process
        logical :: all = .false. !! what a process has for itself goes the same way
        integer, allocatable :: run(:, :)
        !! (2, runs) first place and number of what it has for itself, where that lies in few runs
        integer :: tiled = 0 !! places in the tiles of all messages
        type(buffer_t) :: messages !! what kernels know of them, see brz_place_loop_bodies
        integer, allocatable :: messages_there(:) !! what the GPU has of that
    end type message_buffers_t

    !> What lists are made of, see brz_send_lists.
    type :: marks_t
        integer(int32), allocatable :: mark(:) !! (places, processes)
        integer(int32), allocatable :: sent(:) !! (places, processes) 1: listed before, if kept
        integer(int32), allocatable :: joined(:) !! two lists in one
        integer(int32), allocatable :: before(:) !! chunks of marks: how many are marked before
        integer(int32), allocatable :: ends(:), sums(:) !! of bodies, in a row; marks before them
        integer(int32), allocatable :: pieces(:), asks(:) !! small tables
        integer, allocatable :: ends_there(:) !! what a GPU has of them
    end type marks_t

contains

    !> First entry of the message of each process.
    pure subroutine find_firsts(number, first)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, allocatable, intent(inout) :: first(:) !! (0:processes)
        integer :: r

        if (.not. allocated(first)) allocate (first(0:size(number, 2)))
        first(0) = 1
        do r = 1, size(number, 2)
            first(r) = first(r - 1) + int(sum(number(:, r)))
        end do
    end subroutine find_firsts

    !> Pieces of a list of what comes, process by process: that of a process and body is one.
    pure subroutine find_pieces(number, before, piece)
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        integer, intent(inout) :: before(:) !! (bodies) places that are taken; these ones, too, then
        integer, intent(out) :: piece(:, :) !! (2, pieces) last entry, what an entry is short of
        integer :: b, k, n, r

        n = 0
        k = 0
        do r = 1, size(number, 2)
            do b = 1, size(number, 1)
                k = k + 1
                piece(2, k) = before(b) - n
                n = n + int(number(b, r))
                before(b) = before(b) + int(number(b, r))
                piece(1, k) = n
            end do
        end do
    end subroutine find_pieces

    !> Pieces of a list that is made of two, process by process and body by body: what is kept of
    !> the first, then that of the second.
    pure subroutine find_joined(was, kept, number, piece)
        integer(int64), intent(in) :: was(:, :), number(:, :) !! (bodies, processes) in both lists
        logical, intent(in) :: kept(:) !! (bodies) else what the first one has is left out
        integer, intent(out) :: piece(:, :) !! (2, pieces) last entry, what an entry is short of
        integer :: b, k, n, r, taken(2)

        n = 0
        k = 0
        taken = 0
        do r = 1, size(was, 2)
            do b = 1, size(was, 1)
                piece(2, k + 1) = taken(1) - n
                if (kept(b)) n = n + int(was(b, r))
                piece(1, k + 1) = n
                piece(2, k + 2) = taken(2) - n
                n = n + int(number(b, r))
                piece(1, k + 2) = n
                taken = taken + int([was(b, r), number(b, r)])
                k = k + 2
            end do
        end do
    end subroutine find_joined
end module brz_places
