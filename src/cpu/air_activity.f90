! SPDX-License-Identifier: MIT
!> Which parts of lines are computed: those in bricks that are active, see brz_brick_loop_bodies.
module brz_air_activity
    use brz_air_state, only: air_t, brick, lines_per_block
    use brz_grid_lines, only: first_cell_of, n_lines
    use brz_kinds, only: int8
    implicit none
    private
    public :: active_along, next_run

contains

    !> Bricks along a block of lines of which some line is active.
    pure subroutine active_along(air, d, b, active)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: b !! block
        integer(int8), intent(out) :: active(:) !! 1 for each brick along d that is
        integer :: i, line, at(3), before(3)

        active = 0
        before = 0
        do line = (b - 1)*lines_per_block + 1, min(b*lines_per_block, n_lines(air%n, d))
            call first_cell_of(air%n, d, line, at)
            at = (at - 1)/brick + 1
            if (all(at == before)) cycle
            before = at
            do i = 1, size(active)
                at(d) = i
                if (air%active(at(1), at(2), at(3)) /= 0) active(i) = 1
            end do
        end do
    end subroutine active_along

    !> The next cells lo..hi along a line whose bricks are active; none is left if lo > n.
    pure subroutine next_run(active, n, lo, hi)
        integer(int8), intent(in) :: active(:) !! bricks along the line
        integer, intent(in) :: n !! cells on the line
        integer, intent(out) :: lo
        integer, intent(inout) :: hi !! in: the last cell of the run before, 0 at first
        integer :: i

        do i = (hi + brick - 1)/brick + 1, size(active)
            if (active(i) /= 0) exit
        end do
        lo = (i - 1)*brick + 1
        do i = i, size(active)
            if (active(i) == 0) exit
        end do
        hi = min((i - 1)*brick, n)
    end subroutine next_run
end module brz_air_activity
