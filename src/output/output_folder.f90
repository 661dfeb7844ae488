! SPDX-License-Identifier: MIT
!> The output folder of a run: what lies in it, and when it may be used.
!>
!>     <job>.echo.nml                     the complete deck
!>     air_00012.vtkhdf, solid_00012.vtkhdf   dumps
!>     air.vtkhdf.series, solid.vtkhdf.series what ParaView opens: dumps with their times
!>     energy.csv, bodies.csv, gauges.csv histories
!>     chk_001230.h5                      checkpoints by step, the last two
!>     air_00012.part003.h5, chk_001230.part003.h5   parts of them, where several processes write
!>
!> Results are never overwritten unasked: a new run refuses a folder that holds results.
module brz_output_folder
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_files, only: list_folder, make_folder, name_len, remove_file, write_text_file
    implicit none
    private
    public :: prepare_folder, holds_histories
    public :: dump_name, checkpoint_name, checkpoint_begin, checkpoint_end
    public :: folder_fresh, folder_replace, folder_resume

    integer, parameter :: folder_fresh = 1 !! a new run; results that are there are an error
    integer, parameter :: folder_replace = 2 !! a new run; results that are there are removed
    integer, parameter :: folder_resume = 3 !! a run goes on

    character(*), parameter :: checkpoint_begin = 'chk_', checkpoint_end = '.h5'
    ! beginnings and ends of the names of results
    character(*), parameter :: begins(12) = [character(10) :: 'air_', 'solid_', 'air', 'solid', &
                                             'air_', checkpoint_begin, 'energy', 'bodies', &
                                             'gauges', 'profile_', 'solid_', &
                                             checkpoint_begin]
    character(*), parameter :: ends(12) = [character(14) :: '.vtkhdf', '.vtkhdf', &
                                           '.vtkhdf.series', '.vtkhdf.series', '.h5', &
                                           checkpoint_end, '.csv', '.csv', '.csv', '.csv', &
                                           '.parcel', '.parcel']

contains

    !> Make the folder, see to earlier results, and leave the complete deck in it.
    subroutine prepare_folder(folder, job, echo, use, err)
        character(*), intent(in) :: folder
        character(*), intent(in) :: job
        character(*), intent(in) :: echo !! the complete deck
        integer, intent(in) :: use !! folder_fresh, folder_replace, folder_resume
        type(error_t), intent(inout) :: err
        character(name_len), allocatable :: names(:)
        integer :: i

        if (failed(err)) return
        call make_folder(folder, err)
        if (failed(err)) return
        call list_results(folder, names)
        if (use == folder_fresh .and. size(names) > 0) then
            call raise(err, exit_io, folder//': holds results of another run ('//trim(names(1))// &
                       '); continue that run with --restart latest, write to another folder '// &
                       'with --out, or overwrite it with --replace')
        else if (use == folder_replace) then
            do i = 1, size(names)
                call remove_file(folder//'/'//trim(names(i)))
            end do
        end if
        call write_text_file(folder//'/'//trim(job)//'.echo.nml', echo, err)
    end subroutine prepare_folder

    !> True for a folder with results besides checkpoints: a run that goes on there continues them.
    logical function holds_histories(folder)
        character(*), intent(in) :: folder
        character(name_len), allocatable :: names(:)

        call list_results(folder, names)
        holds_histories = any(index(names, checkpoint_begin) /= 1)
    end function holds_histories

    !> Names of the results in a folder.
    subroutine list_results(folder, names)
        character(*), intent(in) :: folder
        character(name_len), allocatable, intent(out) :: names(:)
        character(name_len), allocatable :: more(:)
        integer :: i

        allocate (names(0))
        do i = 1, size(begins)
            call list_folder(folder, trim(begins(i)), trim(ends(i)), more)
            names = [names, more]
        end do
    end subroutine list_results

    !> Name of a dump, e.g. air_00012.vtkhdf.
    pure function dump_name(kind, number) result(name)
        character(*), intent(in) :: kind !! 'air' or 'solid'
        integer, intent(in) :: number
        character(:), allocatable :: name
        character(12) :: digits

        write (digits, '(i0.5)') number
        name = kind//'_'//trim(digits)//'.vtkhdf'
    end function dump_name

    !> Name of a checkpoint, e.g. chk_001230.h5.
    pure function checkpoint_name(step) result(name)
        integer, intent(in) :: step
        character(:), allocatable :: name
        character(12) :: digits

        write (digits, '(i0.6)') step
        name = checkpoint_begin//trim(digits)//checkpoint_end
    end function checkpoint_name
end module brz_output_folder
