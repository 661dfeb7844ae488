! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid: the solid moved, the gas must be accounted for.
!>
!> Everything is a gather over cells in their own order, so the result depends neither on the order
!> of the particles nor on the number of threads; only debts, which are few, are booked one by one.
module brz_coupling_events
    use brz_air_state, only: air_t
    use brz_air_walls, only: build_walls
    use brz_cell_items, only: cells_of_a_chunk, change_of
    use brz_cell_loops, only: each_count_kind, each_list_kind
    use brz_coupling_bins, only: fill_bins, find_cells, index_faces, mark_cells
    use brz_coupling_box, only: box_t, is_left, is_solid
    use brz_coupling_guests, only: invite_guests, see_window
    use brz_coupling_shared, only: share_debts
    use brz_coupling_state, only: coupling_t
    use brz_coupling_steps, only: settle_ledgers
    use brz_debt_steps, only: donate, fill_uncovered, settle_covered
    use brz_kinds, only: int8
    use brz_lists, only: at_least, running_sum
    use brz_ranks, only: several
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
        type(solid_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(solid_t), allocatable :: guests

        if (several(solid%ranks)) then
            call invite_guests(air, solid, coupling)
            call see_window(air)
            call share_debts(air, coupling)
            call move_alloc(coupling%guests, guests)
            coupling%rebuilds = -1 ! a guest's place is another one's in the next step
            call move_on(air, guests, coupling)
            call move_alloc(guests, coupling%guests)
            call see_window(air)
        else
            call move_on(air, solid, coupling)
        end if
    end subroutine reclassify

    !> The same for the particles in the box.
    subroutine move_on(air, solid, coupling)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        logical :: moved

        call find_cells(solid, coupling, moved)
        if (moved) then
            call mark_cells(solid, coupling)
            call list_changes(coupling)
            if (coupling%n_covered + coupling%n_uncovered > 0) call change_hands(air, coupling)
            call fill_bins(solid, coupling)
        end if
        call settle_ledgers(air, solid, solid, coupling)
    end subroutine move_on

    !> Count the cells newly covered and newly uncovered; list the latter in their order.
    subroutine list_changes(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer :: chunks, j, k, covered, uncovered, own(2)

        covered = 0
        uncovered = 0
        own = 0
        associate (lo => coupling%wall%lo, hi => coupling%wall%hi, box => coupling%box)
            !$omp parallel do if(size(coupling%mark) >= worth_threads) schedule(static) &
            !$omp collapse(2) reduction(+:covered, uncovered, own)
            do k = 1, box%n(3)
                do j = 1, box%n(2)
                    call compare_row(coupling%wall%solid(lo(1):hi(1), lo(2) - 1 + j, &
                                                         lo(3) - 1 + k), &
                                     coupling%mark(:, j, k), own_part(box, j, k), covered, &
                                     uncovered, own)
                end do
            end do
        end associate
        coupling%n_covered = covered
        coupling%n_uncovered = uncovered
        coupling%books%covered = coupling%books%covered + own(1)
        coupling%books%uncovered = coupling%books%uncovered + own(2)
        call at_least(coupling%uncovered, uncovered)
        if (uncovered == 0) return
        associate (cells => coupling%box%cells)
            chunks = (cells - 1)/cells_of_a_chunk + 1
            call at_least(coupling%start, chunks + 1)
            call each_count_kind(chunks, cells, int(is_left), coupling%mark, coupling%start)
            call running_sum(coupling%start, chunks, uncovered)
            call each_list_kind(chunks, cells, int(is_left), coupling%mark, coupling%start, &
                                coupling%uncovered)
        end associate
    end subroutine list_changes

    !> The cells of a row, see compare_cell.
    pure subroutine compare_row(solid, mark, part, covered, uncovered, own)
        integer(int8), intent(in) :: solid(:)
        integer(int8), intent(inout) :: mark(:)
        integer, intent(in) :: part(2) !! first and last cell of this process
        integer, intent(inout) :: covered, uncovered !! added to
        integer, intent(inout) :: own(2) !! both, of this process: added to
        integer :: change, i

        do i = 1, size(mark)
            change = change_of(solid(i), mark(i))
            if (change > 0) covered = covered + 1
            if (change < 0) uncovered = uncovered + 1
            if (change < 0) mark(i) = is_left
            if (i < part(1) .or. i > part(2)) cycle
            if (change > 0) own(1) = own(1) + 1
            if (change < 0) own(2) = own(2) + 1
        end do
    end subroutine compare_row

    !> First and last cell of this process in a row; none if the row is beside its box.
    pure function own_part(box, j, k) result(part)
        type(box_t), intent(in) :: box
        integer, intent(in) :: j, k
        integer :: part(2)

        part = box%own(1, :)
        if (any([j, k] < box%own(2:3, 1) .or. [j, k] > box%own(2:3, 2))) part = [1, 0]
    end function own_part

    !> The map has changed: fill what the solid left, put the new walls up, pass the rest on.
    subroutine change_hands(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling

        call fill_uncovered(air, coupling)
        associate (lo => coupling%wall%lo, hi => coupling%wall%hi)
            coupling%wall%solid(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) = &
                merge(1_int8, 0_int8, coupling%mark == is_solid)
        end associate
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
        call at_least(coupling%excess, n)
        call at_least(coupling%ledger, max_var, n)
        n = coupling%wall%n_faces
        call at_least(coupling%surface, n)
        call at_least(coupling%weight, n)
        call at_least(coupling%force, n)
        call at_least(coupling%impedance, n)
    end subroutine size_walls
end module brz_coupling_events
