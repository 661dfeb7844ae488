! SPDX-License-Identifier: MIT
!> The flux through one face of the air, see brz_face_items.
module brz_air_faces
    use brz_air_grid, only: grid_t, place_of
    use brz_air_state, only: air_t, wall_t
    use brz_face_items, only: face_at
    use brz_kinds, only: int64, int8, rk
    use brz_scheme, only: max_var, scheme_t
    implicit none
    private
    public :: flux_at

contains

    !> Flux through the face above a cell in direction d.
    subroutine flux_at(air, wall, scheme, d, low, f, p_star, speed)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face
        real(rk), intent(out) :: f(max_var) !! flux, normal momentum in slot 2
        real(rk), intent(out) :: p_star !! pressure on the wall, 0 where there is none [Pa]
        real(rk), intent(out) :: speed !! normal velocity of the wall, 0 where there is none [m/s]
        type(grid_t) :: grid
        integer(int8), parameter :: no_map(1) = 0
        integer, parameter :: no_cells(1) = 0
        real(rk), parameter :: no_walls(3) = 0

        grid%n = air%n ! what face_at reads: this is called for every face near a wall
        grid%g = air%g
        grid%n_var = air%n_var
        grid%bc = air%bc
        grid%step(1) = 1
        grid%step(2) = air%n(1) + 2*air%g(1)
        grid%step(3) = grid%step(2)*(air%n(2) + 2*air%g(2))
        grid%apart = int(grid%step(3), int64)*(air%n(3) + 2*air%g(3))
        grid%walls = 0
        associate (at => place_of(grid, low(1), low(2), low(3)))
            if (wall%present) then
                grid%walls = 1
                call face_at(d, grid, scheme, at, low(d), air%u, wall%solid, wall%index, wall%v, &
                             f, p_star, speed)
            else
                call face_at(d, grid, scheme, at, low(d), air%u, no_map, no_cells, no_walls, f, &
                             p_star, speed)
            end if
        end associate
    end subroutine flux_at
end module brz_air_faces
