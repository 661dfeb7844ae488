! SPDX-License-Identifier: MIT
!> Studies of the air on the GPU that take too long elsewhere: the point blast of study_air with
!> more cells per octant.
!>
!> usage: BRISANCE_PTX=bin/brisance.ptx study_gpu [cells in each direction ...]
program study_gpu
    use, intrinsic :: iso_fortran_env, only: output_unit
    use air_problems, only: judge_sedov, scheme_name, air_result_t, set_up_sedov
    use brz_air_setup, only: time_step_ramp
    use brz_air_state, only: air_ok, air_t, wall_t
    use brz_device, only: device_t, free_all
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: fetch_air, open_gpu_air
    use brz_air_driver, only: air_step
    use brz_gpu_air_sums, only: gpu_air_time_step
    use brz_kinds, only: dp, int64
    use brz_timer, only: wall_seconds
    use gpu_tools, only: get_device
    implicit none
    integer, parameter :: default = 6 !! of scheme_name
    type(device_t) :: device
    type(error_t) :: err
    character(16) :: word
    integer :: a, n

    call get_device(device, err)
    write (output_unit, '(a)') &
        'problem,scheme,cells,error,shock radius,seconds,cell steps,fallback faces'
    do a = 1, command_argument_count()
        call get_command_argument(a, word)
        read (word, *) n
        call point_blast(n)
    end do

contains

    !> The point blast in an octant of n^3 cells until t = 1.
    subroutine point_blast(n)
        integer, intent(in) :: n
        type(air_t) :: air
        type(wall_t) :: wall
        type(air_result_t) :: seen
        real(dp) :: t, dt, start
        integer :: step

        call set_up_sedov(default, n, air)
        air%activity = .true.
        call open_gpu_air(device, air, .false., err)
        start = wall_seconds()
        t = 0
        step = 0
        do while (t < 1 - 1e-12_dp .and. seen%status == air_ok .and. .not. failed(err))
            dt = min(gpu_air_time_step(air%device, air, 0.5_dp, err)*time_step_ramp(step, 20), &
                     1 - t)
            call air_step(air, wall, dt, seen%status, err)
            t = t + dt
            step = step + 1
            seen%cell_steps = seen%cell_steps + int(n, int64)**3
        end do
        seen%seconds = wall_seconds() - start
        call fetch_air(air%device, air, err)
        call free_all()
        if (failed(err) .or. seen%status /= air_ok) then
            write (output_unit, '(a)') 'the run has failed: '//err%text
            error stop 5
        end if
        call judge_sedov(air, seen)
        write (output_unit, '(3a, i0, 3(a, es10.3), 2(a, i0))') 'sedov,', &
            trim(scheme_name(default)), ',', n, ',', seen%error, ',', seen%radius, ',', &
            seen%seconds, ',', seen%cell_steps, ',', air%fallback_faces
        flush (output_unit)
    end subroutine point_blast
end program study_gpu
