! SPDX-License-Identifier: MIT
!> What the gas of a cut cell does at its wall: the wave that the wall sends, the pressure behind
!> it, and what gauges see of that.
module brz_cut_wall_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: bare, n_met, node_grid_t, see_image
    use brz_fallback_loop_bodies, only: neighbour
    use brz_gas, only: to_primitive
    use brz_kinds, only: int32, int64, rk
    use brz_muscl, only: limited_slope
    use brz_scheme, only: first_order, mixture_gamma, scheme_t
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: state_at, meet_wall, cut_meet

    real(rk), parameter :: least_weight = 0.25_rk !! of open faces away from a wall, for a slope

contains

    !> State of a cell of the air.
    !@cuf attributes(host,device) &
    pure subroutine state_at(nodes, scheme, at, u, gamma, w)
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        integer(int64), intent(in) :: at !! place
        real(rk), intent(in) :: u(*)
        real(rk), intent(out) :: gamma
        real(rk), intent(out) :: w(5) !! density, velocity, pressure
        real(rk) :: q(5)
        integer :: c

        do c = 1, 5
            q(c) = u(at + (c - 1)*nodes%grid%apart)
        end do
        gamma = scheme%gamma
        if (nodes%grid%n_var == 6) gamma = mixture_gamma(scheme, u(at + 5*nodes%grid%apart)/q(1))
        call to_primitive(gamma, q, w)
    end subroutine state_at

    !> Density and pressure at the wall of a listed cell, behind the wave that the wall sends. The
    !> speed of approach is that of the cluster, carried on to the wall by a slope that is limited
    !> between the one towards it and that which ends at rest there. Gas that runs along a curve is
    !> held on it by dp/dn = rho u^2/R: its pressure is lower at a convex wall than in the cell.
    !>
    !> Source of the latter: Dadone, Grossman 1994 (AIAA J. 32, 285), there for states beyond it.
    !@cuf attributes(host,device) &
    pure subroutine meet_wall(s, nodes, scheme, ijk, beside, aperture, area, middle, curvature, v, &
                              master, cell, place, lowered, u, w, gamma, whole, n, p_star, &
                              rho_star)
        integer, intent(in) :: s !! entry
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: ijk(3) !! its cell
        integer(int32), intent(in) :: beside(6, *)
        real(rk), intent(in) :: aperture(6, *), area(3, *), middle(3, *), curvature(6, *), v(3, *)
        integer(int32), intent(in) :: master(*), cell(*), place(*)
        logical, intent(in) :: lowered !! to first order
        real(rk), intent(in) :: u(*)
        real(rk), intent(in) :: w(5), gamma !! state of the cell
        real(rk), intent(out) :: whole !! area of the wall [m2]; 0: there is none
        real(rk), intent(out) :: n(3) !! normal, out of the gas
        real(rk), intent(out) :: p_star, rho_star
        real(rk) :: along(3), away, drop, du, share, slope
        integer :: d, root(3)

        whole = 0
        p_star = w(5)
        rho_star = w(1)
        do d = 1, 3
            n(d) = 0
            whole = whole + area(d, s)**2
        end do
        whole = sqrt(whole)
        if (whole <= bare*max(nodes%area(1), nodes%area(2), nodes%area(3))) then
            whole = 0
            return
        end if
        du = 0
        do d = 1, 3
            n(d) = area(d, s)/whole
            du = du + (w(1 + d) - v(d, s))*n(d)
        end do
        if (lowered .or. scheme%reconstruction == first_order) then
            call wall_star(gamma, w(1), w(5), du, p_star, rho_star)
            return
        end if
        root = cell_at(nodes%n, cell(master(s)))
        away = distance_to_wall(s, n, nodes, root, ijk, middle)
        drop = 0
        if (away > 0) then
            call look_away(master(s), n, nodes, scheme, root, beside, aperture, master, place, u, &
                           share, slope)
            do d = 1, 3
                along(d) = w(1 + d) - v(d, s) - du*n(d)
            end do
            drop = share*away*w(1)*acceleration(along, s, curvature)
            du = du + share*away*limited_slope(slope, -du/away)
        end if
        call wall_star(gamma, w(1), w(5), du, p_star, rho_star)
        ! not below zero, nor doubled, where a cell is not small beside the radius
        if (drop > 0) then
            p_star = p_star*p_star/(p_star + drop)
        else
            p_star = p_star + min(-drop, p_star)
        end if
    end subroutine meet_wall

    !> Distance from the centre of the master of a cell to the wall in the cell [m], 0 to a cell.
    !@cuf attributes(host,device) &
    pure function distance_to_wall(s, n, nodes, root, ijk, middle) result(away)
        integer, intent(in) :: s
        real(rk), intent(in) :: n(3) !! normal, out of the gas
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: root(3), ijk(3) !! the master, the cell
        real(rk), intent(in) :: middle(3, *)
        real(rk) :: away, wide
        integer :: d

        away = 0
        wide = 0
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            away = away + n(d)*real(nodes%dx(d), rk) &
                *(way_to(nodes, d, root(d), ijk(d)) + middle(d, s) - 0.5_rk)
            wide = wide + n(d)**2*real(nodes%dx(d), rk)
        end do
        away = max(0.0_rk, min(away, wide))
    end function distance_to_wall

    !> Acceleration of gas that follows a curved wall, u^2/R, > 0 where the body is convex [m/s2].
    !@cuf attributes(host,device) &
    pure function acceleration(along, s, curvature)
        real(rk), intent(in) :: along(3) !! velocity of the gas along the wall [m/s]
        integer, intent(in) :: s
        real(rk), intent(in) :: curvature(6, *) !! see cut_find_curvature
        real(rk) :: acceleration

        acceleration = along(1)*(along(1)*curvature(1, s) + 2*along(2)*curvature(4, s)) &
            + along(2)*(along(2)*curvature(2, s) + 2*along(3)*curvature(5, s)) &
            + along(3)*(along(3)*curvature(3, s) + 2*along(1)*curvature(6, s))
    end function acceleration

    !> Cells from one to another along a direction; round a periodic one the shorter way.
    !@cuf attributes(host,device) &
    pure function way_to(nodes, d, from, to) result(way)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        integer, intent(in) :: from, to !! indices along it
        integer :: way

        way = to - from
        if (nodes%wraps(d)) way = modulo(way + nodes%cells(d)/2, nodes%cells(d)) - nodes%cells(d)/2
    end function way_to

    !> Slope of the speed of approach towards a wall, across the faces of a master that lie away
    !> from it; and how much of what a slope brings counts, as at walls of the box: the ratio of the
    !> pressures on the two sides, lower over higher. With all of it a shock that is reflected
    !> overshoots.
    !@cuf attributes(host,device) &
    pure subroutine look_away(q, n, nodes, scheme, root, beside, aperture, master, place, u, &
                              share, slope)
        integer, intent(in) :: q !! entry of the master
        real(rk), intent(in) :: n(3) !! normal, out of the gas
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: root(3) !! its cell
        integer(int32), intent(in) :: beside(6, *)
        real(rk), intent(in) :: aperture(6, *)
        integer(int32), intent(in) :: master(*), place(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(out) :: share, slope !! [-], [1/s]
        real(rk) :: far, from(5), gamma, here(5), long, near, press, weight, weights
        integer(int64) :: at
        integer :: d, e, image, next, row

        share = 0
        slope = 0
        call state_at(nodes, scheme, int(place(q), int64), u, gamma, here)
        far = 0
        press = 0
        long = 0
        weights = 0
        near = 0
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            near = near + here(1 + d)*n(d)
            row = merge(2*d - 1, 2*d, n(d) > 0)
            if (.not. aperture(row, q) > 0) cycle
            next = beside(row, q)
            if (next == 0) then
                e = root(d) + merge(-1, 1, n(d) > 0)
                call see_image(nodes, d, 0, e, image)
                if (.not. nodes%wraps(d) .and. (e < 1 .or. e > nodes%cells(d))) cycle
            else
                if (master(next) == q) cycle
                image = 0
            end if
            at = place(q)
            if (image == 0) at = neighbour(d, merge(-1, 1, n(d) > 0), nodes%grid, at, root(d))
            call state_at(nodes, scheme, at, u, gamma, from)
            if (image > 0) from(1 + d) = -from(1 + d)
            weight = n(d)**2
            weights = weights + weight
            press = press + weight*from(5)
            long = long + weight*abs(n(d))*real(nodes%dx(d), rk)
            do e = 1, 3
                if (nodes%n(e) > 1) far = far + weight*from(1 + e)*n(e)
            end do
        end do
        if (weights < least_weight) return
        press = press/weights
        share = max(min(here(5), press), 0.0_rk)/max(here(5), press, tiny(share))
        slope = (near - far/weights)*weights/long
    end subroutine look_away

    !> The mean state at the walls of the cluster of a cell, each by its area: density and pressure
    !> are those that push the wall, the velocity is that of the gas along the wall and that of the
    !> wall across it. Cells of a cluster share a state, so this is how it meets walls.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_meet(k, nodes, scheme, number, slot, cell, place, shut, beside, aperture, &
                             area, middle, curvature, v, master, ends, member, u, met)
        integer, intent(in) :: k !! cells that are asked for
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        integer(int32), intent(in) :: number(*) !! in the grid of nodes, 0: none
        integer(int32), intent(in) :: slot(*), cell(*), place(*), shut(*), beside(6, *)
        real(rk), intent(in) :: aperture(6, *), area(3, *), middle(3, *), curvature(6, *), v(3, *)
        integer(int32), intent(in) :: master(*), ends(*), member(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: met(n_met, *)
        real(rk) :: gamma, high, n(3), off, p_star, rho_star, w(5), whole, wide
        integer :: at(3), d, i, ijk(3), q, s

        do i = 1, n_met
            met(i, k) = 0
        end do
        if (number(k) == 0) return
        s = slot(number(k))
        if (s == 0) return
        if (place(s) == 0 .or. shut(s) /= 0) return
        at = cell_at(nodes%n, cell(s))
        do i = ends(master(s)) + 1, ends(master(s) + 1)
            q = member(i)
            ijk = cell_at(nodes%n, cell(q))
            call state_at(nodes, scheme, int(place(q), int64), u, gamma, w)
            call meet_wall(q, nodes, scheme, ijk, beside, aperture, area, middle, curvature, v, &
                           master, cell, place, .false., u, w, gamma, whole, n, p_star, rho_star)
            if (.not. whole > 0) cycle
            off = 0
            high = 0
            wide = 0
            do d = 1, 3
                if (nodes%n(d) == 1) cycle
                off = off + (w(1 + d) - v(d, q))*n(d)
                high = high + n(d)*real(nodes%dx(d), rk) &
                    *(way_to(nodes, d, at(d), ijk(d)) + middle(d, q) - 0.5_rk)
                wide = wide + n(d)**2*real(nodes%dx(d), rk)
            end do
            met(1, k) = met(1, k) + whole*rho_star
            met(5, k) = met(5, k) + whole*p_star
            met(6, k) = met(6, k) + whole
            met(7, k) = met(7, k) + whole*high/wide
            do d = 1, 3
                met(1 + d, k) = met(1 + d, k) + whole*(w(1 + d) - off*n(d))
                met(7 + d, k) = met(7 + d, k) + whole*n(d)*real(nodes%dx(d), rk)/wide
            end do
        end do
        if (.not. met(6, k) > 0) return
        do i = 1, n_met
            if (i /= 6) met(i, k) = met(i, k)/met(6, k)
        end do
    end subroutine cut_meet
end module brz_cut_wall_loop_bodies
