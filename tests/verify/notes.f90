! SPDX-License-Identifier: MIT
!> Figures that a test has measured, each under a key, for the tables of the manual.
!>
!> They go to the end of the file that BRZ_NOTES names, a line `key,value` each, and nowhere
!> without it. `make figures` compares the tables with them (scripts/figures.py).
module notes
    use brz_kinds, only: dp
    implicit none
    private
    public :: note

    interface note
        module procedure note_one, note_many
    end interface note

contains

    subroutine note_one(key, value)
        character(*), intent(in) :: key !! letters, digits, points, underscores
        real(dp), intent(in) :: value !! in the unit in which the table shows it
        character(1024) :: path
        integer :: unit

        call get_environment_variable('BRZ_NOTES', path)
        if (path == '') return
        open (newunit=unit, file=path, position='append', action='write')
        write (unit, '(2a, es24.16e3)') trim(key), ',', value
        close (unit)
    end subroutine note_one

    !> Several under key_1, key_2, ...
    subroutine note_many(key, values)
        character(*), intent(in) :: key
        real(dp), intent(in) :: values(:)
        character(12) :: number
        integer :: i

        do i = 1, size(values)
            write (number, '("_", i0)') i
            call note_one(trim(key)//trim(number), values(i))
        end do
    end subroutine note_many
end module notes
