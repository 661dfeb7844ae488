! SPDX-License-Identifier: MIT
!> A run from the deck to the last result.
module brz_run
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_backend, only: choose_backend, settle_backend
    use brz_backend_step, only: start_backend
    use brz_build_case, only: build_case
    use brz_check, only: print_check, print_outline
    use brz_check_start, only: is_axial, is_radial
    use brz_clock, only: start_clock, walltime_is_up
    use brz_command_line, only: options_t
    use brz_deck, only: deck_t
    use brz_errors, only: error_t, exit_deck, exit_stopped, failed, raise
    use brz_files, only: write_text_file
    use brz_host_calls, only: count_calls, enter_part
    use brz_kernel_profile, only: start_profile
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_kinds, only: dp
    use brz_outputs, only: close_outputs, open_outputs, outputs_t, report, save_checkpoint, &
                           write_due
    use brz_print_early, only: print_charges, print_early
    use brz_progress, only: start_progress
    use brz_ranks, only: reduce_errors, ranks_t, several, share_text
    use brz_run_axial, only: run_axial
    use brz_run_radial, only: run_radial
    use brz_run_ranks, only: cut_air, print_ranks, refuse_on_ranks, settle_threads
    use brz_saves, only: on_gpu
    use brz_scanner, only: read_deck
    use brz_scene_size, only: refuse_too_large, scene_size_t, size_scene, too_large_to_look
    use brz_setup_progress, only: begin_setup, end_setup
    use brz_screen, only: say, warn
    use brz_signals, only: checkpoint_asked, listen_to_signals, look_for_stop_file, stop_asked
    use brz_simulation, only: simulation_t
    use brz_simulation_setup, only: set_up_simulation
    use brz_summary, only: print_summary
    use brz_text, only: to_text
    use brz_time_step, only: advance
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: run_deck

contains

    !> Do what `brisance run` was asked for.
    subroutine run_deck(options, ranks, err)
        type(options_t), intent(in) :: options
        type(ranks_t), intent(in) :: ranks !! the processes that run it
        type(error_t), intent(inout) :: err
        type(simulation_t), allocatable :: sim
        type(outputs_t) :: outputs
        type(scene_size_t) :: size_of
        type(error_t) :: closing
        character(:), allocatable :: note
        logical :: large

        if (options%check .and. ranks%rank > 0) return ! the first one looks for all
        if (options%calls) call count_calls()
        allocate (sim)
        call read_scene(options, sim, err)
        call write_echo(options, sim%case%echo, err)
        call plan_ranks(options, ranks, sim, err)
        call open_backend(sim, err)
        call reduce_errors(sim%ranks, err)
        if (failed(err)) return
        if (.not. options%check) call listen_to_signals()
        if (is_radial(sim%case)) then
            if (sim%ranks%rank == 0) call run_first(options, sim, err)
            call reduce_errors(sim%ranks, err)
            return
        end if
        call size_scene(sim%case, size_of, err)
        call cut_air(sim%case, max(options%ranks, ranks%n), size_of, err)
        if (failed(err)) return
        if (options%check) then
            large = too_large_to_look(size_of)
            if (large) call print_outline(sim%case, size_of, &
                                          sim%backend%on_gpu .or. sim%backend%bodies_on_gpu)
            if (large) call print_ranks(sim%case, size_of, max(options%ranks, ranks%n))
            if (large) return
        end if
        call refuse_too_large(size_of, sim%ranks, err)
        call reduce_errors(sim%ranks, err)
        if (failed(err)) return
        call start_clock(sim%case, sim%clock, options%walltime)
        if (.not. options%check) call begin_setup(sim%case%output%report_every)
        if (several(sim%ranks) .and. sim%case%air%present) sim%boxes = size_of%boxes
        call set_up_simulation(sim, err)
        call end_setup()
        call reduce_errors(sim%ranks, err)
        if (failed(err)) return
        call settle_backend(trim(sim%case%run%backend), sim%solid, sim%coupling, sim%backend, &
                            note, err)
        if (failed(err)) return
        if (note /= '') write (error_unit, '(a)') note
        if (sim%solid%present) write (error_unit, '(a)', advance='no') sim%solid%notes
        if (sim%early%present) call print_early(sim%early)
        if (allocated(sim%air%charge)) call print_charges(sim%case, sim%air%charge)
        if (options%check) then
            call print_check(sim, size_of, max(options%ranks, ranks%n), err)
            return
        end if
        if (sim%early%present) sim%clock%time = sim%early%time
        call open_outputs(options, sim, outputs, err)
        if (failed(err)) return
        call enter_part('start of the GPU')
        call start_computing(sim, err)
        if (failed(err)) return
        if (options%profile) call profile(sim, err)
        if (failed(err)) return
        call time_loop(sim, outputs, err)
        call close_outputs(sim, outputs, closing) ! the rows up to a failure are the ones that tell
        call reduce_errors(sim%ranks, closing)
        if (.not. failed(err)) err = closing
        if (failed(err) .and. err%code /= exit_stopped) return
        call print_summary(sim, outputs, closing)
        call reduce_errors(sim%ranks, closing)
        if (.not. failed(err)) err = closing
    end subroutine run_deck

    !> The air along a line or in a plane takes seconds: the first process computes it alone.
    subroutine run_first(options, sim, err)
        type(options_t), intent(in) :: options
        type(simulation_t), intent(in) :: sim
        type(error_t), intent(inout) :: err

        if (several(sim%ranks)) call say('processes    one of '//to_text(sim%ranks%n)// &
            " computes a geometry = '"//trim(sim%case%air%geometry)//"'")
        if (is_axial(sim%case)) then
            call run_axial(options, sim%case, err)
        else
            call run_radial(options, sim%case, err)
        end if
    end subroutine run_first

    !> Bring the scene to where it is computed, and say what that takes on a GPU.
    subroutine start_computing(sim, err)
        type(simulation_t), intent(inout) :: sim
        type(error_t), intent(inout) :: err
        character(12) :: seconds
        real(dp) :: mark

        mark = wall_seconds()
        call start_backend(sim%backend, sim%air, sim%coupling, sim%solid, err)
        call reduce_errors(sim%ranks, err)
        if (failed(err) .or. .not. on_gpu(sim)) return
        write (seconds, '(f12.1)') wall_seconds() - mark
        call say('GPU          code, state and lists: '//trim(adjustl(seconds))//' s')
    end subroutine start_computing

    !> Write the complete deck where `--check --echo FILE` wants it; equal decks give equal files.
    subroutine write_echo(options, echo, err)
        type(options_t), intent(in) :: options
        character(:), allocatable, intent(in) :: echo !! absent where the deck was refused
        type(error_t), intent(inout) :: err

        if (failed(err) .or. options%echo == '') return
        if (.not. options%check) then
            call raise(err, exit_deck, 'run: --echo goes with --check; a run leaves its '// &
                       'complete deck in the folder of its results')
            return
        end if
        call write_text_file(options%echo, echo, err)
    end subroutine write_echo

    !> On several processes: refuse what they cannot do; they use GPUs only where asked to.
    subroutine plan_ranks(options, ranks, sim, err)
        type(options_t), intent(in) :: options
        type(ranks_t), intent(in) :: ranks
        type(simulation_t), intent(inout) :: sim
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (options%backend /= '') sim%case%run%backend = options%backend
        if (options%ranks > 0 .and. .not. options%check) call raise(err, exit_deck, &
            'run: --ranks goes with --check; to run on several processes start them with '// &
            'mpirun -n '//to_text(options%ranks))
        call refuse_on_ranks(sim%case, max(options%ranks, ranks%n), err)
        if (options%check) return
        sim%ranks = ranks
        if (several(ranks) .and. sim%case%run%backend == 'auto') sim%case%run%backend = 'cpu'
    end subroutine plan_ranks

    !> Read and check the deck; warnings go to the error unit.
    subroutine read_scene(options, sim, err)
        type(options_t), intent(in) :: options
        type(simulation_t), intent(inout) :: sim
        type(error_t), intent(inout) :: err
        type(key_t), allocatable :: keys(:)
        type(deck_t) :: deck

        call all_keys(keys)
        call read_deck(options%deck, keys, options%overrides, deck, err)
        call build_case(deck, keys, sim%case, err)
        call warn(sim%case%warnings)
    end subroutine read_scene

    !> Choose where to compute.
    subroutine open_backend(sim, err)
        type(simulation_t), intent(inout) :: sim
        type(error_t), intent(inout) :: err
        character(:), allocatable :: note

        if (failed(err)) return
        call choose_backend(trim(sim%case%run%backend), sim%case%air%present, &
                            size(sim%case%bodies) > 0, sim%ranks, sim%backend, note, err)
        if (note /= '') write (error_unit, '(a)') note
        call settle_threads(sim%ranks, sim%backend%on_gpu .or. sim%backend%bodies_on_gpu)
    end subroutine open_backend

    !> Record the time of each kernel; there are none on the CPU.
    subroutine profile(sim, err)
        type(simulation_t), intent(in) :: sim
        type(error_t), intent(inout) :: err

        if (.not. (sim%backend%on_gpu .or. sim%backend%bodies_on_gpu)) call raise(err, exit_deck, &
            'run: --profile prints the time of kernels, and this run has none: it is on the CPU')
        call start_profile()
    end subroutine profile

    !> Step until the end, an error, or a request to stop.
    subroutine time_loop(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        real(dp) :: next_report

        call start_progress(sim%progress, sim%clock%time, sim%clock%cycle)
        next_report = wall_seconds() + sim%case%output%report_every
        call enter_part('output')
        if (.not. outputs%resumed) call write_due(sim, outputs, err)
        do while (sim%clock%time < sim%case%run%t_end .and. .not. failed(err))
            if (sim%clock%cycle >= sim%case%run%max_steps) exit
            call advance(sim, err)
            call reduce_errors(sim%ranks, err)
            if (failed(err)) exit
            call enter_part('output')
            call write_due(sim, outputs, err)
            call enter_part('output', go_on=.true.)
            if (wall_seconds() >= next_report) then
                call report(sim, outputs, err)
                next_report = wall_seconds() + sim%case%output%report_every
            end if
            call obey_requests(sim, outputs, err)
        end do
        if (failed(err)) then
            if (sim%intact) call save_last(sim, outputs, err)
            return
        end if
        call save_checkpoint(sim, outputs, err, beside=on_gpu(sim))
        call report(sim, outputs, err)
    end subroutine time_loop

    !> After an error that left the state intact: a checkpoint of it, told with the error.
    subroutine save_last(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        type(error_t) :: saving

        call save_checkpoint(sim, outputs, saving)
        if (failed(saving)) return
        err%text = err%text//'; the state before it is in a checkpoint'
    end subroutine save_last

    !> Checkpoint, or checkpoint and stop, where a signal, a stop file or the wall clock asks.
    subroutine obey_requests(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        character(:), allocatable :: note, why
        logical :: stop

        if (several(sim%ranks)) then
            call obey_together(sim, outputs, err)
            return
        end if
        if (failed(err)) return
        if (checkpoint_asked()) call save_checkpoint(sim, outputs, err)
        stop = stop_asked(why)
        if (.not. stop) then
            stop = look_for_stop_file(outputs%folder, trim(sim%case%run%job), note)
            if (note /= '') write (error_unit, '(a)') note
            if (stop) why = 'a stop file'
        end if
        if (walltime_is_up(sim%clock, outputs%saves%reserve)) then
            if (.not. stop) why = 'the wall-clock limit'
            stop = .true.
        end if
        if (.not. stop .or. failed(err)) return
        call stop_here(why, sim, outputs, err)
    end subroutine obey_requests

    !> The same on several processes: a signal counts that any of them has heard; the stop file and
    !> the wall clock are those of the first.
    subroutine obey_together(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        character(:), allocatable :: note, why
        real(dp) :: wish(3) !! 0: a checkpoint; 0: a stop; the process that says why
        logical :: stop

        note = ''
        stop = stop_asked(why)
        if (sim%ranks%rank == 0 .and. .not. (stop .or. failed(err))) then
            stop = look_for_stop_file(outputs%folder, trim(sim%case%run%job), note)
            why = 'a stop file'
            if (walltime_is_up(sim%clock, outputs%saves%reserve) .and. .not. stop) then
                why = 'the wall-clock limit'
                stop = .true.
            end if
        end if
        if (note /= '') write (error_unit, '(a)') note
        wish = [1, merge(0, 1, stop), merge(sim%ranks%rank, sim%ranks%n, stop)]
        if (checkpoint_asked()) wish(1) = 0
        call reduce_errors(sim%ranks, err, wish)
        if (failed(err)) return
        if (wish(1) < 1) call save_checkpoint(sim, outputs, err)
        if (wish(2) >= 1 .or. failed(err)) return
        call share_text(sim%ranks, nint(wish(3)), why)
        call stop_here(why, sim, outputs, err)
    end subroutine obey_together

    !> Write a checkpoint, and end the run.
    subroutine stop_here(why, sim, outputs, err)
        character(*), intent(in) :: why
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err

        call save_checkpoint(sim, outputs, err)
        if (failed(err)) return
        call raise(err, exit_stopped, 'stopped by '//why//' at t = '//to_text(sim%clock%time)// &
                   ' s with a checkpoint; go on with --restart latest')
    end subroutine stop_here
end module brz_run
