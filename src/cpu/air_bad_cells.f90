! SPDX-License-Identifier: MIT
!> The list of cells that a stage would leave unphysical, on which all processes agree: each has its
!> own cells and those beside its box, in the order of the grid, so that what is added to the rates
!> of a cell is added in the same order everywhere.
module brz_air_bad_cells
    use brz_air_lost, only: number_of
    use brz_air_state, only: air_t, bc_inside
    use brz_fetch, only: fetch
    use brz_grid_lines, only: across
    use brz_kinds, only: dp, int64, int8
    use brz_ranks, only: most_of_all, several
    use brz_row_order, only: order_rows
    implicit none
    private
    public :: join_bad, is_own, is_beside, is_counted, anywhere, grow

contains

    !> Put the bad cells into the order of the grid, each once, with those of other processes beside
    !> the box.
    subroutine join_bad(air, last, n_bad)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: last !! direction whose lines count first
        integer, intent(inout) :: n_bad !! in: own cells in air%bad; out: all in it
        real(dp), allocatable :: rows(:, :)
        integer, allocatable :: order(:), sorted(:, :)
        integer :: m, n

        if (several(air%part%ranks)) call add_cells_beside(air, n_bad)
        if (n_bad < 2) return
        rows = reshape([(number_of(air, last, air%bad(:, m)), m=1, n_bad)], [1, n_bad])
        allocate (order(n_bad))
        call order_rows(rows, order)
        sorted = air%bad(:, order)
        n = 0
        do m = 1, n_bad
            if (m > 1) then
                if (all(sorted(:, m) == sorted(:, m - 1))) cycle
            end if
            n = n + 1
            air%bad(:, n) = sorted(:, m)
        end do
        n_bad = n
    end subroutine join_bad

    !> Add the bad cells of other processes that share a face with the box.
    subroutine add_cells_beside(air, n_bad)
        type(air_t), intent(inout) :: air
        integer, intent(inout) :: n_bad
        integer :: d, j, k, m, side, cell(3)

        call mark_own(air, n_bad, .true.)
        call fetch(air%part%ranks, air%part%beside, lbound(air%part%bad), ubound(air%part%bad), &
                   air%part%bad)
        call mark_own(air, n_bad, .false.)
        do d = 1, 3
            do side = 1, 2
                if (air%bc(side, d) /= bc_inside) cycle
                cell(d) = merge(0, air%n(d) + 1, side == 1)
                do k = 1, air%n(across(2, d))
                    do j = 1, air%n(across(1, d))
                        cell(across(:, d)) = [j, k]
                        associate (at => cell + air%before)
                            m = air%part%bad(at(1), at(2), at(3))
                        end associate
                        if (m == 0) cycle
                        n_bad = n_bad + 1
                        call grow(air%bad, n_bad)
                        air%bad(:, n_bad) = cell
                    end do
                end do
            end do
        end do
    end subroutine add_cells_beside

    !> Mark the listed cells on the map, or wipe them off.
    subroutine mark_own(air, n_bad, bad)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: n_bad
        logical, intent(in) :: bad
        integer :: m, at(3)

        do m = 1, n_bad
            at = air%bad(:, m) + air%before
            air%part%bad(at(1), at(2), at(3)) = merge(1_int8, 0_int8, bad)
        end do
    end subroutine mark_own

    !> True for a cell of the box.
    pure logical function is_own(air, cell)
        type(air_t), intent(in) :: air
        integer, intent(in) :: cell(3)

        is_own = all(cell >= 1 .and. cell <= air%n)
    end function is_own

    !> True for a face of a cell of the box.
    pure logical function is_beside(air, d, low)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face
        integer :: high(3)

        high = low
        high(d) = low(d) + 1
        is_beside = is_own(air, low) .or. is_own(air, high)
    end function is_beside

    !> True for a face that is this process's to count: one between two boxes counts once.
    pure logical function is_counted(air, d, low)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face

        is_counted = low(d) > 0 .or. air%bc(1, d) /= bc_inside
    end function is_counted

    !> True if it is so in any process.
    logical function anywhere(air, here)
        type(air_t), intent(in) :: air
        logical, intent(in) :: here
        integer(int64) :: vote(1)

        vote = merge(1, 0, here)
        call most_of_all(air%part%ranks, vote)
        anywhere = vote(1) > 0
    end function anywhere

    !> Make a table with at least n columns, keeping its content.
    subroutine grow(table, n)
        integer, allocatable, intent(inout) :: table(:, :)
        integer, intent(in) :: n
        integer, allocatable :: longer(:, :)

        if (size(table, 2) >= n) return
        allocate (longer(size(table, 1), 2*n + 64))
        longer(:, 1:size(table, 2)) = table
        call move_alloc(longer, table)
    end subroutine grow
end module brz_air_bad_cells
