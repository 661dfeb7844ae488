! SPDX-License-Identifier: MIT
!> One dump of everything that a scene has, with its place in the series.
module brz_dumps
    use brz_air_dump, only: write_air_dump
    use brz_air_state, only: air_t, wall_t
    use brz_case, only: case_t
    use brz_clock, only: clock_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp
    use brz_meta, only: describe_run, meta_t
    use brz_output_folder, only: dump_name
    use brz_series, only: add_to_series, open_series, series_t
    use brz_solid_dump, only: write_solid_dump
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: dumps_t, start_dumps, write_dumps

    type :: dumps_t
        character(:), allocatable :: folder
        type(series_t) :: air, solid
    end type dumps_t

contains

    !> Begin the dumps of a run, or continue them after the time of a checkpoint.
    subroutine start_dumps(dumps, folder, err, resume_at)
        type(dumps_t), intent(out) :: dumps
        character(*), intent(in) :: folder
        type(error_t), intent(inout) :: err
        real(dp), intent(in), optional :: resume_at !! time of the checkpoint [s]

        dumps%folder = folder
        call open_series(dumps%air, folder, 'air', err, resume_at)
        call open_series(dumps%solid, folder, 'solid', err, resume_at)
    end subroutine start_dumps

    !> Write what the scene has, and count the dump in the clock.
    subroutine write_dumps(dumps, case, clock, air, wall, solid, err)
        type(dumps_t), intent(inout) :: dumps
        type(case_t), intent(in) :: case
        type(clock_t), intent(inout) :: clock
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        type(meta_t) :: meta
        character(:), allocatable :: name

        call describe_run(case, clock, meta)
        if (air%present) then
            name = dump_name('air', clock%dump_number)
            call write_air_dump(dumps%folder//'/'//name, air, wall, meta, err)
            call add_to_series(dumps%air, name, clock%time, err)
        end if
        if (solid%present) then
            name = dump_name('solid', clock%dump_number)
            call write_solid_dump(dumps%folder//'/'//name, solid, meta, err)
            call add_to_series(dumps%solid, name, clock%time, err)
        end if
        if (failed(err)) return
        clock%dump_number = clock%dump_number + 1
        clock%dump_time = clock%time
    end subroutine write_dumps
end module brz_dumps
