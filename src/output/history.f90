! SPDX-License-Identifier: MIT
!> History files: one row of numbers per history time, as comma-separated text.
!>
!> The first row names the columns with their units, `time[s]` first. Numbers carry 17 digits, so
!> they come back to the same bits. On a restart the file is cut back to the time of the
!> checkpoint and continued: it then equals that of an uninterrupted run byte for byte. For this
!> the rows up to a checkpoint must be on the disk before it: flush first, checkpoint then.
module brz_history
    use brz_errors, only: error_t, failed, raise, exit_internal, exit_io
    use brz_files, only: append_text, file_exists, read_text_file, write_text_file
    use brz_kinds, only: dp
    implicit none
    private
    public :: history_t, open_history, append_row, flush_history, close_history, read_history

    integer, parameter :: number_width = 24 !! of es24.16e3
    integer, parameter :: buffer_size = 65536 !! or one row, if that is longer
    character(*), parameter :: line_end = new_line('a')

    type :: history_t
        character(:), allocatable :: path
        integer :: columns = 0 !! 0: not open
        character(:), allocatable :: buffer !! rows that are not in the file yet
        integer :: filled = 0 !! part of the buffer that holds rows
    end type history_t

contains

    !> Open a history. Without `resume_at` a new file replaces an old one; with it the rows after
    !> that time are dropped from the file, which must have the same columns.
    subroutine open_history(history, path, names, err, resume_at)
        type(history_t), intent(inout) :: history
        character(*), intent(in) :: path
        character(*), intent(in) :: names(:) !! columns with units, 'time[s]' first
        type(error_t), intent(inout) :: err
        real(dp), intent(in), optional :: resume_at !! time of the checkpoint [s]
        character(:), allocatable :: header
        logical :: there

        call close_history(history, err)
        call join(names, header)
        there = file_exists(path)
        if (present(resume_at) .and. there) then
            call cut_back(path, header, resume_at, err)
        else
            call write_text_file(path, header, err)
        end if
        if (failed(err)) return
        history%path = path
        history%columns = size(names)
        history%filled = 0
        if (allocated(history%buffer)) deallocate (history%buffer)
        allocate (character(max(buffer_size, (number_width + 1)*size(names))) :: history%buffer)
    end subroutine open_history

    !> The row of names.
    pure subroutine join(names, header)
        character(*), intent(in) :: names(:)
        character(:), allocatable, intent(out) :: header
        integer :: i

        header = trim(names(1))
        do i = 2, size(names)
            header = header//','//trim(names(i))
        end do
        header = header//line_end
    end subroutine join

    !> Drop the rows after `time`, and a last row that was never finished.
    subroutine cut_back(path, header, time, err)
        character(*), intent(in) :: path, header
        real(dp), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        real(dp) :: row_time
        integer :: start, length, io

        call read_text_file(path, text, err)
        if (failed(err)) return
        if (index(text, header) /= 1) then
            call raise(err, exit_io, path//': its columns are not those of this deck; '// &
                       'move it away or continue in another folder')
            return
        end if
        start = len(header) + 1
        do while (start <= len(text))
            length = index(text(start:), line_end)
            if (length < number_width) exit
            read (text(start:start + number_width - 1), *, iostat=io) row_time
            if (io /= 0 .or. row_time > time) exit
            start = start + length
        end do
        call write_text_file(path, text(:start - 1), err)
    end subroutine cut_back

    !> Append one row.
    subroutine append_row(history, values, err)
        type(history_t), intent(inout) :: history
        real(dp), intent(in) :: values(:) !! (columns)
        type(error_t), intent(inout) :: err
        integer :: length

        if (size(values) /= history%columns) then
            call raise(err, exit_internal, history%path//': a row has another number of columns')
            return
        end if
        length = (number_width + 1)*history%columns
        if (history%filled + length > len(history%buffer)) call flush_history(history, err)
        if (failed(err)) return
        associate (row => history%buffer(history%filled + 1:history%filled + length))
            write (row, '(*(es24.16e3, :, ","))') values
            row(length:length) = line_end
        end associate
        history%filled = history%filled + length
    end subroutine append_row

    !> Bring the rows so far to the file.
    subroutine flush_history(history, err)
        type(history_t), intent(inout) :: history
        type(error_t), intent(inout) :: err

        if (history%filled == 0) return
        call append_text(history%path, history%buffer(:history%filled), err)
        history%filled = 0
    end subroutine flush_history

    !> All rows of a history file.
    subroutine read_history(path, columns, table, err)
        character(*), intent(in) :: path
        integer, intent(in) :: columns
        real(dp), allocatable, intent(out) :: table(:, :) !! (columns, rows)
        type(error_t), intent(inout) :: err
        character(:), allocatable :: text
        integer :: start, length, i, n, io

        call read_text_file(path, text, err)
        n = 0
        do i = 1, len(text)
            if (text(i:i) == line_end) n = n + 1
        end do
        allocate (table(columns, max(n - 1, 0)))
        start = index(text, line_end) + 1
        do i = 1, n - 1
            length = index(text(start:), line_end)
            read (text(start:start + length - 2), *, iostat=io) table(:, i)
            if (io /= 0) call raise(err, exit_io, path//': a row that cannot be read')
            start = start + length
        end do
    end subroutine read_history

    !> Bring the last rows to the file and forget it; silent if it is not open.
    subroutine close_history(history, err)
        type(history_t), intent(inout) :: history
        type(error_t), intent(inout) :: err

        call flush_history(history, err)
        history%columns = 0
    end subroutine close_history
end module brz_history
