! SPDX-License-Identifier: MIT
!> The time step of the solids: staggered leapfrog with two neighbour passes, as a list of
!> operations.
module brz_solid_driver
    use brz_cohesive_driver, only: cohesive_pass
    use brz_errors, only: error_t
    use brz_gpu_solid_motion, only: record_first_half
    use brz_host_calls, only: enter_part
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: drift_bodies, find_stale
    use brz_motion_driver, only: find_levels, kick_bodies
    use brz_skin_level, only: lost_level
    use brz_ranks, only: most_of_all
    use brz_rigid_driver, only: balance_rigid, move_rigid, settle_drag, sum_pushes
    use brz_solid_backend, only: break_bonds, contact_pass, end_support, exchange_motion, &
        fetch_faults, fetch_limit, force_pass, gradient_pass, note_active, offer_motion, &
        refresh_bonds, refresh_rows
    use brz_solid_bonds, only: push_rigid_bonds
    use brz_solid_faults, only: agree_on_step, report_bad, report_lost
    use brz_solid_leaving_driver, only: remove_left
    use brz_solid_list_driver, only: build_neighbours
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: solid_step, find_forces, find_forces_of

contains

    !> One time step under the present `load`. The first kick is half a step; its heat is recorded
    !> now that the length of the step is known.
    subroutine solid_step(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer(int64) :: level(size(solid%bodies))
        logical :: stale(size(solid%bodies)), relink

        if (solid%on_gpu) call begin_on_gpu(solid, err)
        if (solid%steps == 0) call force_pass(solid, dt/2, err)
        if (solid%on_gpu .and. solid%steps == 0) &
            call record_first_half(solid%device, solid, dt, err)
        call drift_bodies(solid, dt)
        call move_rigid(solid, dt, err)
        call kick_bodies(solid, dt, err)
        if (solid%on_gpu) call offer_motion(solid%device, solid, err)
        solid%time = solid%time + dt
        solid%dt_last = dt
        solid%steps = solid%steps + 1
        call find_levels(solid, level, err)
        call most_of_all(solid%ranks, level)
        call report_lost(solid, level, err)
        if (any(level == lost_level)) return ! from all processes
        call find_stale(solid, int(level), stale, relink)
        if (any(stale) .or. relink) then
            call enter_part('lists of bodies')
            call remove_left(solid, err)
            call build_neighbours(solid, .true., err, stale)
            if (any(stale)) solid%rebuilds = solid%rebuilds + 1
            call wake_met(solid)
            if (solid%on_gpu) call note_active(solid%device, solid%bodies%inactive, err)
            call end_support(solid, stale, err)
            call enter_part('bodies', go_on=.true.)
        else
            call exchange_motion(solid, err)
        end if
        call find_forces(solid, dt, err)
    end subroutine solid_step

    !> A GPU goes on from what the host handed over, or from its last step.
    subroutine begin_on_gpu(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        associate (gpu => solid%device)
            if (.not. gpu%stepped) then ! of bodies that sleep, too
                call note_active(gpu, gpu%bodies%inactive, err)
                call gradient_pass(solid, 0.0_dp, err)
            end if
            call note_active(gpu, solid%bodies%inactive, err)
            gpu%fetched = .false.
            gpu%stepped = .true.
            gpu%summed = .false.
            gpu%points_fetched = .false.
        end associate
        if (solid%steps > 0) return
        call refresh_rows(solid, err)
        call cohesive_pass(solid, err)
        call contact_pass(solid, 0.0_dp, err)
    end subroutine begin_on_gpu

    !> Gradients, materials and forces at the present places, over dt, the step just made; what time
    !> step all processes bear.
    subroutine find_forces(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        call gradient_pass(solid, dt, err)
        call find_forces_of(solid, dt, err)
    end subroutine find_forces

    !> The same once the gradients are known.
    subroutine find_forces_of(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: push(6, size(solid%bodies))

        call refresh_rows(solid, err)
        if (dt > 0) call break_bonds(solid, err)
        if (dt > 0) call refresh_bonds(solid, err)
        call cohesive_pass(solid, err)
        call contact_pass(solid, dt, err)
        call force_pass(solid, dt, err)
        if (solid%on_gpu) then
            call fetch_limit(solid%device, solid, err)
        else
            call push_rigid_bonds(solid, dt)
        end if
        call sum_pushes(solid, dt, push, err)
        call balance_rigid(solid, push, dt, err)
        call settle_drag(solid, dt, err)
        if (solid%on_gpu) call fetch_faults(solid%device, solid, err)
        call report_bad(solid, err)
        call agree_on_step(solid, err)
    end subroutine find_forces_of
end module brz_solid_driver
