! SPDX-License-Identifier: MIT
!> Shapes of cut cells from the distances at their corners: gas, open shares of faces, wall areas.
!>
!> The area of the wall in a cell is what closes it: the difference of the open shares of opposite
!> faces. So an even pressure pushes a closed body by nothing, to rounding.
module brz_cut_shape_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: node_grid_t
    use brz_cut_geometry, only: cell_shape, face_of_cell
    use brz_cut_list_loop_bodies, only: entry_at
    use brz_kinds, only: int32, int8, rk
    implicit none
    private
    public :: cut_shape, cut_open, cut_close

contains

    !> Signed distances at the corners of a cell; nodes that are not listed are in the gas.
    !@cuf attributes(host,device) &
    pure subroutine corners_of(nodes, ijk, slot, distance, corner)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! cell
        integer(int32), intent(in) :: slot(*)
        real(rk), intent(in) :: distance(*) !! of the entries
        real(rk), intent(out) :: corner(2, 2, 2)
        real(rk) :: x
        integer :: at(3), c, d, s

        do c = 0, 7
            do d = 1, 3
                at(d) = ijk(d)
                if (nodes%n(d) > 1) at(d) = ijk(d) + iand(ishft(c, 1 - d), 1)
            end do
            s = entry_at(nodes, at(1), at(2), at(3), slot)
            x = 1
            if (s > 0) x = distance(s)
            corner(iand(c, 1) + 1, iand(ishft(c, -1), 1) + 1, ishft(c, -2) + 1) = x
        end do
    end subroutine corners_of

    !> Share of gas in a cell and the middle of its wall; a cell without gas is shut.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_shape(s, nodes, cell, place, slot, distance, gas, middle, shut)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), place(*), slot(*)
        real(rk), intent(in) :: distance(*)
        real(rk), intent(inout) :: gas(*), middle(3, *)
        integer(int32), intent(inout) :: shut(*)
        real(rk) :: corner(2, 2, 2), x(3)
        logical :: modelled(3)
        integer :: d

        gas(s) = 0
        shut(s) = 0
        if (place(s) == 0) return
        do d = 1, 3
            modelled(d) = nodes%n(d) > 1
        end do
        call corners_of(nodes, cell_at(nodes%n, cell(s)), slot, distance, corner)
        call cell_shape(modelled, corner, gas(s), x)
        do d = 1, 3
            middle(d, s) = x(d)
        end do
        if (.not. gas(s) > 0) shut(s) = 1
    end subroutine cut_shape

    !> Open shares of the faces of a cell. A face of a cell that is shut is shut on both sides.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_open(s, nodes, cell, place, slot, beside, distance, shut, aperture)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), place(*), slot(*), beside(6, *)
        real(rk), intent(in) :: distance(*)
        integer(int32), intent(in) :: shut(*)
        real(rk), intent(inout) :: aperture(6, *)
        real(rk) :: corner(2, 2, 2)
        integer :: d, row, side

        if (place(s) > 0) call corners_of(nodes, cell_at(nodes%n, cell(s)), slot, distance, corner)
        do d = 1, 3
            do side = 1, 2
                row = 2*d - 2 + side
                aperture(row, s) = 1
                if (nodes%n(d) == 1 .or. place(s) == 0) cycle
                aperture(row, s) = face_of_cell(corner, d, side)
                if (shut(s) /= 0) aperture(row, s) = 0
                if (beside(row, s) == 0) cycle
                if (shut(beside(row, s)) /= 0) aperture(row, s) = 0
            end do
        end do
    end subroutine cut_open

    !> A cell without an open face is shut; wall area of the others; what holds no gas is solid to
    !> the air.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_close(s, seal, nodes, place, aperture, gas, shut, area, solid)
        integer, intent(in) :: s !! entries
        integer, intent(in) :: seal !! 1: shut cells without an open face, 0: leave them
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: place(*)
        real(rk), intent(in) :: aperture(6, *)
        real(rk), intent(inout) :: gas(*)
        integer(int32), intent(inout) :: shut(*)
        real(rk), intent(inout) :: area(3, *) !! out of the gas [m2]
        integer(int8), intent(inout) :: solid(*) !! of the cells of the air
        real(rk) :: widest
        integer :: d

        do d = 1, 3
            area(d, s) = 0
        end do
        if (place(s) == 0) return
        widest = 0
        do d = 1, 3
            if (nodes%n(d) > 1) widest = max(widest, aperture(2*d - 1, s), aperture(2*d, s))
        end do
        if (seal == 1 .and. .not. widest > 0) then
            gas(s) = 0
            shut(s) = 1
        end if
        solid(place(s)) = int(shut(s), int8)
        do d = 1, 3
            if (nodes%n(d) > 1 .and. shut(s) == 0) &
                area(d, s) = nodes%area(d)*(aperture(2*d - 1, s) - aperture(2*d, s))
        end do
    end subroutine cut_close
end module brz_cut_shape_loop_bodies
