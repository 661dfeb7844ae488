! SPDX-License-Identifier: MIT
!> One step of the scene: the algorithm as a list of calls. See docs/theory/index.md.
module brz_time_step
    use brz_air_setup, only: time_step_ramp
    use brz_air_state, only: air_ok
    use brz_air_driver, only: air_step
    use brz_backend_step, only: advance_solid, limit_of_air
    use brz_inflow_driver, only: let_in
    use brz_paper_step, only: move_paper_walls, paper_step
    use brz_clock, only: next_due
    use brz_device, only: wait_for_device
    use brz_errors, only: error_t, exit_numerical, failed, raise
    use brz_exchange_driver, only: reclassify, set_wall_velocity, spread_load, wake_loaded
    use brz_face_load, only: first_arrival
    use brz_host_calls, only: enter_part
    use brz_kinds, only: dp, int64
    use brz_ranks, only: reduce_errors
    use brz_simulation, only: simulation_t
    use brz_solid_sleep, only: particles_active
    use brz_solid_start, only: solid_time_step
    use brz_text, only: to_text
    use brz_timer, only: lap, wall_seconds
    use brz_whole_step, only: whole_step
    implicit none
    private
    public :: advance, choose_time_step

    real(dp), parameter :: least_share = 1e-12_dp !! of t_end: no run ends with shorter steps

contains

    !> Carry the scene over one time step.
    subroutine advance(sim, err)
        type(simulation_t), intent(inout) :: sim
        type(error_t), intent(inout) :: err !! exit_numerical where a state is lost
        real(dp) :: dt, mark
        logical :: waits

        call enter_part('time step')
        call wait_for_load(sim, waits)
        if (waits) return
        call choose_time_step(sim, dt, err)
        if (failed(err)) return
        mark = wall_seconds()
        if (sim%coupling%present .and. .not. sim%coupling%paper) then
            call enter_part('walls')
            call set_wall_velocity(sim%air, sim%solid, sim%coupling, dt, err)
            call end_part(sim, err)
            call lap(mark, sim%progress%coupling_seconds)
        end if
        call enter_part('air')
        if (sim%air%present) call step_air(sim, dt, err)
        call lap(mark, sim%progress%air_seconds)
        if (failed(err)) return
        if (sim%coupling%present .and. .not. sim%coupling%paper) then
            call enter_part('loads')
            call load_solid(sim, dt, err)
            call lap(mark, sim%progress%coupling_seconds)
        end if
        if (sim%solid%present) call step_solid(sim, dt, err)
        call lap(mark, sim%progress%solid_seconds)
        if (failed(err)) return
        if (sim%coupling%present) then
            if (sim%coupling%paper) then
                call move_paper_walls(sim%air, sim%solid, sim%coupling)
            else
                call enter_part('exchange')
                call reclassify(sim%air, sim%solid, sim%coupling, err)
                call end_part(sim, err)
            end if
            call lap(mark, sim%progress%coupling_seconds)
        end if
        sim%clock%dt = dt
        sim%clock%time = sim%clock%time + dt
        sim%clock%cycle = sim%clock%cycle + 1
    end subroutine advance

    !> A part of the step of the coupling ends when the GPU has done it, so that the times that a
    !> run reports for its parts are their own.
    subroutine end_part(sim, err)
        type(simulation_t), intent(in) :: sim
        type(error_t), intent(inout) :: err

        if (sim%coupling%on_gpu) call wait_for_device(err)
    end subroutine end_part

    !> While the bodies of a scene without air sleep the clock goes to the first load, or to an
    !> output on the way; then they wake.
    subroutine wait_for_load(sim, waits)
        type(simulation_t), intent(inout) :: sim
        logical, intent(out) :: waits !! the step is done
        real(dp) :: until

        waits = .false.
        if (sim%air%present .or. .not. sim%solid%present) return
        if (particles_active(sim%solid) > 0) return
        until = min(first_arrival(sim%solid%loads), sim%case%run%t_end)
        waits = until > sim%clock%time
        sim%solid%bodies%inactive = waits
        if (.not. waits) return
        until = min(until, next_due(sim%clock))
        sim%clock%dt = until - sim%clock%time
        sim%clock%time = until
        sim%clock%cycle = sim%clock%cycle + 1
        sim%solid%time = until
        sim%limiter = 'load'
    end subroutine wait_for_load

    !> Time step: the air's limit, the solid's where there is no air, never past the end.
    subroutine choose_time_step(sim, dt, err)
        type(simulation_t), intent(inout) :: sim
        real(dp), intent(out) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: limit, left

        dt = sim%case%run%dt_max
        sim%limiter = 'dt_max'
        limit = dt
        if (sim%air%present) then
            limit = limit_of_air(sim%backend, sim%air, sim%coupling, sim%case%air%cfl, &
                                 sim%clock%time, err)* &
                    time_step_ramp(sim%clock%cycle, sim%case%air%ramp_steps)
        else if (sim%solid%present) then
            limit = solid_time_step(sim%solid)
        end if
        if (.not. limit >= dt) then
            dt = limit
            sim%limiter = merge('air   ', 'solid ', sim%air%present)
        end if
        call check_floor(sim, dt, trim(sim%limiter), err)
        if (particles_active(sim%solid) > 0) &
            call check_floor(sim, solid_time_step(sim%solid), 'solid', err)
        if (failed(err)) return
        if (sim%air%present .and. particles_active(sim%solid) > 0) &
            dt = whole_step(dt, sim%solid%dt_limit, real(product(int(sim%air%whole, int64)), dp), &
                            real(particles_active(sim%solid), dp))
        left = sim%case%run%t_end - sim%clock%time
        if (2*dt > left) then ! two even steps rather than a tiny last one
            dt = merge(left, left/2, dt >= left)
            sim%limiter = 'end'
        end if
        sim%substeps = 0
        if (particles_active(sim%solid) > 0) sim%substeps = substeps(sim, dt)
    end subroutine choose_time_step

    !> A time step that has collapsed ends the run; the state before it is intact.
    subroutine check_floor(sim, dt, limiter, err)
        type(simulation_t), intent(inout) :: sim
        real(dp), intent(in) :: dt !! [s]
        character(*), intent(in) :: limiter !! what asks for this step
        type(error_t), intent(inout) :: err
        real(dp) :: floor

        if (failed(err)) return
        floor = max(sim%case%run%dt_min, least_share*sim%case%run%t_end)
        if (dt > floor) return
        sim%intact = .true.
        call raise(err, exit_numerical, 'time step '//to_text(dt)//' s ('//limiter// &
                   ') is not above its floor '//to_text(floor)//' s (dt_min, at least t_end/1e12)')
    end subroutine check_floor

    !> Solid steps in a step of the scene. What is stable rounds up; how fast steps may grow rounds
    !> down: else 20 steps that may each be 5 % longer would stay 20 for ever.
    pure integer function substeps(sim, dt)
        type(simulation_t), intent(in) :: sim
        real(dp), intent(in) :: dt !! of the scene [s]

        substeps = max(1, ceiling(dt/sim%solid%dt_limit), int(dt/solid_time_step(sim%solid)))
    end function substeps

    !> One step of the air.
    subroutine step_air(sim, dt, err)
        type(simulation_t), intent(inout) :: sim
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer :: status

        call let_in(sim%air, sim%clock%time, dt, err)
        if (sim%coupling%paper) then
            call paper_step(sim%air, sim%solid, sim%coupling, dt, status, err)
        else
            call air_step(sim%air, sim%coupling%wall, dt, status, err)
        end if
        if (status /= air_ok) call report_lost_cell(sim, err)
        sim%progress%cell_steps = sim%progress%cell_steps + product(int(sim%air%whole, int64))
    end subroutine step_air

    !> Say where the air became unphysical, from what, and what may help.
    subroutine report_lost_cell(sim, err)
        type(simulation_t), intent(in) :: sim
        type(error_t), intent(inout) :: err
        character(:), allocatable :: remedy, state
        integer :: d

        state = ''
        do d = 1, 5
            state = state//' '//to_text(sim%air%bad_state(d))
        end do
        remedy = 'a smaller cfl or finer cells'
        if (sim%clock%cycle < max(20, 2*sim%case%air%ramp_steps)) &
            remedy = 'a larger ramp_steps or a smaller cfl'
        if (.not. sim%air%fallback) remedy = 'fallback = .true., or '//remedy
        call raise(err, exit_numerical, 'the air is lost at t = '//to_text(sim%clock%time)// &
                   ' s (cycle '//to_text(sim%clock%cycle)//'): cell '// &
                   to_text(sim%air%bad_cell(1))//', '//to_text(sim%air%bad_cell(2))//', '// &
                   to_text(sim%air%bad_cell(3))//' would have density, momentum and energy'// &
                   state//', without positive density and pressure; try '//remedy)
    end subroutine report_lost_cell

    !> Hand the impulse of this step to the particles, and wake the bodies that feel it.
    subroutine load_solid(sim, dt, err)
        type(simulation_t), intent(inout) :: sim
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        call spread_load(sim%solid, sim%coupling, dt, err)
        call end_part(sim, err)
        if (sim%solid%on_gpu) sim%solid%device%fetched = .false.
        if (any(sim%solid%bodies%inactive)) call wake_loaded(sim%solid, sim%coupling, err)
        if (sim%coupling%on_gpu) call reduce_errors(sim%solid%ranks, err)
        if (particles_active(sim%solid) > 0) sim%substeps = substeps(sim, dt)
    end subroutine load_solid

    !> Sub-steps of the solid under the constant load of this step; none while all of it is
    !> inactive.
    subroutine step_solid(sim, dt, err)
        type(simulation_t), intent(inout) :: sim
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer :: k

        do k = 1, sim%substeps
            call enter_part('bodies')
            call advance_solid(sim%solid, dt/sim%substeps, err)
            if (failed(err)) return
        end do
        sim%progress%particle_steps = sim%progress%particle_steps + &
                                      sim%substeps*particles_active(sim%solid)
    end subroutine step_solid
end module brz_time_step
