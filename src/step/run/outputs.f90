! SPDX-License-Identifier: MIT
!> What a run writes and when: histories, dumps, checkpoints, progress lines.
module brz_outputs
    use, intrinsic :: iso_fortran_env, only: error_unit
    use brz_backend_fetch, only: fetch_around, fetch_followed
    use brz_checkpoint, only: drop_later_checkpoints, find_checkpoint, read_checkpoint
    use brz_clock, only: resume_clock, tick
    use brz_command_line, only: options_t
    use brz_coupling_setup, only: restart_coupling
    use brz_dumps, only: cut_dumps, start_dumps
    use brz_force_driver, only: forces_on_bodies, n_forces
    use brz_errors, only: error_t, exit_io, exit_numerical, failed, raise
    use brz_gauge_quantities, only: from_impulse
    use brz_gauges, only: gauge_names, gauge_particles, gauge_places, gauge_points, gauge_row, &
                          gauges_need_state, gauges_t, early_gauge_row, set_up_gauges
    use brz_host_calls, only: enter_part
    use brz_history, only: append_row, close_history, copy_history, cut_history, flush_history, &
                           history_t, open_history
    use brz_files, only: is_folder
    use brz_folder_lock, only: lock_folder
    use brz_kinds, only: dp, real32
    use brz_conservation_audit, only: body_names, body_row, energy_columns, is_balanced, &
                          audit_row, audit_start_t, balance_t, audit_scene
    use brz_output_folder, only: folder_fresh, folder_replace, folder_resume, holds_histories, &
                                 prepare_folder
    use brz_progress, only: progress_line
    use brz_ranks, only: reduce_errors
    use brz_timer, only: lap, wall_seconds
    use brz_saves, only: hear_writers, on_gpu, save_dump, save_state, saves_t
    use brz_simulation, only: simulation_t
    use brz_solid_start, only: resume_solid
    use brz_text, only: to_text
    use brz_watch, only: watch_limited, watch_region
    implicit none
    private
    public :: outputs_t, open_outputs, write_due, report, save_checkpoint, close_outputs

    type :: outputs_t
        character(:), allocatable :: folder
        type(saves_t) :: saves !! dumps and checkpoints
        type(history_t) :: energy, bodies, gauge_history
        type(gauges_t) :: gauges
        real(dp), allocatable :: body_values(:), gauge_values(:) !! buffers of a row
        real(dp) :: energy_error = 0 !! of the last history row, relative
        logical :: resumed = .false. !! the run goes on from a checkpoint
        logical :: continued = .false. !! and in the folder where its files are
        logical :: kept(3) = .false. !! histories that go on: energy, bodies, gauges
        logical :: outside = .false. !! it was told that particles have left the region
        logical :: held = .false. !! it was told that cells of gas were held
    end type outputs_t

contains

    !> Prepare the folder and the files; with a restart, read the state and continue the files. What
    !> does not fit is found before anything is changed. Of several processes the first does it.
    subroutine open_outputs(options, sim, outputs, err)
        type(options_t), intent(in) :: options
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        character(:), allocatable :: note
        logical :: leads

        outputs%resumed = options%restart//options%branch /= ''
        outputs%folder = options%out
        if (outputs%folder == '') outputs%folder = 'out/'//trim(sim%case%run%job)
        if (options%restart == 'latest') then
            if (.not. is_folder(outputs%folder)) call raise(err, exit_io, outputs%folder// &
                ': no such folder, so no checkpoint in it')
        end if
        note = ''
        leads = sim%ranks%rank == 0
        if (leads) call lock_folder(outputs%folder, note, err)
        if (note /= '') write (error_unit, '(a)') note
        call reduce_errors(sim%ranks, err)
        if (.not. outputs%resumed .and. leads) then
            call prepare_folder(outputs%folder, trim(sim%case%run%job), sim%case%echo, &
                                merge(folder_replace, folder_fresh, options%replace), err)
        else if (outputs%resumed .and. .not. failed(err)) then
            call restart(options, sim, outputs, err)
            outputs%continued = holds_histories(outputs%folder) .and. options%branch == ''
            outputs%kept = outputs%continued
            if (options%branch /= '' .and. leads) then
                call prepare_folder(outputs%folder, trim(sim%case%run%job), sim%case%echo, &
                                    folder_fresh, err)
            else if (.not. (outputs%continued .or. failed(err))) then
                write (error_unit, '(a)') outputs%folder//': holds no histories; they begin '// &
                    'at the checkpoint'
            end if
        end if
        call reduce_errors(sim%ranks, err)
        if (failed(err)) return
        call set_up_gauges(sim%case, sim%solid, outputs%gauges, err)
        call open_histories(options%branch, sim, outputs, err)
        call start_dumps(outputs%saves%dumps, outputs%folder, &
                         [sim%air%present, sim%solid%present], &
                         outputs%continued .and. leads, sim%clock, err)
        outputs%saves%dumps%leads = leads
        outputs%saves%together%folder = outputs%folder
        if (leads .and. outputs%resumed) call go_on(sim, outputs, err)
        call reduce_errors(sim%ranks, err)
        if (.not. outputs%resumed) call write_early(sim, outputs, err)
        call reduce_errors(sim%ranks, err)
    end subroutine open_outputs

    !> Drop what a run has left behind the checkpoint that it goes on from.
    subroutine go_on(sim, outputs, err)
        type(simulation_t), intent(in) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        call note_end(sim)
        call prepare_folder(outputs%folder, trim(sim%case%run%job), sim%case%echo, folder_resume, &
                            err)
        call drop_later_checkpoints(outputs%folder, sim%clock%cycle, err)
        if (outputs%kept(1)) call cut_history(outputs%energy, err)
        if (outputs%kept(2)) call cut_history(outputs%bodies, err)
        if (outputs%kept(3)) call cut_history(outputs%gauge_history, err)
        if (outputs%continued) call cut_dumps(outputs%saves%dumps, err)
    end subroutine go_on

    !> Say where the checkpoint of a restart has nothing left to compute.
    subroutine note_end(sim)
        type(simulation_t), intent(in) :: sim
        character(*), parameter :: none = ': nothing is left to compute; to go on, set a '

        associate (run => sim%case%run, clock => sim%clock)
            if (clock%time >= run%t_end) then
                write (error_unit, '(a)') 'the checkpoint is at t = '// &
                    to_text(real(clock%time, real32))//' s and t_end = '// &
                    to_text(real(run%t_end, real32))//' s'//none//'later run.t_end'
            else if (clock%cycle >= run%max_steps) then
                write (error_unit, '(a)') 'the checkpoint is at step '//to_text(clock%cycle)// &
                    ' and max_steps = '//to_text(run%max_steps)//none//'larger run.max_steps'
            end if
        end associate
    end subroutine note_end

    !> What the gauges saw of the blast before it was put into the grid.
    subroutine write_early(sim, outputs, err)
        type(simulation_t), intent(in) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        integer :: m

        if (failed(err) .or. outputs%gauges%n == 0) return
        do m = 1, sim%early%rows
            outputs%gauge_values(1) = sim%early%when(m)
            call early_gauge_row(outputs%gauges, sim%early%seen(:, :, m), sim%solid, &
                                 outputs%gauge_values)
            call append_row(outputs%gauge_history, outputs%gauge_values, err)
        end do
    end subroutine write_early

    !> The state of a checkpoint, and what follows from it.
    subroutine restart(options, sim, outputs, err)
        type(options_t), intent(in) :: options
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        character(:), allocatable :: path, note
        real(dp) :: sums(9)

        call find_checkpoint(options%restart//options%branch, outputs%folder, path, note, err, &
                             sim%ranks)
        if (failed(err)) return
        if (note /= '') write (error_unit, '(a)') note
        call read_checkpoint(path, options%branch /= '', sim%case, sim%clock, sim%air, &
                             sim%coupling, sim%solid, sums, err)
        if (failed(err)) return
        sim%start = audit_start_t(.true., sums(1), sums(2), sums(3:5), sums(6), sums(7), &
                                   sums(8), sums(9))
        call resume_clock(sim%clock)
        if (options%branch /= '') then ! dumps are those of its own folder
            sim%clock%dump_number = 0
            sim%clock%dump_time = -huge(1.0_dp)
        end if
        call resume_solid(sim%solid, err)
        if (sim%coupling%present) call restart_coupling(sim%air, sim%solid, sim%coupling)
    end subroutine restart

    !> Open the histories. Those of a branch begin as those beside its checkpoint, where they have
    !> the same columns.
    subroutine open_histories(branch, sim, outputs, err)
        character(*), intent(in) :: branch !! file of its checkpoint, or ''
        type(simulation_t), intent(in) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        character(64), allocatable :: names(:)

        call open_one(1, energy_columns, outputs%energy)
        if (sim%solid%present) then
            call body_names(sim%solid, names)
            allocate (outputs%body_values(size(names)))
            call open_one(2, names, outputs%bodies)
        end if
        if (outputs%gauges%n > 0) then
            call gauge_names(outputs%gauges, names)
            allocate (outputs%gauge_values(size(names)))
            call open_one(3, names, outputs%gauge_history)
        end if

    contains

        subroutine open_one(k, columns, history)
            integer, intent(in) :: k
            character(*), intent(in) :: columns(:)
            type(history_t), intent(inout) :: history
            character(*), parameter :: files(3) = [character(10) :: 'energy.csv', 'bodies.csv', &
                                                   'gauges.csv']
            character(:), allocatable :: path

            if (sim%ranks%rank > 0) return
            path = outputs%folder//'/'//trim(files(k))
            if (branch /= '') then
                call copy_history(branch(:index(branch, '/', back=.true.))//trim(files(k)), path, &
                                  columns, sim%clock%marks(k), outputs%kept(k), err)
                if (.not. (outputs%kept(k) .or. failed(err))) write (error_unit, '(a)') path// &
                    ': begins at the checkpoint: no file with these columns is beside that'
            end if
            if (outputs%kept(k)) then
                call open_history(history, path, columns, err, sim%clock%marks(k))
            else
                call open_history(history, path, columns, err)
            end if
        end subroutine open_one
    end subroutine open_histories

    !> Write what is due at the present time.
    subroutine write_due(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        logical :: last

        call hear_writers(sim, outputs%saves, outputs%saves%writers%n, err)
        if (failed(err)) return
        last = sim%clock%time >= sim%case%run%t_end
        if (tick(sim%clock%history, sim%clock%time) .or. last) then
            call enter_part('histories')
            call write_histories(sim, outputs, err)
        end if
        if (failed(err)) return
        if (tick(sim%clock%dump, sim%clock%time) .or. last) then
            call enter_part('dumps')
            call save_dump(sim, outputs%saves, last, err)
        end if
        if (failed(err)) return
        if (.not. tick(sim%clock%checkpoint, sim%clock%time)) return
        call enter_part('checkpoints')
        call save_checkpoint(sim, outputs, err, beside=on_gpu(sim))
    end subroutine write_due

    !> Forces on whole bodies, for gauges.
    subroutine weigh_bodies(sim, gauges, err)
        type(simulation_t), intent(inout) :: sim
        type(gauges_t), intent(inout) :: gauges
        type(error_t), intent(inout) :: err
        real(dp) :: at(3, gauges%n), sums(n_forces, gauges%n)
        integer, allocatable :: asks(:)
        integer :: g, k

        asks = pack([(g, g=1, gauges%n)], gauges%list(:gauges%n)%of%whole > 0 .and. &
            gauges%list(:gauges%n)%of%whole < from_impulse)
        do k = 1, size(asks)
            at(:, k) = gauges%list(asks(k))%at
        end do
        call forces_on_bodies(sim%solid, gauges%list(asks)%body, at(:, :size(asks)), &
                              sums(:, :size(asks)), err)
        do k = 1, size(asks)
            gauges%list(asks(k))%force = sums(:, k)
        end do
    end subroutine weigh_bodies

    !> One row in every history; the audit must close, and the energy stay in its band.
    subroutine write_histories(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        type(balance_t) :: audit

        call audit_scene(sim%clock%time, sim%backend, sim%air, sim%solid, sim%coupling, sim%start, &
                        audit, err)
        call reduce_errors(sim%ranks, err)
        if (failed(err)) return
        outputs%energy_error = audit%energy_error
        call append_row(outputs%energy, audit_row(audit), err)
        if (sim%solid%present) then
            call body_row(audit, sim%solid, outputs%body_values)
            call append_row(outputs%bodies, outputs%body_values, err)
        end if
        if (outputs%gauges%n > 0) then
            call fetch_around(sim%backend, gauge_points(outputs%gauges), sim%air, &
                              sim%coupling%wall, err)
            call fetch_followed(sim%backend, gauge_particles(outputs%gauges), &
                                gauge_places(outputs%gauges), &
                                gauges_need_state(outputs%gauges), sim%solid, err)
            call weigh_bodies(sim, outputs%gauges, err)
            call gauge_row(outputs%gauges, sim%clock%time, sim%air, sim%coupling%wall, sim%solid, &
                           outputs%gauge_values)
            call append_row(outputs%gauge_history, outputs%gauge_values, err)
        end if
        call reduce_errors(sim%ranks, err)
        if (failed(err)) return
        call watch_region(sim, audit%outside, outputs%outside, err)
        call watch_limited(sim, audit%limited_cells, outputs%held)
        if (.not. (is_balanced(audit) .or. sim%coupling%paper)) call raise(err, exit_numerical, &
            'mass or momentum of the air is lost at t = '//to_text(sim%clock%time)// &
            ' s: errors '//to_text(audit%mass_error)//' and '//to_text(audit%momentum_error)// &
            ' of the whole; this is a fault of the program, please report it with the deck')
        if (.not. abs(audit%energy_error) <= sim%case%run%energy_band) call raise( &
            err, exit_numerical, 'the energy error '//to_text(audit%energy_error)//' at t = '// &
            to_text(sim%clock%time)//' s is outside the band energy_band = '// &
            to_text(sim%case%run%energy_band))
    end subroutine write_histories

    !> A progress line, with all rows in their files.
    subroutine report(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err

        call flush_all(outputs, err)
        call progress_line(sim%progress, [sim%clock%time, sim%case%run%t_end], sim%clock%cycle, &
                           sim%clock%dt, sim%limiter, outputs%energy_error)
    end subroutine report

    !> Write a checkpoint; the histories up to it are on the disk first.
    subroutine save_checkpoint(sim, outputs, err, beside)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: beside !! the run; else it is on the disk on return
        logical :: apart

        if (failed(err)) return
        apart = .false.
        if (present(beside)) apart = beside
        call flush_all(outputs, err, sync=.true.)
        call reduce_errors(sim%ranks, err)
        sim%clock%marks = [outputs%energy%mark, outputs%bodies%mark, outputs%gauge_history%mark]
        call save_state(sim, outputs%saves, apart, err)
    end subroutine save_checkpoint

    !> Bring all histories to their files; with `sync` to the disk.
    subroutine flush_all(outputs, err, sync)
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: sync

        call flush_history(outputs%energy, err, sync)
        call flush_history(outputs%bodies, err, sync)
        call flush_history(outputs%gauge_history, err, sync)
    end subroutine flush_all

    !> Wait for what is being written, and close all histories.
    subroutine close_outputs(sim, outputs, err)
        type(simulation_t), intent(in) :: sim
        type(outputs_t), intent(inout) :: outputs
        type(error_t), intent(inout) :: err
        real(dp) :: mark

        mark = wall_seconds()
        call hear_writers(sim, outputs%saves, 0, err)
        call lap(mark, outputs%saves%writing)
        call close_history(outputs%energy, err)
        call close_history(outputs%bodies, err)
        call close_history(outputs%gauge_history, err)
    end subroutine close_outputs
end module brz_outputs
