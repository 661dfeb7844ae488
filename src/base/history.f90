! SPDX-License-Identifier: MIT
!> History files: one row of numbers per history time, as comma-separated text.
!>
!> The first row names the columns with their units, `time[s]` first. Numbers carry 17 digits, so
!> they come back to the same bits. Rows are appended to a file that must be as this run left it. A
!> checkpoint notes how far that is, once the rows are on the disk: a restart cuts the file back to
!> the mark and goes on, so that it ends as that of an uninterrupted run byte for byte, and sees
!> where rows are lost or changed.
module brz_history
    use brz_byte_file, only: add_bytes, byte_file_t, close_bytes, cut_bytes, open_bytes, piece, &
                             read_bytes, to_change, to_read
    use brz_checksum, only: checksum, add_to_checksum
    use brz_errors, only: error_t, failed, raise, exit_internal, exit_io
    use brz_files, only: file_exists, write_text_file
    use brz_kinds, only: dp, int64
    use brz_text, only: to_text
    implicit none
    private
    public :: history_t, mark_t, open_history, cut_history, append_row, flush_history
    public :: close_history, copy_history, read_history

    integer, parameter :: number_width = 24 !! of es24.16e3
    integer, parameter :: buffer_size = 65536 !! or one row, if that is longer
    character(*), parameter :: line_end = new_line('a')

    !> How far a history is.
    type :: mark_t
        integer(int64) :: bytes = 0 !! length of the file, first row included
        integer(int64) :: sum = 0 !! checksum of these
    end type mark_t

    type :: history_t
        character(:), allocatable :: path
        integer :: columns = 0 !! 0: not open
        type(mark_t) :: mark !! of what is in the file
        character(:), allocatable :: buffer !! rows that are not in the file yet
        integer :: filled = 0 !! part of the buffer that holds rows
    end type history_t

contains

    !> Open a history. Without `resume_at` a new file replaces an old one; with it the file must be
    !> what it was up to that mark, and waits for cut_history.
    subroutine open_history(history, path, names, err, resume_at)
        type(history_t), intent(inout) :: history
        character(*), intent(in) :: path
        character(*), intent(in) :: names(:) !! columns with units, 'time[s]' first
        type(error_t), intent(inout) :: err
        type(mark_t), intent(in), optional :: resume_at
        character(:), allocatable :: header

        call close_history(history, err)
        call join(names, header)
        if (present(resume_at)) then
            history%mark = resume_at
            call compare(path, header, resume_at, err)
        else
            history%mark = mark_t(len(header), checksum(header, 0_int64))
            call write_text_file(path, header, err)
        end if
        if (failed(err)) return
        history%path = path
        history%columns = size(names)
        history%filled = 0
        if (allocated(history%buffer)) deallocate (history%buffer)
        allocate (character(max(buffer_size, (number_width + 1)*size(names))) :: history%buffer)
    end subroutine open_history

    !> Begin a history as another one did up to a mark; not where that is not there or has other
    !> columns.
    subroutine copy_history(from, to, names, mark, copied, err)
        character(*), intent(in) :: from, to !! files
        character(*), intent(in) :: names(:) !! columns with units, 'time[s]' first
        type(mark_t), intent(in) :: mark
        logical, intent(out) :: copied
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(:), allocatable :: header, text
        integer(int64) :: n

        call join(names, header)
        copied = file_exists(from)
        if (.not. copied .or. failed(err)) return
        allocate (character(max(mark%bytes, len(header, int64))) :: text)
        call open_bytes(file, from, to_read, err)
        call read_bytes(file, text, n, err)
        call close_bytes(file, err)
        copied = n >= mark%bytes .and. text(:len(header)) == header .and. .not. failed(err)
        if (copied) call write_text_file(to, text(:mark%bytes), err)
    end subroutine copy_history

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

    !> Is the file up to the mark what was written?
    subroutine compare(path, header, mark, err)
        character(*), intent(in) :: path, header
        type(mark_t), intent(in) :: mark
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(len(header)) :: first
        integer(int64) :: n, sum

        call open_bytes(file, path, to_read, err)
        if (failed(err)) err%text = err%text//remedy()
        first = ''
        call read_bytes(file, first, n, err)
        if (first /= header) call raise(err, exit_io, path//': its columns are not those of '// &
                                        'this deck; move it away or continue in another folder')
        if (file%size < mark%bytes) call raise(err, exit_io, path//': rows are lost: it has '// &
            to_text(file%size)//' bytes, at the checkpoint it had '//to_text(mark%bytes)//remedy())
        sum = checksum(first, 0_int64)
        call add_to_checksum(file, n, mark%bytes - n, .true., sum, err)
        if (sum /= mark%sum) call raise(err, exit_io, path//': rows before the checkpoint have '// &
                                        'changed'//remedy())
        call close_bytes(file, err)
    end subroutine compare

    !> Drop what lies behind the mark.
    subroutine cut_history(history, err)
        type(history_t), intent(in) :: history
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file

        if (history%columns == 0) return
        call open_bytes(file, history%path, to_change, err)
        call cut_bytes(file, history%mark%bytes, err)
        call close_bytes(file, err, sync=.true.)
    end subroutine cut_history

    function remedy() result(text)
        character(:), allocatable :: text

        text = '; bring the file back, or continue in an empty folder with --out'
    end function remedy

    !> Append one row; to a history that was not opened, as another process writes it, none.
    subroutine append_row(history, values, err)
        type(history_t), intent(inout) :: history
        real(dp), intent(in) :: values(:) !! (columns)
        type(error_t), intent(inout) :: err
        integer :: length

        if (.not. allocated(history%path)) return
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

    !> Bring the rows so far to the file; with `sync` to the disk.
    subroutine flush_history(history, err, sync)
        type(history_t), intent(inout) :: history
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: sync
        type(byte_file_t) :: file

        if (history%columns == 0 .or. failed(err)) return
        if (history%filled == 0 .and. .not. present(sync)) return
        associate (rows => history%buffer(:history%filled), mark => history%mark)
            call open_bytes(file, history%path, to_change, err)
            if (file%size /= mark%bytes) call raise(err, exit_io, history%path//': has '// &
                to_text(file%size)//' bytes where this run has written '//to_text(mark%bytes)// &
                ': something else has changed it')
            call add_bytes(file, rows, err)
            call close_bytes(file, err, sync)
            if (failed(err)) return
            mark = mark_t(file%size, checksum(rows, mark%sum))
        end associate
        history%filled = 0
    end subroutine flush_history

    !> All rows of a history file.
    subroutine read_history(path, columns, table, err)
        character(*), intent(in) :: path
        integer, intent(in) :: columns
        real(dp), allocatable, intent(out) :: table(:, :) !! (columns, rows)
        type(error_t), intent(inout) :: err
        type(byte_file_t) :: file
        character(:), allocatable :: text
        integer(int64) :: n, header
        integer :: at, i, io, length, rows

        call open_bytes(file, path, to_read, err)
        length = (number_width + 1)*columns
        allocate (character(max(piece, length)) :: text)
        call read_bytes(file, text, n, err)
        header = index(text(:n), line_end)
        rows = int((file%size - header)/length)
        allocate (table(columns, rows))
        if (file%size /= header + int(length, int64)*rows) call raise(err, exit_io, path// &
            ': its rows are not those of '//to_text(columns)//' columns')
        at = int(header)
        do i = 1, rows
            if (n - at < length) call read_on(file, text, at, n, err)
            if (failed(err)) exit
            read (text(at + 1:at + length - 1), *, iostat=io) table(:, i)
            if (io /= 0) call raise(err, exit_io, path//': row '//to_text(i)//' cannot be read')
            at = at + length
        end do
        call close_bytes(file, err)
    end subroutine read_history

    !> Put what is left of a text to its front, and fill it up from the file.
    subroutine read_on(file, text, at, n, err)
        type(byte_file_t), intent(in) :: file
        character(*), intent(inout) :: text
        integer, intent(inout) :: at !! what is read ends here
        integer(int64), intent(inout) :: n !! length of what is in the text
        type(error_t), intent(inout) :: err
        integer(int64) :: left, more

        left = n - at
        text(:left) = text(at + 1:n)
        call read_bytes(file, text(left + 1:), more, err)
        at = 0
        n = left + more
    end subroutine read_on

    !> Bring the last rows to the file and forget it; silent if it is not open.
    subroutine close_history(history, err)
        type(history_t), intent(inout) :: history
        type(error_t), intent(inout) :: err

        call flush_history(history, err)
        history%columns = 0
    end subroutine close_history
end module brz_history
