! SPDX-License-Identifier: MIT
!> Stress at the faces of bodies that the air loads: as a node hands its load to particles over the
!> depth of a cell or two, a particle lacks the stress of what acts below it. See brz_face_stress.
!>
!> Along each direction the nodes make lines. What acts below a particle on the lines around it,
!> over the part of faces that the body fills there, is a pressure: of gas on the low side what is
!> handed to the particles above it, of gas on the high side to those below. A thin body fills no
!> node, but as much of a line as its walls cover.
!>
!> The gradient across layers is a central difference, which takes the load of a layer half from the
!> layer above and half from that below: with f the load of a layer, tau(j-1) - tau(j+1) = 2 f(j)
!> where the sums of loads give f(j) + (f(j-1) + f(j+1))/2. So f'/4 is added, and f/4 in the
!> outermost layer, which has none above it; not in a body so thin that it feels both of its faces,
!> whose gradients are others.
module brz_cut_stress_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: layers_t, node_grid_t, ring_of_stress, see_image
    use brz_cut_list_loop_bodies, only: entries_of_corners, entry_at
    use brz_cut_node_loop_bodies, only: tents_of, way_from
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: cut_sum_lines, cut_stress_particle

    integer, parameter :: farthest = 2 !! nodes from a wall that bear its load

contains

    !> On the lines through a node: loads of the nodes that lie deeper, of gas on the low side those
    !> above it, of gas on the high side those below; and the area that all near it bear.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_sum_lines(s, nodes, cell, slot, ring, force, from_low, faces, deeper, &
                                  in_line)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*), ring(*)
        real(dp), intent(in) :: force(3, *) !! of all walls [N]
        real(rk), intent(in) :: from_low(3, *) !! of those with gas on the low side [N]
        real(rk), intent(in) :: faces(2, 3, *) !! area that a node bears, in faces
        real(rk), intent(inout) :: deeper(2, 3, *) !! from the low, the high side [N]
        real(rk), intent(inout) :: in_line(2, 3, *) !! in faces
        integer :: b, d, e, ijk(3), m, side, to(3)
        integer :: image
        logical :: turned
        real(rk) :: load(2)

        ijk = cell_at(nodes%n, cell(s))
        do d = 1, 3
            do side = 1, 2
                deeper(side, d, s) = 0
                in_line(side, d, s) = 0
            end do
            if (nodes%n(d) == 1 .or. ring(s) > ring_of_stress) cycle
            do m = -farthest, farthest
                do e = 1, 3
                    to(e) = ijk(e)
                end do
                to(d) = ijk(d) + m
                call see_image(nodes, d, 1, to(d), image)
                turned = image > 0
                b = entry_at(nodes, to(1), to(2), to(3), slot)
                if (b == 0) cycle
                load(1) = from_low(d, b)
                load(2) = real(force(d, b), rk) - from_low(d, b)
                do side = 1, 2
                    ! what is on the low side of an image is on its high side
                    e = merge(3 - side, side, turned)
                    in_line(side, d, s) = in_line(side, d, s) + faces(e, d, b)
                    if (merge(m, -m, side == 1) <= 0) cycle
                    deeper(side, d, s) = deeper(side, d, s) + merge(-load(e), load(e), turned)
                end do
            end do
        end do
    end subroutine cut_sum_lines

    !> Stress that a particle of a body lacks along each direction.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_stress_particle(t, first, nodes, share, layers, wide, stride_d, stride_t, &
                                        home, cell, slot, ring, x, fill, distance, mass, above, &
                                        force, from_low, faces, deeper, in_line, face_stress)
        integer, intent(in) :: t !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(node_grid_t), intent(in) :: nodes
        real(rk), intent(in) :: share !! face_share of the body, for which the stress is kept
        type(layers_t), intent(in) :: layers !! of the body
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_t
        !! distances in `face_stress` of components, of particles
        integer(int32), intent(in) :: home(*), cell(*), slot(*), ring(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: fill(*), distance(*)
        real(dp), intent(in) :: mass(*) !! of nodes [kg]
        real(rk), intent(in) :: above(3, *) !! part of it above the node
        real(dp), intent(in) :: force(3, *)
        real(rk), intent(in) :: from_low(3, *), faces(2, 3, *), deeper(2, 3, *), in_line(2, 3, *)
        real(rk), intent(inout) :: face_stress(*) !! [Pa]
        real(rk) :: across, at, borne(2), layer, line(2), outermost, pressed(2), stress, width(2)
        real(rk) :: y_phi
        real(dp) :: tents(2, 3), y(3)
        integer :: c, corner(8), d, ijk(3), p, pair(2), side
        logical :: beside_wall

        p = first - 1 + t
        beside_wall = home(p) > 0
        if (beside_wall) beside_wall = ring(home(p)) <= ring_of_stress
        if (beside_wall) then
            ijk = cell_at(nodes%n, cell(home(p)))
            do d = 1, 3
                y(d) = x(d, p)
            end do
            call entries_of_corners(nodes, ijk, slot, corner)
            call tents_of(nodes, ijk, y, tents)
        end if
        do d = 1, 3
            stress = 0
            if (beside_wall .and. nodes%n(d) > 1) then
                do side = 1, 2
                    pressed(side) = 0
                    width(side) = 0
                end do
                at = real(way_from(nodes, d, ijk(d), y(d)), rk)
                layer = real(layers%apart(d)/nodes%dx(d), rk)
                do c = 0, 7
                    if (iand(c, 2**(d - 1)) /= 0) cycle
                    pair(1) = corner(c + 1)
                    pair(2) = corner(c + 1 + 2**(d - 1))
                    if (pair(1) == 0 .or. pair(2) == 0) cycle
                    across = real(tent_across(tents, d, c), rk)
                    if (.not. across > 0) cycle
                    y_phi = (1 - at)*distance(pair(1)) + at*distance(pair(2))
                    outermost = max(0.0_rk, 1 - abs(-y_phi/layer - 0.5_rk))
                    do side = 1, 2
                        borne(side) = min(1.0_rk, max(faces(side, d, pair(1)), &
                                                      faces(side, d, pair(2))))
                    end do
                    line = line_at(d, at, layer, outermost, borne, pair, fill, mass, above, &
                                   force, from_low, deeper)
                    do side = 1, 2
                        pressed(side) = pressed(side) + across*line(side)
                        width(side) = width(side) + across*min(1.0_rk, max(fill(pair(1)), &
                            fill(pair(2)), in_line(side, d, pair(1)), in_line(side, d, pair(2))))
                    end do
                end do
                if (width(1) > 0) stress = stress - pressed(1)/(width(1)*nodes%area(d)*share)
                if (width(2) > 0) stress = stress + pressed(2)/(width(2)*nodes%area(d)*share)
            end if
            face_stress(1 + (d - 1)*stride_d + (p - 1)*stride_t) = stress
        end do
    end subroutine cut_stress_particle

    !> Weight of a particle on a line of nodes along a direction.
    !@cuf attributes(host,device) &
    pure function tent_across(tents, d, corner) result(weight)
        real(dp), intent(in) :: tents(2, 3) !! of the particle
        integer, intent(in) :: d, corner !! direction, a corner of the cell on the line
        real(dp) :: weight
        integer :: e

        weight = 1
        do e = 1, 3
            if (e /= d) weight = weight*tents(1 + iand(ishft(corner, 1 - e), 1), e)
        end do
    end function tent_across

    !> What acts on a line below a particle between two of its nodes, of gas on the low and on the
    !> high side [N].
    !@cuf attributes(host,device) &
    pure function line_at(d, at, layer, outermost, borne, pair, fill, mass, above, force, &
                          from_low, deeper) result(line)
        integer, intent(in) :: d !! direction
        real(rk), intent(in) :: at !! place between the nodes, 0 to 1
        real(rk), intent(in) :: layer !! distance of layers, in cells
        real(rk), intent(in) :: outermost !! 1: in the outermost layer
        real(rk), intent(in) :: borne(2) !! of walls with gas on the low, the high side, in faces
        integer, intent(in) :: pair(2) !! entries of the nodes
        real(rk), intent(in) :: fill(*), above(3, *), from_low(3, *), deeper(2, 3, *)
        real(dp), intent(in) :: mass(*), force(3, *)
        real(rk) :: line(2)
        real(rk) :: below, beyond(2), full, half, load(2), own, slope, whole
        integer :: k, s, side

        line(1) = deeper(1, d, pair(2))
        line(2) = deeper(2, d, pair(1))
        half = layer/2
        do k = 1, 2
            s = pair(k)
            whole = real(mass(s), rk)
            if (.not. whole > 0) cycle
            load(1) = from_low(d, s)
            load(2) = real(force(d, s), rk) - from_low(d, s)
            ! mass of the node above the particle and below it: the mean of both sides of its layer,
            ! as a body has it that goes on between the nodes; not more than there is
            below = whole - above(d, s)
            full = whole/fill(s)*0.5_rk
            if (k == 1) then
                beyond(1) = min(above(d, s), full*((1 - at)**2 + half**2))
                beyond(2) = below + min(above(d, s), full*(1 - (1 - at)**2 - half**2))
                own = layer*(1 - at)/fill(s)
                slope = -layer**2/fill(s)
            else
                beyond(1) = above(d, s) + min(below, full*(1 - at**2 - half**2))
                beyond(2) = min(below, full*(at**2 + half**2))
                own = layer*at/fill(s)
                slope = layer**2/fill(s)
            end if
            do side = 1, 2
                line(side) = line(side) + beyond(side)/whole*load(side)
                line(side) = line(side) + (1 - borne(3 - side))*load(side) &
                             *(merge(slope, -slope, side == 1) + outermost*own)/4
            end do
        end do
    end function line_at
end module brz_cut_stress_loop_bodies
