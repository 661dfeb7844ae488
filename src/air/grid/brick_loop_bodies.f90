! SPDX-License-Identifier: MIT
!> Blocks of cells of the air, called bricks: which something has reached, which are active; sums
!> over their cells, and over what leaves through their faces.
!>
!> A brick at rest holds gas with the density and energy of the undisturbed air to the bit, and a
!> velocity below the rounding error of the sound speed. It is put to rest wholly, or else every
!> step would carry ever smaller numbers a few cells further. Any other brick, or one that holds
!> solid, is reached, and stays so. Bricks so near that a step can carry something from a reached
!> one into them are active too. The rates of all other cells are zero to the bit, so leaving them
!> out changes nothing.
module brz_brick_loop_bodies
    use brz_air_grid, only: brick, grid_t, place_of, rest_t, stage_t
    use brz_boundary_codes, only: bc_inside, bc_periodic
    use brz_kinds, only: dp, int64, int8, rk
    implicit none
    private
    public :: look_at_row, settle_row, wake_near, total_brick, sum_face, rows_of_brick

    integer, parameter :: rows_of_brick = brick*brick !! of cells along x

contains

    !> Mark an active brick as reached if a row of its cells is not at rest. Whoever marks a brick
    !> writes the same number.
    !@loop_body if(n > 40000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine look_at_row(t, grid, rest, u, active, reached)
        integer, intent(in) :: t !! rows of bricks
        type(grid_t), intent(in) :: grid
        type(rest_t), intent(in) :: rest
        real(rk), intent(in) :: u(*)
        integer(int8), intent(in) :: active(*)
        integer(int8), intent(inout) :: reached(*)
        integer(int64) :: at, first
        integer :: c, cells
        logical :: moved

        call find_row(t, grid, active, reached, first, cells)
        moved = .false.
        do c = 1, grid%n_var
            do at = first + (c - 1)*grid%apart, first + (c - 1)*grid%apart + cells - 1
                if (c > 1 .and. c < 5) then
                    if (.not. abs(u(at)) <= rest%momentum) moved = .true.
                else
                    if (.not. abs(u(at) - rest%u(c)) <= 0) moved = .true.
                end if
            end do
        end do
        if (moved) reached((t - 1)/rows_of_brick + 1) = 1_int8
    end subroutine look_at_row

    !> Put a row of an active brick that nothing has reached to rest.
    !@loop_body if(n > 40000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine settle_row(t, grid, active, reached, u)
        integer, intent(in) :: t !! rows of bricks
        type(grid_t), intent(in) :: grid
        integer(int8), intent(in) :: active(*), reached(*)
        real(rk), intent(inout) :: u(*)
        integer(int64) :: at, first
        integer :: c, cells

        call find_row(t, grid, active, reached, first, cells)
        do c = 1, 3
            do at = first + c*grid%apart, first + c*grid%apart + cells - 1
                if (abs(u(at)) > 0) u(at) = 0
            end do
        end do
    end subroutine settle_row

    !> Place of the first cell of a row, and how many cells it has; none where nothing is to be
    !> asked: what sleeps is at rest, what was reached stays so.
    !@cuf attributes(host,device) &
    pure subroutine find_row(t, grid, active, reached, first, cells)
        integer, intent(in) :: t !! row
        type(grid_t), intent(in) :: grid
        integer(int8), intent(in) :: active(*), reached(*)
        integer(int64), intent(out) :: first
        integer, intent(out) :: cells
        integer :: b, i, j, k

        first = 0
        cells = 0
        b = (t - 1)/rows_of_brick + 1
        if (active(b) == 0 .or. reached(b) /= 0) return
        i = mod(b - 1, grid%bricks(1))*brick + 1
        j = mod((b - 1)/grid%brick_step(2), grid%bricks(2))*brick + 1 + mod(t - 1, brick)
        k = (b - 1)/grid%brick_step(3)*brick + 1 + mod((t - 1)/brick, brick)
        if (j > grid%n(2) .or. k > grid%n(3)) return
        first = place_of(grid, i, j, k)
        cells = min(brick, grid%n(1) - i + 1)
    end subroutine find_row

    !> Active are the reached bricks and those as near as a step reaches, across periodic boundaries
    !> too.
    !@loop_body if(n > 2000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine wake_near(b, grid, layers_x, layers_y, layers_z, reached, active)
        integer, intent(in) :: b !! bricks
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: layers_x, layers_y, layers_z !! bricks on each side
        integer(int8), intent(in) :: reached(*)
        integer(int8), intent(inout) :: active(*)
        integer :: at, i, j, k, x, y, z

        i = mod(b - 1, grid%bricks(1)) + 1
        j = mod((b - 1)/grid%brick_step(2), grid%bricks(2)) + 1
        k = (b - 1)/grid%brick_step(3) + 1
        active(b) = 1
        do z = k - layers_z, k + layers_z
            do y = j - layers_y, j + layers_y
                do x = i - layers_x, i + layers_x
                    at = place_round(grid, x, y, z)
                    if (at == 0) cycle
                    if (reached(at) /= 0) return
                end do
            end do
        end do
        active(b) = 0
    end subroutine wake_near

    !> Place of a brick in the map, 0 beyond a boundary that is not periodic.
    !@cuf attributes(host,device) &
    pure function place_round(grid, x, y, z) result(place)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: x, y, z !! brick
        integer :: place, d, m(3)

        m(1) = x
        m(2) = y
        m(3) = z
        place = 0
        do d = 1, 3
            if (grid%around(d) > 0) m(d) = modulo(m(d) - 1, grid%bricks(d)) + 1
            if (m(d) < 1 .or. m(d) > grid%bricks(d)) return
        end do
        place = m(1) + (m(2) - 1)*grid%brick_step(2) + (m(3) - 1)*grid%brick_step(3)
    end function place_round

    !> Sum of a conserved variable, or of the kinetic energy, over the gas cells of a brick.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine total_brick(t, grid, u, solid, part)
        integer, intent(in) :: t !! bricks, times one more than the conserved variables
        type(grid_t), intent(in) :: grid
        real(rk), intent(in) :: u(*)
        integer(int8), intent(in) :: solid(*) !! read where bodies are
        real(dp), intent(inout) :: part(*) !! (0:n_var, bricks) per volume, 0: kinetic energy
        real(dp) :: row(brick), total
        integer :: b, bricks, c, i, j, k, low(3)

        bricks = grid%bricks(3)*grid%brick_step(3)
        c = (t - 1)/bricks
        b = t - c*bricks
        low(1) = mod(b - 1, grid%bricks(1))*brick
        low(2) = mod((b - 1)/grid%brick_step(2), grid%bricks(2))*brick
        low(3) = (b - 1)/grid%brick_step(3)*brick
        total = 0
        do k = low(3) + 1, min(low(3) + brick, grid%n(3))
            do j = low(2) + 1, min(low(2) + brick, grid%n(2))
                do i = 1, brick ! fetched side by side
                    row(i) = content(grid, low(1) + i, j, k, c, u, solid)
                end do
                do i = 1, brick
                    total = total + row(i)
                end do
            end do
        end do
        part(c + 1 + (b - 1)*(grid%n_var + 1)) = total
    end subroutine total_brick

    !> A conserved variable, or the kinetic energy, of a cell; 0 beyond the grid and without gas.
    !@cuf attributes(host,device) &
    pure function content(grid, i, j, k, c, u, solid) result(value)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: i, j, k !! cell
        integer, intent(in) :: c !! variable, 0: kinetic energy
        real(rk), intent(in) :: u(*)
        integer(int8), intent(in) :: solid(*) !! read where bodies are
        real(dp) :: value
        real(rk) :: rho
        integer(int64) :: at
        logical :: counts

        at = place_of(grid, min(i, grid%n(1)), j, k)
        counts = i <= grid%n(1)
        if (grid%walls == 2) counts = counts .and. solid(at) == 0
        if (c > 0) then
            value = u(at + (c - 1)*grid%apart)
        else
            rho = u(at)
            if (.not. counts) rho = 1
            value = (u(at + grid%apart)**2 + u(at + 2*grid%apart)**2 + u(at + 3*grid%apart)**2) &
                /(2*rho)
        end if
        if (.not. counts) value = 0
    end function content

    !> Add what leaves in a stage through the face of a brick at the boundary, line by line.
    !@loop_body if(n >= 500) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine sum_face(t, faces, grid, stage, edge, leaving)
        integer, intent(in) :: t !! such faces of all directions, variables, low and high ends
        integer, intent(in) :: faces !! of all directions, at one end
        type(grid_t), intent(in) :: grid
        type(stage_t), intent(in) :: stage
        real(rk), intent(in) :: edge(*) !! (lines, n_var, 2) fluxes through the outer faces
        real(dp), intent(inout) :: leaving(*) !! (faces, n_var, 2) [SI]
        real(dp) :: total
        integer(int64) :: at
        integer :: a, b, d, f, i, j, side, low(2)

        f = mod(t - 1, faces)
        side = (t - 1)/(faces*grid%n_var) + 1
        do d = 1, 3
            a = merge(2, 1, d == 1)
            b = merge(2, 3, d == 3)
            if (grid%n(d) == 1) cycle
            if (f < grid%bricks(a)*grid%bricks(b)) exit
            f = f - grid%bricks(a)*grid%bricks(b)
        end do
        if (grid%bc(side, d) == bc_inside .or. grid%bc(side, d) == bc_periodic) return
        low(1) = mod(f, grid%bricks(a))*brick
        low(2) = f/grid%bricks(a)*brick
        at = grid%before(d) + (t - 1)/faces*int(grid%lines, int64)
        total = 0
        do j = low(2) + 1, min(low(2) + brick, grid%n(b))
            do i = low(1) + 1, min(low(1) + brick, grid%n(a))
                total = total + edge(at + i + (j - 1)*grid%n(a))
            end do
        end do
        leaving(t) = leaving(t) + (2*side - 3)*stage%leaves(d)*total
    end subroutine sum_face
end module brz_brick_loop_bodies
