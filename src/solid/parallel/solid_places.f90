! SPDX-License-Identifier: MIT
!> Places of particles that change processes: who takes which place.
module brz_solid_places
    use brz_kinds, only: int64
    use brz_places, only: find_firsts, message_buffers_t
    implicit none
    private
    public :: choose_places, lay_rooms, whole_lanes

    integer, parameter :: lane = 32 !! particles whose numbers of a column are in one row of memory

contains

    !> Where those that come are put, and which of the last particles take what is left of the
    !> places of those that leave: these moves are the message of a process to itself.
    pure subroutine choose_places(me, out, in, last, leaving, coming)
        integer, intent(in) :: me !! this process, from 0
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes)
        integer, intent(inout) :: last(:) !! (bodies) last particles, before and afterwards
        type(message_buffers_t), intent(inout) :: leaving !! message by message, body by body
        type(message_buffers_t), intent(out) :: coming !! in the same order
        integer, allocatable :: free(:), place(:), old(:), new(:)
        logical, allocatable :: is_free(:)
        integer :: at, b, come, i, k, m, n, r

        allocate (place(sum(in)), old(0), new(0))
        do b = 1, size(out, 1)
            come = int(sum(in(b, :)))
            n = last(b) + come - int(sum(out(b, :)))
            allocate (free(0))
            allocate (is_free(n + 1:last(b)), source=.false.)
            do r = 1, size(out, 2)
                at = leaving%first(r - 1) + int(sum(out(:b - 1, r)))
                associate (gone => leaving%place(at:at + int(out(b, r)) - 1))
                    is_free(pack(gone, gone > n)) = .true.
                    free = [free, pack(gone, gone <= n)]
                end associate
            end do
            free = [free, (i, i=last(b) + 1, n)]
            m = 0
            k = 1
            do r = 1, size(in, 2)
                at = k + int(sum(in(:b - 1, r)))
                place(at:at + int(in(b, r)) - 1) = free(m + 1:m + int(in(b, r)))
                m = m + int(in(b, r))
                k = k + int(sum(in(:, r)))
            end do
            new = [new, free(come + 1:)]
            old = [old, pack([(i, i=n + 1, last(b))], .not. is_free)]
            last(b) = n
            deallocate (free, is_free)
        end do
        call find_firsts(in, coming%first)
        coming%place = place
        call move(old, leaving)
        call move(new, coming)

    contains

        !> Put a message of this process to itself into a list that has none.
        pure subroutine move(places, list)
            integer, intent(in) :: places(:)
            type(message_buffers_t), intent(inout) :: list

            associate (at => list%first(me))
                list%place = [list%place(:at - 1), places, list%place(at:)]
            end associate
            list%first(me + 1:) = list%first(me + 1:) + size(places)
        end subroutine move
    end subroutine choose_places

    !> Places that fill whole rows of memory. Columns that begin with one are read by a warp of a
    !> GPU in as few rows as there are.
    pure integer function whole_lanes(n)
        integer, intent(in) :: n !! places that are needed

        whole_lanes = (n + lane - 1)/lane*lane
    end function whole_lanes

    !> Lay the places of all bodies one after the other, with room for so many in each, whole lanes.
    pure subroutine lay_rooms(need, first, last, rim, room, n)
        integer, intent(in) :: need(:) !! (bodies) places
        integer, intent(inout) :: first(:), last(:), rim(:), room(:) !! (bodies) see body_t
        integer, intent(out) :: n !! places of all
        integer :: b, shift

        n = 0
        do b = 1, size(need)
            if (need(b) > room(b)) room(b) = need(b) + need(b)/4 + 64
            room(b) = whole_lanes(room(b))
            shift = n + 1 - first(b)
            first(b) = first(b) + shift
            last(b) = last(b) + shift
            rim(b) = rim(b) + shift
            n = n + room(b)
        end do
    end subroutine lay_rooms
end module brz_solid_places
