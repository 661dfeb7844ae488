! SPDX-License-Identifier: MIT
!> `brisance mat`: one material point along a path, as a table.
module brz_material_driver
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_algebra, only: to_voigt
    use brz_build_point, only: build_point
    use brz_case, only: point_case_t, segment_case_t
    use brz_command_line, only: options_t
    use brz_deck, only: deck_t
    use brz_errors, only: error_t, exit_io, exit_numerical, failed, raise
    use brz_files, only: file_exists, make_folder
    use brz_history, only: append_row, close_history, history_t, open_history
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t, point_t, material_ok, material_not_finite, &
                            material_step_too_large
    use brz_material_report, only: material_report
    use brz_materials, only: make_material, material_remarks, start_point, update_material
    use brz_model, only: material_label
    use brz_point_table, only: slots_t, point_columns, point_row
    use brz_scanner, only: read_deck
    use brz_screen, only: say, show, warn
    use brz_text, only: string_t, to_text
    use brz_stress_control, only: controlled_step, stress_control_t
    implicit none
    private
    public :: drive_material

    !> A point on its way.
    type :: drive_t
        type(point_case_t) :: case
        type(material_t) :: material
        type(point_t) :: point
        type(history_t) :: table
        type(slots_t) :: columns
        real(dp) :: time = 0, start = 0 !! now, and when the segment began [s]
        real(dp) :: work(2) = 0 !! plastic work, work of damage so far [J/kg]
        real(dp) :: strain(6) = 0 !! integral of the rate of deformation, xx yy zz xy yz xz
        real(rk) :: rates(6) = 0 !! of deformation in the last step [1/s]
        real(rk) :: pressed = 0 !! pressure when the segment began [Pa]
        integer :: segment = 0, step = 0 !! where it is
        logical :: check = .false. !! tell what follows from the material, and drive nothing
        integer :: clamped = 0 !! steps in which a limit of the model acted
    end type drive_t

contains

    !> Do what `brisance mat` was asked for.
    subroutine drive_material(options, err)
        type(options_t), intent(in) :: options
        type(error_t), intent(inout) :: err
        type(drive_t) :: drive
        character(:), allocatable :: file
        type(error_t) :: closing

        call read_point(options, drive%case, err)
        if (failed(err)) return
        call make_material(drive%case%material, drive%material, err)
        if (failed(err)) return
        call start_point(drive%material, real(drive%case%rotation*acos(-1.0_dp)/180, rk), &
                         drive%case%ply_axis, drive%point)
        drive%check = options%check
        call warn_of_material(drive)
        call print_material(drive)
        if (options%check) return
        call open_table(options, drive, file, err)
        if (failed(err)) return
        call follow_path(drive, err)
        call close_history(drive%table, closing) ! the rows up to a failure are the ones that tell
        if (.not. failed(err)) err = closing
        if (drive%clamped > 0) write (error_unit, '(a)') 'warning: a limit of the model '// &
            'acted in '//to_text(drive%clamped)//' steps'
        if (failed(err)) return
        call say('table        '//file)
    end subroutine drive_material

    !> Read and check the deck; warnings go to the error unit.
    subroutine read_point(options, case, err)
        type(options_t), intent(in) :: options
        type(point_case_t), intent(out) :: case
        type(error_t), intent(inout) :: err
        type(key_t), allocatable :: keys(:)
        type(deck_t) :: deck

        call all_keys(keys)
        call read_deck(options%deck, keys, options%overrides, deck, err)
        call build_point(deck, keys, case, err)
        call warn(case%warnings)
    end subroutine read_point

    !> What is odd about the constants, on the error unit.
    subroutine warn_of_material(drive)
        type(drive_t), intent(in) :: drive
        type(string_t), allocatable :: lines(:)
        character(:), allocatable :: warning

        call material_remarks(drive%material, lines, warning)
        if (warning /= '') call warn([string_t(material_label(drive%case%material)// &
                                               'warning: '//warning)])
    end subroutine warn_of_material

    !> What the material is, and how long its path.
    subroutine print_material(drive)
        type(drive_t), intent(in) :: drive

        associate (m => drive%material, case => drive%case)
            write (output_unit, '(4a)') 'material     ', trim(case%material%id), ', model ', &
                trim(case%material%model)
            write (output_unit, '(a, 3(es10.3, a))') 'unloaded    ', m%density, ' kg/m3, K ', &
                m%bulk, ' Pa, waves ', m%c_wave, ' m/s'
            write (output_unit, '(a, i0, a, i0, a)') 'path         ', size(case%segments), &
                ' segments, ', sum(case%segments%steps), ' steps'
            if (drive%check) call show(material_report(case%material, m, 0.0_dp))
        end associate
    end subroutine print_material

    !> Begin the table; one that is there is not overwritten unasked.
    subroutine open_table(options, drive, file, err)
        type(options_t), intent(in) :: options
        type(drive_t), intent(inout) :: drive
        character(:), allocatable, intent(out) :: file
        type(error_t), intent(inout) :: err
        character(48), allocatable :: names(:)
        integer :: slash

        file = options%out
        if (file == '') file = 'out/'//trim(drive%case%job)//'.csv'
        if (file_exists(file) .and. .not. options%replace) then
            call raise(err, exit_io, file//': is there already; write to another file with '// &
                       '--out, or overwrite it with --replace')
            return
        end if
        slash = index(file, '/', back=.true.)
        if (slash > 1) call make_folder(file(:slash - 1), err)
        if (failed(err)) return
        call point_columns(drive%material, drive%columns, names)
        call open_history(drive%table, file, names, err)
    end subroutine open_table

    !> All segments, step by step.
    subroutine follow_path(drive, err)
        type(drive_t), intent(inout) :: drive
        type(error_t), intent(inout) :: err

        call write_row(drive, err)
        do while (drive%segment < size(drive%case%segments))
            drive%segment = drive%segment + 1
            associate (segment => drive%case%segments(drive%segment))
                drive%rates = 0
                drive%start = drive%time
                drive%pressed = -sum(drive%point%stress(:3))/3
                do while (.not. failed(err))
                    if (drive%step == segment%steps) exit
                    drive%step = drive%step + 1
                    call advance(drive, segment, err)
                    if (failed(err)) return
                    if (modulo(drive%step, drive%case%output_every) == 0 .or. &
                        drive%step == segment%steps) call write_row(drive, err)
                end do
            end associate
            drive%step = 0
        end do
    end subroutine follow_path

    !> One step.
    subroutine advance(drive, segment, err)
        type(drive_t), intent(inout) :: drive
        type(segment_case_t), intent(in) :: segment
        type(error_t), intent(inout) :: err
        type(stress_control_t) :: control
        real(rk) :: l(3, 3), left
        real(dp) :: dt
        integer :: status

        dt = segment%duration/segment%steps
        left = 0
        if (segment%control == 'strain') then
            l = real(segment%l, rk)
            call to_voigt(l, drive%rates)
            call update_material(drive%material, real(dt, rk), &
                                 real(drive%case%crack_length, rk), l, drive%point, status)
        else
            control = control_of(drive, segment)
            call controlled_step(drive%material, control, drive%rates, drive%point, left, status)
        end if
        if (status > material_ok .or. left > 0) then
            call raise_refusal(drive, status, left, err)
            return
        end if
        if (status < material_ok) drive%clamped = drive%clamped + 1
        drive%strain = drive%strain + drive%rates*dt
        drive%work = drive%work + drive%point%work
        drive%time = drive%start + drive%step*dt
    end subroutine advance

    !> The stresses that a segment asks for at the end of the step.
    pure function control_of(drive, segment) result(control)
        type(drive_t), intent(in) :: drive
        type(segment_case_t), intent(in) :: segment
        type(stress_control_t) :: control
        real(dp) :: part

        control%dt = real(segment%duration/segment%steps, rk)
        control%crack = real(drive%case%crack_length, rk)
        control%axis = index('xyz', segment%axis)
        control%rate = real(segment%rate, rk)
        select case (segment%control)
        case ('triaxial')
            control%stress(:3) = real(segment%lateral_stress, rk)
        case ('pressure')
            part = real(drive%step, dp)/segment%steps
            control%stress(:3) = real((part - 1)*drive%pressed - part*segment%pressure, rk)
            control%axis = 0
        end select
    end function control_of

    !> Say where the path ended, why, and in what state the point was.
    subroutine raise_refusal(drive, status, left, err)
        type(drive_t), intent(in) :: drive
        integer, intent(in) :: status
        real(rk), intent(in) :: left !! distance from a wanted stress [Pa]
        type(error_t), intent(inout) :: err
        character(:), allocatable :: why, strain, stress
        integer :: i

        select case (status)
        case (material_not_finite)
            why = 'the state or the rates are not finite, or absurd'
        case (material_step_too_large)
            why = 'the strain of this step is too large for the model; take more steps'
        case (:material_ok)
            why = 'no rates give the stresses that are to be held (off by '//to_text(left)// &
                  ' Pa at least); take more steps, or the material cannot carry this'
        case default
            why = 'status '//to_text(status)//' of the model'
        end select
        strain = ''
        stress = ''
        do i = 1, 6
            strain = strain//' '//to_text(drive%strain(i))
            stress = stress//' '//to_text(drive%point%stress(i))
        end do
        call raise(err, exit_numerical, 'segment '//to_text(drive%segment)//', step '// &
                   to_text(drive%step)//', t = '//to_text(drive%time)//' s: '//why// &
                   '; the table ends there. mu '//to_text(drive%point%mu)//', e '// &
                   to_text(drive%point%energy)//' J/kg, strain'//strain//', stress [Pa]'//stress// &
                   ' (xx yy zz xy yz xz)')
    end subroutine raise_refusal

    subroutine write_row(drive, err)
        type(drive_t), intent(inout) :: drive
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: row(:)

        call point_row(drive%material, drive%columns, drive%point, [drive%time, &
                       drive%work], drive%strain, row)
        call append_row(drive%table, row, err)
    end subroutine write_row
end module brz_material_driver
