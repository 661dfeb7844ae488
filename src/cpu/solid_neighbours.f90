! SPDX-License-Identifier: MIT
!> Neighbour lists: who is within reach of a group of particles, itself or as a mirror image.
!>
!> A list depends on `x_built` and the order of the particles alone: rebuilt from them it is the
!> same, entry by entry. The members of a group are in its list: a pair of i with itself is exactly
!> nothing, as is one beyond the support of the kernel. i may be a neighbour of its own image.
module brz_solid_neighbours
    use brz_cell_grid, only: box_span, cell_of_groups, fill_cells, lay_grid, reach_of_lists
    use brz_kinds, only: dp, int32, int64, int8
    use brz_particle_order, only: reorder_particles
    use brz_solid_lanes, only: group_of
    use brz_solid_links, only: build_links
    use brz_solid_state, only: body_t, form_rigid, form_total, lanes, solid_t, worth_threads
    implicit none
    private
    public :: build_neighbours, needs_rebuild

contains

    !> Build the list. With `sort`, the particles are first brought into the order of the cells
    !> at their present positions; without, the list of the positions `x_built` is restored.
    subroutine build_neighbours(solid, sort)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: sort
        integer :: b

        if (sort) then
            do b = 1, size(solid%bodies)
                call note_positions(solid, solid%bodies(b))
                call lay_grid(solid%search, solid%x_built, solid%bodies(b), &
                              cell_of_groups(solid, b))
                call fill_cells(solid%search, solid%x_built, solid%bodies(b))
            end do
            call reorder_particles(solid)
            do b = 1, size(solid%bodies)
                call note_positions(solid, solid%bodies(b))
            end do
        end if
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%formulation == form_total) then
                call build_list(solid, b, solid%x_ref)
            else
                call build_list(solid, b, solid%x_built)
            end if
        end do
        call build_links(solid)
    end subroutine build_neighbours

    !> List of a body for given places: those of total-Lagrangian bodies are the unloaded ones.
    subroutine build_list(solid, b, place)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp) :: reach

        reach = reach_of_lists(solid, b)
        associate (body => solid%bodies(b))
            call lay_grid(solid%search, place, body, cell_of_groups(solid, b))
            call fill_cells(solid%search, place, body)
            call count_body(solid, body, reach, place)
            call make_room(solid%first(group_of(body, body%last) + 1) - 1, solid%list)
            if (any(solid%mirror)) call make_room_for_images(solid, body)
            call fill_body(solid, body, reach, place)
        end associate
    end subroutine build_list

    !> Positions that decide on the neighbours of a body: a total-Lagrangian body that meets no
    !> other keeps the unloaded ones, and with them its order and its list.
    subroutine note_positions(solid, body)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body

        associate (first => body%first, last => body%last)
            if (body%formulation == form_total .and. .not. solid%links%present) then
                solid%x_built(:, first:last) = solid%x_ref(:, first:last)
            else
                solid%x_built(:, first:last) = solid%x(:, first:last)
            end if
        end associate
    end subroutine note_positions

    !> True when a particle has moved more than half the skin since the list was built.
    logical function needs_rebuild(solid)
        type(solid_t), intent(in) :: solid
        real(dp) :: far, d(3)
        integer :: i, k

        far = 0
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i, d) &
        !$omp reduction(max: far)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                if (body%asleep) cycle
                if (body%formulation == form_total .and. .not. solid%links%present) cycle
            end associate
            do i = solid%block(2, k), solid%block(3, k)
                d = solid%x(:, i) - solid%x_built(:, i)
                far = max(far, d(1)*d(1) + d(2)*d(2) + d(3)*d(3))
            end do
        end do
        needs_rebuild = far > (solid%skin/2)**2
    end function needs_rebuild

    !> Lengths of the lists of a body, as running sums in `first` and `image_first`.
    subroutine count_body(solid, body, reach, place)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: reach !! [m]
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer :: g, i

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(g)
        do i = body%first, body%last, lanes
            g = group_of(body, i)
            call count_group(solid, body, place, i, reach, solid%first(g + 1), 0, 0)
            if (any(solid%mirror)) &
                call count_group(solid, body, place, i, reach, solid%image_first(g + 1), 1, 7)
        end do
        do g = group_of(body, body%first), group_of(body, body%last)
            solid%first(g + 1) = solid%first(g) + solid%first(g + 1)
            if (any(solid%mirror)) &
                solid%image_first(g + 1) = solid%image_first(g) + solid%image_first(g + 1)
        end do
    end subroutine count_body

    !> Neighbours of the group that begins with particle `first`, of the images m1..m2.
    subroutine count_group(solid, body, place, first, reach, n, m1, m2)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer, intent(in) :: first
        real(dp), intent(in) :: reach !! [m]
        integer(int64), intent(out) :: n
        integer, intent(in) :: m1, m2 !! masks; 0: the particles themselves
        integer(int32) :: none(1)
        integer :: m

        n = 0
        if (body%formulation == form_rigid) return
        do m = m1, m2
            call search_group(solid, place, members(body, place, first), m, reach, .false., none, n)
        end do
    end subroutine count_group

    subroutine fill_body(solid, body, reach, place)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: reach !! [m]
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp) :: x(lanes, 3)
        integer(int64) :: at, next
        integer :: i, m

        if (body%formulation == form_rigid) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(x, at, next, m)
        do i = body%first, body%last, lanes
            x = members(body, place, i)
            at = solid%first(group_of(body, i)) - 1
            call search_group(solid, place, x, 0, reach, .true., solid%list, at)
            if (.not. any(solid%mirror)) cycle
            at = solid%image_first(group_of(body, i)) - 1
            do m = 1, 7
                next = at
                call search_group(solid, place, x, m, reach, .true., solid%image, next)
                solid%mask(at + 1:next) = int(m, int8)
                at = next
            end do
        end do
    end subroutine fill_body

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

    !> Append to `list`, or only count, the particles whose image in the planes of the mask m is
    !> within reach of a group: all in one box, or where its members are far apart one after the
    !> other.
    pure subroutine search_group(solid, place, group, m, reach, keep, list, last)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp), intent(in) :: group(lanes, 3) !! places of its members [m]
        integer, intent(in) :: m !! planes, bits 0..2; 0: the particles themselves
        real(dp), intent(in) :: reach !! [m]
        logical, intent(in) :: keep !! false: only count
        integer(int32), intent(inout) :: list(*)
        integer(int64), intent(inout) :: last !! last entry that is filled
        real(dp) :: x(lanes, 3)
        integer :: a, l

        x = group
        do a = 1, 3 ! the image of the group; none where no member is near a plane
            if (.not. btest(m, a - 1)) cycle
            if (.not. solid%mirror(a) .or. minval(x(:, a)) >= reach) return
            x(:, a) = -x(:, a)
        end do
        if (all(maxval(x, 1) - minval(x, 1) <= 2*reach)) then
            call search_box(solid, place, x, x(:0, :), reach, keep, list, last)
        else
            do l = 1, lanes
                call search_box(solid, place, spread(x(l, :), 1, lanes), x(:l - 1, :), reach, &
                                keep, list, last)
            end do
        end if
    end subroutine search_group

    !> Append to `list`, or only count, what is within reach of the places x, but of none of those
    !> that were searched before.
    pure subroutine search_box(solid, place, x, before, reach, keep, list, last)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        real(dp), intent(in) :: x(lanes, 3), before(:, :) !! [m]
        real(dp), intent(in) :: reach !! [m]
        logical, intent(in) :: keep !! false: only count
        integer(int32), intent(inout) :: list(*)
        integer(int64), intent(inout) :: last !! last entry that is filled
        real(dp) :: low(3), high(3), middle(3), y(3), r2(lanes), round
        integer :: l, k, c, c1, c2, c3, lo(3), hi(3)

        low = minval(x, 1)
        high = maxval(x, 1)
        middle = (low + high)/2
        round = (norm2(high - low)/2 + reach)**2*(1 + 1e-9_dp) ! a ball that holds all
        call box_span(solid%search, middle, (high - low)/2 + reach, lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = solid%search%code(c1, 1) + solid%search%code(c2, 2) &
                        + solid%search%code(c3, 3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        y = place(:, solid%search%order(k))
                        if (sum((y - middle)**2) > round) cycle
                        do l = 1, lanes
                            r2(l) = (x(l, 1) - y(1))**2 + (x(l, 2) - y(2))**2 + (x(l, 3) - y(3))**2
                        end do
                        if (least(r2) >= reach*reach) cycle
                        if (any((before(:, 1) - y(1))**2 + (before(:, 2) - y(2))**2 &
                                + (before(:, 3) - y(3))**2 < reach*reach)) cycle
                        last = last + 1
                        if (keep) list(last) = solid%search%order(k)
                    end do
                end do
            end do
        end do
    end subroutine search_box

    !> Least of eight numbers, in pairs.
    pure real(dp) function least(q)
        real(dp), intent(in) :: q(lanes)

        least = min(min(min(q(1), q(5)), min(q(2), q(6))), min(min(q(3), q(7)), min(q(4), q(8))))
    end function least

    !> Lengthen the list, with something to spare, keeping what it holds.
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

    !> The same for images and their masks.
    subroutine make_room_for_images(solid, body)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer(int8), allocatable :: mask(:)
        integer(int64) :: n

        n = solid%image_first(group_of(body, body%last) + 1) - 1
        call make_room(n, solid%image)
        if (.not. allocated(solid%mask)) allocate (solid%mask(size(solid%image, kind=int64)))
        if (size(solid%mask, kind=int64) >= n) return
        allocate (mask(size(solid%image, kind=int64)))
        mask(:size(solid%mask, kind=int64)) = solid%mask
        call move_alloc(mask, solid%mask)
    end subroutine make_room_for_images
end module brz_solid_neighbours
