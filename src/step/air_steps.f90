! SPDX-License-Identifier: MIT
!> One time step of the air: two or three Runge-Kutta stages of sweeps (SSP-RK2, which is Heun's
!> method, and SSP-RK3, of Shu and Osher). The operations of every step, in their order;
!> scripts/steps.py writes the same for the GPU.
!>
!> A-posteriori fallback: the faces of a cell that would lose nearly all its density or pressure
!> take the first-order flux. A cell that this does not save is held. See brz_fallback_items. It
!> runs after the rates of a stage are complete and before they are used.
module brz_air_steps
    use brz_air_grid, only: faces_of_bricks, stage_t
    use brz_air_lost, only: first_lost
    use brz_air_operations, only: find_bad, find_lost_cell, get_ready, redo, sweep_all
    use brz_air_operations, only: update !@cpu
    use brz_air_outside, only: keep_outside !@cpu
    use brz_air_stage, only: stage_of
    use brz_air_state, only: air_ok, air_t, air_unphysical, wall_t
    use brz_air_totals, only: book_outflow !@cpu
    use brz_brick_steps, only: settle_bricks, wake_bricks
    use brz_face_loops, only: each_add_push, each_sum_face
    use brz_fallback_items, only: to_hold, to_lose, to_redo
    use brz_fallback_loops, only: each_count_marked
    use brz_fetch, only: fetch !@cpu
    !@gpu use brz_gpu_air_operations, only: offer_ghosts, take_ghosts
    use brz_ghost_loops, only: each_fill_end
    use brz_kinds, only: dp, int64
    use brz_positivity, only: hold_step, most_holds
    use brz_ranks, only: several
    use brz_runge_kutta, only: repair_passes
    use brz_scheme, only: first_order
    implicit none
    private
    public :: air_step, begin_step, take_rates

contains

    !> Advance the air by dt. The walls stand still in the step, but push with their velocity.
    !>
    !> `wall%impulse` becomes the impulse on the walls in this step. `status` is air_ok, or
    !> air_unphysical: then air%bad_cell and air%bad_state tell where, and the step is not finished.
    subroutine air_step(air, wall, dt, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        real(dp), intent(in) :: dt !! time step [s]
        integer, intent(out) :: status
        type(stage_t) :: stage
        integer :: m

        call begin_step(air, wall)
        do m = 1, air%n_stages
            stage = stage_of(air, dt, m)
            !@gpu gpu%offers = m < air%n_stages
            call take_rates(air, wall, stage, status)
            if (status /= air_ok) return
            call update(air, stage%dt, stage%weight, m == 1) !@cpu
            !@gpu call gpu%go_on()
        end do
    end subroutine air_step

    !> Room, impulses and the map of what is awake, for a step. On a GPU the first one is computed
    !> everywhere, so that all states and fluxes hold gas at rest.
    subroutine begin_step(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall

        call get_ready(air, wall) !@cpu
        !@gpu call get_ready(gpu)
        call settle_bricks(air)
        if (air%activity) call wake_bricks(air) !@cpu
        !@gpu if (air%activity .and. gpu%bricks%swept) call wake_bricks(gpu, air)
        !@gpu gpu%bricks%swept = .true.
    end subroutine begin_step

    !> Rates of a stage from the state of the air; `status` as air_step has it.
    subroutine take_rates(air, wall, stage, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(out) :: status
        logical :: found

        status = air_ok
        call fill_ghosts(air, wall)
        call sweep_all(air, wall, stage)
        !@gpu if (gpu%offers) call offer_ghosts(gpu)
        call find_bad(air, found)
        !@gpu if (found) gpu%offered = .false.
        if (found) call repair(air, wall, stage, status)
        if (status /= air_ok) return
        call add_outflow(air, stage)
        if (wall%n_faces > 0) call each_add_push(wall%n_faces, wall%push, wall%impulse)
    end subroutine take_rates

    !> Add up what leaves through the outer faces; on a GPU it is booked when somebody asks.
    subroutine add_outflow(air, stage)
        type(air_t), intent(inout) :: air
        type(stage_t), intent(in) :: stage
        integer :: faces

        air%leaving = 0 !@cpu
        faces = faces_of_bricks(air%grid%n, air%grid%bricks)
        call each_sum_face(2*air%n_var*faces, faces, air%grid, stage, air%edge, air%leaving)
        call book_outflow(air) !@cpu
    end subroutine add_outflow

    !> Fill the ghosts of all directions that are modelled. Where the box of another process begins
    !> they are its cells.
    subroutine fill_ghosts(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall

        call keep_outside(air) !@cpu
        call fetch(air%part%ranks, air%part%halo, air%n_var, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%u) !@cpu
        !@gpu call take_ghosts(gpu)
        call each_fill_end(2*air%grid%lines, air%grid, air%scheme, air%outside, wall%solid, air%u)
    end subroutine fill_ghosts

    !> Repair the rates of a stage where the sweeps found bad cells. `status` is set if in vain.
    subroutine repair(air, wall, stage, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: status
        integer :: pass
        logical :: found

        pass = 0
        if (air%fallback .and. air%scheme%reconstruction /= first_order) then
            do pass = 1, repair_passes
                call tell_marks(air)
                call redo(air, wall, stage, pass, to_redo)
                call find_bad(air, found)
                if (.not. found) exit
            end do
            pass = min(pass, repair_passes)
            call add_count(air, pass, air%fallback_faces)
        end if
        if (air%fallback) call hold_cells(air, wall, stage, pass)
        call redo(air, wall, stage, pass, to_lose)
        call find_bad(air, found)
        if (found) then
            call find_lost_cell(air, stage, found) !@cpu
            !@gpu call find_lost_cell(gpu, air, found)
            if (first_lost(air, found)) status = air_unphysical
        end if
        air%bad = 0 !@cpu
        !@gpu call clear_buffer(gpu%bad)
    end subroutine repair

    !> Close the faces of the cells that no flux of first order saves.
    subroutine hold_cells(air, wall, stage, pass)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: pass !! marks up to this one count
        integer :: m
        logical :: found

        do m = 1, most_holds
            call redo(air, wall, stage, pass, to_hold)
            call find_bad(air, found)
            if (.not. found) exit
            call tell_marks(air)
            pass = pass + hold_step
            call redo(air, wall, stage, pass, to_redo)
            call find_bad(air, found) ! whether cells must be held is asked again
        end do
        if (pass >= hold_step) call add_count(air, pass, air%held_cells)
    end subroutine hold_cells

    !> The marks of cells beside the box, of other processes.
    subroutine tell_marks(air)
        type(air_t), intent(inout) :: air

        if (.not. several(air%part%ranks)) return
        call fetch(air%part%ranks, air%part%beside, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%bad) !@cpu
        !@gpu call gpu%beside%bytes_of_others(gpu%bad)
    end subroutine tell_marks

    !> Count the faces that took the first-order flux, or, in a pass that holds, the cells held.
    subroutine add_count(air, pass, total)
        type(air_t), intent(in) :: air
        integer, intent(in) :: pass !! marks up to this one count
        integer(int64), intent(inout) :: total !! the number is added
        integer :: number

        number = 0
        call each_count_marked(product(air%n), pass, air%grid, air%bad, number) !@cpu
        !@gpu call fallback_kernels%count_marked(product(air%n), pass, gpu%grid, gpu%bad, gpu%found)
        !@gpu call take_found(gpu, number)
        total = total + number
    end subroutine add_count
end module brz_air_steps
