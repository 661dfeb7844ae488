! SPDX-License-Identifier: MIT
!> Where a result comes from: the deck, the program and the moment, written into every HDF5 file.
module brz_meta
    use brz_case, only: case_t
    use brz_clock, only: clock_t
    use brz_errors, only: error_t
    use brz_hdf5_attribute, only: h5_put
    use brz_hdf5_file, only: h5_t, h5_group
    use brz_kinds, only: dp
    use brz_version, only: commit, precision, version
    implicit none
    private
    public :: meta_t, describe_run, write_meta

    integer, parameter :: schema = 1 !! of the layout of dumps

    type :: meta_t
        character(:), allocatable :: job, title
        character(:), allocatable :: deck !! complete deck with all defaults
        real(dp) :: time = 0 !! [s]
        integer :: cycle = 0
    end type meta_t

contains

    !> Gather it from the scene and the clock.
    subroutine describe_run(case, clock, meta)
        type(case_t), intent(in) :: case
        type(clock_t), intent(in) :: clock
        type(meta_t), intent(out) :: meta

        meta%job = trim(case%run%job)
        meta%title = ''
        meta%deck = ''
        if (allocated(case%run%title)) meta%title = case%run%title
        if (allocated(case%echo)) meta%deck = case%echo
        meta%time = clock%time
        meta%cycle = clock%cycle
    end subroutine describe_run

    !> The attributes of group /brisance.
    subroutine write_meta(file, meta, err)
        type(h5_t), intent(in) :: file
        type(meta_t), intent(in) :: meta
        type(error_t), intent(inout) :: err
        character(*), parameter :: group = 'brisance'

        call h5_group(file, group, err)
        call h5_put(file, group, 'schema', [schema], err)
        call h5_put(file, group, 'units', 'SI', err)
        call h5_put(file, group, 'version', version, err)
        call h5_put(file, group, 'commit', trim(commit), err)
        call h5_put(file, group, 'precision', precision, err)
        call h5_put(file, group, 'job', meta%job, err)
        call h5_put(file, group, 'title', meta%title, err)
        call h5_put(file, group, 'deck', meta%deck, err)
        call h5_put(file, group, 'time', [meta%time], err)
        call h5_put(file, group, 'cycle', [meta%cycle], err)
    end subroutine write_meta
end module brz_meta
