! SPDX-License-Identifier: MIT
!> A-posteriori fallback: the faces of a cell that would lose nearly all its density or pressure
!> take the first-order flux. A cell that this does not save is held. See brz_fallback_items.
!>
!> It runs after the rates of a stage are complete and before they are used, by one thread: few
!> cells are marked.
module brz_air_repair
    use brz_air_grid, only: grid_of, grid_t, place_of, stage_t
    use brz_air_lost, only: find_lost, first_lost
    use brz_air_state, only: air_t, air_unphysical, bc_periodic, lines_per_block, wall_t
    use brz_fallback_items, only: is_touched, mark_cell, redo_rates, to_hold, to_lose, to_redo
    use brz_fallback_loops, only: each_count_marked
    use brz_fetch, only: fetch
    use brz_grid_lines, only: first_cell_of, n_blocks, n_lines
    use brz_kinds, only: int64, int8, rk
    use brz_positivity, only: hold_step, most_holds
    use brz_ranks, only: most_of_all
    use brz_runge_kutta, only: repair_passes
    use brz_scheme, only: first_order, max_var
    implicit none
    private
    public :: repair

contains

    !> Repair the rates of a stage where the sweeps found suspects. `status` is set if in vain.
    subroutine repair(air, wall, last, stage, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: last !! direction of the last sweep, whose blocks hold the suspects
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: status
        type(grid_t) :: grid
        real(rk) :: old(max_var), new(max_var)
        integer(int64) :: at
        integer :: pass
        logical :: found

        grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        grid%walls = merge(1, 0, wall%present)
        call find_suspects(air, wall, grid, last, stage, found)
        if (.not. found) return
        pass = 0
        if (air%fallback .and. air%scheme%reconstruction /= first_order) then
            do pass = 1, repair_passes
                call tell_marks(air)
                call redo(air, wall, grid, stage, pass, to_redo, found)
                if (.not. found) exit
            end do
            pass = min(pass, repair_passes)
            call add_count(air, grid, pass, air%fallback_faces)
        end if
        if (air%fallback) call hold_cells(air, wall, grid, stage, pass)
        call redo(air, wall, grid, stage, pass, to_lose, found)
        if (found) then
            call find_lost(air, grid, air%bad, at)
            if (at > 0) call euler_step(air, stage, air%bad_cell, old, new)
            air%bad_state = new(1:5)
            if (first_lost(air, at > 0)) status = air_unphysical
        end if
        air%bad = 0
    end subroutine repair

    !> Close the faces of the cells that no flux of first order saves.
    subroutine hold_cells(air, wall, grid, stage, pass)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(grid_t), intent(in) :: grid
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: pass !! marks up to this one count
        integer :: m
        logical :: found

        do m = 1, most_holds
            call redo(air, wall, grid, stage, pass, to_hold, found)
            if (.not. found) exit
            call tell_marks(air)
            pass = pass + hold_step
            call redo(air, wall, grid, stage, pass, to_redo, found)
        end do
        if (pass >= hold_step) call add_count(air, grid, pass, air%held_cells)
    end subroutine hold_cells

    !> Mark the bad gas cells in the blocks that have suspects. `found` if any process has some.
    subroutine find_suspects(air, wall, grid, last, stage, found)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: last !! direction of the last sweep
        type(stage_t), intent(in) :: stage
        logical, intent(out) :: found
        integer :: b, i, line, cell(3), here(1)

        here = 0
        do b = 1, n_blocks(air%n, last)
            if (air%suspect(b) == 0) cycle
            do line = (b - 1)*lines_per_block + 1, min(b*lines_per_block, n_lines(air%n, last))
                call first_cell_of(air%n, last, line, cell)
                do i = 1, air%n(last)
                    cell(last) = i
                    call look_at(air, wall, grid, stage, 0, to_redo, cell, here)
                end do
            end do
        end do
        found = anywhere(air, here)
    end subroutine find_suspects

    !> Compute marked cells and their neighbours again, or look at marked ones: row by row, of those
    !> that have marks or lie beside one that has.
    subroutine redo(air, wall, grid, stage, pass, task, found)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(grid_t), intent(in) :: grid
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        logical, intent(out) :: found
        integer :: i, j, k, here(1)
        logical :: marked(0:air%n(2) + 1, 0:air%n(3) + 1)

        !$omp parallel do collapse(2) schedule(static) private(i) if (size(air%bad) > 100000)
        do k = 0, air%n(3) + 1
            do j = 0, air%n(2) + 1
                marked(j, k) = any(air%bad(:, row_at(2, j), row_at(3, k)) /= 0)
            end do
        end do
        here = 0
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                if (.not. (any(marked(j - 1:j + 1, k)) .or. any(marked(j, k - 1:k + 1)))) cycle
                do i = 1, air%n(1)
                    if (.not. is_touched(pass, task, grid, i, j, k, air%bad)) cycle
                    if (task == to_redo) call renew(air, wall, grid, stage, pass, [i, j, k])
                    call look_at(air, wall, grid, stage, pass, task, [i, j, k], here)
                end do
            end do
        end do
        found = anywhere(air, here)

    contains

        !> A row beside the grid is that at its other end where it goes on there, else a ghost.
        pure integer function row_at(d, p)
            integer, intent(in) :: d, p

            row_at = p
            if (grid%around(d) > 0) row_at = modulo(p - 1, air%n(d)) + 1
            row_at = min(max(row_at, 1 - air%g(d)), air%n(d) + air%g(d))
        end function row_at
    end subroutine redo

    !> Compute the rates of a cell again.
    subroutine renew(air, wall, grid, stage, pass, cell)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(grid_t), intent(in) :: grid
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass, cell(3)
        integer(int8), parameter :: no_map(1) = 0
        integer, parameter :: no_cells(1) = 0
        real(rk), parameter :: no_walls(3) = 0
        real(rk) :: no_push(1)

        if (wall%present) then
            call redo_rates(pass, grid, air%scheme, stage, cell(1), cell(2), cell(3), air%u, &
                air%rate, air%bad, air%edge, wall%solid, wall%index, wall%v, wall%face_of, &
                wall%push)
        else
            call redo_rates(pass, grid, air%scheme, stage, cell(1), cell(2), cell(3), air%u, &
                air%rate, air%bad, air%edge, no_map, no_cells, no_walls, no_cells, no_push)
        end if
    end subroutine renew

    !> Mark a gas cell as its Euler step says, see mark_cell.
    subroutine look_at(air, wall, grid, stage, pass, task, cell, found)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(grid_t), intent(in) :: grid
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass, task, cell(3)
        integer, intent(inout) :: found(1)
        real(rk) :: old(max_var), euler(max_var)

        if (wall%present) then
            if (wall%solid(cell(1), cell(2), cell(3)) == 1) return
        end if
        call euler_step(air, stage, cell, old, euler)
        call mark_cell(air%n_var, stage%floors, pass, task, &
                       place_of(grid, cell(1), cell(2), cell(3)), old, euler, air%bad, found)
    end subroutine look_at

    !> State of a cell and its Euler step.
    pure subroutine euler_step(air, stage, cell, old, new)
        type(air_t), intent(in) :: air
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        real(rk), intent(out) :: old(max_var), new(max_var)

        old = 0
        new = 0
        old(:air%n_var) = air%u(cell(1), cell(2), cell(3), :)
        new(:air%n_var) = old(:air%n_var) + stage%dt*air%rate(cell(1), cell(2), cell(3), :)
    end subroutine euler_step

    !> The marks of cells beside the box, of other processes.
    subroutine tell_marks(air)
        type(air_t), intent(inout) :: air

        call fetch(air%part%ranks, air%part%beside, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%bad)
    end subroutine tell_marks

    !> Count the faces that took the first-order flux, or, in a pass that holds, the cells held.
    subroutine add_count(air, grid, pass, total)
        type(air_t), intent(in) :: air
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: pass !! marks up to this one count
        integer(int64), intent(inout) :: total !! the number is added
        integer :: number

        number = 0
        call each_count_marked(product(air%n), pass, grid, air%bad, number)
        total = total + number
    end subroutine add_count

    !> True if there is one in any process.
    logical function anywhere(air, here)
        type(air_t), intent(in) :: air
        integer, intent(in) :: here(1)
        integer(int64) :: vote(1)

        vote = here
        call most_of_all(air%part%ranks, vote)
        anywhere = vote(1) > 0
    end function anywhere
end module brz_air_repair
