! SPDX-License-Identifier: MIT
!> Nodes near bodies: what the particles fill, their mass and momentum there, and the signed
!> distance to the wall. Each is a gather over the particles of the cells around.
!>
!> Beyond a plane at the end of the box stands the image of a body that ends there: it fills a node
!> on the plane as much as the body itself does. A body with particles beyond the plane goes on.
module brz_cut_node_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: node_grid_t
    use brz_cut_geometry, only: ball_of, distance_of_fill, thickness_of
    use brz_cut_list_loop_bodies, only: entry_at, nodes_around
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: cut_fill_node, cut_see_fill, cut_find_thickest, cut_find_ball, cut_find_largest, &
        cut_find_distance
    public :: tent, place_in_cells

contains

    !> Coordinate of a particle in cells, from the first node.
    !@cuf attributes(host,device) &
    pure function place_in_cells(nodes, d, x) result(at)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        real(dp), intent(in) :: x !! [m]
        real(dp) :: at

        at = (x - nodes%lo(d))/nodes%dx(d)
    end function place_in_cells

    !> Weight of a particle at a node.
    !@cuf attributes(host,device) &
    pure function tent(nodes, ijk, x) result(weight)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! node
        real(dp), intent(in) :: x(3) !! place of the particle [m]
        real(dp) :: weight
        integer :: d

        weight = 1
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            weight = weight*max(0.0_dp, 1 - abs(place_in_cells(nodes, d, x(d)) - (ijk(d) - 1)))
        end do
    end function tent

    !> Fill of a node, mass and momentum of the particles there, and the heaviest of them.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine cut_fill_node(s, nodes, wide, stride_w, cell, slot, ends, binned, x, v, mass, &
                                  volume, fill, node_mass, momentum, heaviest)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide, stride_w !! rows of x and v; distance of volumes
        integer(int32), intent(in) :: cell(*), slot(*), ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *), mass(*), volume(*)
        real(rk), intent(inout) :: fill(*)
        real(dp), intent(inout) :: node_mass(*), momentum(3, *)
        integer(int32), intent(inout) :: heaviest(*) !! particle of the most mass there, 0: none
        real(dp) :: beyond, filled, full, m, most, p(3), weight, y(3)
        integer :: b, d, i, ijk(3), j, k, low(3), part, q

        ijk = cell_at(nodes%n, cell(s))
        full = 0
        beyond = 0
        m = 0
        most = 0
        heaviest(s) = 0
        do d = 1, 3
            p(d) = 0
            low(d) = merge(ijk(d) - 1, ijk(d), nodes%n(d) > 1)
        end do
        do k = low(3), ijk(3)
            do j = low(2), ijk(2)
                do i = low(1), ijk(1)
                    b = entry_at(nodes, i, j, k, slot)
                    if (b == 0) cycle
                    do q = ends(b) + 1, ends(b + 1)
                        part = binned(q)
                        do d = 1, 3
                            y(d) = x(d, part)
                        end do
                        weight = tent(nodes, ijk, y)
                        filled = volume(1 + (part - 1)*stride_w)*weight
                        full = full + filled
                        if (is_beyond(nodes, y)) beyond = beyond + filled
                        m = m + mass(part)*weight
                        if (mass(part)*weight > most) then
                            most = mass(part)*weight
                            heaviest(s) = part
                        end if
                        do d = 1, 3
                            p(d) = p(d) + mass(part)*weight*v(d, part)
                        end do
                    end do
                end do
            end do
        end do
        full = full/nodes%volume
        do d = 1, 3
            momentum(d, s) = p(d)
            if (nodes%n(d) == 1 .or. beyond > 0) cycle
            if (ijk(d) == 1 .or. ijk(d) == nodes%n(d)) full = 2*full
        end do
        fill(s) = real(full, rk)
        node_mass(s) = m
    end subroutine cut_fill_node

    !> True for a place outside the box.
    !@cuf attributes(host,device) &
    pure function is_beyond(nodes, x) result(beyond)
        type(node_grid_t), intent(in) :: nodes
        real(dp), intent(in) :: x(3) !! [m]
        logical :: beyond
        integer :: d

        beyond = .false.
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            beyond = beyond .or. x(d) < nodes%lo(d) &
                     .or. x(d) > nodes%lo(d) + nodes%cells(d)*nodes%dx(d)
        end do
    end function is_beyond

    !> Fill interpolated to a particle.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_see_fill(p, nodes, wide, home, cell, slot, x, fill, own)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: home(*), cell(*), slot(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: fill(*)
        real(rk), intent(inout) :: own(*)
        real(dp) :: y(3)
        integer :: at(3), c, d, ijk(3), s

        own(p) = 0
        if (home(p) == 0) return
        ijk = cell_at(nodes%n, cell(home(p)))
        do d = 1, 3
            y(d) = x(d, p)
        end do
        do c = 0, 7
            do d = 1, 3
                at(d) = ijk(d) + iand(ishft(c, 1 - d), 1)
            end do
            s = entry_at(nodes, at(1), at(2), at(3), slot)
            if (s > 0) own(p) = own(p) + real(tent(nodes, at, y), rk)*fill(s)
        end do
    end subroutine cut_see_fill

    !> Largest number that a particle of a cell has, 0 without particles.
    !@cuf attributes(host,device) &
    pure function largest_in(s, ends, binned, x) result(largest)
        integer, intent(in) :: s !! entry
        integer(int32), intent(in) :: ends(*), binned(*)
        real(rk), intent(in) :: x(*)
        real(rk) :: largest
        integer :: q

        largest = 0
        do q = ends(s) + 1, ends(s + 1)
            largest = max(largest, x(binned(q)))
        end do
    end function largest_in

    !> Largest fill that a particle of a cell sees.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_thickest(s, ends, binned, own, thickness)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: ends(*), binned(*)
        real(rk), intent(in) :: own(*) !! of the particles
        real(rk), intent(inout) :: thickness(*)

        thickness(s) = largest_in(s, ends, binned, own)
    end subroutine cut_find_thickest

    !> Radius of the ball that stands for a particle where its body is thin, 0 where it is not.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_ball(p, nodes, stride_w, home, cell, slot, volume, thickness, radius)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: stride_w !! distance of volumes
        integer(int32), intent(in) :: home(*), cell(*), slot(*)
        real(rk), intent(in) :: volume(*) !! [m3]
        real(rk), intent(in) :: thickness(*) !! of the cells
        real(rk), intent(inout) :: radius(*)
        real(rk) :: side, thickest
        integer :: d, i, ijk(3), j, k, r(3), s

        radius(p) = 0
        if (home(p) == 0) return
        ijk = cell_at(nodes%n, cell(home(p)))
        do d = 1, 3
            r(d) = merge(1, 0, nodes%n(d) > 1)
        end do
        thickest = 0
        do k = ijk(3) - r(3), ijk(3) + r(3)
            do j = ijk(2) - r(2), ijk(2) + r(2)
                do i = ijk(1) - r(1), ijk(1) + r(1)
                    s = entry_at(nodes, i, j, k, slot)
                    if (s > 0) thickest = max(thickest, thickness(s))
                end do
            end do
        end do
        side = volume(1 + (p - 1)*stride_w)/nodes%volume
        if (nodes%dimensions == 2) side = sqrt(side)
        if (nodes%dimensions == 3) side = side**(1/3.0_rk)
        radius(p) = ball_of(nodes%dimensions, side, thickness_of(thickest))
    end subroutine cut_find_ball

    !> Largest ball in a cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_largest(s, ends, binned, radius, ball)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: ends(*), binned(*)
        real(rk), intent(in) :: radius(*) !! of the particles
        real(rk), intent(inout) :: ball(*)

        ball(s) = largest_in(s, ends, binned, radius)
    end subroutine cut_find_largest

    !> Signed distance of a node to the wall: that of its fill, or to the nearest ball.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_distance(s, nodes, wide, cell, slot, ends, binned, x, radius, ball, &
                                      fill, distance)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: cell(*), slot(*), ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: radius(*), ball(*), fill(*)
        real(rk), intent(inout) :: distance(*)
        real(dp) :: square
        integer :: b, d, high(3), i, ijk(3), j, k, low(3), part, q

        distance(s) = distance_of_fill(fill(s))
        ijk = cell_at(nodes%n, cell(s))
        call nodes_around(nodes, ijk, 2, 1, low, high)
        do k = low(3), high(3)
            do j = low(2), high(2)
                do i = low(1), high(1)
                    b = entry_at(nodes, i, j, k, slot)
                    if (b == 0) cycle
                    if (.not. ball(b) > 0) cycle
                    do q = ends(b) + 1, ends(b + 1)
                        part = binned(q)
                        if (.not. radius(part) > 0) cycle
                        square = 0
                        do d = 1, 3
                            if (nodes%n(d) > 1) square = square &
                                + (place_in_cells(nodes, d, x(d, part)) - (ijk(d) - 1))**2
                        end do
                        distance(s) = min(distance(s), real(sqrt(square), rk) - radius(part))
                    end do
                end do
            end do
        end do
    end subroutine cut_find_distance
end module brz_cut_node_loop_bodies
