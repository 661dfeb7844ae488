! SPDX-License-Identifier: MIT
!> Stress at the faces of bodies that the air loads: as a node hands its load to particles over the
!> depth of a cell or two, a particle lacks the stress of what acts below it. See brz_face_stress.
!>
!> Along each direction the nodes make lines, whose loads act over the part of a face of a cell that
!> the body fills there. Loads of gas on the low side press to the high side, and act deeper there.
module brz_cut_stress_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: node_grid_t, see_image
    use brz_cut_list_loop_bodies, only: entry_at
    use brz_cut_node_loop_bodies, only: tent, way_from
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: cut_sum_deeper, cut_stress_particle

    integer, parameter :: farthest = 2 !! nodes from a wall that bear its load

contains

    !> Loads of the nodes that lie deeper on the lines through a node: of gas on the low side those
    !> above it, of gas on the high side those below.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_sum_deeper(s, nodes, cell, slot, force, from_low, deeper)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*)
        real(dp), intent(in) :: force(3, *) !! of all walls [N]
        real(rk), intent(in) :: from_low(3, *) !! of those with gas on the low side [N]
        real(rk), intent(inout) :: deeper(2, 3, *) !! from the low side, from the high side [N]
        integer :: b, d, e, ijk(3), m, side, to(3)
        logical :: turned

        ijk = cell_at(nodes%n, cell(s))
        do d = 1, 3
            do side = 1, 2
                deeper(side, d, s) = 0
                if (nodes%n(d) == 1) cycle
                do m = 1, farthest
                    do e = 1, 3
                        to(e) = ijk(e)
                        if (e == d) to(e) = ijk(e) + (3 - 2*side)*m
                    end do
                    call see_image(nodes, d, 1, to(d), turned)
                    b = entry_at(nodes, to(1), to(2), to(3), slot)
                    if (b == 0) cycle
                    ! what loads an image from its low side is its high side
                    if ((side == 1) .neqv. turned) then
                        deeper(side, d, s) = deeper(side, d, s) &
                                             + merge(-1, 1, turned)*from_low(d, b)
                    else
                        deeper(side, d, s) = deeper(side, d, s) + merge(-1, 1, turned) &
                                             *(real(force(d, b), rk) - from_low(d, b))
                    end if
                end do
            end do
        end do
    end subroutine cut_sum_deeper

    !> Stress that a particle of a body lacks along each direction.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_stress_particle(t, first, nodes, share, wide, stride_d, stride_t, home, &
                                        cell, slot, x, fill, mass, above, force, from_low, &
                                        deeper, face_stress)
        integer, intent(in) :: t !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(node_grid_t), intent(in) :: nodes
        real(rk), intent(in) :: share !! face_share of the body, for which the stress is kept
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_t
        !! distances in `face_stress` of components, of particles
        integer(int32), intent(in) :: home(*), cell(*), slot(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: fill(*)
        real(dp), intent(in) :: mass(*) !! of nodes [kg]
        real(rk), intent(in) :: above(3, *) !! part of it above the node
        real(dp), intent(in) :: force(3, *)
        real(rk), intent(in) :: from_low(3, *), deeper(2, 3, *)
        real(rk), intent(inout) :: face_stress(*) !! [Pa]
        real(rk) :: across, line(2), pressed(3), width(3)
        real(dp) :: place, y(3)
        integer :: at(3), c, d, ijk(3), p, pair(2)

        p = first - 1 + t
        do d = 1, 3
            pressed(d) = 0
            width(d) = 0
            y(d) = x(d, p)
        end do
        if (home(p) > 0) then
            ijk = cell_at(nodes%n, cell(home(p)))
            do d = 1, 3
                if (nodes%n(d) == 1) cycle
                place = way_from(nodes, d, ijk(d), y(d))
                do c = 0, 7
                    if (iand(c, 2**(d - 1)) /= 0) cycle
                    call line_of(nodes, ijk, d, c, slot, pair, at)
                    if (pair(1) == 0 .or. pair(2) == 0) cycle
                    across = real(tent_across(nodes, at, d, y), rk)
                    if (.not. across > 0) cycle
                    line = line_at(d, real(place, rk), pair, fill, mass, above, force, from_low, &
                                   deeper)
                    pressed(d) = pressed(d) + across*line(1)
                    width(d) = width(d) + across*line(2)
                end do
            end do
        end if
        do d = 1, 3
            if (width(d) > 0) pressed(d) = pressed(d)/(width(d)*nodes%area(d)*share)
            face_stress(1 + (d - 1)*stride_d + (p - 1)*stride_t) = -pressed(d)
        end do
    end subroutine cut_stress_particle

    !> The two nodes of a cell on one of its edges along a direction.
    !@cuf attributes(host,device) &
    pure subroutine line_of(nodes, ijk, d, corner, slot, pair, low)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3), d !! cell, direction
        integer, intent(in) :: corner !! 0 to 7, of the lower of them: a bit for each direction
        integer(int32), intent(in) :: slot(*)
        integer, intent(out) :: pair(2) !! entries, 0: none
        integer, intent(out) :: low(3) !! the lower node
        integer :: e, to(3)

        do e = 1, 3
            low(e) = ijk(e) + iand(ishft(corner, 1 - e), 1)
            to(e) = low(e)
            if (e == d) to(e) = low(e) + 1
        end do
        pair(1) = entry_at(nodes, low(1), low(2), low(3), slot)
        pair(2) = entry_at(nodes, to(1), to(2), to(3), slot)
    end subroutine line_of

    !> Weight of a particle on a line of nodes along a direction.
    !@cuf attributes(host,device) &
    pure function tent_across(nodes, ijk, d, x) result(weight)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3), d !! a node of the line, direction
        real(dp), intent(in) :: x(3) !! place of the particle [m]
        real(dp) :: weight, y(3)
        integer :: e

        do e = 1, 3
            y(e) = x(e)
            if (e == d) y(e) = nodes%lo(d) + (nodes%before(d) + ijk(d) - 1)*nodes%dx(d)
        end do
        weight = tent(nodes, ijk, y)
    end function tent_across

    !> What acts on a line below a particle between two of its nodes, as a pressure [N], and the
    !> part of a face that the body fills there.
    !@cuf attributes(host,device) &
    pure function line_at(d, at, pair, fill, mass, above, force, from_low, deeper) result(line)
        integer, intent(in) :: d !! direction
        real(rk), intent(in) :: at !! place between the nodes, 0 to 1
        integer, intent(in) :: pair(2) !! entries of the nodes
        real(rk), intent(in) :: fill(*), above(3, *), from_low(3, *), deeper(2, 3, *)
        real(dp), intent(in) :: mass(*), force(3, *)
        real(rk) :: line(2)
        real(rk) :: layer, whole, over(2) ! share of the load of each node above the particle
        integer :: k, s

        line(2) = 0
        do k = 1, 2
            s = pair(k)
            over(k) = 0
            line(2) = max(line(2), min(fill(s), 1.0_rk))
            whole = real(mass(s), rk)
            if (.not. whole > 0) cycle
            ! of the layer between the nodes, as far as a body that goes on has mass there
            if (k == 1) then
                layer = min(above(d, s), whole/fill(s)*0.5_rk*(1 - at)**2)
                over(k) = layer/whole
            else
                layer = min(whole - above(d, s), whole/fill(s)*0.5_rk*(1 - at**2))
                over(k) = (above(d, s) + layer)/whole
            end if
        end do
        line(1) = deeper(1, d, pair(2)) - deeper(2, d, pair(1))
        do k = 1, 2
            s = pair(k)
            line(1) = line(1) + over(k)*from_low(d, s) &
                - (1 - over(k))*(real(force(d, s), rk) - from_low(d, s))
        end do
    end function line_at
end module brz_cut_stress_loop_bodies
