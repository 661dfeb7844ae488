! SPDX-License-Identifier: MIT
!> The operations of a step of the air that are not loop bodies: as sweeps over lines of cells on
!> the CPU, as kernels on a GPU. brz_air_driver puts them in order.
module brz_air_backend
    use brz_air_grid, only: stage_t
    use brz_air_operations, only: cpu_find_bad => find_bad, cpu_find_lost_cell => find_lost_cell, &
        cpu_get_ready => get_ready, cpu_redo => redo, cpu_sweep_all => sweep_all, update
    use brz_air_outside, only: keep_outside
    use brz_air_state, only: air_t, wall_t
    use brz_device, only: clear_buffer
    use brz_errors, only: error_t
    use brz_fetch, only: fetch
    use brz_gpu_air_operations, only: gpu_find_bad => find_bad, &
        gpu_find_lost_cell => find_lost_cell, gpu_get_ready => get_ready, gpu_redo => redo, &
        gpu_sweep_all => sweep_all, offer_ghosts, take_ghosts
    use brz_gpu_air_state, only: go_on
    use brz_present_table, only: attach
    implicit none
    private
    public :: get_ready, exchange_ghosts, sweep_all, find_bad, redo, find_lost_cell, end_stage
    public :: exchange_marks, clear_marks, exchange_bricks, offer_next

contains

    !> Room for a step.
    subroutine get_ready(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall

        if (air%on_gpu) then
            call gpu_get_ready(air%device)
            call attach(air%u_start, air%device%start)
        else
            call cpu_get_ready(air, wall)
        end if
    end subroutine get_ready

    !> Ghosts where the box of another process begins: its cells.
    subroutine exchange_ghosts(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call take_ghosts(air%device, err)
        else
            call keep_outside(air)
            associate (lo => air%before + 1 - air%g, hi => air%before + air%n + air%g)
                call fetch(air%part%ranks, air%part%halo, air%n_var, lo, hi, air%u)
            end associate
        end if
    end subroutine exchange_ghosts

    !> Rates of a stage, and marks of the cells that they would leave bad.
    subroutine sweep_all(air, wall, stage, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call gpu_sweep_all(air%device, air, stage, err)
        else
            call cpu_sweep_all(air, wall, stage)
        end if
    end subroutine sweep_all

    !> On a GPU others get their ghosts of the next state before all vote on it.
    subroutine offer_next(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (air%on_gpu) call offer_ghosts(air%device, err)
    end subroutine offer_next

    !> Has a bad cell been found since the last call, in any process?
    subroutine find_bad(air, found, err)
        type(air_t), intent(inout) :: air
        logical, intent(out) :: found
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call gpu_find_bad(air%device, air, found, err)
        else
            call cpu_find_bad(air, found)
        end if
    end subroutine find_bad

    !> Compute marked cells and their neighbours again, or look at marked ones.
    subroutine redo(air, wall, stage, pass, task, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            air%device%offered = .false. ! the next state changes
            call gpu_redo(air%device, air, stage, pass, task, err)
        else
            call cpu_redo(air, wall, stage, pass, task)
        end if
    end subroutine redo

    !> Where the first lost cell of this process is, and what it would have become.
    subroutine find_lost_cell(air, wall, stage, here, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        logical, intent(out) :: here !! there is one
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call gpu_find_lost_cell(air%device, air, here, err)
        else
            call cpu_find_lost_cell(air, wall, stage, here)
        end if
    end subroutine find_lost_cell

    !> The state after a stage. A GPU has written it beside the one before.
    subroutine end_stage(air, stage, first)
        type(air_t), intent(inout) :: air
        type(stage_t), intent(in) :: stage
        logical, intent(in) :: first !! of the step

        if (air%on_gpu) then
            call go_on(air)
        else
            call update(air, stage%dt, stage%weight, first)
        end if
    end subroutine end_stage

    !> Marks of cells beside the box, of other processes.
    subroutine exchange_marks(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call air%device%beside%bytes_of_others(air%device%bad, err)
        else
            call fetch(air%part%ranks, air%part%beside, air%before + 1 - air%g, &
                       air%before + air%n + air%g, air%bad)
        end if
    end subroutine exchange_marks

    !> No cell is marked.
    subroutine clear_marks(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call clear_buffer(air%device%bad, err)
        else
            air%bad = 0
        end if
    end subroutine clear_marks

    !> Which bricks of other processes near the box something has reached.
    subroutine exchange_bricks(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (air%on_gpu) then
            call air%device%bricks%others%bytes_of_others(air%device%bricks%near_reached, err)
        else
            associate (whole => air%part%bricks%whole)
                call fetch(air%part%ranks, air%part%bricks, whole%lo, whole%hi, air%part%reached)
            end associate
        end if
    end subroutine exchange_bricks
end module brz_air_backend
