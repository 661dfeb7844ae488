! SPDX-License-Identifier: MIT
!> A cell that is lost, on which all processes agree.
module brz_air_lost
    use brz_air_state, only: air_t
    use brz_grid_lines, only: across
    use brz_kinds, only: dp
    use brz_ranks, only: bits_of_all, least_of_all
    implicit none
    private
    public :: number_of, first_lost

contains

    !> Number of a cell of the grid along lines of direction `last`.
    pure real(dp) function number_of(air, last, cell) result(number)
        type(air_t), intent(in) :: air
        integer, intent(in) :: last
        integer, intent(in) :: cell(3) !! of the box, or beside it
        integer :: at(3)

        at = modulo(cell + air%before - 1, air%whole)
        associate (a => across(1, last), b => across(2, last))
            number = (real(at(b), dp)*air%whole(a) + at(a))*air%whole(last) + at(last)
        end associate
    end function number_of

    !> Tell all processes the first cell that is lost, of the whole grid. True if there is one.
    logical function first_lost(air, last, here) result(lost)
        type(air_t), intent(inout) :: air !! its bad_cell (in: of the box) and bad_state
        integer, intent(in) :: last !! direction whose lines count first
        logical, intent(in) :: here !! one of this process is lost
        real(dp) :: first(1), mine, told(8)

        mine = huge(mine)
        if (here) mine = number_of(air, last, air%bad_cell)
        first = mine
        call least_of_all(air%part%ranks, first)
        lost = first(1) < huge(mine)
        if (.not. lost) return
        told = 0
        if (here .and. .not. mine > first(1)) &
            told = [real(air%bad_cell + air%before, dp), real(air%bad_state, dp)]
        call bits_of_all(air%part%ranks, told)
        air%bad_cell = nint(told(1:3))
        air%bad_state = real(told(4:8), kind(air%bad_state))
    end function first_lost
end module brz_air_lost
