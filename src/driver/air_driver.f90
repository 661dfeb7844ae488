! SPDX-License-Identifier: MIT
!> One time step of the air: two or three Runge-Kutta stages of sweeps (SSP-RK2, which is Heun's
!> method, and SSP-RK3, of Shu and Osher). The operations of every step, in their order.
!>
!> A-posteriori fallback: the faces of a cell that would lose nearly all its density or pressure
!> take the first-order flux. A cell that this does not save is held. See brz_fallback_loop_bodies.
!> It runs after the rates of a stage are complete and before they are used.
module brz_air_driver
    use brz_air_backend, only: clear_marks, end_stage, exchange_ghosts, exchange_marks, find_bad, &
        find_lost_cell, get_ready, offer_next, redo, sweep_all
    use brz_air_grid, only: stage_t
    use brz_air_lost, only: first_lost
    use brz_air_stage, only: stage_of
    use brz_air_state, only: air_ok, air_t, air_unphysical, wall_t
    use brz_air_totals, only: add_outflow
    use brz_brick_driver, only: settle_bricks, wake_bricks
    use brz_cut_rate_driver, only: find_cut_rates, ready_cut_cells, redo_cut_cells
    use brz_errors, only: error_t
    use brz_face_loops, only: for_each_add_push
    use brz_fallback_loop_bodies, only: to_hold, to_lose, to_redo
    use brz_fallback_loops, only: for_each_count_marked
    use brz_ghost_loops, only: for_each_fill_end
    use brz_kinds, only: dp, int64
    use brz_positivity, only: limit_step, most_holds
    use brz_ranks, only: several
    use brz_runge_kutta, only: repair_passes
    use brz_scheme, only: first_order
    implicit none
    private
    public :: air_step, begin_step, take_rates

contains

    !> Advance the air by dt. The walls stand still in the step, but push with their velocity.
    !>
    !> `wall%cells%impulse` becomes the impulse on them in this step. `status` is air_ok, or
    !> air_unphysical: then air%bad_cell and air%bad_state tell where, and the step is not finished.
    subroutine air_step(air, wall, dt, status, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        real(dp), intent(in) :: dt !! time step [s]
        integer, intent(out) :: status
        type(error_t), intent(inout) :: err !! exit_device where a GPU fails
        type(stage_t) :: stage
        integer :: m

        call begin_step(air, wall, err)
        do m = 1, air%n_stages
            stage = stage_of(air, dt, m)
            call take_rates(air, wall, stage, m == air%n_stages, status, err)
            if (status /= air_ok) return
            call end_stage(air, stage, m == 1)
        end do
    end subroutine air_step

    !> Room, impulses and the map of what is active, for a step. On a GPU the first one is computed
    !> everywhere, so that all states and fluxes hold gas at rest.
    subroutine begin_step(air, wall, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err

        call get_ready(air, wall)
        if (wall%cells%present) call ready_cut_cells(air, wall%cells, err)
        call settle_bricks(air, err)
        if (air%activity .and. .not. (air%on_gpu .and. .not. air%swept)) call wake_bricks(air, err)
        air%swept = .true.
    end subroutine begin_step

    !> Rates of a stage from the state of the air; `status` as air_step has it.
    subroutine take_rates(air, wall, stage, last, status, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        logical, intent(in) :: last !! stage of the step
        integer, intent(out) :: status
        type(error_t), intent(inout) :: err
        logical :: found

        status = air_ok
        call fill_ghosts(air, err)
        call sweep_all(air, wall, stage, err)
        if (wall%cells%present) call find_cut_rates(air, wall, stage, 0, err)
        if (.not. last) call offer_next(air, err)
        call find_bad(air, found, err)
        if (found) call repair(air, wall, stage, status, err)
        if (status /= air_ok) return
        call add_outflow(air, stage, err)
        if (wall%cells%present) call for_each_add_push(air%on_gpu, 3*wall%cells%n, &
            wall%cells%push, wall%cells%impulse, err)
    end subroutine take_rates

    !> Fill the ghosts of all directions that are modelled. Where the box of another process begins
    !> they are its cells.
    subroutine fill_ghosts(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        call exchange_ghosts(air, err)
        call for_each_fill_end(air%on_gpu, 2*air%grid%lines, air%grid, air%scheme, air%outside, &
                               air%u, err)
    end subroutine fill_ghosts

    !> Repair the rates of a stage where the sweeps found bad cells. `status` is set if in vain.
    subroutine repair(air, wall, stage, status, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: status
        type(error_t), intent(inout) :: err
        integer :: pass
        logical :: found

        pass = 0
        if (air%fallback .and. air%scheme%reconstruction /= first_order) then
            do pass = 1, repair_passes
                call tell_marks(air, err)
                call redo_all(air, wall, stage, pass, to_redo, err)
                call find_bad(air, found, err)
                if (.not. found) exit
            end do
            pass = min(pass, repair_passes)
            call add_count(air, pass, air%fallback_faces, err)
        end if
        if (air%fallback) call hold_cells(air, wall, stage, pass, err)
        call redo_all(air, wall, stage, pass, to_lose, err)
        call find_bad(air, found, err)
        if (found) then
            call find_lost_cell(air, wall, stage, found, err)
            if (first_lost(air, found)) status = air_unphysical
        end if
        call clear_marks(air, err)
    end subroutine repair

    !> Close the faces of the cells that no flux of first order saves.
    subroutine hold_cells(air, wall, stage, pass, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: pass !! marks up to this one count
        type(error_t), intent(inout) :: err
        integer :: m
        logical :: found

        do m = 1, most_holds
            call redo_all(air, wall, stage, pass, to_hold, err)
            call find_bad(air, found, err)
            if (.not. found) exit
            call tell_marks(air, err)
            pass = pass + limit_step
            call redo_all(air, wall, stage, pass, to_redo, err)
            call find_bad(air, found, err) ! whether cells must be held is asked again
        end do
        if (pass >= limit_step) call add_count(air, pass, air%limited_cells, err)
    end subroutine hold_cells

    !> Compute marked cells and their neighbours again, cut ones as well, or look at marked ones.
    subroutine redo_all(air, wall, stage, pass, task, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(error_t), intent(inout) :: err

        if (wall%cells%present) call redo_cut_cells(air, wall, stage, pass, task, err)
        call redo(air, wall, stage, pass, task, err)
    end subroutine redo_all

    !> The marks of cells beside the box, of other processes.
    subroutine tell_marks(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (several(air%part%ranks)) call exchange_marks(air, err)
    end subroutine tell_marks

    !> Count the faces that took the first-order flux, or, in a pass that holds, the cells held.
    subroutine add_count(air, pass, total, err)
        type(air_t), intent(in) :: air
        integer, intent(in) :: pass !! marks up to this one count
        integer(int64), intent(inout) :: total !! the number is added
        type(error_t), intent(inout) :: err
        integer :: number

        number = 0
        call for_each_count_marked(air%on_gpu, product(air%n), pass, air%grid, air%bad, number, err)
        total = total + number
    end subroutine add_count
end module brz_air_driver
