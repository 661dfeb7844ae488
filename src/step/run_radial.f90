! SPDX-License-Identifier: MIT
!> A run along the radius of one charge in open air: from the deck to histories and profiles.
module brz_run_radial
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_blast1d_profile, only: blast1d_at
    use brz_blast1d_reconstruct, only: prepare
    use brz_blast1d_state, only: blast1d_input_t, blast1d_t, blast1d_totals, start_blast1d, &
                                 whole_angle
    use brz_blast1d_step, only: advance_blast1d
    use brz_blast_start, only: radial_input
    use brz_case, only: case_t
    use brz_check_ground, only: burst_text
    use brz_clock, only: clock_t, start_clock, tick
    use brz_command_line, only: options_t
    use brz_early, only: along_arm
    use brz_errors, only: error_t, exit_deck, exit_numerical, exit_stopped, &
                          failed, raise
    use brz_folder_lock, only: lock_folder
    use brz_gauge_summary, only: gauge_summary
    use brz_gauges, only: gauge_names, gauges_t, early_gauge_row, set_up_gauges
    use brz_history, only: append_row, close_history, history_t, open_history
    use brz_kinds, only: dp
    use brz_output_folder, only: folder_fresh, folder_replace, prepare_folder
    use brz_screen, only: say
    use brz_signals, only: stop_asked
    use brz_solid_state, only: solid_t
    use brz_text, only: to_text
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: run_radial, open_folder

    character(16), parameter :: profile_columns(5) = [character(16) :: 'radius[m]', &
                                'density[kg/m3]', 'velocity[m/s]', 'pressure[Pa]', 'products[-]']

contains

    !> Run a deck with a one-dimensional geometry, or say what it would do.
    subroutine run_radial(options, case, err)
        type(options_t), intent(in) :: options
        type(case_t), intent(in) :: case
        type(error_t), intent(inout) :: err
        type(blast1d_t) :: blast
        type(gauges_t) :: gauges
        character(:), allocatable :: folder, text
        real(dp) :: before(4), begin

        if (options%restart /= '') then
            call raise(err, exit_deck, 'a run along the radius takes seconds and leaves no '// &
                       'checkpoint; run it again without --restart')
            return
        end if
        call start_blast1d(radial_input(case), blast)
        call print_charge(case, blast%input)
        if (options%check) return
        call open_folder(options, case, folder, err)
        if (failed(err)) return
        begin = wall_seconds()
        before = blast1d_totals(blast)
        call follow(case, folder, blast, gauges, err)
        if (failed(err)) return
        call print_end(blast, before, begin)
        call gauge_summary(gauges, folder//'/gauges.csv', text, err)
        if (.not. failed(err)) write (output_unit, '(/, a)') text
        call say('results        '//folder)
    end subroutine run_radial

    !> The folder of the results, for this run alone.
    subroutine open_folder(options, case, folder, err)
        type(options_t), intent(in) :: options
        type(case_t), intent(in) :: case
        character(:), allocatable, intent(out) :: folder
        type(error_t), intent(inout) :: err
        character(:), allocatable :: note

        folder = options%out
        if (folder == '') folder = 'out/'//trim(case%run%job)
        call lock_folder(folder, note, err)
        if (note /= '') write (error_unit, '(a)') note
        call prepare_folder(folder, trim(case%run%job), case%echo, &
                            merge(folder_replace, folder_fresh, options%replace), err)
    end subroutine open_folder

    !> Step to the end of the run and write what is due.
    subroutine follow(case, folder, blast, gauges, err)
        type(case_t), intent(in) :: case
        character(*), intent(in) :: folder
        type(blast1d_t), intent(inout) :: blast
        type(gauges_t), intent(out) :: gauges
        type(error_t), intent(inout) :: err
        type(error_t) :: closing
        character(:), allocatable :: why
        type(clock_t) :: clock
        type(history_t) :: history
        type(solid_t) :: solid
        character(64), allocatable :: names(:)
        real(dp), allocatable :: row(:), seen(:, :)
        real(dp) :: arm(3), state(3)
        logical :: ok, last
        integer :: g

        call start_clock(case, clock)
        call set_up_gauges(case, solid, gauges, err)
        call gauge_names(gauges, names)
        if (failed(err)) return
        allocate (row(gauges%n + 1), seen(5, gauges%n))
        call open_history(history, folder//'/gauges.csv', names, err)
        do
            last = blast%time >= case%run%t_end .or. blast%cycle >= case%run%max_steps
            call prepare(blast, blast%time)
            if (tick(clock%history, blast%time) .or. last) then
                row(1) = blast%time
                do g = 1, gauges%n
                    arm = gauges%list(g)%at - case%charges(1)%at
                    call blast1d_at(blast, norm2(arm), state)
                    seen(:, g) = along_arm(state, arm)
                end do
                call early_gauge_row(gauges, seen, solid, row)
                call append_row(history, row, err)
            end if
            if (tick(clock%dump, blast%time) .or. last) then
                call write_profile(folder, clock%dump_number, blast, err)
                clock%dump_number = clock%dump_number + 1
            end if
            if (last .or. failed(err)) exit
            if (stop_asked(why)) then
                call raise(err, exit_stopped, 'stopped by '//why//' at t = '// &
                           to_text(blast%time)//' s; a run along the radius leaves no '// &
                           'checkpoint: run it again with --replace')
                exit
            end if
            call advance_blast1d(blast, min(case%run%t_end - blast%time, case%run%dt_max), ok)
            if (.not. ok) call raise(err, exit_numerical, 'the blast in one dimension is lost '// &
                                     'at t = '//to_text(blast%time)//' s')
        end do
        call close_history(history, closing) ! the rows up to a failure are the ones that tell
        if (.not. failed(err)) err = closing
    end subroutine follow

    !> What the charge becomes along the radius.
    subroutine print_charge(case, input)
        type(case_t), intent(in) :: case
        type(blast1d_input_t), intent(in) :: input
        character(10), parameter :: per(0:2) = [character(10) :: 'kg/m2', 'kg/m', 'kg']

        write (output_unit, '(a)') trim(case%run%job)//': '//case%run%title
        write (output_unit, '(3a, es11.4, 3a, f0.4, a, es11.4, a)') 'charge       ', &
            trim(case%charges(1)%id), ':', case%charges(1)%mass, ' ', trim(per(input%power)), &
            ', radius ', 1e3_dp*input%radius, ' mm,', input%eos%e0/input%eos%rho0, ' J/kg'
        if (case%charges(1)%on_ground) write (output_unit, '(2a)') '             ', &
            burst_text(case, case%charges(1))
        write (output_unit, '(a, 2(i0, a))') 'cells        ', input%n_in, &
            ' in the charge at all times, at most ', input%n_air, ' in the air'
    end subroutine print_charge

    !> Steps, balances, cost.
    subroutine print_end(blast, before, begin)
        type(blast1d_t), intent(in) :: blast
        real(dp), intent(in) :: before(4) !! totals at the start, less the air's
        real(dp), intent(in) :: begin !! wall clock at the start [s]
        real(dp) :: change(4), room

        change = blast1d_totals(blast) - before
        change(4) = change(4) - blast%burnt_on*before(1)
        room = blast%xi(blast%n)
        associate (in => blast%input)
            write (output_unit, '(/, a, es12.5, a, i0, a)') 'end at t =', blast%time, &
                ' s after ', blast%cycle, ' steps'
            write (output_unit, '(a, es10.2)') 'energy error   ', change(4)/(before(4) + &
                in%pressure/(in%gamma - 1)*room)
            write (output_unit, '(a, es10.2)') 'mass error     ', change(2)/(in%density*room)
            write (output_unit, '(a, es10.2)') 'products error ', change(1)/before(1)
            write (output_unit, '(a, es12.5, a)') 'energy set free', &
                whole_angle(in%power)*before(4), ' J less that of the air it displaced'
            if (blast%burnt_on > 0) write (output_unit, '(a, es12.5, a)') 'by burning on  ', &
                whole_angle(in%power)*before(1)*blast%burnt_on, ' J'
        end associate
        write (output_unit, '(a, f0.1, a)') 'wall clock     ', wall_seconds() - begin, ' s'
    end subroutine print_end

    !> The state along the radius as a table.
    subroutine write_profile(folder, number, blast, err)
        character(*), intent(in) :: folder
        integer, intent(in) :: number
        type(blast1d_t), intent(in) :: blast
        type(error_t), intent(inout) :: err
        type(history_t) :: profile
        character(5) :: digits
        integer :: i

        write (digits, '(i5.5)') number
        call open_history(profile, folder//'/profile_'//digits//'.csv', profile_columns, err)
        do i = 1, blast%n
            if (failed(err)) exit
            call append_row(profile, [blast%x(i), blast%state(:3, i), &
                                      merge(1.0_dp, 0.0_dp, i <= blast%n_in)], err)
        end do
        call close_history(profile, err)
    end subroutine write_profile
end module brz_run_radial
