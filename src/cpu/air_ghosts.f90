! SPDX-License-Identifier: MIT
!> Ghost cells of the air: open boundaries let waves out, walls and symmetry planes mirror, a
!> periodic box goes on from the other end.
!>
!> Ghosts of gas at rest must be at rest to the bit: see brz_air_activity. Only ghosts straight
!> across a face are filled; no stencil reaches into edges or corners.
module brz_air_ghosts
    use brz_kinds, only: rk
    use brz_air_outside, only: keep_outside
    use brz_air_state, only: air_t, bc_inside, bc_outflow, bc_symmetry, bc_wall, n_ghost, wall_t
    use brz_air_walls, only: image_of
    use brz_fetch, only: fetch
    use brz_grid_lines, only: across, turned
    use brz_outflow, only: open_ghosts
    use brz_scheme, only: max_var
    implicit none
    private
    public :: fill_ghosts

    integer, parameter :: few_faces = 2000 !! fewer are not worth waking the other threads

contains

    !> Fill the ghosts of all directions that are modelled. Where the box of another process begins
    !> they are its cells.
    subroutine fill_ghosts(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer :: d, m, p, side
        real(rk) :: sign

        call keep_outside(air)
        call fetch(air%part%ranks, air%part%halo, air%n_var, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%u)
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do side = 1, 2
                if (air%bc(side, d) == bc_inside) cycle
                if (air%bc(side, d) == bc_outflow) then
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

    !> Fill the ghosts at the open end of one line. The gas outside also stands for solid cells.
    subroutine open_line(air, wall, d, side, line)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        integer, intent(in) :: line(2) !! transverse indices
        integer :: cell(3), m, turn(air%n_var)
        real(rk) :: outside(max_var), inside(max_var, 3), ghost(max_var, 3)
        logical :: solid

        turn = turned(:air%n_var, d)
        outside = 0
        outside(:air%n_var) = air%outside(side, d)%q(turn, line(1), line(2))
        inside = 0
        cell(across(:, d)) = line
        do m = 3, 1, -1
            cell(d) = merge(min(m, air%n(d)), air%n(d) + 1 - min(m, air%n(d)), side == 1)
            inside(:air%n_var, m) = air%u(cell(1), cell(2), cell(3), turn)
            solid = .false.
            if (wall%present) solid = wall%solid(cell(1), cell(2), cell(3)) /= 0
            if (solid) inside(:, m) = outside
        end do
        if (solid) then
            ghost = spread(outside, 2, 3)
        else
            call open_ghosts(air%scheme, min(3, air%n(d)), inside, outside, 2*side - 3, ghost)
        end if
        do m = 1, n_ghost
            cell(d) = merge(1 - m, air%n(d) + m, side == 1)
            air%u(cell(1), cell(2), cell(3), turn) = ghost(:air%n_var, m)
        end do
    end subroutine open_line

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
