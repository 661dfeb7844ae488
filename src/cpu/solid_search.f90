! SPDX-License-Identifier: MIT
!> Neighbour lists: who is within reach of a group of particles, itself or as a mirror image.
!>
!> A list depends on `x_built` and the order of the particles alone: rebuilt from them it is the
!> same, entry by entry. Each body has its list, and keeps it while those of others change. The
!> members of a group are in its list: a pair of i with itself is exactly nothing, as is one beyond
!> the support of the kernel. i may be a neighbour of its own image. Entries stand in the order of
!> the numbers of the particles (images: of the planes, then of the numbers), so the sums of a
!> particle depend neither on who shares its group nor on where particles are in memory.
module brz_solid_search
    use brz_body, only: body_t
    use brz_cell_grid, only: box_span, cell_of_groups, fill_cells, lay_grid, &
        number_of_cell, reach_of_lists
    use brz_formulation_names, only: form_rigid, form_total
    use brz_id_order, only: order_by_id, order_room_t
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_particle_groups, only: lanes
    use brz_particle_marks, only: is_gone
    use brz_solid_arrays, only: group_of
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: build_list

contains

    !> List of a body: those of total-Lagrangian bodies are of the unloaded places.
    subroutine build_list(solid, b)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b

        if (solid%bodies(b)%formulation == form_total) then
            call list_places(solid, b, solid%x_ref)
        else
            call list_places(solid, b, solid%x_built)
        end if
    end subroutine build_list

    !> List of a body for given places.
    subroutine list_places(solid, b, place)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp) :: reach

        reach = reach_of_lists(solid, b)
        associate (body => solid%bodies(b))
            if (body%last < body%first) return
            if (body%formulation == form_rigid) then
                call leave_out(solid, body)
            else
                call lay_grid(solid%search, place, solid%fixed, body, cell_of_groups(solid, b))
                call fill_cells(solid%search, place, solid%fixed, body)
                call list_body(solid, body, reach, place)
            end if
        end associate
    end subroutine list_places

    !> The particles of a rigid body have no neighbours.
    pure subroutine leave_out(solid, body)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body

        associate (from => group_of(body, body%first), to => group_of(body, body%last))
            solid%first(from + 1:to + 1) = solid%first(from)
            if (any(solid%mirror)) solid%image_first(from + 1:to + 1) = solid%image_first(from)
        end associate
    end subroutine leave_out

    !> Search for the neighbours of all groups of a body, or of the chosen ones. Every thread keeps
    !> what it finds for its groups, until the lengths of all lists are known.
    subroutine list_body(solid, body, reach, place)
        type(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: reach !! [m]
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer(int64), allocatable :: found(:), was(:), image_was(:)
        type(order_room_t) :: room
        integer(int64) :: n
        integer :: g, i, m

        if (body%cells%in_part) then
            was = solid%first
            if (any(solid%mirror)) image_was = solid%image_first
        end if
        !$omp parallel if(solid%n >= worth_threads) private(found, room, n, g, m)
        allocate (found(1024))
        n = 0
        !$omp do schedule(static)
        do i = body%first, body%last, lanes
            g = group_of(body, i)
            solid%first(g + 1) = 0
            if (any(solid%mirror)) solid%image_first(g + 1) = 0
            if (solid%fixed(i) == is_gone) cycle ! and so are all that follow
            if (body%cells%in_part) then
                if (.not. solid%search%chosen(g)) then
                    call keep_group(solid, g, was, image_was, found, n)
                    cycle
                end if
            end if
            solid%first(g + 1) = n
            call search_group(solid, place, members(body, place, i), 0, reach, room, &
                              found, n)
            solid%first(g + 1) = n - solid%first(g + 1)
            if (.not. any(solid%mirror)) cycle
            solid%image_first(g + 1) = n
            do m = 1, 7
                call search_group(solid, place, members(body, place, i), m, reach, room, &
                                  found, n)
            end do
            solid%image_first(g + 1) = n - solid%image_first(g + 1)
        end do
        !$omp single
        call lay_out(solid, group_of(body, body%first), group_of(body, body%last))
        !$omp end single
        n = 0
        !$omp do schedule(static)
        do i = body%first, body%last, lanes
            call store_group(solid, group_of(body, i), found, n)
        end do
        !$omp end parallel
    end subroutine list_body

    !> Append the lists that a group has.
    subroutine keep_group(solid, g, was, image_was, found, n)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: g
        integer(int64), intent(in) :: was(:), image_was(:) !! where lists lay
        integer(int64), allocatable, intent(inout) :: found(:) !! 8*particle + mask
        integer(int64), intent(inout) :: n !! entries
        integer(int64) :: k

        solid%first(g + 1) = was(g + 1) - was(g)
        do k = was(g), was(g + 1) - 1
            n = n + 1
            if (n > size(found, kind=int64)) call lengthen(found)
            found(n) = 8*int(solid%list(k), int64)
        end do
        if (.not. any(solid%mirror)) return
        solid%image_first(g + 1) = image_was(g + 1) - image_was(g)
        do k = image_was(g), image_was(g + 1) - 1
            n = n + 1
            if (n > size(found, kind=int64)) call lengthen(found)
            found(n) = 8*int(solid%image(k), int64) + solid%mask(k)
        end do
    end subroutine keep_group

    !> Lists begin where those of the group before end; there must be room for all.
    subroutine lay_out(solid, from, to)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: from, to !! groups of a body
        integer :: g

        do g = from, to
            solid%first(g + 1) = solid%first(g) + solid%first(g + 1)
        end do
        call fit(solid%first, from, to, solid%list)
        if (.not. any(solid%mirror)) return
        do g = from, to
            solid%image_first(g + 1) = solid%image_first(g) + solid%image_first(g + 1)
        end do
        call fit(solid%image_first, from, to, solid%image, solid%mask)
    end subroutine lay_out

    !> Make room for the lists of the groups from..to of a body. Those of the next body begin at
    !> first(to + 2), with something between; where that does not do, all behind moves back.
    subroutine fit(first, from, to, list, mask)
        integer(int64), intent(inout) :: first(:)
        integer, intent(in) :: from, to
        integer(int32), allocatable, intent(inout) :: list(:)
        integer(int8), allocatable, intent(inout), optional :: mask(:) !! entry by entry beside it
        integer(int64) :: end, k, more

        more = 0
        if (to + 2 <= size(first)) more = max(first(to + 1) - first(to + 2), 0_int64)
        if (more > 0) more = more + (first(to + 1) - first(from))/8
        end = first(size(first))
        call make_room(end + more - 1, list)
        if (present(mask)) call make_room_beside(list, mask)
        if (more == 0) return
        do k = end - 1, first(to + 2), -1
            list(k + more) = list(k)
            if (present(mask)) mask(k + more) = mask(k)
        end do
        first(to + 2:) = first(to + 2:) + more
    end subroutine fit

    !> Lengthen a mask to the length of the list beside it, keeping what it holds.
    subroutine make_room_beside(list, mask)
        integer(int32), intent(in) :: list(:)
        integer(int8), allocatable, intent(inout) :: mask(:)
        integer(int8), allocatable :: longer(:)

        if (.not. allocated(mask)) allocate (mask(size(list, kind=int64)))
        if (size(mask, kind=int64) == size(list, kind=int64)) return
        allocate (longer(size(list, kind=int64)))
        longer(:size(mask, kind=int64)) = mask
        call move_alloc(longer, mask)
    end subroutine make_room_beside

    !> Lengthen a list, with something to spare, keeping what it holds.
    subroutine make_room(n, list)
        integer(int64), intent(in) :: n
        integer(int32), allocatable, intent(inout) :: list(:)
        integer(int32), allocatable :: longer(:)

        if (.not. allocated(list)) allocate (list(n + n/8))
        if (size(list, kind=int64) >= n) return
        allocate (longer(n + n/8))
        longer(:size(list, kind=int64)) = list
        call move_alloc(longer, list)
    end subroutine make_room

    !> Bring what was found for a group, after entry n, into its lists.
    subroutine store_group(solid, g, found, n)
        type(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: g
        integer(int64), intent(in) :: found(:)
        integer(int64), intent(inout) :: n !! entries that are stored
        integer(int64) :: k

        do k = solid%first(g), solid%first(g + 1) - 1
            n = n + 1
            solid%list(k) = int(found(n)/8, int32)
        end do
        if (.not. any(solid%mirror)) return
        do k = solid%image_first(g), solid%image_first(g + 1) - 1
            n = n + 1
            solid%image(k) = int(found(n)/8, int32)
            solid%mask(k) = int(modulo(found(n), 8_int64), int8)
        end do
    end subroutine store_group

    !> Places of the members of the group that begins with particle `first`.
    pure function members(body, place, first) result(x)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer, intent(in) :: first
        real(dp) :: x(lanes, 3)
        integer :: l

        do l = 1, lanes
            x(l, :) = place(:, min(first + l - 1, body%last))
        end do
    end function members

    !> Append the particles whose image in the planes of the mask m is within reach of a group: all
    !> in one box, or where its members are far apart one after the other.
    pure subroutine search_group(solid, place, group, m, reach, room, found, n)
        type(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp), intent(in) :: group(lanes, 3) !! places of its members [m]
        integer, intent(in) :: m !! planes, bits 0..2; 0: the particles themselves
        real(dp), intent(in) :: reach !! [m]
        type(order_room_t), intent(inout) :: room
        integer(int64), allocatable, intent(inout) :: found(:) !! 8*particle + mask
        integer(int64), intent(inout) :: n !! entries
        real(dp) :: x(lanes, 3)
        integer(int64) :: before
        integer :: a, l

        x = group
        do a = 1, 3 ! the image of the group; none where all are too far from a plane
            if (.not. btest(m, a - 1)) cycle
            if (.not. solid%mirror(a)) return
            if (minval(x(:, a)) >= reach + solid%search%deep(a)) return
            x(:, a) = -x(:, a)
        end do
        before = n
        if (all(maxval(x, 1) - minval(x, 1) <= 2*reach)) then
            call search_box(solid, place, x, x(:0, :), reach, found, n)
        else
            do l = 1, lanes
                call search_box(solid, place, spread(x(l, :), 1, lanes), x(:l - 1, :), reach, &
                                found, n)
            end do
        end if
        call order_by_id(solid%id, 8_int64, found(before + 1:n), room)
        if (m > 0) found(before + 1:n) = found(before + 1:n) + m
    end subroutine search_group

    !> Append what is within reach of the places x, but of none of those that were searched before.
    pure subroutine search_box(solid, place, x, before, reach, found, n)
        type(listed_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp), intent(in) :: x(lanes, 3), before(:, :) !! [m]
        real(dp), intent(in) :: reach !! [m]
        integer(int64), allocatable, intent(inout) :: found(:) !! 8*particle
        integer(int64), intent(inout) :: n !! entries
        real(dp) :: low(3), high(3), middle(3), y(3), r2(lanes), round
        integer :: j, l, k, c, c1, c2, c3, lo(3), hi(3)

        low = minval(x, 1)
        high = maxval(x, 1)
        middle = (low + high)/2
        round = (norm2(high - low)/2 + reach)**2*(1 + 1e-9_dp) ! a ball that holds all
        call box_span(solid%search, middle, (high - low)/2 + reach, lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = number_of_cell(solid%search, c1, c2, c3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        j = solid%search%order(k)
                        y = place(:, j) - middle
                        if (y(1)*y(1) + y(2)*y(2) + y(3)*y(3) > round) cycle
                        y = place(:, j)
                        do l = 1, lanes
                            r2(l) = (x(l, 1) - y(1))**2 + (x(l, 2) - y(2))**2 + (x(l, 3) - y(3))**2
                        end do
                        if (least(r2) >= reach*reach) cycle
                        if (any((before(:, 1) - y(1))**2 + (before(:, 2) - y(2))**2 &
                                + (before(:, 3) - y(3))**2 < reach*reach)) cycle
                        n = n + 1
                        if (n > size(found, kind=int64)) call lengthen(found)
                        found(n) = 8*int(j, int64)
                    end do
                end do
            end do
        end do
    end subroutine search_box

    pure subroutine lengthen(found)
        integer(int64), allocatable, intent(inout) :: found(:)
        integer(int64), allocatable :: longer(:)

        allocate (longer(2*size(found, kind=int64)))
        longer(:size(found, kind=int64)) = found
        call move_alloc(longer, found)
    end subroutine lengthen

    !> Least of eight numbers, in pairs.
    pure real(dp) function least(q)
        real(dp), intent(in) :: q(lanes)

        least = min(min(min(q(1), q(5)), min(q(2), q(6))), min(min(q(3), q(7)), min(q(4), q(8))))
    end function least
end module brz_solid_search
