! SPDX-License-Identifier: MIT
!> The operations of a step of the coupling as printed, in their order, see brz_coupling_paper.
module brz_paper_step
    use brz_air_grid, only: stage_t
    use brz_air_operations, only: update
    use brz_air_stage, only: stage_of
    use brz_air_state, only: air_ok, air_t, wall_t
    use brz_air_driver, only: begin_step, take_rates
    use brz_coupling_paper, only: add_forces, fill_solid_cells
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t
    use brz_kinds, only: dp
    use brz_paper_cells, only: find_filled_velocities, load_filled_carriers, move_filled_cells
    use brz_runge_kutta, only: share_of
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: paper_step, move_paper_walls

contains

    !> One step of the air with the bodies in it; their particles get its mean force (Eq. 28, 29:
    !> the weights of the stages, even shares for the particles of a cell).
    subroutine paper_step(air, solid, coupling, dt, status, err)
        type(air_t), intent(inout) :: air
        class(bodies_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: status !! as air_step has it
        type(error_t), intent(inout) :: err
        type(wall_t) :: none
        type(stage_t) :: stage
        integer :: m

        call find_filled_velocities(solid, coupling)
        call fill_solid_cells(air, coupling)
        call begin_step(air, none, err)
        solid%load(:, :solid%n) = 0
        do m = 1, air%n_stages
            if (m > 1) call fill_solid_cells(air, coupling)
            stage = stage_of(air, dt, m)
            call take_rates(air, none, stage, m == air%n_stages, status, err)
            if (status /= air_ok) return
            call add_forces(air, solid, coupling, share_of(m, air%n_stages), dt)
            call update(air, stage%dt, stage%weight, m == 1)
        end do
        call load_filled_carriers(solid, coupling)
    end subroutine paper_step

    !> The map of solid cells after the particles have moved. A cell that the solid leaves keeps the
    !> gas it was filled with.
    subroutine move_paper_walls(air, solid, coupling)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling

        call move_filled_cells(air, solid, coupling)
        call find_filled_velocities(solid, coupling)
    end subroutine move_paper_walls
end module brz_paper_step
