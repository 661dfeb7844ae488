! SPDX-License-Identifier: MIT
!> A run in the plane through the axis of one charge, in open air or over a floor: from the deck to
!> histories and dumps.
module brz_run_axial
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_axial_dump, only: write_axial_dump
    use brz_axial_start, only: axial_at, axial_input, frame_t, make_frame
    use brz_axial_state, only: axial_input_t, axial_t, axial_totals, start_axial, v_energy, &
                               v_products, v_rho
    use brz_axial_step, only: advance_axial
    use brz_blast_output, only: blast_output_t, close_output, close_rows, open_output, &
                                refuse_restart, stop_if_asked, write_row
    use brz_case, only: case_t
    use brz_check_ground, only: burst_text
    use brz_clock, only: tick
    use brz_command_line, only: options_t
    use brz_early, only: lose_blast
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp
    use brz_meta, only: describe_run, meta_t
    use brz_series, only: add_to_series, open_series, series_t
    implicit none
    private
    public :: run_axial

contains

    !> Run a deck with geometry='axial', or say what it would do.
    subroutine run_axial(options, case, err)
        type(options_t), intent(in) :: options
        type(case_t), intent(in) :: case
        type(error_t), intent(inout) :: err
        type(axial_input_t) :: input
        type(axial_t) :: blast
        type(frame_t) :: frame
        type(blast_output_t) :: out
        real(dp) :: before(5)

        out%kind = 'in the plane of an axis'
        call refuse_restart(options, out, 'minutes at most', err)
        if (failed(err)) return
        frame = make_frame(case)
        call axial_input(case, frame, input, err)
        if (failed(err)) return
        call start_axial(input, blast)
        call print_plane(case, blast)
        if (options%check) return
        call open_output(options, case, out, err)
        if (failed(err)) return
        before = axial_totals(blast)
        call follow(case, frame, blast, out, err)
        if (failed(err)) return
        call print_end(blast, before)
        call close_output(out, err)
    end subroutine run_axial

    !> Step to the end of the run and write what is due.
    subroutine follow(case, frame, blast, out, err)
        type(case_t), intent(in) :: case
        type(frame_t), intent(in) :: frame
        type(axial_t), intent(inout) :: blast
        type(blast_output_t), intent(inout) :: out
        type(error_t), intent(inout) :: err
        type(series_t) :: series
        logical :: ok, last
        integer :: m

        call open_series(series, out%folder, 'air', err)
        do
            last = blast%time >= case%run%t_end .or. blast%cycle >= case%run%max_steps
            if (blast%cycle > 0) then ! its states are there after the first step
                if (tick(out%clock%history, blast%time) .or. last) then
                    do m = 1, size(out%points, 2)
                        out%seen(:, m) = axial_at(blast, frame, out%points(:, m))
                    end do
                    call write_row(out, blast%time, err)
                end if
                if (tick(out%clock%dump, blast%time) .or. last) &
                    call write_dump(case, frame, blast, out, series, err)
            end if
            if (.not. last .and. .not. failed(err)) call stop_if_asked(out, blast%time, err)
            if (last .or. failed(err)) exit
            call advance_axial(blast, min(case%run%t_end - blast%time, case%run%dt_max), ok)
            if (.not. ok) call lose_blast('two dimensions', blast%time, err)
        end do
        call close_rows(out, err)
    end subroutine follow

    !> The plane as it is, and its name in the series.
    subroutine write_dump(case, frame, blast, out, series, err)
        type(case_t), intent(in) :: case
        type(frame_t), intent(in) :: frame
        type(axial_t), intent(in) :: blast
        type(blast_output_t), intent(inout) :: out
        type(series_t), intent(inout) :: series
        type(error_t), intent(inout) :: err
        type(meta_t) :: meta
        character(18) :: name

        out%clock%time = blast%time
        out%clock%cycle = blast%cycle
        call describe_run(case, out%clock, meta)
        write (name, '(a, i5.5, a)') 'air_', out%clock%dump_number, '.vtkhdf'
        call write_axial_dump(out%folder//'/'//trim(name), blast, frame, meta, err)
        call add_to_series(series, trim(name), blast%time, err)
        out%clock%dump_number = out%clock%dump_number + 1
    end subroutine write_dump

    !> The charge and the cells of the plane.
    subroutine print_plane(case, blast)
        type(case_t), intent(in) :: case
        type(axial_t), intent(in) :: blast

        associate (in => blast%input)
            write (output_unit, '(a)') trim(case%run%job)//': '//case%run%title
            write (output_unit, '(3a, es11.4, 2(a, f0.4), a, es11.4, a)') 'charge       ', &
                trim(case%charges(1)%id), ':', case%charges(1)%mass, ' kg, radius ', &
                1e3_dp*in%radius, ' mm, half length ', 1e3_dp*in%half, ' mm,', &
                in%eos%e0/in%eos%rho0, ' J/kg'
            if (case%charges(1)%on_ground) write (output_unit, '(2a)') '             ', &
                burst_text(case, case%charges(1))
            write (output_unit, '(a, i0, a, i0, 2(a, f0.4), a)') 'cells        ', blast%n, ' x ', &
                blast%n - blast%low + 1, ' of ', 1e3_dp*blast%dr, ' x ', 1e3_dp*blast%dz, &
                ' mm at first; four become one as the blast grows'
            write (output_unit, '(a, i0, a)') 'accuracy     far out peaks are about ', &
                nint(100*shortfall(blast%n)), ' % low with so many cells (plane_cells), '// &
                'impulses are right; of a sphere in open air or a hemisphere'
            write (output_unit, '(a)') "             on the ground geometry = 'spherical' has "// &
                'the peak as well'
            if (in%floor < huge(in%floor)) write (output_unit, '(a, es11.4, a)') 'floor        ', &
                in%floor, ' m below the centre'
        end associate
    end subroutine print_plane

    !> Part of the peak that cells of n from axis to edge miss, measured on a hemisphere on the
    !> floor at 1 to 4 m/kg^(1/3) with 80, 160 and 240 of them (docs/manual/blast.md).
    pure real(dp) function shortfall(n)
        integer, intent(in) :: n
        real(dp), parameter :: lost = 38 !! cells

        shortfall = lost/(n + lost)
    end function shortfall

    !> Steps, balances.
    subroutine print_end(blast, before)
        type(axial_t), intent(in) :: blast
        real(dp), intent(in) :: before(5) !! totals at the start, less the air's
        real(dp) :: change(5)

        change = (axial_totals(blast) - before)/max(abs(before), tiny(before))
        write (output_unit, '(/, a, es12.5, 2(a, i0), a)') 'end at t =', blast%time, ' s after ', &
            blast%cycle, ' steps, ', blast%merged, ' times four cells made one'
        write (output_unit, '(a, es10.2)') 'energy error   ', change(v_energy)
        write (output_unit, '(a, es10.2)') 'mass error     ', change(v_rho)
        write (output_unit, '(a, es10.2)') 'products error ', change(v_products)
    end subroutine print_end
end module brz_run_axial
