! SPDX-License-Identifier: MIT
!> What cut cells do in a step of the air, beside the sweeps.
module brz_cut_rate_driver
    use brz_air_grid, only: stage_t
    use brz_air_state, only: air_t, wall_t
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_share, only: found_by_any, pick_states, put_states, share_rows, states_in
    use brz_cut_loops, only: for_each_cut_count_moving, for_each_cut_finish, for_each_cut_join, &
        for_each_cut_rate, for_each_cut_reach
    use brz_errors, only: error_t
    use brz_fallback_loop_bodies, only: to_redo
    use brz_lists, only: clear_reals
    use brz_ranks, only: several
    use brz_record_rules, only: w => words_of_real
    use brz_rows, only: rows_of
    use brz_scheme, only: max_var
    implicit none
    private
    public :: ready_cut_cells, find_cut_rates, redo_cut_cells

contains

    !> Impulses for a step; where walls move, the bricks with cut cells are reached.
    subroutine ready_cut_cells(air, cells, err)
        type(air_t), intent(inout) :: air
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err
        integer :: moving

        call clear_reals(air%on_gpu, 3*cells%n, cells%impulse, err)
        moving = 0
        call for_each_cut_count_moving(air%on_gpu, cells%n, cells%v, moving, err)
        if (found_by_any(air%part%ranks, moving)) call for_each_cut_reach(air%on_gpu, cells%n, &
            cells%nodes, cells%cell, cells%place, air%reached, err)
    end subroutine ready_cut_cells

    !> Rates of the cut cells in place of those that the sweeps have given them, and marks of those
    !> that they would leave bad.
    subroutine find_cut_rates(air, wall, stage, pass, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        type(error_t), intent(inout) :: err

        associate (c => wall%cells)
            call for_each_cut_rate(air%on_gpu, c%n, c%nodes, air%scheme, stage, pass, c%cell, &
                c%place, c%beside, c%shut, c%aperture, c%area, c%middle, c%curvature, &
                c%v, c%master, air%bad, air%u, air%edge, c%rate, c%push, err)
            if (several(air%part%ranks)) call share_rates(air, wall, stage, err)
            call for_each_cut_join(air%on_gpu, c%n, c%nodes, stage, c%place, c%master, c%ends, &
                                   c%member, c%volume, c%swept, c%rate, air%u, air%u_start, &
                                   c%joined, c%euler, err)
        end associate
        call finish_cut_cells(air, wall%cells, stage, pass, to_redo, err)
    end subroutine find_cut_rates

    !> Rates of the cells of others, and their states: members of a cluster may be in boxes of
    !> several processes.
    subroutine share_rates(air, wall, stage, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout), target :: wall
        type(stage_t), intent(in) :: stage
        type(error_t), intent(inout) :: err

        associate (g => air%on_gpu, c => wall%cells, share => wall%share)
            call pick_states(share, c, air%u, err)
            call share_rows(share, [rows_of(g, c%rate, max_var*w), states_in(share)], err)
            call put_states(share, c, air%u, err)
            ! the start of the step, which later stages read: a GPU keeps all of it
            if (stage%first == 1 .and. .not. g) call put_states(share, c, air%u_start, err)
        end associate
    end subroutine share_rates

    !> Compute the cut cells again, or look at marked ones.
    subroutine redo_cut_cells(air, wall, stage, pass, task, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(error_t), intent(inout) :: err

        if (task == to_redo) then
            call find_cut_rates(air, wall, stage, pass, err)
        else
            call finish_cut_cells(air, wall%cells, stage, pass, task, err)
        end if
    end subroutine redo_cut_cells

    !> Rates of the clusters become those of their cells; on a GPU, where the next state stands in
    !> place of the rates, this.
    subroutine finish_cut_cells(air, cells, stage, pass, task, err)
        type(air_t), intent(inout) :: air
        type(cut_cells_t), intent(in) :: cells
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(error_t), intent(inout) :: err

        call for_each_cut_finish(air%on_gpu, cells%n, cells%nodes, stage, pass, task, &
            merge(1, 0, air%on_gpu), cells%cell, cells%place, cells%shut, cells%joined, &
            cells%euler, air%u, air%u_start, air%rate, air%bad, air%found, err)
    end subroutine finish_cut_cells
end module brz_cut_rate_driver
