! SPDX-License-Identifier: MIT
!> Speed of the air: million cell-steps per second in a box of 96^3 cells.
!>
!> What a cell-step costs, by the sources: three stages of three directions, each about 45 flops
!> with one division and one root for the splitting, 2*5*22 flops with 10 divisions for the
!> reconstruction and 15 for the differences: about 2500 flops and 100 divisions or roots. Main
!> memory: per stage and direction 40 B of state read and 40 (80 from the second on) of rate moved,
!> then 160 to combine: 1.6 kB in real64. At 4 M cell-steps/s that is 10 Gflop/s and 6 GB/s.
program bench_air
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_kinds, only: dp, int64, rk
    use brz_air_state, only: air_t, wall_t
    use brz_air_setup, only: make_grid
    use brz_air_step, only: air_step
    use brz_air_sums, only: air_time_step
    use omp_lib, only: omp_get_max_threads, omp_set_num_threads
    implicit none
    integer, parameter :: n = 96, steps = 6
    integer :: threads, most, bytes

    bytes = (15*storage_size(1.0_rk) + 8)/8
    write (output_unit, '(a, i0, a)') 'air: ', bytes, ' B per cell besides ghosts; walls add 5'
    most = omp_get_max_threads()
    threads = 1
    do while (threads <= most)
        call omp_set_num_threads(threads)
        call measure(.false.)
        call measure(.true.)
        threads = 2*threads
    end do

contains

    !> Time some steps of a blast, without and with a plate in the box.
    subroutine measure(with_plate)
        use brz_air_walls, only: build_walls, set_up_walls
        logical, intent(in) :: with_plate
        type(air_t) :: air
        type(wall_t) :: wall
        integer :: m, status
        integer(int64) :: start, finish, rate
        real(dp) :: seconds, core, dt

        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], [1.0_dp, 1.0_dp, 1.0_dp], [n, n, n], air)
        air%u(1:n/3, 1:n/3, n/3:2*n/3, 5) = 100*air%u(1, 1, 1, 5)
        if (with_plate) then
            call set_up_walls(air, wall)
            wall%solid(:, :, 4:9) = 1
            call build_walls(air, wall)
        end if
        dt = air_time_step(air, wall, 0.3_dp)
        call air_step(air, wall, dt, status)
        call system_clock(start, rate)
        call cpu_time(core)
        do m = 1, steps
            dt = air_time_step(air, wall, 0.3_dp)
            call air_step(air, wall, dt, status)
        end do
        call system_clock(finish)
        seconds = -core
        call cpu_time(core)
        core = core + seconds
        seconds = real(finish - start, dp)/rate
        write (output_unit, '(a, i0, a, l1, a, f8.3, a, f8.3)') 'air: ', threads, &
            ' threads, plate ', with_plate, &
            ', ', 1e-6_dp*steps*real(n, dp)**3/seconds, &
                ' M cell-steps/s; per core and second of its time', &
            1e-6_dp*steps*real(n, dp)**3/core
        if (status /= 0) error stop 'air_step failed'
    end subroutine measure
end program bench_air
