! SPDX-License-Identifier: MIT
!> Bricks of the air: which are awake, see brz_air_activity; sums over their cells.
module brz_brick_items
    use brz_air_grid, only: brick, grid_t, place_of
    use brz_kinds, only: dp, int64, int8, rk
    implicit none
    private
    public :: wake_near, total_brick

contains

    !> Awake are the reached bricks and those as near as a step reaches, across periodic boundaries
    !> too.
    !@item if(n > 2000) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine wake_near(b, grid, layers_x, layers_y, layers_z, reached, awake)
        integer, intent(in) :: b !! bricks
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: layers_x, layers_y, layers_z !! bricks on each side
        integer(int8), intent(in) :: reached(*)
        integer(int8), intent(inout) :: awake(*)
        integer :: at, i, j, k, x, y, z

        i = mod(b - 1, grid%bricks(1)) + 1
        j = mod((b - 1)/grid%brick_step(2), grid%bricks(2)) + 1
        k = (b - 1)/grid%brick_step(3) + 1
        awake(b) = 1
        do z = k - layers_z, k + layers_z
            do y = j - layers_y, j + layers_y
                do x = i - layers_x, i + layers_x
                    at = place_round(grid, x, y, z)
                    if (at == 0) cycle
                    if (reached(at) /= 0) return
                end do
            end do
        end do
        awake(b) = 0
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
    !@item if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine total_brick(t, grid, u, solid, part)
        integer, intent(in) :: t !! bricks, times one more than the conserved variables
        type(grid_t), intent(in) :: grid
        real(rk), intent(in) :: u(*)
        integer(int8), intent(in) :: solid(*) !! read where there are walls
        real(dp), intent(inout) :: part(*) !! (0:n_var, bricks) per volume, 0: kinetic energy
        real(dp) :: total
        integer(int64) :: at
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
                do i = low(1) + 1, min(low(1) + brick, grid%n(1))
                    at = place_of(grid, i, j, k)
                    if (grid%walls == 1) then
                        if (solid(at) /= 0) cycle
                    end if
                    if (c > 0) then
                        total = total + u(at + (c - 1)*grid%apart)
                    else
                        total = total + (u(at + grid%apart)**2 + u(at + 2*grid%apart)**2 &
                            + u(at + 3*grid%apart)**2)/(2*u(at))
                    end if
                end do
            end do
        end do
        part(c + 1 + (b - 1)*(grid%n_var + 1)) = total
    end subroutine total_brick
end module brz_brick_items
