! SPDX-License-Identifier: MIT
!> A blast in one dimension put into the grid of the air, nothing lost.
!>
!> Each cell is probed at points. The cells of the blast are gathered into rings about as thick as
!> two points are apart; every point in a ring gets the same share of what the ring holds, so mass,
!> energy and products come out exactly. Outside the front the air is left as it is; what the
!> rings cover more or less than their true volume is made up for at the front. Momentum points
!> outwards; the small sum that the points leave of it is taken out in proportion to the mass.
!> A half, a quarter or an eighth between planes of symmetry gets what the whole has there.
!> No sum depends on the order of the directions: x, y and z get the same bits.
module brz_blast_remap
    use brz_air_state, only: air_t, bc_symmetry
    use brz_bisection, only: count_up_to
    use brz_blast1d_state, only: blast1d_t, whole_angle
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, int64, rk
    use brz_ranks, only: sum_of_all
    implicit none
    private
    public :: map_blast, outward

    integer, parameter :: points_of(0:2) = [64, 16, 8]
    !! points per direction in a cell: plane, cylinder, sphere
    integer, parameter :: many_cells = 400000 !! of the whole ball; more have half the points
    real(dp), parameter :: on_plane = 1e-6_dp !! how exactly a plane halves a charge, in cells
    integer, parameter :: few_points = 200 !! of a whole ring; with fewer it joins the next
    real(dp), parameter :: unit = 2.0_dp**52
    !! of direction cosines as whole numbers, whose sums are exact in any order

    !> Rings of the blast; the sums are those of the modelled part of the circle.
    type :: rings_t
        integer :: n = 0
        real(dp), allocatable :: edge(:) !! (0:n) radii [m]
        real(dp), allocatable :: held(:, :) !! (4, n) mass, radial momentum, energy, products
        integer(int64), allocatable :: points(:) !! (n)
    end type rings_t

    !> Where and how to probe.
    type :: probe_t
        logical :: active(3) = .true.
        real(dp) :: centre(3) = 0 !! of the charge [m]
        integer :: lo(3) = 1, hi(3) = 1 !! cells of the grid that the front can have reached
        integer :: first(3) = 1, last(3) = 1 !! those of them in the box of this process
        integer :: m(3) = 1 !! points per direction
        real(dp) :: volume = 0 !! of a point, in the directions that are modelled
    end type probe_t

contains

    !> Put the blast into the grid. `centre` is a corner of cells or lies anywhere; `part` of the
    !> circle lies inside the box (1/2 for each plane of symmetry).
    subroutine map_blast(blast, centre, part, air)
        type(blast1d_t), intent(in) :: blast !! prepared
        real(dp), intent(in) :: centre(3) !! [m]
        real(dp), intent(in) :: part
        type(air_t), intent(inout) :: air
        type(rings_t) :: rings
        type(probe_t) :: probe
        real(dp) :: reach
        integer :: cells(3)

        reach = blast%r(blast%front)
        probe%active = air%n > 1
        probe%centre = centre
        where (probe%active)
            probe%lo = max(1, floor((centre - reach - air%lo)/air%dx) + 1)
            probe%hi = min(air%whole, ceiling((centre + reach - air%lo)/air%dx))
        end where
        probe%first = max(probe%lo, air%before + 1)
        probe%last = min(probe%hi, air%before + air%n)
        cells = probe%hi - probe%lo + 1
        probe%m = merge(points_of(blast%input%power), 1, probe%active)
        if (product(real(cells, dp)) > part*many_cells) probe%m = max(probe%m/2, 1)
        probe%volume = product(air%dx/probe%m, mask=probe%active)
        call gather_rings(blast, 2*maxval(air%dx/probe%m, mask=probe%active), part, rings)
        call count_points(air, probe, rings)
        call join_thin_rings(part, rings)
        call make_up_volume(blast, probe, part, rings)
        call pour_rings(air, probe, rings)
        call balance_momentum(air, probe, sum(rings%held(2, :rings%n)))
    end subroutine map_blast

    !> Gather the cells of the blast inside its front into rings of at least a thickness, none of
    !> them across the contact.
    subroutine gather_rings(blast, thickness, part, rings)
        type(blast1d_t), intent(in) :: blast
        real(dp), intent(in) :: thickness !! [m]
        real(dp), intent(in) :: part
        type(rings_t), intent(out) :: rings
        real(dp) :: whole
        integer :: i

        allocate (rings%edge(0:blast%front), source=0.0_dp)
        allocate (rings%held(4, blast%front), source=0.0_dp)
        allocate (rings%points(blast%front), source=0_int64)
        whole = part*whole_angle(blast%input%power)
        rings%n = 1
        do i = 1, blast%front
            associate (n => rings%n)
                rings%held(:3, n) = rings%held(:3, n) + whole*blast%q(:, i)
                if (i <= blast%n_in) rings%held(4, n) = rings%held(4, n) + whole*blast%q(1, i)
                rings%edge(n) = blast%r(i)
                if (i == blast%front) exit
                if (i == blast%n_in .or. blast%r(i) - rings%edge(n - 1) >= thickness) n = n + 1
            end associate
        end do
    end subroutine gather_rings

    !> Ring at a radius; n + 1 outside.
    pure integer function ring_at(rings, radius)
        type(rings_t), intent(in) :: rings
        real(dp), intent(in) :: radius !! [m]

        ring_at = 1 + count_up_to(rings%edge(1:rings%n), radius)
    end function ring_at

    !> How many points lie in each ring.
    subroutine count_points(air, probe, rings)
        type(air_t), intent(in) :: air
        type(probe_t), intent(in) :: probe
        type(rings_t), intent(inout) :: rings
        integer(int64), allocatable :: points(:)
        integer :: i, j, k, a, b, c, ring

        allocate (points(rings%n + 1), source=0_int64)
        !$omp parallel do collapse(2) private(i, a, b, c, ring) reduction(+: points)
        do k = probe%first(3), probe%last(3)
            do j = probe%first(2), probe%last(2)
                do i = probe%first(1), probe%last(1)
                    do c = 1, probe%m(3)
                        do b = 1, probe%m(2)
                            do a = 1, probe%m(1)
                                ring = ring_at(rings, length(arm(air, probe, [i, j, k], &
                                    real([a, b, c], dp))))
                                points(ring) = points(ring) + 1
                            end do
                        end do
                    end do
                end do
            end do
        end do
        !$omp end parallel do
        call sum_of_all(air%part%ranks, points)
        rings%points(:rings%n) = points(:rings%n)
    end subroutine count_points

    !> From the centre of the charge to a point of a cell, in the directions that are modelled.
    pure function arm(air, probe, cell, point)
        type(air_t), intent(in) :: air
        type(probe_t), intent(in) :: probe
        integer, intent(in) :: cell(3)
        real(dp), intent(in) :: point(3) !! from 1 on, in each direction
        real(dp) :: arm(3)

        arm = air%lo + (cell - 1 + (2*point - 1)/(2.0_dp*probe%m))*air%dx - probe%centre
        where (.not. probe%active) arm = 0
    end function arm

    !> Length of a vector, the same bits for any order of its components.
    pure real(dp) function length(x)
        real(dp), intent(in) :: x(3)
        real(dp) :: s(3), middle

        s = x*x
        middle = max(min(s(1), s(2)), min(max(s(1), s(2)), s(3)))
        length = sqrt((minval(s) + middle) + maxval(s))
    end function length

    !> Rings with few points join the next outside, the last one the one before.
    subroutine join_thin_rings(part, rings)
        real(dp), intent(in) :: part
        type(rings_t), intent(inout) :: rings
        integer :: i, n

        n = 0
        do i = 1, rings%n
            if (n > 0) then
                if (rings%points(n) < part*few_points .or. &
                    (i == rings%n .and. rings%points(i) < part*few_points)) then
                    rings%held(:, n) = rings%held(:, n) + rings%held(:, i)
                    rings%points(n) = rings%points(n) + rings%points(i)
                    rings%edge(n) = rings%edge(i)
                    cycle
                end if
            end if
            n = n + 1
            rings%held(:, n) = rings%held(:, i)
            rings%points(n) = rings%points(i)
            rings%edge(n) = rings%edge(i)
        end do
        rings%n = n
    end subroutine join_thin_rings

    !> The points cover a little more or less than the true volume: at the front, add or take the
    !> undisturbed air of the difference. What little the blast has changed ahead of its front
    !> goes there too.
    subroutine make_up_volume(blast, probe, part, rings)
        type(blast1d_t), intent(in) :: blast
        type(probe_t), intent(in) :: probe
        real(dp), intent(in) :: part
        type(rings_t), intent(inout) :: rings
        real(dp) :: rest(3), covered, whole

        whole = part*whole_angle(blast%input%power)
        associate (in => blast%input, held => rings%held(:3, rings%n), front => blast%front, &
                   n => blast%n)
            rest = [in%density, 0.0_dp, in%pressure/(in%gamma - 1)]
            covered = sum(rings%points(:rings%n))*probe%volume
            held = held + rest*(covered - whole*blast%xi(front))
            if (front < n) held = held + whole*(sum(blast%q(:, front + 1:n), dim=2) &
                - rest*(blast%xi(n) - blast%xi(front)))
        end associate
    end subroutine make_up_volume

    !> Give every cell the mean over its points.
    subroutine pour_rings(air, probe, rings)
        type(air_t), intent(inout) :: air
        type(probe_t), intent(in) :: probe
        type(rings_t), intent(in) :: rings
        real(dp), allocatable :: density(:, :)
        real(dp) :: mean(6)
        integer :: i, j, k, ring, inside

        allocate (density(4, rings%n))
        do ring = 1, rings%n
            density(:, ring) = rings%held(:, ring)/(rings%points(ring)*probe%volume)
        end do
        !$omp parallel do collapse(2) private(i, mean, inside)
        do k = probe%first(3), probe%last(3)
            do j = probe%first(2), probe%last(2)
                do i = probe%first(1), probe%last(1)
                    call mean_of_points(air, probe, rings, density, [i, j, k], mean, inside)
                    if (inside == 0) cycle
                    associate (q => air%u(i - air%before(1), j - air%before(2), &
                                          k - air%before(3), :))
                        q = real(1 - inside/real(product(probe%m), dp), rk)*q &
                            + real(mean(:air%n_var), rk)
                    end associate
                end do
            end do
        end do
        !$omp end parallel do
    end subroutine pour_rings

    !> What the rings give to a cell, per volume, and how many of its points they cover.
    pure subroutine mean_of_points(air, probe, rings, density, cell, mean, inside)
        type(air_t), intent(in) :: air
        type(probe_t), intent(in) :: probe
        type(rings_t), intent(in) :: rings
        real(dp), intent(in) :: density(:, :) !! (4, n)
        integer, intent(in) :: cell(3)
        real(dp), intent(out) :: mean(6)
        integer, intent(out) :: inside
        real(dp) :: x(3), radius, half
        integer(int64) :: sums(0:3, rings%n) !! points and their direction cosines in each ring
        integer :: a, b, c, ring, first, last

        mean = 0
        inside = 0
        half = 0.5_dp*length(merge(air%dx, 0.0_dp, probe%active))
        radius = length(arm(air, probe, cell, (probe%m + 1)/2.0_dp))
        first = ring_at(rings, max(radius - 1.001_dp*half, 0.0_dp))
        last = min(ring_at(rings, radius + 1.001_dp*half), rings%n)
        if (first > rings%n) return
        sums(:, first:last) = 0
        do c = 1, probe%m(3)
            do b = 1, probe%m(2)
                do a = 1, probe%m(1)
                    x = arm(air, probe, cell, real([a, b, c], dp))
                    radius = length(x)
                    ring = ring_at(rings, radius)
                    if (ring > rings%n) cycle
                    sums(0, ring) = sums(0, ring) + 1
                    sums(1:3, ring) = sums(1:3, ring) + int(x/max(radius, tiny(radius))*unit, int64)
                end do
            end do
        end do
        do ring = first, last
            inside = inside + int(sums(0, ring))
            mean(1) = mean(1) + density(1, ring)*sums(0, ring)
            mean(2:4) = mean(2:4) + density(2, ring)*(sums(1:3, ring)/unit)
            mean(5:6) = mean(5:6) + density(3:4, ring)*sums(0, ring)
        end do
        mean = mean/product(probe%m)
    end subroutine mean_of_points

    !> Make the momentum of the model what it must be, see `outward`, by one velocity for all cells
    !> that the blast has reached.
    subroutine balance_momentum(air, probe, radial)
        type(air_t), intent(inout) :: air
        type(probe_t), intent(in) :: probe
        real(dp), intent(in) :: radial !! sum of the radial momentum [kg m/s]
        real(dp), allocatable :: moved(:, :) !! (4, cells) mass and momentum per volume
        real(dp) :: total(4), want(3)
        integer :: i, j, k, cells, lo(3), hi(3)

        lo = probe%first - air%before
        hi = probe%last - air%before
        allocate (moved(4, product(max(hi - lo + 1, 0))))
        cells = 0
        do k = lo(3), hi(3)
            do j = lo(2), hi(2)
                do i = lo(1), hi(1)
                    if (at_rest(air, i, j, k)) cycle
                    cells = cells + 1
                    moved(:, cells) = air%u(i, j, k, 1:4)
                end do
            end do
        end do
        call exact_sums(air%part%ranks, moved(:, :cells), total)
        want = radial*outward(air, probe%centre)
        want = (want/product(air%dx, mask=probe%active) - total(2:4))/total(1)
        where (.not. probe%active) want = 0
        do k = lo(3), hi(3)
            do j = lo(2), hi(2)
                do i = lo(1), hi(1)
                    if (at_rest(air, i, j, k)) cycle
                    air%u(i, j, k, 2:4) = air%u(i, j, k, 2:4) + real(want*air%u(i, j, k, 1), rk)
                end do
            end do
        end do
    end subroutine balance_momentum

    !> Momentum along x, y, z over the radial momentum of the modelled part: zero in a direction
    !> that is whole, the mean component over a half where a plane of symmetry passes the centre.
    pure function outward(air, centre) result(share)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: centre(3) !! of the charge [m]
        real(dp), parameter :: half_mean(3) = [1.0_dp, 2/acos(-1.0_dp), 0.5_dp]
        real(dp) :: share(3), cells
        integer :: d

        share = 0
        do d = 1, 3
            if (air%n(d) == 1) cycle
            cells = (centre(d) - air%lo(d))/air%dx(d)
            if (air%outer(1, d) == bc_symmetry .and. abs(cells) < on_plane) &
                share(d) = half_mean(count(air%n > 1))
            if (air%outer(2, d) == bc_symmetry .and. abs(cells - air%whole(d)) < on_plane) &
                share(d) = -half_mean(count(air%n > 1))
        end do
    end function outward

    !> True for a cell that the blast has not reached.
    pure logical function at_rest(air, i, j, k)
        type(air_t), intent(in) :: air
        integer, intent(in) :: i, j, k

        at_rest = all(abs(air%u(i, j, k, 2:4)) <= 0)
    end function at_rest
end module brz_blast_remap
