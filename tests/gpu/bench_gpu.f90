! SPDX-License-Identifier: MIT
!> Speed of the air on the GPU: time of each kernel, and of the whole step.
!>
!> usage: BRISANCE_PTX=bin/brisance.ptx bench_gpu [cells in each direction ...]
program bench_gpu
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_air_setup, only: make_grid
    use brz_air_state, only: air_t
    use brz_device, only: device_t, start_timer, stop_timer, wait_for_device
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: close_gpu_air, gpu_air_t, open_gpu_air
    use brz_gpu_air_step, only: gpu_air_step
    use brz_gpu_air_sums, only: gpu_air_time_step
    use brz_kinds, only: dp, rk
    use brz_scheme, only: hllc, muscl_cells, steger_warming, weno3_cells, weno5z_cells
    use gpu_tools, only: get_device
    implicit none
    type(device_t) :: device
    type(error_t) :: err
    character(16) :: word
    integer :: a, n

    call get_device(device, err)
    do a = 1, command_argument_count()
        call get_command_argument(a, word)
        read (word, *) n
        call measure('weno3 steger_warming rk3', n, weno3_cells, steger_warming, 3)
        call measure('muscl hllc rk2', n, muscl_cells, hllc, 2)
        call measure('weno5z hllc rk3', n, weno5z_cells, hllc, 3)
    end do
    if (failed(err)) error stop 5

contains

    !> Time some steps of a blast in a box of n^3 cells.
    subroutine measure(name, n, reconstruction, flux, stages)
        character(*), intent(in) :: name
        integer, intent(in) :: n, reconstruction, flux, stages
        integer, parameter :: steps = 10
        type(air_t) :: air
        type(gpu_air_t) :: gpu
        real(dp) :: dt, seconds
        integer :: m, status

        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], [1.0_dp, 1.0_dp, 1.0_dp], [n, n, n], air)
        air%u(1:n/3, 1:n/3, n/3:2*n/3, 5) = 100*air%u(1, 1, 1, 5)
        air%scheme%reconstruction = reconstruction
        air%scheme%flux = flux
        air%n_stages = stages
        call open_gpu_air(device, air, .false., gpu, err)
        dt = gpu_air_time_step(gpu, air, 0.3_dp, err)
        call gpu_air_step(gpu, air, dt, status, err)
        call wait_for_device(err)
        call start_timer(device, err)
        do m = 1, steps
            dt = gpu_air_time_step(gpu, air, 0.3_dp, err)
            call gpu_air_step(gpu, air, dt, status, err)
        end do
        seconds = stop_timer(device, err)
        call close_gpu_air(gpu)
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
