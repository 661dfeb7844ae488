! SPDX-License-Identifier: MIT
!> How fast the walls are.
module brz_load_loop_bodies
    use brz_air_grid, only: grid_t
    use brz_kinds, only: rk
    implicit none
    private
    public :: wall_speed

contains

    !> Largest sum_d |v_d|/dx_d of the walls.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine wall_speed(c, grid, v, fastest)
        integer, intent(in) :: c !! walls
        type(grid_t), intent(in) :: grid
        real(rk), intent(in) :: v(3, *) !! [m/s]
        real(rk), intent(inout) :: fastest !@most [1/s]

        fastest = max(fastest, abs(v(1, c))*grid%inverse_dx(1) &
                      + abs(v(2, c))*grid%inverse_dx(2) + abs(v(3, c))*grid%inverse_dx(3))
    end subroutine wall_speed
end module brz_load_loop_bodies
