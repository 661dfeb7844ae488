! SPDX-License-Identifier: MIT
!> Speed of the air: million cell-steps per second in a box of 96^3 cells for every scheme, beside
!> what memory and arithmetic would allow, and the gain by leaving out what nothing has reached.
!>
!> The floors are measured in the same run: a triad in main memory, multiply-adds and divisions on
!> numbers in the cache. What a cell-step moves and computes is counted in the sources: all bytes
!> read and written by the loops over the grid once, all +, -, *, min, max and selections as one
!> flop, divisions and roots apart.
program bench_air
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_bench_floors, only: core_time, floors_t, measure_floors
    use brz_errors, only: error_t
    use brz_kinds, only: dp, int64, rk
    use brz_air_state, only: air_t, wall_t
    use brz_air_setup, only: make_grid
    use brz_air_driver, only: air_step
    use brz_air_sums, only: air_time_step
    use brz_scheme, only: first_order, hllc, muscl_cells, scheme_t, steger_warming, weno3_cells, &
        weno5z_cells
    use omp_lib, only: omp_get_max_threads, omp_set_num_threads
    implicit none

    !> A scheme and what it computes for a cell in one direction.
    type :: method_t
        character(25) :: name = ''
        integer :: reconstruction = first_order, flux = steger_warming, stages = 3
        integer :: flops = 0, divisions = 0
    end type method_t

    integer, parameter :: n = 96, steps = 6
    integer, parameter :: update_flops = 50 !! per cell and stage: the update and the test of it
    type(method_t), parameter :: methods(7) = [ &
                                 method_t('weno3 steger_warming rk3', weno3_cells, &
                                          steger_warming, 3, 323, 12), &
                                 method_t('weno5z steger_warming rk3', weno5z_cells, &
                                          steger_warming, 3, 863, 22), &
                                 method_t('muscl steger_warming rk2', muscl_cells, &
                                          steger_warming, 2, 163, 12), &
                                 method_t('first_order hllc rk2', first_order, hllc, 2, 100, 11), &
                                 method_t('muscl hllc rk2', muscl_cells, hllc, 2, 150, 16), &
                                 method_t('weno3 hllc rk3', weno3_cells, hllc, 3, 358, 21), &
                                 method_t('weno5z hllc rk3', weno5z_cells, hllc, 3, 898, 31)]
    type(floors_t) :: floors
    integer :: threads, most, m

    most = omp_get_max_threads()
    threads = 1
    do while (threads <= min(most, 2))
        call omp_set_num_threads(threads)
        call measure_floors(floors)
        write (output_unit, '(a, i0, a, f6.1, a, f6.1, a, f6.2, a)') 'air: ', threads, &
            ' thread(s): triad', 1e-9_dp*floors%bytes, ' GB/s, multiply-add', &
            1e-9_dp*floors%flops, ' Gflop/s, divisions', 1e-9_dp*floors%divisions, ' G/s'
        write (output_unit, '(a)') '     M cell-steps/s by the clock, per second of core time; ' &
            //'parts of this that memory, multiply-adds, divisions alone would take'
        do m = 1, size(methods)
            call measure(methods(m))
        end do
        call measure_activity(methods(1))
        threads = 2*threads
    end do

contains

    !> An air with a hot box in it.
    subroutine make_air(method, hot, air)
        type(method_t), intent(in) :: method
        integer, intent(in) :: hot !! its sides in cells
        type(air_t), intent(out) :: air

        air%scheme = scheme_t(reconstruction=method%reconstruction, flux=method%flux)
        air%n_stages = method%stages
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], [1.0_dp, 1.0_dp, 1.0_dp], [n, n, n], air)
        air%u(1:hot, 1:hot, n/3:n/3 + hot - 1, 5) = 100*air%u(n, n, n, 5)
    end subroutine make_air

    !> Time some steps of a blast.
    subroutine measure(method)
        type(method_t), intent(in) :: method
        type(air_t) :: air
        type(wall_t) :: wall
        real(dp) :: clock, core, bytes, part(3)
        integer :: grid_bytes

        call make_air(method, n/3, air)
        call time_steps(air, wall, 1, clock, core)
        call time_steps(air, wall, steps, clock, core)
        ! state in and rate out three ways, 320 B in real64; 160 to combine; 40 for the time step
        bytes = (60*method%stages + 5)*storage_size(1.0_rk)/8.0_dp
        part(1) = bytes/floors%bytes
        part(2) = method%stages*(3*method%flops + update_flops)/floors%flops
        part(3) = method%stages*3*method%divisions/floors%divisions
        part = part*real(n, dp)**3*steps/core
        grid_bytes = int((storage_size(1.0_rk)/8*3*size(air%u, kind=int64) &
            + size(air%bad, kind=int64))/n**3)
        write (output_unit, '(5a, 2f8.3, a, 3f6.2, a, i0, a, i0, a, i0, 2a)') '     ', &
            method%name, ' ', ' ', ' ', &
            1e-6_dp*steps*real(n, dp)**3/clock, 1e-6_dp*steps*real(n, dp)**3/core, '; ', part, &
            '; ', grid_bytes, ' B stored, ', nint(bytes), ' B moved, ', &
            method%stages*(3*method%flops + update_flops), ' flops; bound by ', bound_by(part)
    end subroutine measure

    !> The largest of the three floors, or their sum where none is near.
    function bound_by(part) result(text)
        real(dp), intent(in) :: part(3) !! of the time: memory, multiply-adds, divisions
        character(:), allocatable :: text
        character(12), parameter :: names(3) = ['memory      ', 'multiply-add', 'divisions   ']

        text = trim(names(maxloc(part, dim=1)))
        if (maxval(part) < 0.5_dp) text = text//' and the rest in turn'
    end function bound_by

    !> Clock and core time of some steps [s].
    subroutine time_steps(air, wall, steps, clock, core)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: steps
        real(dp), intent(out) :: clock, core
        integer(int64) :: start, finish, rate
        integer :: s, status
        type(error_t) :: err

        call system_clock(start, rate)
        core = -core_time()
        do s = 1, steps
            call air_step(air, wall, air_time_step(air, wall, 0.3_dp), status, err)
            if (status /= 0) error stop 'air_step failed'
        end do
        core = core + core_time()
        call system_clock(finish)
        clock = real(finish - start, dp)/rate
    end subroutine time_steps

    !> Time a small blast until its front has passed half the box, with and without activity.
    subroutine measure_activity(method)
        type(method_t), intent(in) :: method
        type(air_t) :: air
        type(wall_t) :: wall
        real(dp) :: clock, core(2), active
        integer :: m, s, count_steps

        core = 0
        active = 0
        do m = 1, 2
            call make_air(method, 10, air)
            air%activity = m == 2
            do s = 1, 60
                call time_steps(air, wall, 1, clock, active)
                core(m) = core(m) + active
            end do
        end do
        active = 0
        count_steps = count(air%active == 1)
        active = real(count_steps, dp)/size(air%active)
        write (output_unit, '(a, f5.2, a, f5.2, a)') &
            '     activity: 60 steps of a blast until ', active, &
            ' of the bricks are awake take ', core(2)/core(1), ' of the time'
    end subroutine measure_activity
end program bench_air
