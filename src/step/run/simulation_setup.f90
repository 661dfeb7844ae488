! SPDX-License-Identifier: MIT
!> From the case to the scene at t = 0.
module brz_simulation_setup
    use brz_air_setup, only: set_up_air
    use brz_body_pair_force_driver, only: begin_body_pair_force
    use brz_body_setup, only: set_up_solid
    use brz_charge_loss, only: weigh_loss
    use brz_coupling_setup, only: set_up_coupling
    use brz_errors, only: error_t, failed
    use brz_kinds, only: rk
    use brz_ranks, only: several
    use brz_setup_progress, only: setup_blast, setup_stage
    use brz_simulation, only: simulation_t
    use brz_solid_owner, only: share_out
    use brz_contact_surface, only: find_contact_surface
    use brz_solid_sleep, only: put_to_sleep, sleep_until_loaded
    use brz_solid_start, only: start_solid
    use brz_start_1d, only: start_from_1d
    use brz_start_2d, only: start_from_2d
    implicit none
    private
    public :: set_up_simulation

contains

    !> State of the scene at t = 0.
    subroutine set_up_simulation(sim, err)
        type(simulation_t), intent(inout) :: sim !! with its case
        type(error_t), intent(inout) :: err

        if (sim%case%air%present) then
            call setup_stage('air')
            call set_up_air(sim%case, sim%air, err, sim%ranks, sim%boxes)
        end if
        if (failed(err)) return
        if (any(sim%case%charges%start == '1d')) then
            call setup_stage('blast in 1-D')
            call start_from_1d(sim%case, sim%air, sim%early, err, setup_blast)
        end if
        if (any(sim%case%charges%start == '2d')) then
            call setup_stage('blast in 2-D')
            call start_from_2d(sim%case, sim%air, sim%early, err, setup_blast)
        end if
        if (failed(err)) return
        if (size(sim%case%bodies) > 0) call setup_stage('bodies')
        call set_up_solid(sim%case, sim%solid, err)
        if (failed(err)) return
        if (sim%solid%present) then
            sim%solid%ranks = sim%ranks
            ! all processes have all particles
            if (several(sim%ranks)) call find_contact_surface(sim%solid)
            if (several(sim%ranks) .and. sim%air%present) &
                allocate (sim%solid%v_before(3, sim%solid%n), source=0.0_rk)
            call share_out(sim%solid)
        end if
        if (sim%solid%present) call setup_stage('neighbours')
        call start_solid(sim%solid, err)
        if (failed(err)) return
        call begin_body_pair_force(sim%solid, err)
        if (sim%air%present .and. sim%solid%present) call setup_stage('coupling')
        call set_up_coupling(sim%case, sim%air, sim%solid, sim%coupling, err)
        if (failed(err)) return
        if (sim%coupling%present) &
            call weigh_loss(sim%case, sim%air, sim%solid, sim%coupling, err)
        if (sim%coupling%present .and. .not. sim%coupling%paper) call put_to_sleep(sim%solid)
        if (.not. sim%air%present) call sleep_until_loaded(sim%solid)
    end subroutine set_up_simulation
end module brz_simulation_setup
