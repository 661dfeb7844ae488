! SPDX-License-Identifier: MIT
!> Speed of the air on the GPU, time steps included: a blast that has reached a tenth of its
!> box, with and without leaving out the rest, and a box that is all in motion.
!>
!> usage: BRISANCE_PTX=bin/brisance.ptx bench_gpu [cells in each direction ...]
program bench_gpu
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_air_setup, only: make_grid
    use brz_air_state, only: air_t, wall_t
    use brz_device, only: device_t, free_all, wait_for_device
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: open_gpu_air
    use brz_air_driver, only: air_step
    use brz_gpu_air_sums, only: gpu_air_time_step
    use brz_kinds, only: dp, rk
    use brz_scheme, only: hllc, muscl_cells, steger_warming, weno3_cells, weno5z_cells
    use gpu_tools, only: get_device, start_timer, stop_timer
    implicit none
    type(device_t) :: device
    type(error_t) :: err
    character(16) :: word
    integer :: a, n

    call get_device(device, err)
    do a = 1, command_argument_count()
        call get_command_argument(a, word)
        read (word, *) n
        call measure_all('weno3 steger_warming rk3', n, weno3_cells, steger_warming, 3)
        call measure_all('muscl hllc rk2', n, muscl_cells, hllc, 2)
        call measure_all('weno5z hllc rk3', n, weno5z_cells, hllc, 3)
    end do
    if (failed(err)) error stop 5

contains

    subroutine measure_all(name, n, reconstruction, flux, stages)
        character(*), intent(in) :: name
        integer, intent(in) :: n, reconstruction, flux, stages
        type(air_t) :: air

        air%scheme%reconstruction = reconstruction
        air%scheme%flux = flux
        air%n_stages = stages
        call measure(name//', all of it', n, air, 1.0_dp)
        call measure(name//', a tenth, no activity', n, air, 0.4_dp)
        air%activity = .true.
        call measure(name//', a tenth', n, air, 0.4_dp)
    end subroutine measure_all

    !> Time some steps of a box of n^3 cells.
    subroutine measure(name, n, like, share)
        character(*), intent(in) :: name
        integer, intent(in) :: n
        type(air_t), intent(in) :: like !! scheme, stages, activity
        real(dp), intent(in) :: share !! of each side of the box that is not at rest
        integer, parameter :: steps = 10
        type(air_t) :: air
        type(wall_t) :: wall
        real(dp) :: dt, seconds
        integer :: h, m, status

        air = like
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], [1.0_dp, 1.0_dp, 1.0_dp], [n, n, n], air)
        h = int(share*n)
        air%u(1:h, 1:h, 1:h, 5) = 1.1_rk*air%u(1, 1, 1, 5)
        air%u(1:n/3, 1:n/3, 1:n/3, 5) = 100*air%u(1, 1, 1, 5)
        call open_gpu_air(device, air, .false., err)
        dt = gpu_air_time_step(air%device, air, 0.3_dp, err)
        do m = 1, 2 ! the first is computed everywhere
            call air_step(air, wall, dt, status, err)
        end do
        call wait_for_device(err)
        call start_timer(err)
        do m = 1, steps
            dt = gpu_air_time_step(air%device, air, 0.3_dp, err)
            call air_step(air, wall, dt, status, err)
        end do
        seconds = stop_timer(err)
        call free_all()
        if (failed(err)) then
            write (output_unit, '(a)') err%text
            error stop 5
        end if
        write (output_unit, '(2a, i0, a, i0, a, f9.3, a, f9.4, a, i0)') name, ', real', &
            storage_size(1.0_rk), ', ', n, '^3: ', 1e-9_dp*steps*real(n, dp)**3/seconds, &
            ' G cell-steps/s, ', 1e3_dp*seconds/steps, ' ms a step, status ', status
        flush (output_unit)
    end subroutine measure
end program bench_gpu
