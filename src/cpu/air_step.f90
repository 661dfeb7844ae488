! SPDX-License-Identifier: MIT
!> One time step of the air: two or three Runge-Kutta stages of sweeps (SSP-RK2, which is Heun's
!> method, and SSP-RK3, of Shu and Osher).
module brz_air_step
    use brz_kinds, only: dp, int64, rk
    use brz_air_activity, only: find_awake, next_run
    use brz_air_grid, only: stage_t
    use brz_air_state, only: air_ok, air_t, brick, bc_inside, bc_periodic, lines_per_block, &
        n_ghost, set_scale, wall_t
    use brz_air_ghosts, only: fill_ghosts
    use brz_air_repair, only: repair
    use brz_air_stage, only: stage_of
    use brz_air_sweep, only: sweep
    use brz_air_totals, only: show_outflow
    use brz_face_loops, only: each_add_push
    use brz_grid_lines, only: across, n_blocks, n_lines
    use brz_ranks, only: most_of_all
    use brz_running_total, only: add_to_total
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: air_step, begin_step, take_rates, update

    integer, parameter :: few_numbers = 40000 !! fewer are not worth waking the other threads
    integer, parameter :: few_bricks = 100

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
            call take_rates(air, wall, stage, status)
            if (status /= air_ok) return
            call update(air, stage%dt, stage%weight, m == 1)
        end do
    end subroutine air_step

    !> Buffers, impulses and the map of what is awake, for a step.
    subroutine begin_step(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall

        call make_buffers(air)
        if (wall%present) then
            wall%push(1:wall%n_faces) = 0
            wall%impulse(1:wall%n_faces) = 0
        end if
        call set_scale(air)
        call find_awake(air, wall)
    end subroutine begin_step

    !> Rates of a stage from the state of the air, in air%rate; `status` as air_step has it.
    subroutine take_rates(air, wall, stage, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(out) :: status
        integer :: d, last
        integer(int64) :: suspects(1)

        status = air_ok
        last = findloc(air%n > 1, .true., dim=1, back=.true.)
        call fill_ghosts(air, wall)
        do d = 1, last
            if (air%n(d) > 1) call sweep(air, wall, d, stage)
        end do
        suspects = count(air%suspect(1:n_blocks(air%n, last)) > 0)
        call most_of_all(air%part%ranks, suspects)
        if (suspects(1) > 0) call repair(air, wall, last, stage, status)
        if (status /= air_ok) return
        call add_outflow(air, stage)
        if (wall%present) call each_add_push(wall%n_faces, wall%push, wall%impulse)
    end subroutine take_rates

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

    !> Book what left through the outer faces: the faces of a brick are summed in order, and those
    !> of bricks exactly, so that neither threads nor processes matter.
    subroutine add_outflow(air, stage)
        type(air_t), intent(inout) :: air
        type(stage_t), intent(in) :: stage
        integer :: b, c, d, s, before, bricks

        before = 0
        do d = 1, 3
            if (air%n(d) == 1) cycle
            bricks = size(air%reached)/size(air%reached, d)
            associate (n => n_lines(air%n, d), sums => air%brick_sum)
                do s = 1, 2
                    if (any(air%bc(s, d) == [bc_inside, bc_periodic])) cycle
                    !$omp parallel do schedule(static) if (bricks > few_bricks)
                    do b = 1, bricks
                        call sum_faces(air%n(across(:, d)), b, &
                                       air%edge(before + 1:before + n, :, s), sums(1:air%n_var, b))
                    end do
                    !$omp end parallel do
                    do b = 1, bricks
                        do c = 1, air%n_var
                            call add_to_total(air%left(c), (2*s - 3)*stage%leaves(d)*sums(c, b))
                        end do
                    end do
                end do
                before = before + n
            end associate
        end do
        call show_outflow(air)
    end subroutine add_outflow

    !> Fluxes through the faces of a brick at the boundary, added line by line.
    pure subroutine sum_faces(n, b, f, sums)
        integer, intent(in) :: n(2) !! lines in the transverse directions
        integer, intent(in) :: b !! brick
        real(rk), intent(in) :: f(:, :) !! (lines, n_var)
        real(dp), intent(out) :: sums(:) !! (n_var)
        integer :: c, j, k, first(2), last(2)

        first = [modulo(b - 1, (n(1) - 1)/brick + 1), (b - 1)/((n(1) - 1)/brick + 1)]*brick + 1
        last = min(first + brick - 1, n)
        sums = 0
        do c = 1, size(f, 2)
            do k = first(2), last(2)
                do j = first(1), last(1)
                    sums(c) = sums(c) + f((k - 1)*n(1) + j, c)
                end do
            end do
        end do
    end subroutine sum_faces

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
                            call next_run(air%awake(:, (j - 1)/brick + 1, (k - 1)/brick + 1), &
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
end module brz_air_step
