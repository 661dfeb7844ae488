! SPDX-License-Identifier: MIT
!> A blast in the plane through its axis put into the grid of the air, nothing lost.
!>
!> Each cell of the grid is probed at points and takes the mean of what the cells of the plane hold
!> there, its radial momentum turned into the direction of the point. What the points sum up a
!> little wrong is put right by one factor for each sum (of air: where it is compressed), and along
!> directions that no plane of symmetry cuts by one velocity. Sums do not depend on their order: a
!> half, a quarter or an eighth between planes of symmetry gets what the whole has there, and so
!> does a box of many processes.
module brz_axial_remap
    use brz_air_state, only: air_t
    use brz_axial_inside, only: inside_t
    use brz_axial_start, only: frame_t
    use brz_axial_state, only: axial_t, top_of, v_energy, v_products, v_r, v_rho, v_z
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: map_axial

    integer, parameter :: n_points = 8 !! per direction in a cell
    integer, parameter :: many_cells = 400000 !! of the whole blast; more have half the points
    integer, parameter :: s_air = 1, s_energy = 5, s_products = 6, s_radial = 7, &
                          s_axial = 8, n_sums = 8 !! rows of sums, the last two of amounts

    !> Where to probe.
    type :: sampling_t
        integer :: first(3) = 1, last(3) = 0 !! cells of the box of this process
        integer :: m = n_points !! points per direction
    end type sampling_t

contains

    !> Put what lies in the box into the grid, which holds a part of the blast (1/2 for each plane
    !> of symmetry through the centre).
    subroutine map_axial(blast, frame, inside, part, air, off, ok)
        type(axial_t), intent(in) :: blast !! all of it burnt
        type(frame_t), intent(in) :: frame
        type(inside_t), intent(in) :: inside !! sums that the grid shall have
        real(dp), intent(in) :: part
        type(air_t), intent(inout) :: air !! undisturbed
        real(dp), intent(out) :: off !! largest relative error of the sums of points
        logical, intent(out) :: ok !! no cell has lost its pressure
        type(sampling_t) :: probe
        real(dp), allocatable :: sums(:, :)
        !! (8, cells) air, momentum, energy, products, radial and amount of axial momentum, over
        !! rest, per volume
        integer, allocatable :: at(:, :) !! (3, cells)
        real(dp) :: total(n_sums), factor(n_sums), push(3), dense(1)
        integer :: n

        call place_probe(blast, frame, part, air, probe)
        call probe_cells(blast, frame, air, probe, sums, at, n)
        call exact_sums(air%part%ranks, sums(:, :n), total)
        call exact_sums(air%part%ranks, max(sums(1:1, :n), 0.0_dp), dense)
        total = total*product(air%dx)
        dense = dense*product(air%dx)
        factor = 1
        factor(s_air) = 1 + (inside%mass - inside%products - total(s_air))/dense(1)
        factor(s_energy) = inside%energy/total(s_energy)
        if (total(s_products) > 0) factor(s_products) = inside%products/total(s_products)
        if (total(s_radial) > 0) factor(s_radial) = inside%radial/total(s_radial)
        if (total(s_axial) > 0) factor(s_axial) = inside%axial/total(s_axial)
        off = maxval(abs(factor - 1))
        factor(1 + frame%across) = factor(s_radial)
        factor(1 + frame%axis) = factor(s_axial)
        push = merge(0.0_dp, inside%momentum - factor(2:4)*total(2:4), frame%mirrored)
        call pour(air, sums(:, :n), at(:, :n), factor, push, ok)
    end subroutine map_axial

    !> Cells of the box that the front can have reached.
    subroutine place_probe(blast, frame, part, air, probe)
        type(axial_t), intent(in) :: blast
        type(frame_t), intent(in) :: frame
        real(dp), intent(in) :: part
        type(air_t), intent(in) :: air
        type(sampling_t), intent(out) :: probe
        real(dp) :: lo(3), hi(3), ends(2)
        integer :: first(3), last(3)

        lo = frame%centre - blast%reach*blast%dr
        hi = frame%centre + blast%reach*blast%dr
        ends = frame%sense*[top_of(blast, blast%first - 1), top_of(blast, blast%last)]
        lo(frame%axis) = frame%centre(frame%axis) + minval(ends)
        hi(frame%axis) = frame%centre(frame%axis) + maxval(ends)
        first = max(1, floor((lo - air%lo)/air%dx) + 1)
        last = min(air%whole, ceiling((hi - air%lo)/air%dx))
        if (product(real(last - first + 1, dp)) > part*many_cells) probe%m = n_points/2
        probe%first = max(first - air%before, 1)
        probe%last = min(last - air%before, air%n)
    end subroutine place_probe

    !> What each cell takes, in the order of the cells.
    subroutine probe_cells(blast, frame, air, probe, sums, at, n)
        type(axial_t), intent(in) :: blast
        type(frame_t), intent(in) :: frame
        type(air_t), intent(in) :: air
        type(sampling_t), intent(in) :: probe
        real(dp), allocatable, intent(out) :: sums(:, :) !! (n_sums, cells)
        integer, allocatable, intent(out) :: at(:, :) !! (3, cells)
        integer, intent(out) :: n !! cells that the blast has reached
        real(dp), allocatable :: row(:, :, :)
        logical, allocatable :: inside(:, :)
        integer :: i, j, k, most

        most = product(max(probe%last - probe%first + 1, 0))
        allocate (sums(n_sums, most), at(3, most))
        associate (a => probe%first, b => probe%last)
            allocate (row(n_sums, a(1):b(1), a(2):b(2)), inside(a(1):b(1), a(2):b(2)))
            n = 0
            do k = a(3), b(3)
                !$omp parallel do private(i)
                do j = a(2), b(2)
                    do i = a(1), b(1)
                        call mean_of_points(blast, frame, air, probe%m, [i, j, k], row(:, i, j), &
                            inside(i, j))
                    end do
                end do
                !$omp end parallel do
                do j = a(2), b(2)
                    do i = a(1), b(1)
                        if (.not. inside(i, j)) cycle
                        n = n + 1
                        sums(:, n) = row(:, i, j)
                        at(:, n) = [i, j, k]
                    end do
                end do
            end do
        end associate
    end subroutine probe_cells

    !> Mean over the points of a cell of air, momentum, energy, products and radial momentum, over
    !> those of undisturbed air.
    pure subroutine mean_of_points(blast, frame, air, m, cell, mean, inside)
        type(axial_t), intent(in) :: blast
        type(frame_t), intent(in) :: frame
        type(air_t), intent(in) :: air
        integer, intent(in) :: m !! points per direction
        integer, intent(in) :: cell(3)
        real(dp), intent(out) :: mean(n_sums)
        logical, intent(out) :: inside !! the blast has reached a point
        real(dp) :: arm(3), r, q(5)
        integer :: a, b, c, i, j, step(3)

        mean = 0
        inside = .false.
        do c = 1, m
            do b = 1, m
                do a = 1, m
                    step([frame%across, frame%axis]) = [a, b, c]
                    arm = (air%lo - frame%centre) &
                        + (cell + air%before - 1 + (2*step - 1)/(2.0_dp*m))*air%dx
                    arm(frame%axis) = frame%sense*arm(frame%axis)
                    r = sqrt(arm(frame%across(1))**2 + arm(frame%across(2))**2)
                    j = floor((arm(frame%axis) - blast%rise)/blast%dz) + 1
                    if (j < blast%first .or. j > blast%last) cycle
                    i = int(r/blast%dr) + 1
                    if (i > blast%reached(j)) cycle
                    inside = .true.
                    q = blast%u(i, :, j) - blast%rest
                    mean([s_air, s_energy, s_products]) = mean([s_air, s_energy, s_products]) &
                        + [q(v_rho) - q(v_products), q(v_energy), q(v_products)]
                    mean(1 + frame%across) = mean(1 + frame%across) &
                        + q(v_r)*(arm(frame%across)/max(r, tiny(r)))
                    mean(1 + frame%axis) = mean(1 + frame%axis) + frame%sense*q(v_z)
                    mean(s_radial) = mean(s_radial) + q(v_r)
                    mean(s_axial) = mean(s_axial) + abs(q(v_z))
                end do
            end do
        end do
        mean = mean/m**3
    end subroutine mean_of_points

    !> Give the cells what they take, put right.
    subroutine pour(air, sums, at, factor, push, ok)
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: sums(:, :) !! (n_sums, cells)
        integer, intent(in) :: at(:, :) !! (3, cells)
        real(dp), intent(in) :: factor(:)
        real(dp), intent(in) :: push(3) !! momentum that is missing [kg m/s]
        logical, intent(out) :: ok
        real(dp), allocatable :: q(:, :)
        real(dp) :: mass(1)
        integer :: m

        allocate (q(6, size(at, 2)))
        ok = .true.
        do m = 1, size(at, 2)
            q(:, m) = factor(:6)*sums(:6, m)
            if (sums(s_air, m) < 0) q(1, m) = sums(s_air, m)
            q(1, m) = max(air%rest(1) + q(1, m), 0.0_dp) + q(s_products, m)
            q(5, m) = q(5, m) + air%rest(5)
        end do
        call exact_sums(air%part%ranks, q(1:1, :), mass)
        mass = mass*product(air%dx)
        do m = 1, size(at, 2)
            q(2:4, m) = q(2:4, m) + push/mass(1)*q(1, m)
            if (.not. (q(1, m) > 0 .and. q(5, m)*q(1, m) > 0.5_dp*sum(q(2:4, m)**2))) ok = .false.
            air%u(at(1, m), at(2, m), at(3, m), :) = real(q(:air%n_var, m), rk)
        end do
    end subroutine pour
end module brz_axial_remap
