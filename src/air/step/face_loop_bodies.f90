! SPDX-License-Identifier: MIT
!> Faces of the air, one at a time: the flux straight from the state of the air, walls at the ends
!> of the grid included; the impulse on a wall in it.
module brz_face_loop_bodies
    use brz_air_boundary, only: beyond_wall
    use brz_air_grid, only: grid_t, variable_in_slot
    use brz_face_flux, only: end_face, end_fraction
    use brz_kinds, only: int64, int8, rk
    use brz_scheme, only: max_var, mixture_gamma, scheme_t
    implicit none
    private
    public :: face_at, add_push, see_wall

contains

    !> Flux through the face of direction d above a cell.
    !@cuf attributes(host,device) &
    pure subroutine face_at(d, grid, scheme, at, index, u, f)
        integer, intent(in) :: d !! direction
        type(grid_t), intent(in) :: grid
        type(scheme_t), intent(in) :: scheme
        integer(int64), intent(in) :: at !! place of the cell
        integer, intent(in) :: index !! of the cell along d
        real(rk), intent(in) :: u(*) !! conserved variables
        real(rk), intent(out) :: f(max_var) !! normal momentum in slot 2
        real(rk) :: q(5, -2:3), gamma(-2:3), y(-2:3)
        integer(int64) :: p
        integer :: c, m, beyond(-2:3)

        do m = -2, 3
            p = at + m*grid%step(d)
            do c = 1, 5
                q(c, m) = u(p + (variable_in_slot(c, d) - 1)*grid%apart)
            end do
            beyond(m) = 0
            y(m) = 0
            gamma(m) = scheme%gamma
            if (beyond_wall(scheme, grid%bc(1, d), grid%bc(2, d), grid%n(d), index + m)) &
                beyond(m) = 1
            if (grid%n_var == 6 .and. beyond(m) == 0) then
                y(m) = u(p + 5*grid%apart)/q(1, m)
                gamma(m) = mixture_gamma(scheme, y(m))
            end if
        end do
        call end_face(scheme, gamma, beyond, q, f)
        f(6) = 0
        if (grid%n_var == 6) f(6) = f(1)*end_fraction(scheme, beyond, f(1), y)
    end subroutine face_at

    !> Add the impulse of a stage to that of the step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine add_push(f, push, impulse)
        integer, intent(in) :: f !! walls, by direction
        real(rk), intent(in) :: push(*) !! of this stage [N s]
        real(rk), intent(inout) :: impulse(*) !! of the step

        impulse(f) = impulse(f) + push(f)
    end subroutine add_push

    !> Whether a listed cell is without gas.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine see_wall(t, place, solid, row)
        integer, intent(in) :: t !! cells of the list
        integer(int64), intent(in) :: place(*) !! of each cell, from 1
        integer(int8), intent(in) :: solid(*) !! 1 in cells without gas
        real(rk), intent(inout) :: row(*) !! the same

        row(t) = solid(place(t))
    end subroutine see_wall
end module brz_face_loop_bodies
