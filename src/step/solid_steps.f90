! SPDX-License-Identifier: MIT
!> The time step of the solids: staggered leapfrog with two neighbour passes, as a list of
!> operations. scripts/steps.py writes the same for the GPU.
module brz_solid_steps
    use brz_cohesive_steps, only: cohesive_pass
    use brz_errors, only: error_t
    !@gpu use brz_gpu_solid_contact, only: break_bonds, contact_pass, note_awake
    !@gpu use brz_gpu_solid_copy, only: fetch_faults
    !@gpu use brz_gpu_solid_ghosts, only: offer_motion, refresh_bonds, refresh_rows
    !@gpu use brz_gpu_solid_ghosts, only: take_motion
    !@gpu use brz_gpu_solid_forces, only: force_pass
    !@gpu use brz_gpu_solid_gradients, only: gradient_pass
    !@gpu use brz_gpu_solid_motion, only: begin_step, book_first_half, end_support
    !@gpu use brz_gpu_solid_books, only: fetch_limit
    use brz_host_calls, only: enter_part
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: drift_bodies, find_stale
    use brz_motion_steps, only: find_levels, kick_bodies
    use brz_move_level, only: lost_level
    use brz_ranks, only: most_of_all
    use brz_rigid_steps, only: balance_rigid, move_rigid, settle_drag, sum_pushes
    use brz_solid_bonds, only: break_bonds, push_rigid_bonds !@cpu
    use brz_solid_contact, only: contact_pass !@cpu
    use brz_solid_faults, only: agree_on_step, report_bad, report_lost
    use brz_solid_forces, only: force_pass !@cpu
    use brz_solid_ghosts, only: refresh_bonds, refresh_motion, refresh_rows !@cpu
    use brz_solid_gradients, only: gradient_pass !@cpu
    use brz_solid_leaving_steps, only: remove_left
    use brz_solid_list_steps, only: build_neighbours
    use brz_solid_motion, only: end_support !@cpu
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: solid_step, find_forces, find_forces_of

contains

    !> One time step under the present `load`. The first kick is half a step; its heat is booked
    !> now that the length of the step is known.
    subroutine solid_step(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer(int64) :: level(size(solid%bodies))
        logical :: stale(size(solid%bodies)), relink

        !@gpu call begin_step(gpu, solid)
        if (solid%steps == 0) call force_pass(solid, dt/2)
        !@gpu if (solid%steps == 0) call book_first_half(gpu, solid, dt)
        call drift_bodies(solid, dt) !@host
        call move_rigid(solid, dt)
        call kick_bodies(solid, dt)
        !@gpu call offer_motion(gpu, solid)
        solid%time = solid%time + dt
        solid%dt_last = dt
        solid%steps = solid%steps + 1
        call find_levels(solid, level)
        call most_of_all(solid%ranks, level)
        call report_lost(solid, level, err) !@host
        if (any(level == lost_level)) return ! from all processes
        call find_stale(solid, int(level), stale, relink) !@host
        if (any(stale) .or. relink) then
            call enter_part('lists of bodies')
            call remove_left(solid)
            call build_neighbours(solid, .true., stale)
            if (any(stale)) solid%rebuilds = solid%rebuilds + 1
            call wake_met(solid) !@host
            !@gpu call note_awake(gpu, solid%bodies%asleep)
            call end_support(solid, stale)
            call enter_part('bodies', go_on=.true.)
        else
            call refresh_motion(solid) !@cpu
            !@gpu call take_motion(gpu, solid)
        end if
        call find_forces(solid, dt, err)
    end subroutine solid_step

    !> Gradients, materials and forces at the present places, over dt, the step just made; what time
    !> step all processes bear.
    subroutine find_forces(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        call gradient_pass(solid, dt)
        call find_forces_of(solid, dt, err)
    end subroutine find_forces

    !> The same once the gradients are known.
    subroutine find_forces_of(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: push(6, size(solid%bodies))

        call refresh_rows(solid)
        if (dt > 0) call break_bonds(solid)
        if (dt > 0) call refresh_bonds(solid)
        call cohesive_pass(solid)
        call contact_pass(solid, dt)
        call force_pass(solid, dt)
        !@gpu call fetch_limit(gpu, solid)
        call push_rigid_bonds(solid, dt) !@cpu
        call sum_pushes(solid, dt, push)
        call balance_rigid(solid, push, dt)
        call settle_drag(solid, dt)
        !@gpu call fetch_faults(gpu, solid)
        call report_bad(solid, err) !@host
        call agree_on_step(solid, err) !@host
    end subroutine find_forces_of
end module brz_solid_steps
