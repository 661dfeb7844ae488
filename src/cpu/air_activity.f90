! SPDX-License-Identifier: MIT
!> Which parts of the air must be computed: bricks of cells that something has reached.
!>
!> A brick at rest holds gas with the density and energy of the undisturbed air to the bit, and a
!> velocity below the rounding error of the sound speed. It is put to rest wholly, or else every
!> step would carry ever smaller numbers a few cells further. Any other brick, or one that holds
!> solid, is reached, and stays so. Bricks so near that a step can carry something from a reached
!> one into them are awake too. The rates of all other cells are zero to the bit, so leaving them
!> out changes nothing.
module brz_air_activity
    use brz_air_state, only: air_t, brick, lines_per_block, wall_t
    use brz_grid_lines, only: first_cell_of, n_lines
    use brz_kinds, only: int8, rk
    implicit none
    private
    public :: settle_bricks, awake_along, next_run

    integer, parameter :: few_numbers = 40000 !! fewer are not worth waking the other threads

contains

    !> Bring the map of reached bricks up to date. At the start of a step.
    subroutine settle_bricks(air, wall)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer :: c, i, j, k, cell(3)

        do c = 1, wall%n_cells
            if (any(wall%cell(:, c) < 1 .or. wall%cell(:, c) > air%n)) cycle ! of another process
            cell = (wall%cell(:, c) - 1)/brick + 1
            air%reached(cell(1), cell(2), cell(3)) = 1
        end do
        !$omp parallel do collapse(2) schedule(dynamic, 4) if (size(air%rate) > few_numbers)
        do k = 1, size(air%reached, 3)
            do j = 1, size(air%reached, 2)
                do i = 1, size(air%reached, 1)
                    if (air%reached(i, j, k) == 0) call settle(air, [i, j, k])
                end do
            end do
        end do
        !$omp end parallel do
    end subroutine settle_bricks

    !> Put a brick to rest if it is but for rounding, or mark it as reached.
    pure subroutine settle(air, at)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: at(3) !! brick
        real(rk) :: least
        integer :: c, j, k, lo(3), hi(3)
        logical :: still

        lo = (at - 1)*brick + 1
        hi = min(at*brick, air%n)
        least = epsilon(least)*sqrt(air%scheme%gamma*air%p_rest*air%rho_rest)
        still = .true.
        air%reached(at(1), at(2), at(3)) = 1
        do c = 1, air%n_var
            do k = lo(3), hi(3)
                do j = lo(2), hi(2)
                    associate (u => air%u(lo(1):hi(1), j, k, c))
                        if (c > 1 .and. c < 5) then
                            if (.not. all(abs(u) <= least)) return
                            still = still .and. all(abs(u) <= 0)
                        else
                            if (.not. all(abs(u - air%rest(c)) <= 0)) return
                        end if
                    end associate
                end do
            end do
        end do
        air%reached(at(1), at(2), at(3)) = 0
        if (.not. still) air%u(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), 2:4) = 0
    end subroutine settle

    !> Bricks along a block of lines of which some line is awake.
    pure subroutine awake_along(air, d, b, awake)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: b !! block
        integer(int8), intent(out) :: awake(:) !! 1 for each brick along d that is
        integer :: i, line, at(3), before(3)

        awake = 0
        before = 0
        do line = (b - 1)*lines_per_block + 1, min(b*lines_per_block, n_lines(air%n, d))
            call first_cell_of(air%n, d, line, at)
            at = (at - 1)/brick + 1
            if (all(at == before)) cycle
            before = at
            do i = 1, size(awake)
                at(d) = i
                if (air%awake(at(1), at(2), at(3)) /= 0) awake(i) = 1
            end do
        end do
    end subroutine awake_along

    !> The next cells lo..hi along a line whose bricks are awake; none is left if lo > n.
    pure subroutine next_run(awake, n, lo, hi)
        integer(int8), intent(in) :: awake(:) !! bricks along the line
        integer, intent(in) :: n !! cells on the line
        integer, intent(out) :: lo
        integer, intent(inout) :: hi !! in: the last cell of the run before, 0 at first
        integer :: i

        do i = (hi + brick - 1)/brick + 1, size(awake)
            if (awake(i) /= 0) exit
        end do
        lo = (i - 1)*brick + 1
        do i = i, size(awake)
            if (awake(i) == 0) exit
        end do
        hi = min((i - 1)*brick, n)
    end subroutine next_run
end module brz_air_activity
