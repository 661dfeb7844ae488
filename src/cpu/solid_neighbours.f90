! SPDX-License-Identifier: MIT
!> Neighbour lists: who is within reach of a particle, itself or as a mirror image.
!>
!> A list depends on `x_built` and the order of the particles alone: rebuilt from them it is the
!> same, entry by entry. Images of a particle follow its direct neighbours; i may be a neighbour of
!> its own image. Both parts are padded with i itself, whose pair with i is exactly nothing.
module brz_solid_neighbours
    use brz_cell_grid, only: cell_span, fill_cells, lay_grid, reach_of_lists
    use brz_kinds, only: dp, int32, int64, int8
    use brz_particle_order, only: reorder_particles
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
                              reach_of_lists(solid, b))
                call fill_cells(solid%search, solid%x_built, solid%bodies(b))
            end do
            call reorder_particles(solid)
            do b = 1, size(solid%bodies)
                call note_positions(solid, solid%bodies(b))
            end do
        end if
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%formulation == form_total) then
                call build_list(solid, solid%bodies(b), reach_of_lists(solid, b), solid%x_ref)
            else
                call build_list(solid, solid%bodies(b), reach_of_lists(solid, b), solid%x_built)
            end if
        end do
        call build_links(solid)
    end subroutine build_neighbours

    !> List of a body for given places: those of total-Lagrangian bodies are the unloaded ones.
    subroutine build_list(solid, body, reach, place)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: reach !! [m]
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]

        call lay_grid(solid%search, place, body, reach)
        call fill_cells(solid%search, place, body)
        call count_body(solid, body, reach, place)
        call make_room(solid, solid%first(body%last + 1) - 1)
        call fill_body(solid, body, reach, place)
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

    !> Lengths of the lists of a body, as running sums in `first`, and of their parts in `direct`.
    subroutine count_body(solid, body, reach, place)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: reach !! [m]
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer(int64) :: last
        integer :: i, m
        integer(int32) :: none(1)

        if (body%first == 1) solid%first(1) = 1
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(m, last, none)
        do i = body%first, body%last
            last = 0
            if (body%formulation == form_rigid) then
                solid%direct(i) = 0
                solid%first(i + 1) = 0
                cycle
            end if
            call search(solid, place, i, 0, reach, .false., none, last)
            solid%direct(i) = int(round_up(last), int32)
            last = 0
            do m = 1, 7
                if (image_in_reach(solid, place(:, i), m, reach)) &
                    call search(solid, place, i, m, reach, .false., none, last)
            end do
            solid%first(i + 1) = round_up(last)
        end do
        do i = body%first, body%last
            solid%first(i + 1) = solid%first(i) + solid%direct(i) + solid%first(i + 1)
        end do
    end subroutine count_body

    !> Next multiple of the lanes.
    pure integer(int64) function round_up(n)
        integer(int64), intent(in) :: n

        round_up = (n + lanes - 1)/lanes*lanes
    end function round_up

    !> Lengthen the list, with something to spare, keeping what it holds.
    subroutine make_room(solid, n)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: n
        integer(int32), allocatable :: list(:)
        integer(int8), allocatable :: mask(:)
        integer(int64) :: have

        have = 0
        if (allocated(solid%list)) have = size(solid%list, kind=int64)
        if (have >= n) return
        allocate (list(n + n/8), mask(n + n/8))
        if (have > 0) list(:have) = solid%list
        if (have > 0) mask(:have) = solid%mask
        call move_alloc(list, solid%list)
        call move_alloc(mask, solid%mask)
    end subroutine make_room

    subroutine fill_body(solid, body, reach, place)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: reach !! [m]
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer(int64) :: at, image, next
        integer :: i, m

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(m, at, image, next)
        do i = body%first, body%last
            at = solid%first(i) - 1
            if (body%formulation == form_rigid) cycle
            call search(solid, place, i, 0, reach, .true., solid%list, at)
            image = solid%first(i) + solid%direct(i)
            solid%list(at + 1:image - 1) = i
            solid%mask(solid%first(i):image - 1) = 0
            at = image - 1
            do m = 1, 7
                if (.not. image_in_reach(solid, place(:, i), m, reach)) cycle
                next = at
                call search(solid, place, i, m, reach, .true., solid%list, next)
                solid%mask(at + 1:next) = int(m, int8)
                at = next
            end do
            solid%list(at + 1:solid%first(i + 1) - 1) = i
            solid%mask(at + 1:solid%first(i + 1) - 1) = 0
        end do
    end subroutine fill_body

    !> True where the planes of the mask m exist and the place x is near all of them.
    pure logical function image_in_reach(solid, x, m, reach)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: m
        real(dp), intent(in) :: x(3), reach !! [m]
        integer :: a

        image_in_reach = .true.
        do a = 1, 3
            if (.not. btest(m, a - 1)) cycle
            image_in_reach = image_in_reach .and. solid%mirror(a) .and. x(a) < reach
        end do
    end function image_in_reach

    !> Append to `list`, or only count, the particles near the image of i in the planes of m.
    pure subroutine search(solid, place, i, m, reach, keep, list, last)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: place(:, :) !! (3, n) [m]
        integer, intent(in) :: i
        integer, intent(in) :: m !! planes, bits 0..2; 0: i itself
        real(dp), intent(in) :: reach !! [m]
        logical, intent(in) :: keep !! false: only count
        integer(int32), intent(inout) :: list(*)
        integer(int64), intent(inout) :: last !! last entry that is filled
        real(dp) :: x(3), d(3)
        integer :: a, j, k, c, c1, c2, c3, lo(3), hi(3)

        x = place(:, i)
        do a = 1, 3
            if (btest(m, a - 1)) x(a) = -x(a)
        end do
        call cell_span(solid%search, x, reach, lo, hi)
        do c3 = lo(3), hi(3)
            do c2 = lo(2), hi(2)
                do c1 = lo(1), hi(1)
                    c = solid%search%code(c1, 1) + solid%search%code(c2, 2) &
                        + solid%search%code(c3, 3)
                    do k = solid%search%start(c), solid%search%start(c + 1) - 1
                        j = solid%search%order(k)
                        d = place(:, j) - x
                        if (d(1)*d(1) + d(2)*d(2) + d(3)*d(3) >= reach*reach) cycle
                        if (m == 0 .and. j == i) cycle
                        last = last + 1
                        if (keep) list(last) = j
                    end do
                end do
            end do
        end do
    end subroutine search
end module brz_solid_neighbours
