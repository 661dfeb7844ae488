! SPDX-License-Identifier: MIT
!> Nodes near bodies: what the particles fill, their mass and momentum there, and the signed
!> distance to the wall. Each is a gather over the particles of the cells around.
!>
!> Beyond a plane at the end of the box stands the image of a body that ends there: it fills a node
!> on the plane as much as the body itself does, and moves as this does where it is one of symmetry.
!> A body with particles beyond the plane goes on. Round a periodic direction a node sees the image
!> of a particle that is nearest to it.
module brz_cut_node_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: at_corner, node_grid_t
    use brz_cut_geometry, only: ball_of, distance_of_fill, thickness_of
    use brz_cut_list_loop_bodies, only: entries_of_corners, entry_at, nodes_around
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: cut_fill_corner, cut_fill_node, cut_see_fill, cut_find_thickest, &
        cut_widen_thickness, cut_find_ball, cut_find_largest, cut_find_distance, cut_search_octant
    public :: cell_below, row_beyond, see_images, tent, tents_of, tent_at, turns_to, way_from

    ! rows of the sums at corners; + 1..3
    integer, parameter :: row_fill = 1, row_beyond = 2, row_mass = 3, row_most = 4
    integer, parameter :: row_momentum = 4

contains

    !> Coordinate of a particle in cells, from the first node of the grid.
    !@cuf attributes(host,device) &
    pure function place_in_cells(nodes, d, x) result(at)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        real(dp), intent(in) :: x !! [m]
        real(dp) :: at

        at = (x - nodes%lo(d))*nodes%inverse_dx(d)
    end function place_in_cells

    !> Periods from a node to the image of it that is nearest to a place.
    !@cuf attributes(host,device) &
    pure function turns_to(nodes, d, i, x) result(turns)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d, i !! direction, index of the node
        real(dp), intent(in) :: x !! [m]
        integer :: turns

        turns = 0
        if (nodes%wraps(d)) turns = floor((place_in_cells(nodes, d, x) - (i - 1))/nodes%whole(d) &
                                          + 0.5_dp)
    end function turns_to

    !> Way along a direction from a node, or its image nearest to a place, to that place, in cells.
    !@cuf attributes(host,device) &
    pure function way_from(nodes, d, i, x) result(way)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d, i !! direction, index of the node
        real(dp), intent(in) :: x !! [m]
        real(dp) :: way

        way = place_in_cells(nodes, d, x) &
              - (nodes%before(d) + i - 1 + turns_to(nodes, d, i, x)*nodes%whole(d))
    end function way_from

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
            weight = weight*max(0.0_dp, 1 - abs(way_from(nodes, d, ijk(d), x(d))))
        end do
    end function tent

    !> Weights of a particle at the nodes below and above it along each direction.
    !@cuf attributes(host,device) &
    pure subroutine tents_of(nodes, ijk, x, tents)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! its cell
        real(dp), intent(in) :: x(3) !! place of the particle [m]
        real(dp), intent(out) :: tents(2, 3)
        integer :: d

        do d = 1, 3
            tents(1, d) = 1
            tents(2, d) = 1
            if (nodes%n(d) == 1) cycle
            tents(1, d) = max(0.0_dp, 1 - abs(way_from(nodes, d, ijk(d), x(d))))
            tents(2, d) = max(0.0_dp, 1 - abs(way_from(nodes, d, ijk(d) + 1, x(d))))
        end do
    end subroutine tents_of

    !> Weight at a corner of the cell.
    !@cuf attributes(host,device) &
    pure function tent_at(tents, corner) result(weight)
        real(dp), intent(in) :: tents(2, 3)
        integer, intent(in) :: corner !! 0 to 7: a bit for each direction
        real(dp) :: weight
        integer :: d

        weight = 1
        do d = 1, 3
            weight = weight*tents(1 + iand(ishft(corner, 1 - d), 1), d)
        end do
    end function tent_at

    !> What the particles of a cell bring to one of its corners by tent weights: eight threads side
    !> by side read the same particles. See cut_fill_node for the rows.
    !@loop_body if(n >= worth_threads) schedule(dynamic, 256)
    !@cuf attributes(host,device) &
    pure subroutine cut_fill_corner(t, nodes, wide, stride_w, cell, ends, binned, x, v, mass, &
                                    volume, sums, top)
        integer, intent(in) :: t !! corners of entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide, stride_w !! rows of x and v; distance of volumes
        integer(int32), intent(in) :: cell(*), ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *), mass(*), volume(*)
        real(dp), intent(inout) :: sums(at_corner, 8, *)
        integer(int32), intent(inout) :: top(8, *) !! particle of the most mass there, 0: none
        real(dp) :: filled, own(at_corner), share, weight, y(3)
        integer :: at(3), c, d, ijk(3), p, q, s
        logical :: at_end

        s = (t - 1)/8 + 1
        c = t - 8*(s - 1) - 1
        do d = 1, at_corner
            own(d) = 0
        end do
        top(c + 1, s) = 0
        ijk = cell_at(nodes%n, cell(s))
        do d = 1, 3
            at(d) = ijk(d) + iand(ishft(c, 1 - d), 1)
        end do
        at_end = .false.
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            at_end = at_end .or. nodes%before(d) + ijk(d) == 1 &
                .or. nodes%before(d) + ijk(d) == nodes%whole(d)
        end do
        do q = ends(s) + 1, ends(s + 1)
            p = binned(q)
            do d = 1, 3
                y(d) = x(d, p)
            end do
            share = tent(nodes, at, y)
            filled = volume(1 + (p - 1)*stride_w)*share
            own(row_fill) = own(row_fill) + filled
            if (at_end .and. is_beyond(nodes, y)) own(row_beyond) = own(row_beyond) + filled
            weight = mass(p)*share
            own(row_mass) = own(row_mass) + weight
            if (weight > own(row_most)) then
                own(row_most) = weight
                top(c + 1, s) = p
            end if
            do d = 1, 3
                own(row_momentum + d) = own(row_momentum + d) + weight*v(d, p)
            end do
        end do
        do d = 1, at_corner
            sums(d, c + 1, s) = own(d)
        end do
    end subroutine cut_fill_corner

    !> What the particles bring to a node, from the corners of the cells about it: fill, mass, the
    !> heaviest of them, and momentum.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_fill_node(s, nodes, cell, slot, sums, top, fill, node_mass, above, &
                                  heaviest, momentum)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*)
        real(dp), intent(in) :: sums(at_corner, 8, *)
        integer(int32), intent(in) :: top(8, *)
        real(rk), intent(inout) :: fill(*)
        real(dp), intent(inout) :: node_mass(*)
        real(rk), intent(inout) :: above(3, *) !! part of it above the node
        integer(int32), intent(inout) :: heaviest(*) !! particle of the most mass there, 0: none
        real(dp), intent(inout) :: momentum(3, *)
        real(dp) :: all(at_corner), upper(3)
        real(dp) :: mass, times(3) ! as often as the images say
        logical :: halved(3)
        integer :: b, c, corner, d, ijk(3)

        ijk = cell_at(nodes%n, cell(s))
        do d = 1, at_corner
            all(d) = 0
        end do
        do d = 1, 3
            upper(d) = 0
        end do
        heaviest(s) = 0
        do c = 0, 7
            call cell_below(nodes, ijk, c, slot, b, corner)
            if (b == 0) cycle
            if (sums(row_most, corner, b) > all(row_most)) heaviest(s) = top(corner, b)
            do d = 1, 3
                if (iand(c, 2**(d - 1)) /= 0) upper(d) = upper(d) + sums(row_mass, corner, b)
            end do
            do d = 1, at_corner
                if (d == row_most) then
                    all(d) = max(all(d), sums(d, corner, b))
                else
                    all(d) = all(d) + sums(d, corner, b)
                end if
            end do
        end do
        call see_images(nodes, ijk, all(row_beyond) > 0, all(row_fill), mass, times, halved)
        fill(s) = real(all(row_fill)/nodes%volume, rk)
        node_mass(s) = mass*all(row_mass)
        do d = 1, 3
            above(d, s) = real(merge(node_mass(s)/2, mass*upper(d), halved(d)), rk)
            momentum(d, s) = times(d)*all(row_momentum + d)
        end do
    end subroutine cut_fill_node

    !> What the images of a body bring to a node at an end of the box: as much fill, unless it has
    !> particles beyond; on a plane of symmetry and a wall as much mass, and vectors, of the former
    !> with their part along the normal turned.
    !@cuf attributes(host,device) &
    pure subroutine see_images(nodes, ijk, beyond, fill, mass, times, halved)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! node
        logical, intent(in) :: beyond !! there are particles beyond the box
        real(dp), intent(inout) :: fill
        real(dp), intent(out) :: mass, times(3) !! factors of mass and of vectors
        logical, intent(out) :: halved(3) !! half of the mass is beyond the node
        integer :: d, e, side

        mass = 1
        do d = 1, 3
            times(d) = 1
            halved(d) = .false.
        end do
        if (beyond) return
        do d = 1, 3
            if (nodes%n(d) == 1 .or. nodes%wraps(d)) cycle
            side = 0
            if (nodes%before(d) + ijk(d) == nodes%whole(d) + 1) side = 2
            if (nodes%before(d) + ijk(d) == 1) side = 1
            if (side == 0) cycle
            fill = 2*fill
            if (.not. (nodes%mirrors(side, d) .or. nodes%closed(side, d))) cycle
            mass = 2*mass
            halved(d) = .true.
            do e = 1, 3
                times(e) = times(e)*merge(0.0_dp, 2.0_dp, e == d .and. nodes%mirrors(side, d))
            end do
        end do
    end subroutine see_images

    !> Entry of one of the eight cells about a node, the lowest first, 0 where there is none; and
    !> which of its corners the node is.
    !@cuf attributes(host,device) &
    pure subroutine cell_below(nodes, ijk, c, slot, b, corner)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! node
        integer, intent(in) :: c !! 0 to 7: a bit for each direction
        integer(int32), intent(in) :: slot(*)
        integer, intent(out) :: b, corner !! entry, 1 to 8
        integer :: d, to(3)

        b = 0
        corner = 1
        do d = 1, 3
            to(d) = ijk(d)
            if (nodes%n(d) == 1) then
                if (iand(c, 2**(d - 1)) /= 0) return
            else
                to(d) = ijk(d) - 1 + merge(1, 0, iand(c, 2**(d - 1)) /= 0)
                if (iand(c, 2**(d - 1)) == 0) corner = corner + 2**(d - 1)
            end if
        end do
        b = entry_at(nodes, to(1), to(2), to(3), slot)
    end subroutine cell_below

    !> True for a place outside the grid.
    !@cuf attributes(host,device) &
    pure function is_beyond(nodes, x) result(beyond)
        type(node_grid_t), intent(in) :: nodes
        real(dp), intent(in) :: x(3) !! [m]
        logical :: beyond
        integer :: d

        beyond = .false.
        do d = 1, 3
            if (nodes%n(d) == 1 .or. nodes%wraps(d)) cycle
            beyond = beyond .or. x(d) < nodes%lo(d) &
                     .or. x(d) > nodes%lo(d) + nodes%whole(d)*nodes%dx(d)
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
        real(dp) :: tents(2, 3), y(3)
        integer :: at(8), c, d, ijk(3)

        own(p) = 0
        if (home(p) == 0) return
        ijk = cell_at(nodes%n, cell(home(p)))
        do d = 1, 3
            y(d) = x(d, p)
        end do
        call entries_of_corners(nodes, ijk, slot, at)
        call tents_of(nodes, ijk, y, tents)
        do c = 0, 7
            if (at(c + 1) > 0) own(p) = own(p) + real(tent_at(tents, c), rk)*fill(at(c + 1))
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

    !> The same with the cells around.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_widen_thickness(s, nodes, cell, slot, own, thickness)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*)
        real(rk), intent(in) :: own(*) !! of the cells
        real(rk), intent(inout) :: thickness(*)
        integer :: b, high(3), i, j, k, low(3)

        thickness(s) = 0
        call nodes_around(nodes, cell_at(nodes%n, cell(s)), 1, 1, low, high)
        do k = low(3), high(3)
            do j = low(2), high(2)
                do i = low(1), high(1)
                    b = entry_at(nodes, i, j, k, slot)
                    if (b > 0) thickness(s) = max(thickness(s), own(b))
                end do
            end do
        end do
    end subroutine cut_widen_thickness

    !> Radius of the ball that stands for a particle where its body is thin, 0 where it is not.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_ball(p, nodes, stride_w, home, volume, thickness, radius)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: stride_w !! distance of volumes
        integer(int32), intent(in) :: home(*)
        real(rk), intent(in) :: volume(*) !! [m3]
        real(rk), intent(in) :: thickness(*) !! of the cells and those around
        real(rk), intent(inout) :: radius(*)
        real(rk) :: side

        radius(p) = 0
        if (home(p) == 0) return
        side = volume(1 + (p - 1)*stride_w)/nodes%volume
        if (nodes%dimensions == 2) side = sqrt(side)
        if (nodes%dimensions == 3) side = side**(1/3.0_rk)
        radius(p) = ball_of(nodes%dimensions, side, thickness_of(thickness(home(p))))
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

    !> Distance of a node to the nearest ball in one octant about it, as far as two cells: eight
    !> threads share the work of a node. A cell that cannot hold a nearer one is passed over.
    !@loop_body if(n >= worth_threads) schedule(dynamic, 512)
    !@cuf attributes(host,device) &
    pure subroutine cut_search_octant(t, nodes, wide, cell, slot, ends, binned, x, radius, ball, &
                                      fill, sag, octants)
        integer, intent(in) :: t !! octants of entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: cell(*), slot(*), ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: radius(*), ball(*), fill(*), sag(*)
        real(rk), intent(inout) :: octants(8, *) !! least distance to a ball, or that of the fill
        real(rk) :: least
        integer :: b, c, d, far, ijk(3), o, s, to(3)
        logical :: here

        s = (t - 1)/8 + 1
        o = t - 8*(s - 1) - 1
        least = distance_of_fill(fill(s)) - sag(s)
        ijk = cell_at(nodes%n, cell(s))
        do c = 0, 7
            far = 0
            here = .true.
            do d = 1, 3
                to(d) = ijk(d)
                if (nodes%n(d) == 1) then
                    here = here .and. iand(ior(o, c), 2**(d - 1)) == 0
                    cycle
                end if
                if (iand(c, 2**(d - 1)) /= 0) far = far + 1
                to(d) = ijk(d) + merge(merge(1, 0, iand(c, 2**(d - 1)) /= 0), &
                                       merge(-2, -1, iand(c, 2**(d - 1)) /= 0), &
                                       iand(o, 2**(d - 1)) /= 0)
            end do
            if (.not. here) cycle
            b = entry_at(nodes, to(1), to(2), to(3), slot)
            if (b == 0) cycle
            if (.not. ball(b) > 0 .or. sqrt(real(far, rk)) - ball(b) > least) cycle
            call find_nearest(nodes, wide, ijk, ends(b) + 1, ends(b + 1), binned, x, radius, least)
        end do
        octants(o + 1, s) = least
    end subroutine cut_search_octant

    !> Least distance of a node to the balls of some particles.
    !@cuf attributes(host,device) &
    pure subroutine find_nearest(nodes, wide, ijk, first, last, binned, x, radius, least)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: ijk(3) !! node
        integer, intent(in) :: first, last !! of the particles in `binned`
        integer(int32), intent(in) :: binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: radius(*)
        real(rk), intent(inout) :: least
        real(dp) :: square
        integer :: d, part, q

        do q = first, last
            part = binned(q)
            if (.not. radius(part) > 0) cycle
            square = 0
            do d = 1, 3
                if (nodes%n(d) > 1) square = square + way_from(nodes, d, ijk(d), x(d, part))**2
            end do
            least = min(least, real(sqrt(square), rk) - radius(part))
        end do
    end subroutine find_nearest

    !> Signed distance of a node to the wall: the least of its octants.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_distance(s, octants, distance)
        integer, intent(in) :: s !! entries
        real(rk), intent(in) :: octants(8, *)
        real(rk), intent(inout) :: distance(*)
        integer :: o

        distance(s) = octants(1, s)
        do o = 2, 8
            distance(s) = min(distance(s), octants(o, s))
        end do
    end subroutine cut_find_distance
end module brz_cut_node_loop_bodies
