! SPDX-License-Identifier: MIT
!> What a step of the air is made of on the CPU; brz_air_driver puts it in order. Cells that the
!> fallback computes again are few: one thread does it.
module brz_air_operations
    use brz_kinds, only: int64, int8, rk
    use brz_air_activity, only: next_run
    use brz_air_grid, only: number_of, place_of, stage_t
    use brz_air_lost, only: find_lost
    use brz_air_outside, only: set_grid
    use brz_air_state, only: air_t, brick, lines_per_block, n_ghost, &
        set_scale, wall_t
    use brz_air_sweep, only: sweep
    use brz_fallback_loop_bodies, only: is_touched, mark_cell, redo_rates, to_redo
    use brz_grid_lines, only: first_cell_of, n_blocks, n_lines
    use brz_ranks, only: most_of_all
    use brz_scheme, only: max_var
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: get_ready, sweep_all, find_bad, redo, find_lost_cell, update

    integer, parameter :: few_numbers = 40000 !! fewer are not worth waking the other threads

contains

    !> Buffers for a step.
    subroutine get_ready(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall

        call make_buffers(air)
        call set_scale(air)
        call set_grid(air)
        if (wall%cells%present) air%grid%walls = 2
    end subroutine get_ready

    !> Give every thread its buffers; only a first step, or one with more threads, allocates.
    subroutine make_buffers(air)
        type(air_t), intent(inout) :: air
        integer :: t, n

        if (allocated(air%work)) then
            if (size(air%work) >= omp_get_max_threads()) return
            deallocate (air%work)
        end if
        n = maxval(air%n)
        allocate (air%work(0:omp_get_max_threads() - 1))
        do t = 0, omp_get_max_threads() - 1
            allocate (air%work(t)%q(lines_per_block, air%n_var, 1 - n_ghost:n + n_ghost), &
                air%work(t)%f(lines_per_block, air%n_var, 0:n), &
                air%work(t)%ends(lines_per_block, air%n_var, 2))
        end do
    end subroutine make_buffers

    !> Rates of all directions, in air%rate, and marks of the cells that they would leave bad. Cut
    !> cells get theirs afterwards.
    subroutine sweep_all(air, wall, stage)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer :: d

        do d = 1, air%grid%last
            if (air%n(d) > 1) call sweep(air, d, stage)
        end do
        if (any(air%suspect(:n_blocks(air%n, air%grid%last)) > 0)) &
            call find_suspects(air, wall, stage)
    end subroutine sweep_all

    !> True for a cell of the list of cut cells, which have rates of their own.
    pure logical function is_cut(wall, i, j, k)
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: i, j, k !! cell

        is_cut = .false.
        if (wall%cells%present) is_cut = entry_of(wall, [i, j, k]) > 0
    end function is_cut

    !> Entry of a cell in the list of cut cells, 0: not listed.
    pure integer function entry_of(wall, cell) result(entry)
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: cell(3)

        associate (nodes => wall%cells%nodes)
            entry = wall%cells%slot(number_of(nodes%n, nodes%own(:, 1) - 1 + cell))
        end associate
    end function entry_of

    !> Has a bad cell been found since the last call, in any process?
    subroutine find_bad(air, found)
        type(air_t), intent(inout) :: air
        logical, intent(out) :: found
        integer(int64) :: reduction(1)

        reduction = air%found
        call most_of_all(air%part%ranks, reduction)
        found = reduction(1) > 0
        air%found = 0
    end subroutine find_bad

    !> Mark the bad gas cells in the blocks that have suspects.
    subroutine find_suspects(air, wall, stage)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer :: b, i, last, line, cell(3)

        last = air%grid%last ! direction of the last sweep, whose blocks hold the suspects
        do b = 1, n_blocks(air%n, last)
            if (air%suspect(b) == 0) cycle
            do line = (b - 1)*lines_per_block + 1, min(b*lines_per_block, n_lines(air%n, last))
                call first_cell_of(air%n, last, line, cell)
                do i = 1, air%n(last)
                    cell(last) = i
                    if (is_cut(wall, cell(1), cell(2), cell(3))) cycle
                    call look_at(air, wall, stage, 0, to_redo, cell)
                end do
            end do
        end do
    end subroutine find_suspects

    !> Compute marked cells and their neighbours again, or look at marked ones: row by row, of those
    !> that have marks or lie beside one that has.
    subroutine redo(air, wall, stage, pass, task)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        integer :: i, j, k
        logical :: marked(0:air%n(2) + 1, 0:air%n(3) + 1)

        !$omp parallel do collapse(2) schedule(static) private(i) if (size(air%bad) > 100000)
        do k = 0, air%n(3) + 1
            do j = 0, air%n(2) + 1
                marked(j, k) = any(air%bad(:, row_at(2, j), row_at(3, k)) /= 0)
            end do
        end do
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                if (.not. (any(marked(j - 1:j + 1, k)) .or. any(marked(j, k - 1:k + 1)))) cycle
                do i = 1, air%n(1)
                    if (.not. is_touched(pass, task, air%grid, i, j, k, air%bad)) cycle
                    if (is_cut(wall, i, j, k)) cycle
                    if (task == to_redo) call redo_rates(pass, air%grid, air%scheme, i, j, k, &
                        air%u, air%rate, air%bad, air%edge)
                    call look_at(air, wall, stage, pass, task, [i, j, k])
                end do
            end do
        end do

    contains

        !> A row beside the grid is that at its other end where it goes on there, else a ghost.
        pure integer function row_at(d, p)
            integer, intent(in) :: d, p

            row_at = p
            if (air%grid%around(d) > 0) row_at = modulo(p - 1, air%n(d)) + 1
            row_at = min(max(row_at, 1 - air%g(d)), air%n(d) + air%g(d))
        end function row_at
    end subroutine redo

    !> Mark a gas cell as its Euler step says, see mark_cell.
    subroutine look_at(air, wall, stage, pass, task, cell)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass, task, cell(3)
        real(rk) :: old(max_var), euler(max_var)

        call euler_step(air, wall, stage, cell, old, euler)
        call mark_cell(air%n_var, stage%floors, pass, task, &
                       place_of(air%grid, cell(1), cell(2), cell(3)), old, euler, air%bad, &
                       air%found)
    end subroutine look_at

    !> State of a cell and its Euler step.
    pure subroutine euler_step(air, wall, stage, cell, old, new)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        real(rk), intent(out) :: old(max_var), new(max_var)

        old = 0
        new = 0
        old(:air%n_var) = air%u(cell(1), cell(2), cell(3), :)
        new(:air%n_var) = old(:air%n_var) + stage%dt*air%rate(cell(1), cell(2), cell(3), :)
        if (is_cut(wall, cell(1), cell(2), cell(3))) new(:air%n_var) = &
            wall%cells%euler(:air%n_var, entry_of(wall, cell))
    end subroutine euler_step

    !> Where the first lost cell of this process is, and what it would have become.
    subroutine find_lost_cell(air, wall, stage, here)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        logical, intent(out) :: here !! there is one
        real(rk) :: old(max_var), new(max_var)
        integer(int64) :: at

        call find_lost(air, air%grid, air%bad, at)
        here = at > 0
        new = 0
        if (here) call euler_step(air, wall, stage, air%bad_cell, old, new)
        air%bad_state = new(1:5)
    end subroutine find_lost_cell

    !> Combine the Euler step with the start of the step; the first stage keeps the start.
    !>
    !> Written in differences, so that a gas at rest does not change by a bit.
    subroutine update(air, dt, part, first)
        type(air_t), intent(inout) :: air
        real(rk), intent(in) :: dt !! time step [s]
        real(rk), intent(in) :: part !! weight of the new state
        logical, intent(in) :: first !! first stage
        integer :: i, j, k, c, lo, hi

        associate (u => air%u, u_start => air%u_start, rate => air%rate)
            !$omp parallel do collapse(2) schedule(dynamic, 4) private(i, j, lo, hi) &
            !$omp& if (size(air%rate) > few_numbers)
            do c = 1, air%n_var
                do k = 1, air%n(3)
                    do j = 1, air%n(2)
                        hi = 0
                        do
                            call next_run(air%active(:, (j - 1)/brick + 1, (k - 1)/brick + 1), &
                                air%n(1), lo, hi)
                            if (lo > air%n(1)) exit
                            if (first) then
                                do i = lo, hi
                                    u_start(i, j, k, c) = u(i, j, k, c)
                                    u(i, j, k, c) = u(i, j, k, c) + dt*rate(i, j, k, c)
                                end do
                            else
                                do i = lo, hi
                                    u(i, j, k, c) = u_start(i, j, k, c) + part &
                                        *(u(i, j, k, c) - u_start(i, j, k, c) + dt*rate(i, j, k, c))
                                end do
                            end if
                        end do
                    end do
                end do
            end do
            !$omp end parallel do
        end associate
    end subroutine update
end module brz_air_operations
