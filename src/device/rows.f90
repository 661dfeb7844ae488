! SPDX-License-Identifier: MIT
!> An array of particles, cells or faces as messages see it: rows of bytes on the host, words of
!> 4 B in columns on a GPU.
module brz_rows
    use, intrinsic :: iso_c_binding, only: c_loc, c_null_ptr, c_ptr
    use brz_buffers, only: buffer_t, integers_t
    use brz_kinds, only: int64
    use brz_present_table, only: copy_of
    implicit none
    private
    public :: rows_t, rows_of, rows_of_copy

    type :: rows_t
        ! on the host
        type(c_ptr) :: host = c_null_ptr
        integer :: bytes = 0 !! of a row
        ! on a GPU: some words of the row of each particle, in each column
        type(integers_t) :: of
        integer :: words = 0, columns = 1
        integer :: pitch = 0 !! words from a particle to the next
        integer(int64) :: stride = 0 !! words from a column to the next
    end type rows_t

contains

    !> An array of words of 4 B, which must be a target. On a GPU it may lie in columns of n rows,
    !> and rows may have gaps between them.
    type(rows_t) function rows_of(on_gpu, array, words, columns, n, pitch) result(rows)
        logical, intent(in) :: on_gpu
        type(*), intent(in), target, contiguous :: array(..)
        integer, intent(in) :: words !! of a row
        integer, intent(in), optional :: columns, n !! on the host all of them are in a row
        integer, intent(in), optional :: pitch !! words from row to row on a GPU

        if (on_gpu) then
            rows = rows_of_copy(buffer_t(address=copy_of(c_loc(array))), words, columns, n, pitch)
        else
            rows%host = c_loc(array)
            rows%bytes = 4*words
            if (present(columns)) rows%bytes = rows%bytes*columns
        end if
    end function rows_of

    !> The same of what a GPU has.
    pure type(rows_t) function rows_of_copy(array, words, columns, n, pitch) result(rows)
        class(buffer_t), intent(in) :: array
        integer, intent(in) :: words !! of a row
        integer, intent(in), optional :: columns, n !! n rows each
        integer, intent(in), optional :: pitch !! words from row to row, else those of a row

        rows%of%address = array%address
        rows%of%bytes = array%bytes
        rows%words = words
        rows%pitch = words
        if (present(pitch)) rows%pitch = pitch
        if (.not. present(columns)) return
        rows%columns = columns
        rows%stride = int(rows%pitch, int64)*n
    end function rows_of_copy
end module brz_rows
