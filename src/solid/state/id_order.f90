! SPDX-License-Identifier: MIT
!> Particles in the order of their numbers. Pairs are summed in this order, so that a sum depends
!> neither on the order of the particles in memory nor on who else is there.
module brz_id_order
    use brz_kinds, only: int32, int64
    implicit none
    private
    public :: order_by_id, order_room_t

    integer(int64), parameter :: low_bits = 2_int64**32 - 1

    !> Work arrays, kept from one use to the next.
    type :: order_room_t
        integer(int64), allocatable :: key(:, :) !! (entries and one more, 2)
        integer, allocatable :: run(:) !! first entries of the runs that are in order
    end type order_room_t

contains

    !> Bring entries, each `unit` times the place of a particle, into the order of the numbers of
    !> these particles. Runs that are in order already are merged (each once per level), without
    !> branches that a processor could guess wrong.
    pure subroutine order_by_id(id, unit, entries, room)
        integer(int32), intent(in) :: id(:) !! numbers of the particles
        integer(int64), intent(in) :: unit
        integer(int64), intent(inout) :: entries(:)
        type(order_room_t), intent(inout) :: room
        integer :: k, n, runs, side

        n = size(entries)
        if (n < 2) return
        call make_room(n, room)
        runs = 0
        do k = 1, n
            room%key(k, 1) = ior(shiftl(int(id(entries(k)/unit), int64), 32), entries(k)/unit)
            if (k > 1) then
                if (room%key(k, 1) > room%key(k - 1, 1)) cycle
            end if
            runs = runs + 1
            room%run(runs) = k
        end do
        if (runs == 1) return
        side = 1
        do while (runs > 1)
            room%run(runs + 1) = n + 1
            do k = 1, runs, 2
                call merge_runs(room%run(k), room%run(k + 1), room%run(min(k + 2, runs + 1)), &
                                room%key(:, side), room%key(:, 3 - side))
                room%run((k + 1)/2) = room%run(k)
            end do
            runs = (runs + 1)/2
            side = 3 - side
        end do
        entries = iand(room%key(:n, side), low_bits)*unit
    end subroutine order_by_id

    pure subroutine make_room(n, room)
        integer, intent(in) :: n
        type(order_room_t), intent(inout) :: room

        if (allocated(room%run)) then
            if (size(room%run) > n + 1) return
            deallocate (room%key, room%run)
        end if
        allocate (room%key(2*n + 2, 2), source=0_int64)
        allocate (room%run(2*n + 2))
    end subroutine make_room

    !> Merge the runs from..middle-1 and middle..last-1.
    pure subroutine merge_runs(from, middle, last, old, new)
        integer, intent(in) :: from, middle, last
        integer(int64), intent(in), contiguous :: old(:) !! with one entry more than `last`
        integer(int64), intent(inout), contiguous :: new(:)
        integer :: i, j, k
        logical :: first

        i = from
        j = middle
        do k = from, last - 1
            first = (old(i) < old(j) .and. i < middle) .or. j >= last
            new(k) = merge(old(i), old(j), first)
            i = i + merge(1, 0, first)
            j = j + merge(0, 1, first)
        end do
    end subroutine merge_runs
end module brz_id_order
