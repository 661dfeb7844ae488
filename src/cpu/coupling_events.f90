! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid: the solid moved, the gas must be accounted for.
!>
!> Everything is a gather over cells in their own order, so the result depends neither on the order
!> of the particles nor on the number of threads; only debts, which are few, are booked one by one.
module brz_coupling_events
    use brz_air_state, only: air_t
    use brz_air_walls, only: build_walls
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_bins, only: at_least, fill_bins, find_cells, index_faces, mark_cells, &
                                 move_walls
    use brz_coupling_box, only: is_left, is_solid
    use brz_coupling_debts, only: level_ledgers, limit_ledgers, release_debts, settle_covered
    use brz_coupling_donors, only: donate, fill_uncovered
    use brz_coupling_state, only: coupling_t
    use brz_scheme, only: max_var
    use brz_solid_state, only: solid_t, worth_threads
    implicit none
    private
    public :: reclassify, size_walls

contains

    !> Bring walls, ledgers and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, ledgers and debts together do not change.
    subroutine reclassify(air, solid, coupling)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        logical :: moved

        call find_cells(air, solid, coupling, moved)
        if (moved) then
            call mark_cells(air, solid, coupling)
            call list_changes(air, coupling)
            if (coupling%n_covered + coupling%n_uncovered > 0) call change_hands(air, coupling)
            call fill_bins(air, solid, coupling)
        end if
        call level_ledgers(air, coupling)
        call limit_ledgers(air, coupling)
        call release_debts(air, coupling)
        ! the next time step depends on these alone, so that a restart finds the same
        call move_walls(air, solid, coupling)
    end subroutine reclassify

    !> Cells newly covered and newly uncovered, in their order.
    subroutine list_changes(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: i, j, k, change, n_covered, n_uncovered

        n_covered = 0
        n_uncovered = 0
        !$omp parallel do if(size(coupling%mark) >= worth_threads) schedule(static) collapse(2) &
        !$omp private(change) reduction(+:n_covered, n_uncovered)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    change = coupling%mark(i, j, k) - coupling%wall%solid(i, j, k)
                    if (change > 0) n_covered = n_covered + 1
                    if (change < 0) n_uncovered = n_uncovered + 1
                end do
            end do
        end do
        coupling%n_covered = n_covered
        coupling%n_uncovered = n_uncovered
        if (n_covered + n_uncovered == 0) return
        call at_least(coupling%covered, n_covered)
        call at_least(coupling%uncovered, n_uncovered)
        n_covered = 0
        n_uncovered = 0
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    if (coupling%mark(i, j, k) == coupling%wall%solid(i, j, k)) cycle
                    if (coupling%mark(i, j, k) == is_solid) then
                        n_covered = n_covered + 1
                        coupling%covered(n_covered) = number_of(air%n, [i, j, k])
                    else
                        n_uncovered = n_uncovered + 1
                        coupling%uncovered(n_uncovered) = number_of(air%n, [i, j, k])
                    end if
                end do
            end do
        end do
        coupling%covered_total = coupling%covered_total + n_covered
        coupling%uncovered_total = coupling%uncovered_total + n_uncovered
    end subroutine list_changes

    !> The map has changed: fill what the solid left, put the new walls up, pass the rest on.
    subroutine change_hands(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: e, c(3)

        call fill_uncovered(air, coupling)
        do e = 1, coupling%n_covered
            c = cell_at(air%n, coupling%covered(e))
            coupling%wall%solid(c(1), c(2), c(3)) = 1
        end do
        do e = 1, coupling%n_uncovered
            c = cell_at(air%n, coupling%uncovered(e))
            coupling%wall%solid(c(1), c(2), c(3)) = 0
            coupling%mark(c(1), c(2), c(3)) = is_left
        end do
        call build_walls(air, coupling%wall)
        call index_faces(air, coupling)
        call size_walls(coupling)
        call settle_covered(air, coupling)
        call donate(air, coupling)
    end subroutine change_hands

    !> Room for what is kept per solid cell and per wall face.
    subroutine size_walls(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer :: n

        n = coupling%wall%n_cells
        if (allocated(coupling%excess)) then
            if (size(coupling%excess) < n) deallocate (coupling%excess, coupling%ledger)
        end if
        if (.not. allocated(coupling%excess)) then
            allocate (coupling%excess(n + n/4), coupling%ledger(max_var, n + n/4))
        end if
        n = coupling%wall%n_faces
        if (allocated(coupling%surface)) then
            if (size(coupling%surface) < n) &
                deallocate (coupling%surface, coupling%weight, coupling%force, coupling%impedance)
        end if
        if (.not. allocated(coupling%surface)) then
            n = n + n/4
            allocate (coupling%surface(n), coupling%weight(n), coupling%force(n))
            allocate (coupling%impedance(n))
        end if
    end subroutine size_walls
end module brz_coupling_events
