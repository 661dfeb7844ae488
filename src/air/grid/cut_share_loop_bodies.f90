! SPDX-License-Identifier: MIT
!> What processes tell each other of their cut cells that lies otherwise than by entries of the
!> list: states of the air, masters; and which entries those are.
module brz_cut_share_loop_bodies
    use brz_air_grid, only: cell_at, number_of
    use brz_cut_cells, only: node_grid_t
    use brz_kinds, only: int32, int64, rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: cut_mark_shared, cut_pick_state, cut_put_state, cut_pick_way, cut_put_way

contains

    !> mark = 1 for an entry whose node is in the box of a process, else 0.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_mark_shared(s, row, boxes, asks, nodes, cell, mark)
        integer, intent(in) :: s !! entries
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: boxes
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest node of the grid
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: mark(*) !! (entries, boxes)
        integer :: d, ijk(3), r
        logical :: inside

        ijk = cell_at(nodes%n, cell(s))
        do r = 1, boxes
            inside = .true.
            do d = 1, 3
                inside = inside .and. ijk(d) + nodes%before(d) >= asks(d, r) &
                         .and. ijk(d) + nodes%before(d) <= asks(d + 3, r)
            end do
            mark((r - 1)*row + s) = merge(1_int32, 0_int32, inside)
        end do
    end subroutine cut_mark_shared

    !> State of the cell of an entry, 0 where this is a node alone.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_pick_state(t, nodes, entry, place, u, states)
        integer, intent(in) :: t !! entries that are sent
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: entry(*), place(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: states(max_var, *) !! (., entries)
        integer :: c, s

        s = entry(t)
        do c = 1, max_var
            states(c, s) = 0
            if (place(s) > 0 .and. c <= nodes%grid%n_var) &
                states(c, s) = u(place(s) + (c - 1)*nodes%grid%apart)
        end do
    end subroutine cut_pick_state

    !> Put it among those of the air.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_put_state(t, nodes, entry, place, states, u)
        integer, intent(in) :: t !! entries that have come
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: entry(*), place(*)
        real(rk), intent(in) :: states(max_var, *) !! (., entries)
        real(rk), intent(inout) :: u(*)
        integer :: c, s

        s = entry(t)
        if (place(s) == 0) return
        do c = 1, nodes%grid%n_var
            u(place(s) + (c - 1)*nodes%grid%apart) = states(c, s)
        end do
    end subroutine cut_put_state

    !> The way from an entry to its master, in cells.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_pick_way(t, nodes, entry, cell, master, way)
        integer, intent(in) :: t !! entries that are sent
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: entry(*), cell(*), master(*)
        integer(int32), intent(inout) :: way(3, *) !! (., entries)
        integer :: d, from(3), s, to(3)

        s = entry(t)
        from = cell_at(nodes%n, cell(s))
        to = cell_at(nodes%n, cell(master(s)))
        do d = 1, 3
            way(d, s) = to(d) - from(d)
        end do
    end subroutine cut_pick_way

    !> The master of an entry, where the way leads; itself where that is not listed here.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_put_way(t, nodes, entry, cell, slot, way, master)
        integer, intent(in) :: t !! entries that have come
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: entry(*), cell(*), slot(*)
        integer(int32), intent(in) :: way(3, *) !! (., entries)
        integer(int32), intent(inout) :: master(*)
        integer :: d, s, to(3)
        logical :: inside

        s = entry(t)
        to = cell_at(nodes%n, cell(s))
        inside = .true.
        do d = 1, 3
            to(d) = to(d) + way(d, s)
            inside = inside .and. to(d) >= 1 .and. to(d) <= nodes%n(d)
        end do
        master(s) = s
        if (.not. inside) return
        if (slot(number_of(nodes%n, to)) > 0) master(s) = slot(number_of(nodes%n, to))
    end subroutine cut_put_way
end module brz_cut_share_loop_bodies
