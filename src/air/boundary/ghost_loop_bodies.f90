! SPDX-License-Identifier: MIT
!> Ghost cells at the ends of the lines of the air: open boundaries let waves out, walls and
!> symmetry planes mirror, a periodic box goes on from the other end.
!>
!> Ghosts of gas at rest must be at rest to the bit: see brz_brick_loop_bodies. Only ghosts straight
!> across a face are filled; no stencil reaches into edges or corners.
module brz_ghost_loop_bodies
    use brz_air_boundary, only: image_at
    use brz_air_grid, only: grid_t, line_start, rest_t, variable_in_slot
    use brz_boundary_codes, only: bc_inside, bc_outflow, bc_periodic, bc_symmetry, bc_wall
    use brz_kinds, only: int64, int8, rk
    use brz_outflow, only: open_ghosts
    use brz_scheme, only: max_var, scheme_t
    implicit none
    private
    public :: fill_end, change_outside, mark_end

contains

    !> Fill the ghosts at one end of a line: the low ends of the lines of all directions come first,
    !> then the high ones. Those where the box of another process begins are left alone.
    !@loop_body if(n > 2000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine fill_end(t, grid, scheme, outside, u)
        integer, intent(in) :: t !! ends, twice the lines
        type(grid_t), intent(in) :: grid
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: outside(*) !! (lines, n_var, 2) gas beyond open boundaries
        real(rk), intent(inout) :: u(*)
        integer(int64) :: first
        integer :: d, line, side

        side = 1
        if (t > grid%lines) side = 2
        line = t - (side - 1)*grid%lines
        d = 1
        if (line > grid%before(2)) d = 2
        if (line > grid%before(3)) d = 3
        if (grid%bc(side, d) == bc_inside) return
        first = line_start(grid, d, line - grid%before(d))
        if (grid%bc(side, d) == bc_outflow) then
            call open_end(d, side, grid, scheme, line, first, outside, u)
        else
            call image_end(d, side, grid, first, u)
        end if
    end subroutine fill_end

    !> Give the gas outside an open face a new state.
    !@loop_body if(n > 2000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine change_outside(t, grid, d, side, gas, outside)
        integer, intent(in) :: t !! lines along the direction
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        type(rest_t), intent(in) :: gas
        real(rk), intent(inout) :: outside(*) !! (lines, n_var, 2)
        integer :: c

        do c = 1, grid%n_var
            outside(grid%before(d) + t + (c - 1 + (side - 1)*grid%n_var)*int(grid%lines, int64)) &
                = gas%u(c)
        end do
    end subroutine change_outside

    !> The bricks at a face count as reached.
    !@loop_body if(n > 2000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine mark_end(b, grid, d, side, reached)
        integer, intent(in) :: b !! bricks
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        integer(int8), intent(inout) :: reached(*)

        if (mod((b - 1)/grid%brick_step(d), grid%bricks(d)) + 1 &
            == merge(1, grid%bricks(d), side == 1)) reached(b) = 1
    end subroutine mark_end

    !> Ghosts behind a wall, a symmetry plane or a periodic boundary.
    !@cuf attributes(host,device) &
    pure subroutine image_end(d, side, grid, first, u)
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        type(grid_t), intent(in) :: grid
        integer(int64), intent(in) :: first !! place of the first cell of the line
        real(rk), intent(inout) :: u(*)
        integer(int64) :: to, from
        integer :: bc, c, m, n, p
        real(rk) :: sign

        n = grid%n(d)
        bc = grid%bc(side, d)
        do m = 1, min(grid%g(d), 3)
            p = merge(1 - m, n + m, side == 1)
            to = first + (p - 1)*grid%step(d)
            from = first + (image_at(n, bc, bc, p) - 1)*grid%step(d)
            if (bc == bc_periodic) from = first + modulo(p - 1, n)*grid%step(d)
            do c = 1, grid%n_var
                sign = 1
                if (c == d + 1 .and. (bc == bc_wall .or. bc == bc_symmetry)) sign = -1
                u(to + (c - 1)*grid%apart) = sign*u(from + (c - 1)*grid%apart)
            end do
        end do
    end subroutine image_end

    !> Ghosts behind an open boundary.
    !@cuf attributes(host,device) &
    pure subroutine open_end(d, side, grid, scheme, line, first, outside, u)
        integer, intent(in) :: d !! direction
        integer, intent(in) :: side !! 1: low, 2: high
        type(grid_t), intent(in) :: grid
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: line !! of those of all directions
        integer(int64), intent(in) :: first !! place of its first cell
        real(rk), intent(in) :: outside(*)
        real(rk), intent(inout) :: u(*)
        real(rk) :: far(max_var), inside(max_var, 3), ghost(max_var, 3)
        integer(int64) :: at
        integer :: c, cells, m

        cells = min(3, grid%n(d))
        do m = 3, 1, -1
            at = first + merge(min(m, cells) - 1, grid%n(d) - min(m, cells), side == 1)*grid%step(d)
            do c = 1, max_var
                far(c) = 0
                inside(c, m) = 0
                if (c > grid%n_var) cycle
                far(c) = outside(line + (variable_in_slot(c, d) - 1 + (side - 1)*grid%n_var) &
                    *int(grid%lines, int64))
                inside(c, m) = u(at + (variable_in_slot(c, d) - 1)*grid%apart)
            end do
        end do
        call open_ghosts(scheme, cells, inside, far, 2*side - 3, ghost)
        do m = 1, 3
            at = first + merge(-m, grid%n(d) + m - 1, side == 1)*grid%step(d)
            do c = 1, max_var
                if (c <= grid%n_var) &
                    u(at + (variable_in_slot(c, d) - 1)*grid%apart) = ghost(c, m)
            end do
        end do
    end subroutine open_end
end module brz_ghost_loop_bodies
