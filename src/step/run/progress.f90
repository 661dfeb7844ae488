! SPDX-License-Identifier: MIT
!> The progress line: what a run prints while it goes on.
module brz_progress
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_kinds, only: dp
    use brz_run_counts, only: progress_t
    use brz_screen, only: say
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: start_progress, progress_line

contains

    !> Start the clocks of a run at simulated time `time`.
    subroutine start_progress(progress, time, cycle)
        type(progress_t), intent(out) :: progress
        real(dp), intent(in) :: time !! [s]
        integer, intent(in) :: cycle

        progress%wall_start = wall_seconds()
        progress%wall_line = progress%wall_start
        progress%time_line = time
        progress%cycle_line = cycle
        write (output_unit, '(a)') '   cycle     time [s]     dt [s] limit   ms/step'// &
            '  Mcell/s  Mpart/s  energy error      ETA'
    end subroutine start_progress

    !> Print one line and start the next interval.
    subroutine progress_line(progress, now, cycle, dt, limiter, energy_error)
        type(progress_t), intent(inout) :: progress
        real(dp), intent(in) :: now(2) !! simulated time and the end of the run [s]
        integer, intent(in) :: cycle
        real(dp), intent(in) :: dt !! [s]
        character(*), intent(in) :: limiter !! what limits the time step
        real(dp), intent(in) :: energy_error !! relative [-]
        real(dp) :: wall, seconds, rate
        character(120) :: line

        wall = wall_seconds()
        seconds = max(wall - progress%wall_line, 1e-9_dp)
        rate = (now(1) - progress%time_line)/seconds
        progress%rate = merge(rate, (progress%rate + rate)/2, progress%rate <= 0)
        write (line, '(i8, es13.5, es11.3, 1x, a6, f9.2, 2f9.3, es14.2, 3x, a)') &
            cycle, now(1), dt, limiter, &
            1e3_dp*seconds/max(1, cycle - progress%cycle_line), &
            1e-6_dp*real(progress%cell_steps - progress%cells_line, dp)/seconds, &
            1e-6_dp*real(progress%particle_steps - progress%particles_line, dp)/seconds, &
            energy_error, clock_text((now(2) - now(1))/max(progress%rate, tiny(rate)))
        call say(trim(line))
        progress%wall_line = wall
        progress%time_line = now(1)
        progress%cycle_line = cycle
        progress%cells_line = progress%cell_steps
        progress%particles_line = progress%particle_steps
    end subroutine progress_line

    !> Seconds as H:MM:SS.
    pure function clock_text(seconds) result(text)
        real(dp), intent(in) :: seconds !! [s]
        character(9) :: text
        integer :: s

        s = nint(min(max(seconds, 0.0_dp), 3.5e6_dp))
        write (text, '(i3, ":", i2.2, ":", i2.2)') s/3600, mod(s, 3600)/60, mod(s, 60)
        text = adjustl(text)
    end function clock_text
end module brz_progress
