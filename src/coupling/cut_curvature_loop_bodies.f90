! SPDX-License-Identifier: MIT
!> Curvature of walls. The fill by tent weights lies inside a curved surface by its curvature times
!> h^2/12 (variance of the tent), and a facet through the cuts of edges by as much again (mean sag
!> of a square facet, or a chord): the distance of a node to the wall makes up for both.
!>
!> Curvature is the divergence of the normal of the fill, smoothed by binomial weights. It is none
!> for planes, and where a body is so thin or small that the smoothed fill has no gradient. Its part
!> along the flow makes the pressure at a curved wall another one than in the cell.
module brz_cut_curvature_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: node_grid_t
    use brz_cut_list_loop_bodies, only: entry_at
    use brz_kinds, only: int32, rk
    implicit none
    private
    public :: cut_smooth_fill, cut_find_normal, cut_find_sag, cut_find_curvature

    real(rk), parameter :: least_slope = 0.1_rk !! of a fill that has a direction [1/cell]
    real(rk), parameter :: sag_share = 1/6.0_rk !! of a surface, over its curvature, in cells
    real(rk), parameter :: most_sag = 0.2_rk !! cells

contains

    !> Entry at a node near another. Beyond an end of the box lies its image, if not the other end.
    !@cuf attributes(host,device) &
    pure function entry_near(nodes, ijk, d, by, slot) result(s)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! node
        integer, intent(in) :: d, by !! direction, nodes along it
        integer(int32), intent(in) :: slot(*)
        integer :: e, s, to(3)

        do e = 1, 3
            to(e) = ijk(e)
            if (e /= d) cycle
            to(e) = ijk(e) + by
            if (nodes%wraps(e)) cycle
            to(e) = nodes%before(e) + ijk(e) + by
            if (to(e) < 1) to(e) = 2 - to(e)
            if (to(e) > nodes%whole(e) + 1) to(e) = 2*nodes%whole(e) + 2 - to(e)
            to(e) = to(e) - nodes%before(e)
        end do
        s = entry_at(nodes, to(1), to(2), to(3), slot)
    end function entry_near

    !> Fill of a node smoothed along a direction by weights of 1/4, 1/2, 1/4; in one that is not
    !> modelled as it is.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_smooth_fill(s, nodes, d, cell, slot, from, to)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        integer(int32), intent(in) :: cell(*), slot(*)
        real(rk), intent(in) :: from(*)
        real(rk), intent(inout) :: to(*)
        integer :: b, ijk(3), side

        to(s) = from(s)
        if (nodes%n(d) == 1) return
        to(s) = 0.5_rk*from(s)
        ijk = cell_at(nodes%n, cell(s))
        do side = -1, 1, 2
            b = entry_near(nodes, ijk, d, side, slot)
            if (b > 0) to(s) = to(s) + 0.25_rk*from(b)
        end do
    end subroutine cut_smooth_fill

    !> Normal of the smoothed fill, out of the solid; none where it is nearly even.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_normal(s, nodes, cell, slot, smooth, normal)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*)
        real(rk), intent(in) :: smooth(*)
        real(rk), intent(inout) :: normal(3, *)
        real(rk) :: slope(3), whole
        integer :: b, d, ijk(3), side

        ijk = cell_at(nodes%n, cell(s))
        whole = 0
        do d = 1, 3
            slope(d) = 0
            normal(d, s) = 0
            if (nodes%n(d) == 1) cycle
            do side = -1, 1, 2
                b = entry_near(nodes, ijk, d, side, slot)
                if (b > 0) slope(d) = slope(d) - 0.5_rk*side*smooth(b)
            end do
            whole = whole + slope(d)**2
        end do
        if (whole <= least_slope**2) return
        do d = 1, 3
            normal(d, s) = slope(d)/sqrt(whole)
        end do
    end subroutine cut_find_normal

    !> How far the facets of a wall lie inside it at a node, from the divergence of its normals.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_sag(s, nodes, cell, slot, normal, sag)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*)
        real(rk), intent(in) :: normal(3, *)
        real(rk), intent(inout) :: sag(*)
        real(rk) :: curvature, change
        integer :: b, d, ijk(3), seen, side

        sag(s) = 0
        if (.not. has_normal(s, normal)) return
        ijk = cell_at(nodes%n, cell(s))
        curvature = 0
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            seen = 0
            change = 0
            do side = -1, 1, 2
                b = entry_near(nodes, ijk, d, side, slot)
                if (b == 0) cycle
                if (.not. has_normal(b, normal)) cycle
                seen = seen + 1
                ! an image has its normal turned
                if (.not. nodes%wraps(d) .and. (nodes%before(d) + ijk(d) + side < 1 &
                    .or. nodes%before(d) + ijk(d) + side > nodes%whole(d) + 1)) then
                    change = change + side*(-normal(d, b) - normal(d, s))
                else
                    change = change + side*(normal(d, b) - normal(d, s))
                end if
            end do
            if (seen > 0) curvature = curvature + change/seen
        end do
        sag(s) = max(-most_sag, min(most_sag, sag_share*curvature))
    end subroutine cut_find_sag

    !> Curvature of the wall in a cell, the gradient of its normals: u^T C u is u^2/R along u, > 0
    !> where the body is convex. In order xx, yy, zz, xy, yz, zx.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_curvature(s, nodes, cell, slot, ring, normal, curvature)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*)
        integer(int32), intent(in) :: ring(*) !! 0: there is a wall
        real(rk), intent(in) :: normal(3, *) !! of nodes, in cells
        real(rk), intent(inout) :: curvature(6, *) !! [1/m]
        real(rk) :: gradient(3, 3), n(3), sums(3, 2, 3), whole
        integer :: b, c, d, e, ijk(3), seen(2, 3), side, to(3)
        logical :: here

        do d = 1, 3
            curvature(d, s) = 0
            curvature(3 + d, s) = 0
        end do
        if (ring(s) > 0) return
        do d = 1, 3
            do side = 1, 2
                seen(side, d) = 0
                do e = 1, 3
                    sums(e, side, d) = 0
                end do
            end do
        end do
        ijk = cell_at(nodes%n, cell(s))
        do c = 0, 7
            here = .true.
            do d = 1, 3
                to(d) = ijk(d) + iand(ishft(c, 1 - d), 1)
                here = here .and. (nodes%n(d) > 1 .or. to(d) == ijk(d))
            end do
            if (.not. here) cycle
            b = entry_at(nodes, to(1), to(2), to(3), slot)
            if (b == 0) cycle
            if (.not. has_normal(b, normal)) cycle
            whole = 0
            do d = 1, 3
                n(d) = normal(d, b)/real(nodes%dx(d), rk)
                whole = whole + n(d)**2
            end do
            do d = 1, 3
                side = 1 + iand(ishft(c, 1 - d), 1)
                seen(side, d) = seen(side, d) + 1
                do e = 1, 3
                    sums(e, side, d) = sums(e, side, d) + n(e)/sqrt(whole)
                end do
            end do
        end do
        do d = 1, 3
            do e = 1, 3
                gradient(e, d) = 0
                if (seen(1, d) > 0 .and. seen(2, d) > 0) gradient(e, d) = &
                    (sums(e, 2, d)/seen(2, d) - sums(e, 1, d)/seen(1, d))/real(nodes%dx(d), rk)
            end do
        end do
        do d = 1, 3
            e = 1 + mod(d, 3)
            curvature(d, s) = gradient(d, d)
            curvature(3 + d, s) = (gradient(e, d) + gradient(d, e))/2
        end do
    end subroutine cut_find_curvature

    !@cuf attributes(host,device) &
    pure function has_normal(s, normal) result(has)
        integer, intent(in) :: s !! entry
        real(rk), intent(in) :: normal(3, *)
        logical :: has

        has = abs(normal(1, s)) + abs(normal(2, s)) + abs(normal(3, s)) > 0
    end function has_normal
end module brz_cut_curvature_loop_bodies
