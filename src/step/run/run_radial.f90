! SPDX-License-Identifier: MIT
!> A run along the radius of one charge in open air: from the deck to histories and profiles.
module brz_run_radial
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_blast1d_profile, only: blast1d_at
    use brz_blast1d_reconstruct, only: prepare
    use brz_blast1d_state, only: blast1d_input_t, blast1d_t, blast1d_totals, start_blast1d, &
                                 whole_angle
    use brz_blast1d_step, only: advance_blast1d
    use brz_blast_output, only: blast_output_t, close_output, close_rows, open_output, &
                                refuse_restart, stop_if_asked, write_row
    use brz_blast_start, only: radial_input
    use brz_case, only: case_t
    use brz_check_ground, only: burst_text
    use brz_clock, only: tick
    use brz_command_line, only: options_t
    use brz_early, only: along_arm, lose_blast
    use brz_errors, only: error_t, failed
    use brz_history, only: append_row, close_history, history_t, open_history
    use brz_kinds, only: dp
    implicit none
    private
    public :: run_radial

    character(16), parameter :: profile_columns(5) = [character(16) :: 'radius[m]', &
                                'density[kg/m3]', 'velocity[m/s]', 'pressure[Pa]', 'products[-]']

contains

    !> Run a deck with a one-dimensional geometry, or say what it would do.
    subroutine run_radial(options, case, err)
        type(options_t), intent(in) :: options
        type(case_t), intent(in) :: case
        type(error_t), intent(inout) :: err
        type(blast1d_t) :: blast
        type(blast_output_t) :: out
        real(dp) :: before(4)

        out%kind = 'along the radius'
        call refuse_restart(options, out, 'seconds', err)
        if (failed(err)) return
        call start_blast1d(radial_input(case), blast)
        call print_charge(case, blast%input)
        if (options%check) return
        call open_output(options, case, out, err)
        if (failed(err)) return
        before = blast1d_totals(blast)
        call follow(case, blast, out, err)
        if (failed(err)) return
        call print_end(blast, before)
        call close_output(out, err)
    end subroutine run_radial

    !> Step to the end of the run and write what is due.
    subroutine follow(case, blast, out, err)
        type(case_t), intent(in) :: case
        type(blast1d_t), intent(inout) :: blast
        type(blast_output_t), intent(inout) :: out
        type(error_t), intent(inout) :: err
        real(dp) :: arm(3), state(3)
        logical :: ok, last
        integer :: m

        do
            last = blast%time >= case%run%t_end .or. blast%cycle >= case%run%max_steps
            call prepare(blast, blast%time)
            if (tick(out%clock%history, blast%time) .or. last) then
                do m = 1, size(out%points, 2)
                    arm = out%points(:, m) - case%charges(1)%at
                    call blast1d_at(blast, norm2(arm), state)
                    out%seen(:, m) = along_arm(state, arm)
                end do
                call write_row(out, blast%time, err)
            end if
            if (tick(out%clock%dump, blast%time) .or. last) then
                call write_profile(out%folder, out%clock%dump_number, blast, err)
                out%clock%dump_number = out%clock%dump_number + 1
            end if
            if (.not. last .and. .not. failed(err)) call stop_if_asked(out, blast%time, err)
            if (last .or. failed(err)) exit
            call advance_blast1d(blast, min(case%run%t_end - blast%time, case%run%dt_max), ok)
            if (.not. ok) call lose_blast('one dimension', blast%time, err)
        end do
        call close_rows(out, err)
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

    !> Steps, balances.
    subroutine print_end(blast, before)
        type(blast1d_t), intent(in) :: blast
        real(dp), intent(in) :: before(4) !! totals at the start, less the air's
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
