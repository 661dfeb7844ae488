! SPDX-License-Identifier: MIT
!> A scene that runs: the case and the state of everything in it.
module brz_simulation
    use brz_air_state, only: air_t
    use brz_backend, only: backend_t
    use brz_boxes, only: cells_t
    use brz_case, only: case_t
    use brz_clock, only: clock_t
    use brz_coupling_state, only: coupling_t
    use brz_early, only: early_t
    use brz_conservation_audit, only: audit_start_t
    use brz_ranks, only: ranks_t
    use brz_run_counts, only: progress_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: simulation_t

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
        type(audit_start_t) :: start !! totals at t = 0, to measure errors against
        type(progress_t) :: progress
        character(6) :: limiter = '-' !! what limits the time step
        integer :: substeps = 0 !! solid steps in the last step
        logical :: intact = .false. !! an error has left the state as it was: worth a checkpoint
    end type simulation_t
end module brz_simulation
