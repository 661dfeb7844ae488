! SPDX-License-Identifier: MIT
!> Faces of the air, one at a time: the flux straight from the state of the air, walls included; the
!> impulse on a wall.
module brz_face_loop_bodies
    use brz_air_boundary, only: beyond_wall
    use brz_air_grid, only: grid_t, variable_in_slot
    use brz_boundary_codes, only: bc_symmetry, bc_wall
    use brz_face_flux, only: cut_face, cut_fraction
    use brz_kinds, only: int64, int8, rk
    use brz_scheme, only: max_var, mixture_gamma, scheme_t
    implicit none
    private
    public :: face_at, add_push, see_wall

contains

    !> Flux through the face of direction d above a cell, whatever the cells around it hold.
    !@cuf attributes(host,device) &
    pure subroutine face_at(d, grid, scheme, at, index, u, solid, cell_of, &
        wall_v, f, p_star, speed)
        integer, intent(in) :: d !! direction
        type(grid_t), intent(in) :: grid
        type(scheme_t), intent(in) :: scheme
        integer(int64), intent(in) :: at !! place of the cell
        integer, intent(in) :: index !! of the cell along d
        real(rk), intent(in) :: u(*) !! conserved variables
        integer(int8), intent(in) :: solid(*) !! 1 in cells that hold solid
        integer, intent(in) :: cell_of(*) !! place of each cell in the list of solid cells
        real(rk), intent(in) :: wall_v(*) !! (3, solid cells) velocity [m/s]
        real(rk), intent(out) :: f(max_var) !! normal momentum in slot 2
        real(rk), intent(out) :: p_star !! pressure on the wall, 0 where there is none [Pa]
        real(rk), intent(out) :: speed !! normal velocity of the wall, 0 where there is none [m/s]
        real(rk) :: q(5, -2:3), gamma(-2:3), v(-2:3), y(-2:3)
        integer(int64) :: p
        integer :: c, m, held(-2:3)

        do m = -2, 3
            p = at + m*grid%step(d)
            do c = 1, 5
                q(c, m) = u(p + (variable_in_slot(c, d) - 1)*grid%apart)
            end do
            held(m) = 0
            v(m) = 0
            y(m) = 0
            gamma(m) = scheme%gamma
            if (beyond_wall(scheme, grid%bc(1, d), grid%bc(2, d), grid%n(d), index + m)) then
                held(m) = 1
            else if (grid%walls == 1) then
                held(m) = solid(p)
                if (held(m) == 1) v(m) = wall_speed(d, grid, p, index + m, cell_of, wall_v)
            end if
            if (grid%n_var == 6 .and. held(m) == 0) then
                y(m) = u(p + 5*grid%apart)/q(1, m)
                gamma(m) = mixture_gamma(scheme, y(m))
            end if
        end do
        call cut_face(scheme, gamma, held, v, q, f, p_star)
        speed = 0
        if (held(0) /= held(1)) speed = v(0)*held(0) + v(1)*held(1)
        f(6) = 0
        if (grid%n_var == 6) f(6) = f(1)*cut_fraction(scheme, held, f(1), y)
    end subroutine face_at

    !> Normal velocity of a solid cell or of the image of one, which a mirror turns round.
    !@cuf attributes(host,device) &
    pure function wall_speed(d, grid, at, index, cell_of, wall_v) result(v)
        integer, intent(in) :: d !! direction
        type(grid_t), intent(in) :: grid
        integer(int64), intent(in) :: at !! place of the cell
        integer, intent(in) :: index !! of the cell along d
        integer, intent(in) :: cell_of(*) !! place of each cell in the list of solid cells
        real(rk), intent(in) :: wall_v(*) !! (3, cells) [m/s]
        real(rk) :: v
        integer :: bc

        v = wall_v(3*(cell_of(at) - 1) + d)
        if (index >= 1 .and. index <= grid%n(d)) return
        bc = grid%bc(merge(1, 2, index < 1), d)
        if (bc == bc_wall .or. bc == bc_symmetry) v = -v
    end function wall_speed

    !> Add the impulse of a stage to that of a wall face.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine add_push(f, push, impulse)
        integer, intent(in) :: f !! wall faces
        real(rk), intent(in) :: push(*) !! of this stage [N s]
        real(rk), intent(inout) :: impulse(*) !! of the step

        impulse(f) = impulse(f) + push(f)
    end subroutine add_push

    !> Whether a listed cell holds solid, and the velocity of that.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine see_wall(t, place, solid, cell_of, wall_v, row)
        integer, intent(in) :: t !! cells of the list
        integer(int64), intent(in) :: place(*) !! of each cell, from 1
        integer(int8), intent(in) :: solid(*) !! 1 in cells that hold solid
        integer, intent(in) :: cell_of(*) !! place of each cell in the list of solid cells
        real(rk), intent(in) :: wall_v(3, *) !! velocity of these [m/s]
        real(rk), intent(inout) :: row(4, *) !! 1 where a cell holds solid, its velocity
        integer :: d

        row(1, t) = solid(place(t))
        do d = 1, 3
            row(1 + d, t) = 0
            if (cell_of(place(t)) > 0) row(1 + d, t) = wall_v(d, cell_of(place(t)))
        end do
    end subroutine see_wall
end module brz_face_loop_bodies
