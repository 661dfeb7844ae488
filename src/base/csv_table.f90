! SPDX-License-Identifier: MIT
!> Columns of a table of comma-separated numbers, by their names in the first row. Units in brackets
!> and the case of letters are passed over.
module brz_csv_table
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_files, only: read_text_file
    use brz_kinds, only: dp
    use brz_text, only: lower, split, string_t, to_text
    implicit none
    private
    public :: read_columns

contains

    !> Read the columns of some names; those that the table lacks have zeros.
    subroutine read_columns(path, names, values, found, err, line)
        character(*), intent(in) :: path
        character(*), intent(in) :: names(:)
        real(dp), allocatable, intent(out) :: values(:, :) !! (names, rows)
        logical, intent(out) :: found(:) !! (names) the table has that column
        type(error_t), intent(inout) :: err !! exit_deck where a row is no row of numbers
        integer, allocatable, intent(out), optional :: line(:) !! (rows) of the file
        character(:), allocatable :: text
        type(string_t), allocatable :: rows(:), head(:)
        real(dp), allocatable :: row(:)
        integer, allocatable :: filled(:)
        integer :: at(size(names)), i, io, k, n

        found = .false.
        call read_text_file(path, text, err)
        if (failed(err)) return
        call split(text, new_line('a'), rows)
        call split(rows(1)%s, ',', head)
        do k = 1, size(names)
            at(k) = place_of(head, trim(names(k)))
        end do
        found = at > 0
        if (.not. any(found)) return
        filled = pack([(i, i=2, size(rows))], [(rows(i)%s /= '', i=2, size(rows))])
        n = size(filled)
        allocate (values(size(names), n), row(size(head)))
        values = 0
        do n = 1, size(filled)
            i = filled(n)
            read (rows(i)%s, *, iostat=io) row
            if (io /= 0) then
                call raise(err, exit_deck, path//': row '//to_text(i)//' is no '// &
                           to_text(size(head))//' numbers')
                return
            end if
            do k = 1, size(names)
                if (at(k) > 0) values(k, n) = row(at(k))
            end do
        end do
        if (present(line)) call move_alloc(filled, line)
        if (.not. all(abs(values) <= huge(values))) call raise(err, exit_deck, path// &
            ': holds what is no finite number')
    end subroutine read_columns

    !> Place of a name in the first row, 0: it is not there.
    pure integer function place_of(head, name) result(at)
        type(string_t), intent(in) :: head(:)
        character(*), intent(in) :: name
        integer :: last

        do at = 1, size(head)
            last = index(head(at)%s//'[', '[') - 1
            if (lower(trim(adjustl(head(at)%s(:last)))) == name) return
        end do
        at = 0
    end function place_of
end module brz_csv_table
