! SPDX-License-Identifier: MIT
!> The particles of a body in the order of the cells of their search, and what their lists are
!> measured by.
module brz_solid_sort
    use brz_cell_grid, only: cell_of_groups, fill_cells, lay_grid
    use brz_force_loops, only: each_sum_momentum
    use brz_kinds, only: dp, rk
    use brz_list_drift, only: begin_list
    use brz_particle_order, only: reorder_particles
    use brz_solid_state, only: body_t, form_total, solid_t
    implicit none
    private
    public :: note_places, sort_body

contains

    !> The lists of a body are about to be built for the places of now.
    subroutine note_places(solid, b)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b

        call note_positions(solid, solid%bodies(b))
        call begin_list(solid, b, mean_velocity(solid, solid%bodies(b)))
    end subroutine note_places

    !> Bring the particles of a body into the order of the cells at the places `x_built`. It has no
    !> ghosts.
    subroutine sort_body(solid, b)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b

        associate (body => solid%bodies(b))
            call lay_grid(solid%search, solid%x_built, solid%fixed, body, cell_of_groups(solid, b))
            call fill_cells(solid%search, solid%x_built, solid%fixed, body)
            call reorder_particles(solid, body%first, body%last)
        end associate
    end subroutine sort_body

    !> Velocity of the mass of a body at the step [m/s]: an exact sum, as lists last by it.
    function mean_velocity(solid, body) result(v)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp) :: v(3), sums(4)

        call each_sum_momentum(body%last - body%first + 1, solid%ranks, body%first, 3, 1, 3, &
                               real(solid%dt_last/2, rk), solid%mass, solid%fixed, solid%v, &
                               solid%a, sums)
        v = sums(2:)/max(sums(1), tiny(sums))
    end function mean_velocity

    !> Positions that decide on the neighbours of a body: a total-Lagrangian body that meets no
    !> other keeps the unloaded ones, and with them its order and its list.
    subroutine note_positions(solid, body)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(in) :: body

        associate (first => body%first, last => body%last)
            if (body%formulation == form_total .and. .not. solid%links%present) then
                solid%x_built(:, first:last) = solid%x_ref(:, first:last)
            else
                solid%x_built(:, first:last) = solid%x(:, first:last)
            end if
        end associate
    end subroutine note_positions
end module brz_solid_sort
