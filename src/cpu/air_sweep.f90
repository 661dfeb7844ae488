! SPDX-License-Identifier: MIT
!> Rates of change of the air by one direction: blocks of lines, with the lines as the vector.
!>
!> A block is copied to a buffer in which its direction comes first, so that x, y and z run through
!> the same instructions and give the same bits; then split fluxes, fluxes, differences.
module brz_air_sweep
    use brz_kinds, only: dp, int8, rk
    use brz_air_activity, only: active_along, next_run
    use brz_air_boundary, only: beyond_wall
    use brz_air_grid, only: place_of, stage_t
    use brz_air_state, only: air_t, bc_inside, bc_periodic, brick, lines_per_block, n_ghost, &
        sweep_work_t
    use brz_grid_lines, only: first_cell_of, n_blocks, n_lines, turned
    use brz_gas, only: pressure
    use brz_positivity, only: margin, stray
    use brz_scheme, only: max_var
    use brz_face_loop_bodies, only: face_at
    use brz_air_lines, only: line_fluxes
    use omp_lib, only: omp_get_thread_num
    implicit none
    private
    public :: sweep

    integer, parameter :: nb = lines_per_block
    integer, parameter :: few_cells = 8000 !! fewer are not worth waking the other threads

    !> A part of a block of lines, and where it lies in an array seen as a row of numbers.
    type :: run_t
        integer :: d = 1 !! direction
        integer :: block = 1
        integer :: lo = 1, hi = 0 !! cells along the lines
        integer :: n = 0 !! their number
        integer :: lines = nb !! lines that count, the others repeat the last one
        logical :: adjacent = .false. !! the lines are neighbours in memory
        integer :: start(nb) = 0 !! place of cell 0 of each line
        integer :: along = 1 !! distance of neighbours on a line
        integer :: apart = 1 !! distance of two variables
        logical :: first = .true. !! first direction: the rates start from zero
        logical :: last = .true. !! last direction: the rates are complete
    end type run_t

contains

    !> Add (or, first, set) the rates by the fluxes in direction d.
    subroutine sweep(air, d, stage)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: d !! direction
        type(stage_t), intent(in) :: stage
        integer :: b

        !$omp parallel do schedule(dynamic, 4) if (product(air%n) > few_cells)
        do b = 1, n_blocks(air%n, d)
            call sweep_block(air, d, b, stage, air%work(omp_get_thread_num()))
        end do
        !$omp end parallel do
    end subroutine sweep

    !> One block of lines: the parts of it that are active.
    subroutine sweep_block(air, d, b, stage, work)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: b !! block
        type(stage_t), intent(in) :: stage
        type(sweep_work_t), intent(inout) :: work
        integer(int8) :: active((air%n(d) + brick - 1)/brick)
        type(run_t) :: run

        run%first = all(air%n(:d - 1) == 1)
        run%last = all(air%n(d + 1:) == 1)
        if (run%last) air%suspect(b) = 0
        work%ends = 0
        work%ends(:, 2, :) = pressure(air%scheme%gamma, air%rest)
        call active_along(air, d, b, active)
        run%d = d
        run%block = b
        call locate(air%n, air%g, d, b, run)
        run%hi = 0
        do
            call next_run(active, air%n(d), run%lo, run%hi)
            if (run%lo > air%n(d)) exit
            run%n = run%hi - run%lo + 1
            call sweep_run(air, run, stage, work)
        end do
        call keep_ends(air, d, b, run%lines, work%ends)
    end subroutine sweep_block

    !> A part of a block of lines, as lines of their own.
    subroutine sweep_run(air, run, stage, work)
        type(air_t), intent(inout) :: air
        type(run_t), intent(in) :: run
        type(stage_t), intent(in) :: stage
        type(sweep_work_t), intent(inout) :: work
        integer :: n, nv

        n = run%n
        nv = air%n_var
        call load(n, nv, size(air%u), air%u, run, turned(1, run%d), work%q)
        call line_fluxes(n, nv, air%scheme, work%q, work%f)
        if (run%lo == 1) call wall_end(air, run, 0, work%f)
        if (run%hi == air%n(run%d)) call wall_end(air, run, run%n, work%f)
        if (run%lo == 1) work%ends(:, :, 1) = work%f(:, :, 0)
        if (run%hi == air%n(run%d)) work%ends(:, :, 2) = work%f(:, :, n)
        call difference(n, nv, real(1/air%dx(run%d), rk), work%f)
        call store(n, nv, air%rate, run, turned(1, run%d), run%first, work%f)
        if (run%last) call count_suspects(n, nv, stage, work%q, work%f, air%suspect(run%block))
    end subroutine sweep_run

    !> Replace the flux through the first (i = 0) or last face of the lines if a wall is there.
    subroutine wall_end(air, run, i, f)
        type(air_t), intent(in) :: air
        type(run_t), intent(in) :: run
        integer, intent(in) :: i !! number of the face on the run
        real(rk), intent(inout) :: f(nb, air%n_var, 0:run%n) !! fluxes
        real(rk) :: flux(max_var)
        integer :: d, l, low(3)

        d = run%d
        if (.not. beyond_wall(air%scheme, air%bc(1, d), air%bc(2, d), air%n(d), &
                              merge(0, air%n(d) + 1, i == 0))) return
        do l = 1, nb
            call first_cell_of(air%n, d, (run%block - 1)*nb + min(l, run%lines), low)
            low(d) = run%lo - 1 + i
            call face_at(d, air%grid, air%scheme, place_of(air%grid, low(1), low(2), low(3)), &
                         low(d), air%u, flux)
            f(l, :, i) = flux(:air%n_var)
        end do
    end subroutine wall_end

    !> Find the lines of a block in an array of n cells with g ghost layers.
    pure subroutine locate(n, g, d, b, run)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: g(3) !! ghost layers of the array
        integer, intent(in) :: d !! direction
        integer, intent(in) :: b !! block
        type(run_t), intent(inout) :: run
        integer :: l, cell(3), step(3)

        step = [1, n(1) + 2*g(1), (n(1) + 2*g(1))*(n(2) + 2*g(2))]
        run%along = step(d)
        run%apart = step(3)*(n(3) + 2*g(3))
        run%lines = min(nb, n_lines(n, d) - (b - 1)*nb)
        do l = 1, nb
            call first_cell_of(n, d, (b - 1)*nb + min(l, run%lines), cell)
            cell(d) = 0
            run%start(l) = 1 + dot_product(cell + g - 1, step)
        end do
        run%adjacent = run%lines == nb .and. run%start(nb) - run%start(1) == nb - 1
    end subroutine locate

    !> Copy the lines of a block, ghosts and all, with the vectors turned into direction d.
    pure subroutine load(n, nv, length, u, run, turn, q)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        integer, intent(in) :: length
        real(rk), intent(in) :: u(length)
        type(run_t), intent(in) :: run
        integer, intent(in) :: turn(nv) !! variable in each slot
        real(rk), intent(out) :: q(nb, nv, 1 - n_ghost:n + n_ghost)
        integer :: c, i, l, at

        if (run%adjacent) then
            do i = 1 - n_ghost, n + n_ghost
                do c = 1, nv
                    at = run%start(1) + (run%lo - 1 + i)*run%along + (turn(c) - 1)*run%apart - 1
                    do l = 1, nb
                        q(l, c, i) = u(at + l)
                    end do
                end do
            end do
        else
            do c = 1, nv
                do l = 1, nb
                    at = run%start(l) + (run%lo - 1)*run%along + (turn(c) - 1)*run%apart
                    do i = 1 - n_ghost, n + n_ghost
                        q(l, c, i) = u(at + i*run%along)
                    end do
                end do
            end do
        end if
    end subroutine load

    !> Add the rates of a block to their places, or set them.
    !>
    !> The buffer leaves with the sums, which count_suspects needs after the last direction.
    pure subroutine store(n, nv, rate, run, turn, first, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        real(rk), intent(inout) :: rate(*)
        type(run_t), intent(in) :: run
        integer, intent(in) :: turn(nv) !! variable in each slot
        logical, intent(in) :: first !! set, do not add
        real(rk), intent(inout) :: f(nb, nv, 0:n) !! rate of cell i in place i-1
        real(rk) :: total(nb) ! gcc vectorises the sum with it, and not without
        integer :: c, i, l, at

        if (run%adjacent) then
            do i = 1, n
                do c = 1, nv
                    at = run%start(1) + (run%lo - 1 + i)*run%along + (turn(c) - 1)*run%apart - 1
                    if (first) then
                        do l = 1, nb
                            rate(at + l) = f(l, c, i - 1)
                        end do
                    else
                        total = rate(at + 1:at + nb) + f(:, c, i - 1)
                        f(:, c, i - 1) = total
                        rate(at + 1:at + nb) = total
                    end if
                end do
            end do
        else
            do c = 1, nv
                do l = 1, nb
                    at = run%start(l) + (run%lo - 1)*run%along + (turn(c) - 1)*run%apart
                    if (.not. first) then
                        do i = 1, n
                            f(l, c, i - 1) = rate(at + i*run%along) + f(l, c, i - 1)
                        end do
                    end if
                    if (l > run%lines) cycle
                    do i = 1, n
                        rate(at + i*run%along) = f(l, c, i - 1)
                    end do
                end do
            end do
        end if
    end subroutine store

    !> Rates -(F above - F below)/dx, in place: that of cell i goes to place i-1.
    pure subroutine difference(n, nv, inverse_dx, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        real(rk), intent(in) :: inverse_dx !! [1/m]
        real(rk), intent(inout) :: f(nb, nv, 0:n) !! fluxes in, rates out
        integer :: c, i, l

        do i = 1, n
            do c = 1, nv
                do l = 1, nb
                    f(l, c, i - 1) = (f(l, c, i - 1) - f(l, c, i))*inverse_dx
                end do
            end do
        end do
    end subroutine difference

    !> Keep the fluxes through the ends of the lines of a block that lie on the boundary.
    pure subroutine keep_ends(air, d, block, lines, ends)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: block
        integer, intent(in) :: lines !! lines that count
        real(rk), intent(in) :: ends(nb, air%n_var, 2) !! fluxes through the first and last faces
        integer :: at, c, e, s

        at = (block - 1)*nb
        do e = 1, d - 1
            if (air%n(e) > 1) at = at + n_lines(air%n, e)
        end do
        do s = 1, 2
            if (any(air%bc(s, d) == [bc_inside, bc_periodic])) cycle
            do c = 1, air%n_var
                air%edge(at + 1:at + lines, turned(c, d), s) = ends(:lines, c, s)
            end do
        end do
    end subroutine keep_ends

    !> Count the cells whose Euler step loses nearly all density or pressure, or is not a number.
    !>
    !> As is_sound, for the lines of a block. Cut cells may be among those counted.
    pure subroutine count_suspects(n, nv, stage, q, f, suspects)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        type(stage_t), intent(in) :: stage
        real(rk), intent(in) :: q(nb, nv, 1 - n_ghost:n + n_ghost) !! state before
        real(rk), intent(in) :: f(nb, nv, 0:n) !! complete rate of cell i in place i-1
        integer, intent(inout) :: suspects !! they are added
        real(rk) :: r, m1, m2, m3, e, old, new
        integer :: i, l, bad(nb)

        bad = 0
        do i = 1, n
            do l = 1, nb
                r = q(l, 1, i) + stage%dt*f(l, 1, i - 1)
                m1 = q(l, 2, i) + stage%dt*f(l, 2, i - 1)
                m2 = q(l, 3, i) + stage%dt*f(l, 3, i - 1)
                m3 = q(l, 4, i) + stage%dt*f(l, 4, i - 1)
                e = q(l, 5, i) + stage%dt*f(l, 5, i - 1)
                new = e*r - 0.5_rk*(m1*m1 + m2*m2 + m3*m3)
                old = (q(l, 5, i)*q(l, 1, i) - 0.5_rk*(q(l, 2, i)*q(l, 2, i) &
                    + q(l, 3, i)*q(l, 3, i) + q(l, 4, i)*q(l, 4, i)))*r
                bad(l) = bad(l) + merge(0, 1, r > stage%floors(1)*q(l, 1, i) &
                    .and. r > stage%floors(2) .and. new*q(l, 1, i) > stage%floors(1)*old &
                    .and. new > (stage%floors(3) + margin*e)*r)
            end do
            if (nv < 6) cycle
            do l = 1, nb
                r = q(l, 1, i) + stage%dt*f(l, 1, i - 1)
                new = q(l, 6, i) + stage%dt*f(l, 6, i - 1)
                bad(l) = bad(l) + merge(0, 1, new >= -stray*r .and. new <= (1 + stray)*r)
            end do
        end do
        suspects = suspects + sum(bad)
    end subroutine count_suspects

end module brz_air_sweep
