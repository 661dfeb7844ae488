! SPDX-License-Identifier: MIT
!> Series files: a list of dumps with their times, which ParaView and pyvista open as one.
!>
!> Written anew after every dump, under a temporary name first. A run that goes on reads the list
!> back, sees that all dumps up to its checkpoint are there, and drops the later ones with their
!> files.
module brz_series
    use brz_errors, only: error_t, failed, raise, exit_io
    use brz_air_parts, only: remove_parts
    use brz_files, only: file_exists, read_text_file, remove_file, write_text_file
    use brz_kinds, only: dp
    use brz_text, only: string_t
    implicit none
    private
    public :: series_t, open_series, cut_series, add_to_series

    character(*), parameter :: line_end = new_line('a')
    character(*), parameter :: before_name = '    {"name": "', before_time = '", "time": '

    type :: series_t
        character(:), allocatable :: folder, kind
        character(:), allocatable :: entries !! one line per dump, without the comma between two
        type(string_t), allocatable :: later(:) !! dumps of a list that was read back to drop
    end type series_t

contains

    !> Begin the series `kind`.vtkhdf.series in a folder, or read it back to continue it.
    subroutine open_series(series, folder, kind, err, resume_at, last)
        type(series_t), intent(out) :: series
        character(*), intent(in) :: folder
        character(*), intent(in) :: kind !! 'air' or 'solid'
        type(error_t), intent(inout) :: err
        real(dp), intent(in), optional :: resume_at !! time of the checkpoint [s]
        character(*), intent(in), optional :: last !! dump that must be in it; '' for none

        series%folder = folder
        series%kind = kind
        series%entries = ''
        allocate (series%later(0))
        if (.not. present(resume_at) .or. failed(err)) return
        if (file_exists(path_of(series))) call read_back(series, resume_at, err)
        if (.not. present(last) .or. failed(err)) return
        if (last /= '' .and. index(series%entries, before_name//last//before_time) == 0) &
            call raise(err, exit_io, path_of(series)//': lacks '//last//', which was written '// &
                       'before the checkpoint; bring the list back, or continue in an empty '// &
                       'folder with --out')
    end subroutine open_series

    !> Drop what lies behind the checkpoint.
    subroutine cut_series(series, err)
        type(series_t), intent(inout) :: series
        type(error_t), intent(inout) :: err
        integer :: i

        if (failed(err)) return
        if (series%entries /= '' .or. size(series%later) > 0) call write_series(series, err)
        do i = 1, size(series%later)
            call remove_file(series%folder//'/'//series%later(i)%s)
            call remove_parts(series%folder, series%later(i)%s)
        end do
    end subroutine cut_series

    !> Name one more dump.
    subroutine add_to_series(series, name, time, err)
        type(series_t), intent(inout) :: series
        character(*), intent(in) :: name !! file in the same folder
        real(dp), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err
        character(24) :: number

        if (failed(err)) return
        write (number, '(es24.16e3)') time
        series%entries = series%entries//before_name//name//before_time//trim(adjustl(number))// &
                         '}'//line_end
        call write_series(series, err)
    end subroutine add_to_series

    function path_of(series) result(path)
        type(series_t), intent(in) :: series
        character(:), allocatable :: path

        path = series%folder//'/'//series%kind//'.vtkhdf.series'
    end function path_of

    !> The whole file, with commas between the entries.
    subroutine write_series(series, err)
        type(series_t), intent(in) :: series
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        integer :: start, length

        text = '{'//line_end//'  "file-series-version": "1.0",'//line_end//'  "files": ['//line_end
        start = 1
        do while (start <= len(series%entries))
            length = index(series%entries(start:), line_end)
            text = text//series%entries(start:start + length - 2)
            start = start + length
            if (start <= len(series%entries)) text = text//','
            text = text//line_end
        end do
        call write_text_file(path_of(series), text//'  ]'//line_end//'}'//line_end, err)
    end subroutine write_series

    !> Entries of the file up to a time, whose dumps must be there.
    subroutine read_back(series, last, err)
        type(series_t), intent(inout) :: series
        real(dp), intent(in) :: last !! [s]
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text, line, name
        real(dp) :: time
        integer :: start, length, i, j, io

        call read_text_file(path_of(series), text, err)
        start = 1
        do while (start <= len(text))
            length = index(text(start:), line_end)
            if (length == 0) exit
            line = text(start:start + length - 2)
            start = start + length
            if (index(line, before_name) /= 1) cycle
            i = index(line, before_time)
            j = index(line, '}')
            io = 1
            if (i > 0 .and. j > i) read (line(i + len(before_time):j - 1), *, iostat=io) time
            if (io /= 0) then
                call raise(err, exit_io, path_of(series)// &
                           ': not written by Brisance, or damaged; remove it')
                return
            end if
            name = line(len(before_name) + 1:i - 1)
            if (time > last) then
                series%later = [series%later, string_t(name)]
                cycle
            end if
            series%entries = series%entries//line(:j)//line_end
            if (.not. file_exists(series%folder//'/'//name)) call raise(err, exit_io, &
                series%folder//'/'//name//': is lost; bring it back, or take its line out of '// &
                path_of(series))
        end do
    end subroutine read_back
end module brz_series
