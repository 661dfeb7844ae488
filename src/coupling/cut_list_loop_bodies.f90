! SPDX-License-Identifier: MIT
!> The list of cut cells: marks of the cells near particles, entries, their neighbours and the
!> particles in them.
module brz_cut_list_loop_bodies
    use brz_air_grid, only: cell_at, near_cut, number_of, place_of
    use brz_cut_cells, only: near, node_grid_t, ring_of_stress
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_particle_marks, only: is_gone
    use brz_scheme, only: max_var
    implicit none
    private
    public :: cut_cell_of, cut_mark, cut_mark_listed, cut_mark_unsettled, cut_unite_marks, &
        cut_widen, cut_set_slot, cut_find_beside, cut_find_home, cut_set_near, cut_start_ring, &
        cut_widen_ring
    public :: entries_of_corners, entry_at, nodes_around

    real(rk), parameter :: settled = 64*epsilon(1.0_rk) !! of a cell, in which gas may be off it

contains

    !> Number of the cell of each particle in the grid of nodes. One beside the grid, so near that
    !> it reaches the nodes at the end, counts to the last cell; round a periodic direction one lies
    !> in the grid wherever it is.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_cell_of(p, nodes, wide, x, fixed, number, moved)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(inout) :: number(*) !! 0: outside
        integer, intent(inout) :: moved !@count particles that have changed their cell
        integer(int32) :: c
        integer :: d, ijk(3)
        logical :: near_box
        real(dp) :: y(3)

        do d = 1, 3
            y(d) = x(d, p)
        end do
        ijk = grid_cell_of(nodes, fixed(p), y)
        near_box = .true.
        do d = 1, 3
            ijk(d) = ijk(d) - nodes%before(d)
            near_box = near_box .and. ijk(d) >= 1 .and. ijk(d) <= nodes%cells(d)
        end do
        c = 0
        if (near_box) c = number_of(nodes%n, ijk)
        if (c /= number(p)) moved = moved + 1
        number(p) = c
    end subroutine cut_cell_of

    !> Indices of the cell of a particle in the grid of all processes; 0 outside, see cut_cell_of.
    !@cuf attributes(host,device) &
    pure function grid_cell_of(nodes, fixed, x) result(ijk)
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: fixed
        real(dp), intent(in) :: x(3) !! [m]
        integer :: ijk(3)
        integer :: d
        logical :: near_box
        real(dp) :: s

        near_box = fixed /= is_gone
        do d = 1, 3
            ijk(d) = 1
            if (nodes%n(d) == 1) cycle
            s = (x(d) - nodes%lo(d))*nodes%inverse_dx(d)
            if (nodes%wraps(d)) s = s - nodes%whole(d)*floor(s/nodes%whole(d))
            near_box = near_box .and. s > -1 .and. s < nodes%whole(d) + 1
            if (near_box) ijk(d) = max(1, min(nodes%whole(d), floor(s) + 1))
        end do
        do d = 1, 3
            if (.not. near_box) ijk(d) = 0
        end do
    end function grid_cell_of

    !> Index of a node or cell: round a periodic direction it goes on from the other end.
    !@cuf attributes(host,device) &
    pure function wrapped(nodes, d, index) result(i)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        integer, intent(in) :: index
        integer :: i

        i = index
        if (nodes%wraps(d)) i = modulo(index - 1, nodes%n(d)) + 1
    end function wrapped

    !> Mark the cells of the particles; all that lie in a cell write the same.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_mark(p, number, mark)
        integer, intent(in) :: p !! particles
        integer(int32), intent(in) :: number(*) !! 0: outside
        integer(int8), intent(inout) :: mark(*)

        if (number(p) > 0) mark(number(p)) = 1_int8
    end subroutine cut_mark

    !> Mark the cells of a list.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_mark_listed(s, cell, mark)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(inout) :: mark(*)

        mark(cell(s)) = 1_int8
    end subroutine cut_mark_listed

    !> Mark the cells around a listed one at the end of the list that does not hold a cell of gas,
    !> as where bodies have left the box or are eroded: it stays listed until it does.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_mark_unsettled(s, nodes, cell, place, volume, swept, kept, from, mark, &
                                       found)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), place(*)
        real(rk), intent(in) :: volume(*), swept(*), kept(max_var + 1, *)
        integer(int8), intent(in) :: from(*) !! what is listed without it
        integer(int8), intent(inout) :: mark(*) !! what is listed for it
        integer, intent(inout) :: found !@count such cells
        integer :: d, i, ijk(3), j, k, high(3), low(3), m, next(3), side
        logical :: inside

        if (place(s) == 0) return
        if (abs(volume(s) + swept(s) - 1) <= settled .and. .not. abs(kept(max_var + 1, s)) > 0 &
            .and. .not. abs(kept(1, s)) > 0) return
        ijk = cell_at(nodes%n, cell(s))
        inside = from(cell(s)) /= 0
        do d = 1, 3
            do side = -1, 1, 2
                next = ijk
                next(d) = wrapped(nodes, d, ijk(d) + side)
                if (nodes%n(d) == 1 .or. next(d) < 1 .or. next(d) > nodes%n(d)) cycle
                if (inside) inside = from(number_of(nodes%n, next)) /= 0
            end do
        end do
        if (inside) return
        found = found + 1
        call nodes_around(nodes, ijk, near, near, low, high)
        do k = low(3), high(3)
            do j = low(2), high(2)
                do i = low(1), high(1)
                    m = number_at(nodes, i, j, k)
                    if (m > 0) mark(m) = 1_int8
                end do
            end do
        end do
    end subroutine cut_mark_unsettled

    !> Add the marks of a map to another.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_unite_marks(c, from, to)
        integer, intent(in) :: c !! nodes
        integer(int8), intent(in) :: from(*)
        integer(int8), intent(inout) :: to(*)

        if (from(c) /= 0) to(c) = 1_int8
    end subroutine cut_unite_marks

    !> Mark what lies within `near` cells of a mark along a direction.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_widen(c, nodes, d, from, to)
        integer, intent(in) :: c !! nodes
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        integer(int8), intent(in) :: from(*)
        integer(int8), intent(inout) :: to(*)
        integer :: i, ijk(3), m, next, step

        to(c) = from(c)
        if (nodes%n(d) == 1) return
        ijk = cell_at(nodes%n, c)
        step = 1
        do i = 2, d
            step = step*nodes%n(i - 1)
        end do
        do m = -near, near
            next = wrapped(nodes, d, ijk(d) + m)
            if (next < 1 .or. next > nodes%n(d)) cycle
            if (from(c + (next - ijk(d))*step) /= 0) to(c) = 1_int8
        end do
    end subroutine cut_widen

    !> Cells to the nearest wall, as far as they matter: 0 in a cell with a wall.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_start_ring(s, area, ring)
        integer, intent(in) :: s !! entries
        real(rk), intent(in) :: area(3, *)
        integer(int32), intent(inout) :: ring(*)

        ring(s) = ring_of_stress + 1
        if (abs(area(1, s)) + abs(area(2, s)) + abs(area(3, s)) > 0) ring(s) = 0
    end subroutine cut_start_ring

    !> The same with walls along one direction more; after all of them in the block around.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_widen_ring(s, nodes, d, cell, slot, from, to)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        integer(int32), intent(in) :: cell(*), slot(*), from(*)
        integer(int32), intent(inout) :: to(*)
        integer :: at(3), b, e, ijk(3), m

        to(s) = from(s)
        if (nodes%n(d) == 1) return
        ijk = cell_at(nodes%n, cell(s))
        do m = -ring_of_stress, ring_of_stress
            do e = 1, 3
                at(e) = ijk(e)
            end do
            at(d) = ijk(d) + m
            b = entry_at(nodes, at(1), at(2), at(3), slot)
            if (b > 0) to(s) = min(to(s), max(abs(m), from(b)))
        end do
    end subroutine cut_widen_ring

    !> Enter a listed cell in the map, with its place among the cells of the air; or take it out.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_set_slot(s, nodes, is, cell, slot, place)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: is !! 1: enter it, 0: take it out
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: slot(*), place(*)
        integer :: d, ijk(3)
        logical :: inside

        slot(cell(s)) = is*s
        ijk = cell_at(nodes%n, cell(s))
        inside = .true.
        do d = 1, 3
            inside = inside .and. ijk(d) <= nodes%cells(d)
        end do
        place(s) = 0
        if (inside) place(s) = int(place_of(nodes%grid, ijk(1), ijk(2), ijk(3)), int32)
    end subroutine cut_set_slot

    !> Enter whether a cell is listed in the map of the cells near walls.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_set_near(c, nodes, slot, near_walls)
        integer, intent(in) :: c !! nodes
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: slot(*)
        integer(int8), intent(inout) :: near_walls(*) !! of the cells of the air
        integer(int64) :: at
        integer :: d, ijk(3)

        ijk = cell_at(nodes%n, c)
        do d = 1, 3
            if (ijk(d) > nodes%cells(d)) return
        end do
        at = place_of(nodes%grid, ijk(1), ijk(2), ijk(3))
        near_walls(at) = int(mod(int(near_walls(at)), near_cut) &
                             + merge(near_cut, 0, slot(c) > 0), int8)
    end subroutine cut_set_near

    !> Nodes from `below` before a node to `above` behind it, in the directions that are modelled.
    !@cuf attributes(host,device) &
    pure subroutine nodes_around(nodes, ijk, below, above, low, high)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3), below, above
        integer, intent(out) :: low(3), high(3)
        integer :: d

        do d = 1, 3
            low(d) = merge(ijk(d) - below, 1, nodes%n(d) > 1)
            high(d) = merge(ijk(d) + above, 1, nodes%n(d) > 1)
        end do
    end subroutine nodes_around

    !> Entry at a node of the grid; 0 where it is not listed.
    !@cuf attributes(host,device) &
    pure function entry_at(nodes, i, j, k, slot) result(s)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: i, j, k
        integer(int32), intent(in) :: slot(*)
        integer :: s

        s = number_at(nodes, i, j, k)
        if (s > 0) s = slot(s)
    end function entry_at

    !> Entries at the corners of a cell; 0 where one is not listed, or twice the same.
    !@cuf attributes(host,device) &
    pure subroutine entries_of_corners(nodes, ijk, slot, at)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! cell
        integer(int32), intent(in) :: slot(*)
        integer, intent(out) :: at(8)
        integer :: c, d, number, step(3)
        logical :: here

        step(1) = 1
        step(2) = nodes%n(1)
        step(3) = nodes%n(1)*nodes%n(2)
        do d = 1, 3
            if (ijk(d) < nodes%n(d)) cycle
            ! round a periodic direction the first one, else there is none
            step(d) = merge((1 - nodes%n(d))*step(d), 0, nodes%wraps(d))
        end do
        do c = 0, 7
            number = number_of(nodes%n, ijk)
            here = .true.
            do d = 1, 3
                if (iand(c, 2**(d - 1)) == 0) cycle
                here = here .and. step(d) /= 0
                number = number + step(d)
            end do
            at(c + 1) = 0
            if (here) at(c + 1) = slot(number)
        end do
    end subroutine entries_of_corners

    !> Number of a node of the grid; 0 beyond its ends, see wrapped.
    !@cuf attributes(host,device) &
    pure function number_at(nodes, i, j, k) result(number)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: i, j, k
        integer(int32) :: number
        integer :: at(3), d

        number = 0
        at(1) = i
        at(2) = j
        at(3) = k
        do d = 1, 3
            at(d) = wrapped(nodes, d, at(d))
            if (at(d) < 1 .or. at(d) > nodes%n(d)) return
        end do
        number = number_of(nodes%n, at)
    end function number_at

    !> Find the entries across the faces of a cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_beside(s, nodes, cell, slot, place, beside)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*), place(*)
        integer(int32), intent(inout) :: beside(6, *) !! 0: none that is listed
        integer :: d, ijk(3), side, to(3)

        ijk = cell_at(nodes%n, cell(s))
        do d = 1, 3
            do side = 0, 1
                beside(2*d - 1 + side, s) = 0
                if (nodes%n(d) == 1 .or. place(s) == 0) cycle
                to = ijk
                to(d) = wrapped(nodes, d, ijk(d) + 2*side - 1)
                if (to(d) < 1 .or. to(d) > nodes%cells(d)) cycle
                beside(2*d - 1 + side, s) = entry_at(nodes, to(1), to(2), to(3), slot)
            end do
        end do
    end subroutine cut_find_beside

    !> Entry of the cell of a particle.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_home(p, number, slot, home)
        integer, intent(in) :: p !! particles
        integer(int32), intent(in) :: number(*) !! of its cell, 0: outside
        integer(int32), intent(in) :: slot(*)
        integer(int32), intent(inout) :: home(*)

        home(p) = 0
        if (number(p) > 0) home(p) = slot(number(p))
    end subroutine cut_find_home
end module brz_cut_list_loop_bodies
