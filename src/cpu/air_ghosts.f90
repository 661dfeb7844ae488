! SPDX-License-Identifier: MIT
!> Ghost cells of the air: open boundaries let waves out, walls and symmetry planes mirror, a
!> periodic box goes on from the other end.
!>
!> Ghosts of gas at rest must be at rest to the bit: see brz_air_activity. Only ghosts straight
!> across a face are filled; no stencil reaches into edges or corners.
module brz_air_ghosts
    use brz_kinds, only: rk
    use brz_air_outside, only: keep_outside
    use brz_air_state, only: air_t, bc_outflow, bc_symmetry, bc_wall, wall_t
    use brz_air_walls, only: image_of
    use brz_gas, only: to_conserved, to_primitive
    use brz_grid_lines, only: across, turned
    use brz_outflow, only: beyond, minmod
    use brz_scheme, only: max_var, mixture_gamma
    implicit none
    private
    public :: fill_ghosts

    integer, parameter :: few_faces = 2000 !! fewer are not worth waking the other threads

contains

    !> Fill the ghosts of all directions that are modelled.
    subroutine fill_ghosts(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer :: d, m, p, side
        real(rk) :: sign

        do d = 1, 3
            if (air%n(d) == 1) cycle
            do side = 1, 2
                if (air%bc(side, d) == bc_outflow) then
                    if (.not. allocated(air%outside(side, d)%q)) call keep_outside(air)
                    call open_side(air, wall, d, side)
                    cycle
                end if
                sign = 1
                if (air%bc(side, d) == bc_wall .or. air%bc(side, d) == bc_symmetry) sign = -1
                do m = 1, air%g(d)
                    p = merge(1 - m, air%n(d) + m, side == 1)
                    call copy_layer(air, d, p, image_of(air, d, p), sign)
                end do
            end do
        end do
    end subroutine fill_ghosts

    !> Fill the ghosts behind an open boundary.
    subroutine open_side(air, wall, d, side)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        integer :: j, k, n(2)

        n = air%n(across(:, d))
        !$omp parallel do collapse(2) schedule(static) if (product(n) > few_faces)
        do k = 1, n(2)
            do j = 1, n(1)
                call open_line(air, wall, d, side, [j, k])
            end do
        end do
        !$omp end parallel do
    end subroutine open_side

    !> Fill the ghosts at the open end of one line: the gas inside goes on with a limited slope, and
    !> the gas outside answers. It also stands for solid cells.
    subroutine open_line(air, wall, d, side, line)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        integer, intent(in) :: line(2) !! transverse indices
        integer :: cell(3), m, outward
        real(rk) :: q(max_var), outside(max_var), far(5), w(5, 3), slope(5), out(5)
        real(rk) :: next(5), turned_q(5), gamma, gamma_far, fraction
        logical :: copy

        outward = 2*side - 3
        q = 0
        outside = 0
        outside(:air%n_var) = air%outside(side, d)%q(:, line(1), line(2))
        cell(across(:, d)) = line
        w = 0
        copy = .false.
        do m = min(3, air%n(d)), 1, -1
            cell(d) = merge(m, air%n(d) + 1 - m, side == 1)
            q(:air%n_var) = air%u(cell(1), cell(2), cell(3), :)
            if (wall%present) copy = wall%solid(cell(1), cell(2), cell(3)) /= 0
            if (copy) q = outside
            call turn_to_primitive(air, d, q, w(:, m), gamma)
        end do
        if (.not. copy) then
            call turn_to_primitive(air, d, outside, far, gamma_far)
            fraction = q(6)/q(1)
            slope = 0
            if (air%n(d) > 2) slope = minmod(w(:, 2) - w(:, 3), w(:, 1) - w(:, 2))
            slope(1:5:4) = max(slope(1:5:4), -w(1:5:4, 1)/(2*air%g(d)))
            call beyond(gamma, w(:, 1) + slope, gamma_far, far, outward, out)
            copy = .not. any(abs(out - w(:, 1)) > 0)
            if (outward*out(2) < 0) then ! gas from outside, to which the slope does not belong
                slope = 0
                gamma = gamma_far
                fraction = outside(6)/outside(1)
            end if
        end if
        do m = 1, air%g(d)
            cell(d) = merge(1 - m, air%n(d) + m, side == 1)
            if (.not. copy) then
                next = out + (m - 1)*slope
                next(1:5:4) = out(1:5:4)*(w(1:5:4, 1) + m*slope(1:5:4)) &
                    /(w(1:5:4, 1) + slope(1:5:4)) ! stays positive
                call to_conserved(gamma, next, turned_q)
                q(turned(:5, d)) = turned_q
                q(6) = fraction*q(1)
            end if
            air%u(cell(1), cell(2), cell(3), :) = q(:air%n_var)
        end do
    end subroutine open_line

    !> Primitive variables of a state, the normal velocity in slot 2, and its gamma.
    pure subroutine turn_to_primitive(air, d, q, w, gamma)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        real(rk), intent(in) :: q(max_var) !! conserved variables
        real(rk), intent(out) :: w(5)
        real(rk), intent(out) :: gamma

        gamma = air%scheme%gamma
        if (air%scheme%mixture) gamma = mixture_gamma(air%scheme, q(6)/q(1))
        call to_primitive(gamma, q(turned(:5, d)), w)
    end subroutine turn_to_primitive

    !> Copy one layer of cells normal to d; the normal momentum is multiplied by `sign`.
    subroutine copy_layer(air, d, to, from, sign)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: to, from !! indices of the layers along d
        real(rk), intent(in) :: sign
        integer :: i, j, k, c, lo(3), hi(3), shift(3)
        real(rk) :: s

        lo = 1
        hi = air%n
        lo(d) = to
        hi(d) = to
        shift = 0
        shift(d) = from - to
        do c = 1, air%n_var
            s = merge(sign, 1.0_rk, c == d + 1)
            do k = lo(3), hi(3)
                do j = lo(2), hi(2)
                    do i = lo(1), hi(1)
                        air%u(i, j, k, c) = s*air%u(i + shift(1), j + shift(2), k + shift(3), c)
                    end do
                end do
            end do
        end do
    end subroutine copy_layer
end module brz_air_ghosts
