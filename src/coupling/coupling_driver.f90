! SPDX-License-Identifier: MIT
!> The immersed boundary between air and solids: what the coupling does before and after a step of
!> the air, the operations in their order.
module brz_coupling_driver
    use brz_air_state, only: air_t
    use brz_driven_body_driver, only: move_driven_bodies, see_driven_bodies
    use brz_coupling_state, only: coupling_t
    use brz_deferred_source_driver, only: level_cell_stores, limit_cell_stores, &
        release_deferred_sources
    use brz_errors, only: error_t
    use brz_kinds, only: dp, int32, rk
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_wall_driver, only: find_wall_pressure, find_mean_velocity, find_wall_velocities, &
        weigh_columns
    implicit none
    private
    public :: move_walls, find_velocities, settle_cell_stores

contains

    !> Give each solid cell the mean velocity by mass of its particles: at the step where a body
    !> carries them, else as it is kept, half a step before.
    subroutine move_walls(solid, p, c, err)
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call see_driven_bodies(solid, p, c, err)
        call find_mean_velocity(p, c, err)
    end subroutine move_walls

    !> Velocities of the walls in the middle of the coming step, where that of a particle a step
    !> ago is a column of v_before. Walls and driven bodies are as move_walls left them.
    subroutine find_velocities(air, solid, p, c, dt, v_before, column, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        real(rk), intent(in) :: v_before(:, :) !! [m/s]
        integer(int32), intent(in) :: column(:) !! of each particle in it
        type(error_t), intent(inout) :: err

        call weigh_columns(p, c, err)
        call find_wall_pressure(air, c, err)
        call move_driven_bodies(solid, p, c, dt, err)
        call find_wall_velocities(p, c, dt, v_before, column, err)
    end subroutine find_velocities

    !> Cell stores and deferred sources after a step. The walls move on, too: the next step, and how
    !> long it is, depend on these alone, so that a restart finds the same.
    subroutine settle_cell_stores(air, solid, p, c, err)
        type(air_t), intent(inout) :: air
        class(bodies_t), intent(in) :: solid
        class(bodies_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call level_cell_stores(air, c, err)
        call limit_cell_stores(air, c, err)
        call release_deferred_sources(air, c, err)
        call move_walls(solid, p, c, err)
    end subroutine settle_cell_stores
end module brz_coupling_driver
