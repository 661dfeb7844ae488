! SPDX-License-Identifier: MIT
!> What of a blast in the plane through its axis lies in the box of the air: it may have passed open
!> sides, and what is beyond them is gone.
module brz_axial_inside
    use brz_axial_start, only: frame_t
    use brz_axial_state, only: axial_t, top_of, v_energy, v_products, v_r, v_rho, v_z
    use brz_kinds, only: dp
    implicit none
    private
    public :: inside_t, sums_inside, arc_inside

    real(dp), parameter :: pi = acos(-1.0_dp)

    !> Sums over the box and undisturbed air.
    type :: inside_t
        real(dp) :: mass = 0, energy = 0, products = 0 !! [kg], [J], [kg]
        real(dp) :: momentum(3) = 0 !! [kg m/s]
        real(dp) :: radial = 0, axial = 0 !! amounts of momentum [kg m/s]
        real(dp) :: beyond = 0 !! energy that is not in the box, of that of the blast [-]
    end type inside_t

contains

    !> The sums, of the part that planes of symmetry through the centre leave.
    pure function sums_inside(blast, frame, lo, hi) result(inside)
        type(axial_t), intent(in) :: blast
        type(frame_t), intent(in) :: frame
        real(dp), intent(in) :: lo(3), hi(3) !! corners of the box of all processes [m]
        type(inside_t) :: inside
        real(dp) :: limit(2, 3), arc(3), ring, q(5), whole, share, sums(8)
        real(dp) :: row(blast%low:blast%n)
        integer :: i, j

        limit = box_about_axis(frame, lo, hi)
        do j = blast%low, blast%n
            row(j) = part_of_row(top_of(blast, j - 1), top_of(blast, j), limit(:, 3))
        end do
        sums = 0
        whole = 0
        do i = 1, blast%n
            arc = arc_inside((i - 0.5_dp)*blast%dr, limit(:, 1), limit(:, 2))
            do j = blast%low, blast%n
                ring = i - 0.5_dp
                q = blast%u(i, :, j) - blast%rest
                whole = whole + ring*q(v_energy)
                ring = ring*row(j)
                sums(1:5) = sums(1:5) + arc(1)*ring*q
                sums(6:7) = sums(6:7) + arc(2:3)*ring*q(v_r)
                sums(8) = sums(8) + arc(1)*ring*abs(q(v_z))
            end do
        end do
        inside%beyond = 1 - sums(v_energy)/whole
        share = 2*pi*blast%dr**2*blast%dz*0.5_dp**count(frame%mirrored)
        if (.not. blast%input%floor > 0) share = 2*share ! it is half of the blast already
        sums = share*sums
        inside%mass = sums(v_rho)
        inside%energy = sums(v_energy)
        inside%products = sums(v_products)
        inside%radial = sums(v_r)
        inside%axial = sums(8)
        inside%momentum(frame%axis) = frame%sense*sums(v_z)
        inside%momentum(frame%across) = merge(2/pi*inside%radial, sums(6:7), &
            frame%mirrored(frame%across))
    end function sums_inside

    !> Ends of the box along the two directions across the axis and along it, about the centre of
    !> the charge; with the image where a plane of symmetry cuts it.
    pure function box_about_axis(frame, lo, hi) result(limit)
        type(frame_t), intent(in) :: frame
        real(dp), intent(in) :: lo(3), hi(3)
        real(dp) :: limit(2, 3)
        integer :: d, at

        do d = 1, 3
            at = merge(frame%axis, frame%across(min(d, 2)), d == 3)
            limit(:, d) = [lo(at), hi(at)] - frame%centre(at)
            if (frame%mirrored(at)) limit(:, d) = [-1, 1]*maxval(abs(limit(:, d)))
            if (d == 3 .and. frame%sense < 0) limit(:, d) = -limit([2, 1], d)
        end do
    end function box_about_axis

    !> Part of a row of cells between two heights, exactly 1 where rounding alone cuts it.
    pure real(dp) function part_of_row(low, high, limit) result(part)
        real(dp), intent(in) :: low, high, limit(2) !! [m]
        real(dp), parameter :: rounding = 1e-9_dp

        part = max(min(high, limit(2)) - max(low, limit(1)), 0.0_dp)/(high - low)
        if (part > 1 - rounding) part = 1
    end function part_of_row

    !> Part of a circle about the origin that lies in a rectangle around it, and the mean of cosine
    !> and sine over the whole circle there.
    pure function arc_inside(radius, x, y) result(part)
        real(dp), intent(in) :: radius, x(2), y(2) !! ends of the rectangle [m]
        real(dp) :: part(3), ends(9), middle, angle
        integer :: k, n, s

        part = [1, 0, 0]
        if (radius <= min(-x(1), x(2), -y(1), y(2))) return
        n = 0
        do s = 1, 2
            if (abs(x(s)) < radius) then
                angle = acos(x(s)/radius)
                ends(n + 1:n + 2) = [angle, 2*pi - angle]
                n = n + 2
            end if
            if (abs(y(s)) < radius) then
                angle = asin(y(s)/radius)
                ends(n + 1:n + 2) = [modulo(angle, 2*pi), pi - angle]
                n = n + 2
            end if
        end do
        part = 0
        if (n == 0) return
        call sort(ends(:n))
        ends(n + 1) = ends(1) + 2*pi
        do k = 1, n
            middle = (ends(k) + ends(k + 1))/2
            if (radius*cos(middle) < x(1) .or. radius*cos(middle) > x(2)) cycle
            if (radius*sin(middle) < y(1) .or. radius*sin(middle) > y(2)) cycle
            part = part + [ends(k + 1) - ends(k), sin(ends(k + 1)) - sin(ends(k)), &
                cos(ends(k)) - cos(ends(k + 1))]
        end do
        part = part/(2*pi)
    end function arc_inside

    !> Rising order of a few numbers.
    pure subroutine sort(values)
        real(dp), intent(inout) :: values(:)
        real(dp) :: value
        integer :: i, k

        do k = 2, size(values)
            value = values(k)
            do i = k - 1, 1, -1
                if (values(i) <= value) exit
                values(i + 1) = values(i)
            end do
            values(i + 1) = value
        end do
    end subroutine sort
end module brz_axial_inside
