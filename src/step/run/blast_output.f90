! SPDX-License-Identifier: MIT
!> What runs of one blast along its radius or in the plane of its axis have in common: the folder of
!> their results, the history of the gauges, how they stop and end.
module brz_blast_output
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_case, only: case_t
    use brz_clock, only: clock_t, start_clock
    use brz_command_line, only: options_t
    use brz_errors, only: error_t, exit_deck, exit_stopped, failed, raise
    use brz_folder_lock, only: lock_folder
    use brz_gauge_summary, only: gauge_summary
    use brz_gauges, only: early_gauge_row, gauge_names, gauge_points, gauges_t, set_up_gauges
    use brz_history, only: append_row, close_history, history_t, open_history
    use brz_kinds, only: dp
    use brz_output_folder, only: folder_fresh, folder_replace, prepare_folder
    use brz_screen, only: say
    use brz_signals, only: stop_asked
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_text, only: to_text
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: blast_output_t, refuse_restart, open_output, write_row, stop_if_asked, close_rows
    public :: close_output

    type :: blast_output_t
        character(:), allocatable :: kind !! of run, as 'along the radius'
        character(:), allocatable :: folder
        type(clock_t) :: clock
        type(gauges_t) :: gauges
        type(history_t) :: history
        real(dp), allocatable :: points(:, :) !! (3, n) of the gauges [m]
        real(dp), allocatable :: seen(:, :) !! (5, n) density, velocity, pressure there
        real(dp) :: begin = 0 !! wall clock at the start [s]
    end type blast_output_t

contains

    !> There is no checkpoint to go on from.
    subroutine refuse_restart(options, out, takes, err)
        type(options_t), intent(in) :: options
        type(blast_output_t), intent(in) :: out
        character(*), intent(in) :: takes !! how long
        type(error_t), intent(inout) :: err

        if (options%restart//options%branch /= '') call raise(err, exit_deck, 'a run '// &
            out%kind//' takes '//takes//' and leaves no checkpoint; run it again without '// &
            '--restart or --branch')
    end subroutine refuse_restart

    !> The folder of the results, for this run alone, and the history in it.
    subroutine open_output(options, case, out, err)
        type(options_t), intent(in) :: options
        type(case_t), intent(in) :: case
        type(blast_output_t), intent(inout) :: out
        type(error_t), intent(inout) :: err
        type(interacting_bodies_t) :: solid
        character(64), allocatable :: names(:)
        character(:), allocatable :: note

        out%folder = options%out
        if (out%folder == '') out%folder = 'out/'//trim(case%run%job)
        call lock_folder(out%folder, note, err)
        if (note /= '') write (error_unit, '(a)') note
        call prepare_folder(out%folder, trim(case%run%job), case%echo, &
                            merge(folder_replace, folder_fresh, options%replace), err)
        if (failed(err)) return
        out%begin = wall_seconds()
        call start_clock(case, out%clock)
        call set_up_gauges(case, solid, out%gauges, err)
        call gauge_names(out%gauges, names)
        if (failed(err)) return
        out%points = gauge_points(out%gauges)
        allocate (out%seen(5, size(out%points, 2)))
        call open_history(out%history, out%folder//'/gauges.csv', names, err)
    end subroutine open_output

    !> A row of what the gauges see.
    subroutine write_row(out, time, err)
        type(blast_output_t), intent(inout) :: out
        real(dp), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err
        type(interacting_bodies_t) :: solid
        real(dp) :: row(out%gauges%n + 1)

        row(1) = time
        call early_gauge_row(out%gauges, out%seen, solid, row)
        call append_row(out%history, row, err)
    end subroutine write_row

    !> A signal ends the run.
    subroutine stop_if_asked(out, time, err)
        type(blast_output_t), intent(in) :: out
        real(dp), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err
        character(:), allocatable :: why

        if (stop_asked(why)) call raise(err, exit_stopped, 'stopped by '//why//' at t = '// &
            to_text(time)//' s; a run '//out%kind//' leaves no checkpoint: run it again with '// &
            '--replace')
    end subroutine stop_if_asked

    !> Close the history: the rows up to a failure are the ones that tell.
    subroutine close_rows(out, err)
        type(blast_output_t), intent(inout) :: out
        type(error_t), intent(inout) :: err
        type(error_t) :: closing

        call close_history(out%history, closing)
        if (.not. failed(err)) err = closing
    end subroutine close_rows

    !> Cost, summary of the gauges, where the results are.
    subroutine close_output(out, err)
        type(blast_output_t), intent(in) :: out
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text

        write (output_unit, '(a, f0.1, a)') 'wall clock     ', wall_seconds() - out%begin, ' s'
        call gauge_summary(out%gauges, out%folder//'/gauges.csv', text, err)
        if (.not. failed(err)) write (output_unit, '(/, a)') text
        call say('results        '//out%folder)
    end subroutine close_output
end module brz_blast_output
