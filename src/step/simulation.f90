! SPDX-License-Identifier: MIT
!> A scene that runs: the case and the state of everything in it.
module brz_simulation
    use brz_air_setup, only: set_up_air
    use brz_air_state, only: air_t
    use brz_backend, only: backend_t
    use brz_body_setup, only: set_up_solid
    use brz_boxes, only: cells_t
    use brz_case, only: case_t
    use brz_charge_loss, only: weigh_loss
    use brz_clock, only: clock_t
    use brz_coupling_setup, only: set_up_coupling
    use brz_coupling_state, only: coupling_t
    use brz_early, only: early_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: rk
    use brz_ledger, only: ledger_start_t
    use brz_progress, only: progress_t
    use brz_ranks, only: ranks_t, several
    use brz_setup_progress, only: setup_blast, setup_stage
    use brz_between_steps, only: begin_between
    use brz_solid_home, only: share_out
    use brz_solid_skin, only: find_skin
    use brz_solid_sleep, only: put_to_sleep, sleep_until_loaded
    use brz_solid_state, only: solid_t
    use brz_solid_start, only: start_solid
    use brz_start_1d, only: start_from_1d
    use brz_start_2d, only: start_from_2d
    implicit none
    private
    public :: simulation_t, set_up_simulation

    type :: simulation_t
        type(case_t) :: case
        type(ranks_t) :: ranks !! the processes that share the scene
        type(cells_t), allocatable :: boxes(:) !! the air of each, where there are several
        type(air_t) :: air
        type(solid_t) :: solid
        type(coupling_t) :: coupling
        type(backend_t) :: backend !! where air and bodies are computed
        type(clock_t) :: clock
        type(early_t) :: early !! a blast in one or two dimensions before the first step
        type(ledger_start_t) :: start !! totals at t = 0, to measure errors against
        type(progress_t) :: progress
        character(6) :: limiter = '-' !! what limits the time step
        integer :: substeps = 0 !! solid steps in the last step
        logical :: intact = .false. !! an error has left the state as it was: worth a checkpoint
    end type simulation_t

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
            if (several(sim%ranks)) call find_skin(sim%solid) ! all processes have all particles
            if (several(sim%ranks) .and. sim%air%present) &
                allocate (sim%solid%v_before(3, sim%solid%n), source=0.0_rk)
            call share_out(sim%solid)
        end if
        if (sim%solid%present) call setup_stage('neighbours')
        call start_solid(sim%solid, err)
        if (failed(err)) return
        call begin_between(sim%solid, err)
        if (sim%air%present .and. sim%solid%present) call setup_stage('coupling')
        call set_up_coupling(sim%case, sim%air, sim%solid, sim%coupling, err)
        if (failed(err)) return
        if (sim%coupling%present) &
            call weigh_loss(sim%case, sim%air, sim%solid, sim%coupling, err)
        if (sim%coupling%present .and. .not. sim%coupling%paper) call put_to_sleep(sim%solid)
        if (.not. sim%air%present) call sleep_until_loaded(sim%solid)
    end subroutine set_up_simulation
end module brz_simulation
