! SPDX-License-Identifier: MIT
!> Shape of a cut cell from the signed distances at its corners: open shares of faces, share of gas,
!> middle of the wall. Point physics.
!>
!> Edges are cut linearly. Lengths are in cells. Corners go by 1 (low) and 2 (high) in each
!> direction; where a direction is not modelled both have the same distance, so that cells in two
!> and one dimensions are prisms.
module brz_cut_geometry
    use brz_kinds, only: rk
    implicit none
    private
    public :: distance_of_fill, face_share, cell_shape, thickness_of, ball_of, &
        is_joined, face_of_cell

    real(rk), parameter :: trifle = max(1e-12_rk, 16*epsilon(1.0_rk)) !! of fill, by rounding
    real(rk), parameter :: least_gas = 1e-6_rk !! share of gas below which a cell is shut

contains

    !> Signed distance of a node to the wall, + in the gas, from the fill by tent weights: exact for
    !> a plane along the grid. Within -1..1. Of a node deep in a body or in the gas, whose fill is
    !> off by rounding, it is exactly that: the root would make 1e-8 of 1e-16.
    !@cuf attributes(host,device) &
    pure function distance_of_fill(fill) result(distance)
        real(rk), intent(in) :: fill !! 0: gas, 1 or more: solid
        real(rk) :: distance

        distance = 1 - sqrt(max(0.0_rk, 1 - 2*abs(fill - 0.5_rk) - trifle)/(1 - trifle))
        if (fill > 0.5_rk) distance = -distance
    end function distance_of_fill

    !> Thickness of a body from its fill, interpolated to a particle: the cubic B-spline that tent
    !> and interpolation make gives layers of 0.5, 1 and 1.5 cells 0.324, 0.561 and 0.798.
    !@cuf attributes(host,device) &
    pure function thickness_of(fill) result(thickness)
        real(rk), intent(in) :: fill
        real(rk) :: thickness

        thickness = 0.5_rk + (fill - 0.324_rk)/0.474_rk
    end function thickness_of

    !> Radius of the ball that stands for a particle of a thin part; 0 where the part is thick.
    !>
    !> A sheet of such balls hides no diagonal of a cell: no gas passes a plate of one layer. At the
    !> thickness at which they end they lie in the surface that the fill gives.
    !@cuf attributes(host,device) &
    pure function ball_of(dimensions, side, thickness) result(radius)
        integer, intent(in) :: dimensions
        real(rk), intent(in) :: side !! of the particle
        real(rk), intent(in) :: thickness !! of the part of the body it lies in
        real(rk) :: radius, most

        radius = 0
        if (thickness >= 2) return
        most = sqrt(0.25_rk*dimensions + 0.25_rk*side*side)
        radius = min(most, 0.5_rk*side + max(0.0_rk, most - 0.5_rk*thickness))
    end function ball_of

    !> Open share of a face: area of the polygon of its gas corners and the cuts of its edges.
    !>
    !> A face whose gas corners lie opposite each other is shut: a body passes between them.
    !@cuf attributes(host,device) &
    pure function face_share(d) result(share)
        real(rk), intent(in) :: d(4) !! signed distances round the face
        real(rk) :: share
        real(rk) :: first(2), last(2), x(2), part
        integer :: i, next, gas, point, points

        gas = 0
        do i = 1, 4
            if (d(i) > 0) gas = gas + 1
        end do
        share = merge(1.0_rk, 0.0_rk, gas == 4)
        if (gas == 0 .or. gas == 4) return
        if (gas == 2 .and. ((d(1) > 0) .eqv. (d(3) > 0))) return
        points = 0
        do i = 1, 4
            next = mod(i, 4) + 1
            do point = 1, 2 ! the corner, the cut behind it
                if (point == 1 .and. .not. d(i) > 0) cycle
                if (point == 2 .and. ((d(i) > 0) .eqv. (d(next) > 0))) cycle
                part = 0
                if (point == 2) part = d(i)/(d(i) - d(next))
                x(1) = across(i) + part*(across(next) - across(i))
                x(2) = up(i) + part*(up(next) - up(i))
                if (points == 0) then
                    first(1) = x(1)
                    first(2) = x(2)
                else
                    share = share + 0.5_rk*(last(1)*x(2) - x(1)*last(2))
                end if
                points = points + 1
                last(1) = x(1)
                last(2) = x(2)
            end do
        end do
        share = share + 0.5_rk*(last(1)*first(2) - first(1)*last(2))
        share = max(0.0_rk, min(1.0_rk, share))
    end function face_share

    !> First coordinate of a corner of the unit square, counted round it.
    !@cuf attributes(host,device) &
    pure function across(i) result(x)
        integer, intent(in) :: i
        real(rk) :: x

        x = merge(1.0_rk, 0.0_rk, i == 2 .or. i == 3)
    end function across

    !> Second coordinate.
    !@cuf attributes(host,device) &
    pure function up(i) result(x)
        integer, intent(in) :: i
        real(rk) :: x

        x = merge(1.0_rk, 0.0_rk, i > 2)
    end function up

    !> Number of a corner, counted from 0 in memory order.
    !@cuf attributes(host,device) &
    pure function at_corner(distance, c) result(x)
        real(rk), intent(in) :: distance(2, 2, 2)
        integer, intent(in) :: c
        real(rk) :: x

        x = distance(iand(c, 1) + 1, iand(ishft(c, -1), 1) + 1, ishft(c, -2) + 1)
    end function at_corner

    !> Are the gas corners of a cell joined along its edges? Else gas lies on two sides of a body.
    !@cuf attributes(host,device) &
    pure function is_joined(distance) result(joined)
        real(rk), intent(in) :: distance(2, 2, 2)
        logical :: joined
        integer :: c, d, gas, other, pass, seen

        gas = 0 ! a bit for each corner
        seen = 0
        do c = 0, 7
            if (.not. at_corner(distance, c) > 0) cycle
            gas = ior(gas, 2**c)
            if (seen == 0) seen = 2**c
        end do
        do pass = 1, 7
            do c = 0, 7
                if (iand(gas, 2**c) == 0) cycle
                do d = 0, 2
                    other = ieor(c, 2**d)
                    if (iand(seen, 2**other) /= 0) seen = ior(seen, 2**c)
                end do
            end do
        end do
        joined = seen == gas
    end function is_joined

    !> Share of gas in a cell, and the middle of the wall in it.
    !>
    !> The middle is the mean of the cuts of the edges. By the divergence theorem with the origin
    !> there the wall itself adds nothing to the volume: the open faces alone do. A cell with less
    !> gas than least_gas, and one with gas on two sides of a body, has none.
    !@cuf attributes(host,device) &
    pure subroutine cell_shape(modelled, distance, gas, middle)
        logical, intent(in) :: modelled(3)
        real(rk), intent(in) :: distance(2, 2, 2) !! signed, at the corners
        real(rk), intent(out) :: gas !! 0: the cell is shut
        real(rk), intent(out) :: middle(3) !! from the low corner
        real(rk) :: a, b, cuts
        integer :: c, d, directions, e, gas_corners, other

        gas_corners = 0
        cuts = 0
        do e = 1, 3
            middle(e) = 0
        end do
        do c = 0, 7
            a = at_corner(distance, c)
            if (a > 0) gas_corners = gas_corners + 1
            do d = 1, 3
                if (iand(c, 2**(d - 1)) /= 0) cycle
                other = c + 2**(d - 1)
                b = at_corner(distance, other)
                if ((a > 0) .eqv. (b > 0)) cycle
                cuts = cuts + 1
                do e = 1, 3
                    if (e == d) then
                        middle(e) = middle(e) + a/(a - b)
                    else
                        middle(e) = middle(e) + merge(1.0_rk, 0.0_rk, iand(c, 2**(e - 1)) /= 0)
                    end if
                end do
            end do
        end do
        directions = 0
        gas = 0
        do d = 1, 3
            middle(d) = merge(middle(d)/max(cuts, 1.0_rk), 0.5_rk, cuts > 0)
            if (.not. modelled(d)) cycle
            directions = directions + 1
            gas = gas + middle(d)*face_of_cell(distance, d, 1) &
                  + (1 - middle(d))*face_of_cell(distance, d, 2)
        end do
        gas = max(0.0_rk, min(1.0_rk, gas/max(directions, 1)))
        if (gas_corners == 8) gas = 1
        if (gas_corners == 0 .or. gas < least_gas) gas = 0
        if (.not. is_joined(distance)) gas = 0
    end subroutine cell_shape

    !> Open share of a face of a cell.
    !@cuf attributes(host,device) &
    pure function face_of_cell(distance, d, side) result(share)
        real(rk), intent(in) :: distance(2, 2, 2)
        integer, intent(in) :: d, side !! direction; 1: low, 2: high
        real(rk) :: share, round(4)
        integer :: c, i, j

        do c = 1, 4
            i = merge(2, 1, c == 2 .or. c == 3)
            j = merge(2, 1, c > 2)
            if (d == 1) round(c) = distance(side, i, j)
            if (d == 2) round(c) = distance(i, side, j)
            if (d == 3) round(c) = distance(i, j, side)
        end do
        share = face_share(round)
    end function face_of_cell
end module brz_cut_geometry
