! SPDX-License-Identifier: MIT
!> Where the surfaces of round bodies are, for contact: that of the shape, not of its lattice.
!>
!> Contact begins where the kernel sum over the other body is that of a flat surface one spacing
!> away. A round surface curves away and a lattice follows it in steps; so the cells of the outer
!> particles of a round body get weights with which its sum is 1 half a spacing outside its true
!> surface, and these particles begin to press where it touches a flat body, not where they would
!> with half a spacing around each.
!>
!> Source: docs/solid.md section 9
module brz_solid_skin
    use brz_cell_grid, only: cell_span, fill_cells, lay_grid
    use brz_contact, only: law_none
    use brz_flat_surface, only: flat_sum
    use brz_kernel, only: kernel_slope, kernel_value
    use brz_kinds, only: dp, real32, rk
    use brz_solid_mirror, only: signs
    use brz_solid_state, only: body_t, solid_t
    implicit none
    private
    public :: find_skin

    integer, parameter :: rounds = 3 !! in which the weights are found
    real(dp), parameter :: most_weight = 4 !! and 1/4 is the least
    real(dp), parameter :: outer = 1.5_dp !! spacings below the surface that have weights

contains

    !> Weights and sums at first touch of the particles of round bodies, from the unloaded ones.
    subroutine find_skin(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b

        if (.not. solid%links%present) return
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%round%radius(1) > 0 .or. solid%dimension == 1) cycle
            if (all(solid%links%table(:, b)%law == law_none)) cycle
            call weigh_cells(solid, b)
            call find_thresholds(solid, b)
        end do
    end subroutine find_skin

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
    subroutine weigh_cells(solid, b)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp) :: depth, n(3), half
        real(dp), allocatable :: weight(:)
        integer :: i, k

        associate (body => solid%bodies(b))
            half = body%spacing/2
            call lay_grid(solid%search, solid%x_ref, solid%fixed, body, 2*real(body%h, dp))
            call fill_cells(solid%search, solid%x_ref, solid%fixed, body)
            allocate (weight(body%first:body%last), source=1.0_dp)
            do k = 1, rounds
                do i = body%first, body%last
                    call find_depth(body, solid%dimension, solid%x_ref(:, i), depth, n)
                    if (depth > outer*body%spacing .or. depth < -half) cycle
                    weight(i) = solid%links%weight(i) &
                                /own_sum(solid, b, solid%x_ref(:, i) + (depth + half)*n)
                    weight(i) = max(1/most_weight, min(most_weight, weight(i)))
                end do
                solid%links%weight(body%first:body%last) = real(weight, real32)
            end do
        end associate
    end subroutine weigh_cells

    !> Kernel sum at a place over a body and its images, 1 at a flat surface one spacing away.
    pure real(dp) function own_sum(solid, b, x) result(s)
        type(solid_t), intent(in) :: solid
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
        type(solid_t), intent(in) :: solid
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
                        c = search%code(c1, 1) + search%code(c2, 2) + search%code(c3, 3)
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

    !> Kernel sums of a flat body as its surface touches that of the round body b: the mean over the
    !> bodies that it may meet.
    subroutine find_thresholds(solid, b)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp) :: depth, n(3), total, touch, slope
        integer :: c, i, partners

        associate (body => solid%bodies(b))
            partners = count(solid%links%table(b, :)%law /= law_none)
            do i = body%first, body%last
                call find_depth(body, solid%dimension, solid%x_ref(:, i), depth, n)
                if (depth > body%spacing .or. depth < 0) cycle
                total = 0
                do c = 1, size(solid%bodies)
                    associate (m => solid%links%table(b, c))
                        if (m%law == law_none) cycle
                        call flat_sum(solid%dimension, solid%bodies(c)%spacing, m, &
                                      depth + solid%bodies(c)%spacing/2, touch, slope)
                        total = total + touch/m%touch
                    end associate
                end do
                solid%links%touch(i) = real(total/partners, real32)
            end do
        end associate
    end subroutine find_thresholds
end module brz_solid_skin
