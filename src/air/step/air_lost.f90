! SPDX-License-Identifier: MIT
!> A cell that is lost, on which all processes agree.
module brz_air_lost
    use brz_air_grid, only: grid_t
    use brz_air_state, only: air_t
    use brz_kinds, only: dp, int64, int8
    use brz_positivity, only: lost_mark
    use brz_ranks, only: bits_of_all, least_of_all
    implicit none
    private
    public :: find_lost, first_lost

contains

    !> The first cell of this process that is marked as lost, in air%bad_cell, and its place in
    !> memory, 0: none.
    subroutine find_lost(air, grid, marks, at)
        type(air_t), intent(inout) :: air
        type(grid_t), intent(in) :: grid
        integer(int8), intent(in) :: marks(*)
        integer(int64), intent(out) :: at
        integer(int64) :: left
        integer :: d

        at = findloc(marks(:grid%apart), int(lost_mark, int8), dim=1, kind=int64)
        left = at - 1
        do d = 3, 1, -1
            air%bad_cell(d) = int(left/grid%step(d)) + 1 - air%g(d)
            left = mod(left, int(grid%step(d), int64))
        end do
    end subroutine find_lost

    !> Tell all processes the first cell that is lost, of the whole grid. True if there is one.
    logical function first_lost(air, here) result(lost)
        type(air_t), intent(inout) :: air !! its bad_cell (in: of the box) and bad_state
        logical, intent(in) :: here !! one of this process is lost
        real(dp) :: first(1), mine, told(8)
        integer :: at(3)

        mine = huge(mine)
        at = air%bad_cell + air%before - 1
        if (here) mine = (real(at(3), dp)*air%whole(2) + at(2))*air%whole(1) + at(1)
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
