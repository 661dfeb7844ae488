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
    use brz_ranks, only: several
    use brz_series, only: add_to_series, cut_series, open_series, series_t
    use brz_solid_dump, only: write_solid_dump
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_together, only: end_bodies, together_t
    implicit none
    private
    public :: dumps_t, start_dumps, cut_dumps, write_dump_files, name_dump, bodies_path

    type :: dumps_t
        character(:), allocatable :: folder
        type(series_t) :: air, solid
        logical :: leads = .true. !! this process names them
    end type dumps_t

contains

    !> Begin the dumps of a run; with `resume`, look at those up to the checkpoint.
    subroutine start_dumps(dumps, folder, kinds, resume, clock, err)
        type(dumps_t), intent(out) :: dumps
        character(*), intent(in) :: folder
        logical, intent(in) :: kinds(2) !! the scene has air, bodies
        logical, intent(in) :: resume !! a run goes on in its folder
        type(clock_t), intent(in) :: clock !! of the checkpoint
        type(error_t), intent(inout) :: err

        dumps%folder = folder
        call start(dumps%air, 'air', kinds(1))
        call start(dumps%solid, 'solid', kinds(2))

    contains

        subroutine start(series, kind, present)
            type(series_t), intent(inout) :: series
            character(*), intent(in) :: kind
            logical, intent(in) :: present
            character(:), allocatable :: last

            last = ''
            if (clock%dump_number > 0 .and. present) last = dump_name(kind, clock%dump_number - 1)
            if (resume) then
                call open_series(series, folder, kind, err, clock%time, last)
            else
                call open_series(series, folder, kind, err)
            end if
        end subroutine start
    end subroutine start_dumps

    !> Drop the dumps behind the checkpoint.
    subroutine cut_dumps(dumps, err)
        type(dumps_t), intent(inout) :: dumps
        type(error_t), intent(inout) :: err

        call cut_series(dumps%air, err)
        call cut_series(dumps%solid, err)
    end subroutine cut_dumps

    !> The files of a dump. Of several processes each writes those of its own, and the first the
    !> bodies of all, after begin_bodies.
    subroutine write_dump_files(together, case, clock, air, wall, solid, err)
        type(together_t), intent(inout) :: together
        type(case_t), intent(in) :: case
        type(clock_t), intent(in) :: clock
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(meta_t) :: meta
        character(:), allocatable :: path

        call describe_run(case, clock, meta)
        path = together%folder//'/'//dump_name('air', clock%dump_number)
        if (air%present) call write_air_dump(path, air, wall, meta, err)
        if (.not. solid%present) return
        path = bodies_path(together%folder, clock%dump_number)
        if (several(solid%ranks)) then
            call end_bodies(together, solid, path, .false., err)
            if (solid%ranks%rank > 0 .or. failed(err)) return
            call write_solid_dump(path, together%whole, case%materials%id, meta, err)
        else
            call write_solid_dump(path, solid, case%materials%id, meta, err)
        end if
    end subroutine write_dump_files

    !> File of the bodies in a dump.
    pure function bodies_path(folder, number) result(path)
        character(*), intent(in) :: folder
        integer, intent(in) :: number
        character(:), allocatable :: path

        path = folder//'/'//dump_name('solid', number)
    end function bodies_path

    !> Name a dump in the series, once it is on the disk.
    subroutine name_dump(dumps, number, time, has_air, has_solid, err)
        type(dumps_t), intent(inout) :: dumps
        integer, intent(in) :: number !! of the dump
        real(dp), intent(in) :: time !! of it [s]
        logical, intent(in) :: has_air, has_solid !! in the scene
        type(error_t), intent(inout) :: err

        if (.not. dumps%leads) return
        if (has_air) call add_to_series(dumps%air, dump_name('air', number), time, err)
        if (has_solid) call add_to_series(dumps%solid, dump_name('solid', number), time, err)
    end subroutine name_dump
end module brz_dumps
