! SPDX-License-Identifier: MIT
!> The contact surface of round bodies and of those from triangles: that of the shape, not of its
!> lattice.
!>
!> Contact begins where the kernel sum over the other body is that of a flat surface one spacing
!> away. A round surface curves away and a lattice follows it in steps; so the cells of the outer
!> particles of such a body get weights with which its sum is 1 half a spacing outside its true
!> surface, and these particles begin to press where it touches a flat body, not where they would
!> with half a spacing around each.
!>
!> Source: docs/theory/contact.md
module brz_contact_surface
    use brz_body, only: body_t
    use brz_cell_grid, only: box_span, cell_span, fill_cells, lay_grid, number_of_cell
    use brz_flat_surface, only: flat_sum
    use brz_interaction, only: law_none
    use brz_kernel, only: kernel_slope, kernel_value
    use brz_kinds, only: dp, real32, rk
    use brz_solid_mirror, only: signs
    use brz_listed_bodies, only: listed_bodies_t
    use brz_stl, only: nearest_on
    implicit none
    private
    public :: find_contact_surface

    integer, parameter :: rounds = 3 !! in which the weights are found
    real(dp), parameter :: most_weight = 4 !! and 1/4 is the least
    real(dp), parameter :: outer = 1.5_dp !! spacings below the surface that have weights

contains

    !> Weights and sums at first touch of the particles of bodies whose surface is known, from the
    !> unloaded ones.
    subroutine find_contact_surface(solid)
        class(listed_bodies_t), intent(inout) :: solid
        real(dp), allocatable :: depth(:), n(:, :)
        integer :: b, i

        do b = 1, size(solid%bodies)
            if (allocated(n)) deallocate (depth, n)
            associate (body => solid%bodies(b))
                if (.not. solid%links%present .or. solid%dimension == 1) cycle
                if (all(solid%links%table(:, b)%law == law_none)) cycle
                if (.not. (allocated(body%surface) .or. body%round%radius(1) > 0)) cycle
                allocate (depth(body%first:body%last), n(3, body%first:body%last))
                call lay_grid(solid%search, solid%x_ref, solid%fixed, body, 2*real(body%h, dp))
                call fill_cells(solid%search, solid%x_ref, solid%fixed, body)
                if (allocated(body%surface)) then
                    call reach_surface(solid, body, depth, n)
                else
                    do i = body%first, body%last
                        call find_depth(body, solid%dimension, solid%x_ref(:, i), depth(i), n(:, i))
                    end do
                end if
                call weigh_cells(solid, b, depth, n)
                call find_thresholds(solid, b, depth)
            end associate
        end do
        do b = 1, size(solid%bodies)
            if (allocated(solid%bodies(b)%surface)) deallocate (solid%bodies(b)%surface)
        end do
    end subroutine find_contact_surface

    !> Depths of the particles of a body below its triangles, and the outward normals there; those
    !> far inside are as deep as can be.
    subroutine reach_surface(solid, body, depth, n)
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(out) :: depth(body%first:), n(:, body%first:)
        real(dp) :: away(3), low(3), high(3), reach
        integer :: c, c1, c2, c3, i, k, t, lo(3), hi(3)

        depth = huge(depth)
        n = 0
        reach = outer*body%spacing
        associate (search => solid%search)
            do t = 1, size(body%surface, 3)
                high = maxval(body%surface(:, :, t), 2)
                low = minval(body%surface(:, :, t), 2)
                call box_span(search, (low + high)/2, (high - low)/2 + reach, lo, hi)
                do c3 = lo(3), hi(3)
                    do c2 = lo(2), hi(2)
                        do c1 = lo(1), hi(1)
                            c = number_of_cell(search, c1, c2, c3)
                            do k = search%start(c), search%start(c + 1) - 1
                                i = search%order(k)
                                away = nearest_on(body%surface(:, :, t), solid%x_ref(:, i)) &
                                       - solid%x_ref(:, i)
                                if (.not. norm2(away) < depth(i)) cycle
                                depth(i) = norm2(away)
                                n(:, i) = away/max(depth(i), tiny(reach))
                            end do
                        end do
                    end do
                end do
            end do
        end associate
    end subroutine reach_surface

    !> Depth of a place below the surface of a round body, and the unit normal there, outward.
    pure subroutine find_depth(body, dimension, x, depth, n)
        type(body_t), intent(in) :: body
        integer, intent(in) :: dimension
        real(dp), intent(in) :: x(3) !! [m]
        real(dp), intent(out) :: depth, n(3)
        real(dp) :: d(3), r

        associate (round => body%round)
            d = x - round%centre
            d(dimension + 1:) = 0
            if (round%axis > 0) d(round%axis) = 0
            r = norm2(d)
            n = d/max(r, tiny(r))
            depth = round%radius(1) - r
            if (round%radius(2) > 0 .and. r - round%radius(2) < depth) then
                depth = r - round%radius(2)
                n = -n
            end if
        end associate
    end subroutine find_depth

    !> Weights with which the sum of body b is 1 half a spacing outside its surface.
    subroutine weigh_cells(solid, b, depth, n)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: depth(solid%bodies(b)%first:), n(:, solid%bodies(b)%first:)
        real(dp) :: half
        real(dp), allocatable :: weight(:)
        integer :: i, k

        associate (body => solid%bodies(b))
            half = body%spacing/2
            allocate (weight(body%first:body%last), source=1.0_dp)
            do k = 1, rounds
                do i = body%first, body%last
                    if (depth(i) > outer*body%spacing .or. depth(i) < -half) cycle
                    weight(i) = solid%links%weight(i) &
                                /own_sum(solid, b, solid%x_ref(:, i) + (depth(i) + half)*n(:, i))
                    weight(i) = max(1/most_weight, min(most_weight, weight(i)))
                end do
                solid%links%weight(body%first:body%last) = real(weight, real32)
            end do
        end associate
    end subroutine weigh_cells

    !> Kernel sum at a place over a body and its images, 1 at a flat surface one spacing away.
    pure real(dp) function own_sum(solid, b, x) result(s)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: x(3) !! [m]
        integer :: a, m
        logical :: there

        s = tiny(s)
        do m = 0, 7
            there = .true.
            do a = 1, 3
                there = there .and. (solid%mirror(a) .or. .not. btest(m, a - 1))
            end do
            if (there) call add_image(solid, b, signs(m)*x, s)
        end do
    end function own_sum

    pure subroutine add_image(solid, b, x, s)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: x(3) !! [m]
        real(dp), intent(inout) :: s
        real(rk) :: distance, slope
        integer :: c, c1, c2, c3, j, k, lo(3), hi(3)

        associate (m => solid%links%table(b, b), search => solid%search)
            call cell_span(search, x, 2*real(m%h, dp), lo, hi)
            do c3 = lo(3), hi(3)
                do c2 = lo(2), hi(2)
                    do c1 = lo(1), hi(1)
                        c = number_of_cell(search, c1, c2, c3)
                        do k = search%start(c), search%start(c + 1) - 1
                            j = search%order(k)
                            distance = real(norm2(solid%x_ref(:, j) - x), rk)
                            if (distance >= 2*m%h) cycle
                            slope = kernel_slope(m%scale, m%half_over_h, distance)
                            s = s + solid%links%cell(b)*solid%mass(j)*solid%links%weight(j) &
                                *kernel_value(slope, m%h, distance)/(solid%depth*m%touch)
                        end do
                    end do
                end do
            end do
        end associate
    end subroutine add_image

    !> Kernel sums of a flat body as its surface touches that of body b: the mean over the bodies
    !> that it may meet.
    subroutine find_thresholds(solid, b, depth)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: depth(solid%bodies(b)%first:)
        real(dp) :: total, touch, slope
        integer :: c, i, partners

        associate (body => solid%bodies(b))
            partners = count(solid%links%table(b, :)%law /= law_none)
            do i = body%first, body%last
                if (depth(i) > body%spacing .or. depth(i) < 0) cycle
                total = 0
                do c = 1, size(solid%bodies)
                    associate (m => solid%links%table(b, c))
                        if (m%law == law_none) cycle
                        call flat_sum(solid%dimension, solid%bodies(c)%spacing, m, &
                                      depth(i) + solid%bodies(c)%spacing/2, touch, slope)
                        total = total + touch/m%touch
                    end associate
                end do
                solid%links%touch(i) = real(total/partners, real32)
            end do
        end associate
    end subroutine find_thresholds
end module brz_contact_surface
