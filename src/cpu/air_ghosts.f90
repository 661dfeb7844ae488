! SPDX-License-Identifier: MIT
!> Ghost cells of the air, see brz_ghost_items.
module brz_air_ghosts
    use brz_air_grid, only: grid_of, grid_t
    use brz_air_outside, only: keep_outside
    use brz_air_state, only: air_t, bc_periodic, wall_t
    use brz_fetch, only: fetch
    use brz_ghost_loops, only: each_fill_end
    use brz_kinds, only: int8, rk
    implicit none
    private
    public :: fill_ghosts

contains

    !> Fill the ghosts of all directions that are modelled. Where the box of another process begins
    !> they are its cells.
    subroutine fill_ghosts(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(grid_t) :: grid
        integer(int8) :: none(1)

        call keep_outside(air)
        call fetch(air%part%ranks, air%part%halo, air%n_var, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%u)
        grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        if (wall%present) then
            grid%walls = 1
            call each_fill_end(2*grid%lines, grid, air%scheme, air%outside, wall%solid, air%u)
        else
            none = 0
            call each_fill_end(2*grid%lines, grid, air%scheme, air%outside, none, air%u)
        end if
    end subroutine fill_ghosts
end module brz_air_ghosts
