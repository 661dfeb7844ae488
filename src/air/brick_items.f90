! SPDX-License-Identifier: MIT
!> Which bricks of the air are awake: see brz_air_activity.
module brz_brick_items
    use brz_air_grid, only: grid_t
    use brz_kinds, only: int8
    implicit none
    private
    public :: wake_near

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
end module brz_brick_items
