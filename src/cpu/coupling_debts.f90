! SPDX-License-Identifier: MIT
!> Ledgers of solid cells and debts of gas cells, in every step.
module brz_coupling_debts
    use brz_air_state, only: air_t
    use brz_coupling_bins, only: at_least, running_sum
    use brz_coupling_state, only: coupling_t
    use brz_debt_loops, only: each_enter_debt, each_move_debt, each_pay_debt, each_settle_debt
    use brz_kinds, only: int32, rk
    use brz_ledger_loops, only: each_copy_ledger, each_first_excess, each_give_excess, &
        each_judge_ledger, each_level_ledger, each_open_excess, each_take_excess
    implicit none
    private
    public :: size_debts, drop_paid, level_ledgers, limit_ledgers, release_debts, settle_covered, &
              enter_debts

contains

    !> Exchange parts of the ledgers of neighbours. In one dimension there are no such neighbours.
    subroutine level_ledgers(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        real(rk) :: part

        if (coupling%shells%n < 3 .or. count(air%n > 1) == 1) return
        part = 1/3.0_rk**count(air%n > 1)
        associate (wall => coupling%wall)
            call each_copy_ledger(wall%n_cells, coupling%box, coupling%cell, air%u, coupling%ledger)
            call each_level_ledger(wall%n_cells, coupling%box, coupling%shells, part, &
                                   coupling%cell, wall%solid, wall%index, coupling%face_of, &
                                   coupling%ledger, air%u)
        end associate
    end subroutine level_ledgers

    !> Keep each ledger in its band; the excess becomes debt of the gas beside.
    subroutine limit_ledgers(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: opened, over

        over = 0
        associate (wall => coupling%wall)
            call each_judge_ledger(wall%n_cells, coupling%box, coupling%cell, coupling%gas, &
                                   coupling%face_of, air%u, coupling%excess, &
                                   coupling%ledger_low, coupling%ledger_high, over)
            if (over == 0) return
            call each_take_excess(wall%n_cells, coupling%box, coupling%cell, coupling%face_of, &
                                  coupling%excess, air%u, coupling%ledger)
            call at_least(coupling%start, wall%n_faces + 1)
            call each_first_excess(wall%n_faces, coupling%box, coupling%gas, wall%face_cell, &
                                   wall%solid, wall%index, coupling%face_of, coupling%excess, &
                                   coupling%slot, coupling%start)
            call running_sum(coupling%start, wall%n_faces, opened)
            call size_debts(coupling, coupling%n_debts + opened)
            call each_open_excess(wall%n_faces, coupling%n_var, coupling%n_debts, coupling%start, &
                                  coupling%gas, coupling%slot, coupling%debt_cell, coupling%debt)
            coupling%n_debts = coupling%n_debts + opened
            call each_give_excess(wall%n_faces, coupling%box, coupling%n_var, coupling%gas, &
                                  wall%face_cell, wall%solid, wall%index, coupling%face_of, &
                                  coupling%excess, coupling%ledger, coupling%slot, coupling%debt)
        end associate
    end subroutine limit_ledgers

    !> Pay a part of each debt.
    subroutine release_debts(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling

        if (coupling%n_debts == 0) return
        call at_least(coupling%start, coupling%n_debts + 1)
        call each_pay_debt(coupling%n_debts, coupling%box, coupling%n_var, coupling%debt_cell, &
                           air%u, coupling%debt, coupling%start)
        call drop_paid(coupling)
    end subroutine release_debts

    !> Cells that were covered take their debts into their ledgers.
    subroutine settle_covered(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling

        if (coupling%n_debts == 0) return
        call at_least(coupling%start, coupling%n_debts + 1)
        call each_settle_debt(coupling%n_debts, coupling%box, coupling%n_var, coupling%debt_cell, &
                              coupling%wall%solid, air%u, coupling%debt, coupling%start)
        call drop_paid(coupling)
    end subroutine settle_covered

    !> Close the gaps in the list that paid debts leave; `start` holds 1 for each that stays.
    subroutine drop_paid(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer :: left

        call running_sum(coupling%start, coupling%n_debts, left)
        if (left == coupling%n_debts) return
        call room_for_debts(coupling%n_var, size(coupling%debt_cell), coupling%next_cell, &
                            coupling%next_debt)
        call each_move_debt(coupling%n_debts, coupling%n_var, coupling%start, coupling%debt_cell, &
                            coupling%debt, coupling%slot, coupling%next_cell, coupling%next_debt)
        coupling%n_debts = left
        call swap_lists(coupling)
    end subroutine drop_paid

    subroutine swap_lists(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer(int32), allocatable :: cell(:)
        real(rk), allocatable :: debt(:, :)

        call move_alloc(coupling%debt_cell, cell)
        call move_alloc(coupling%debt, debt)
        call move_alloc(coupling%next_cell, coupling%debt_cell)
        call move_alloc(coupling%next_debt, coupling%debt)
        call move_alloc(cell, coupling%next_cell)
        call move_alloc(debt, coupling%next_debt)
    end subroutine swap_lists

    !> Enter all debts in the map of cells.
    subroutine enter_debts(coupling)
        type(coupling_t), intent(inout) :: coupling

        coupling%slot = 0
        if (coupling%n_debts > 0) &
            call each_enter_debt(coupling%n_debts, coupling%debt_cell, coupling%slot)
    end subroutine enter_debts

    !> Room for n debts; those already listed are kept.
    subroutine size_debts(coupling, n)
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: n

        if (allocated(coupling%debt_cell)) then
            if (size(coupling%debt_cell) >= n) return
        end if
        call room_for_debts(coupling%n_var, 2*n + 64, coupling%next_cell, coupling%next_debt)
        associate (have => coupling%n_debts)
            if (have > 0) coupling%next_cell(:have) = coupling%debt_cell(:have)
            if (have > 0) coupling%next_debt(:, :have) = coupling%debt(:, :have)
        end associate
        call swap_lists(coupling)
    end subroutine size_debts

    !> A list with room for n debts; what was in it is lost.
    subroutine room_for_debts(n_var, n, cell, debt)
        integer, intent(in) :: n_var, n
        integer(int32), allocatable, intent(inout) :: cell(:)
        real(rk), allocatable, intent(inout) :: debt(:, :)

        if (allocated(cell)) then
            if (size(cell) >= n) return
            deallocate (cell, debt)
        end if
        allocate (cell(n), debt(n_var, n))
    end subroutine room_for_debts
end module brz_coupling_debts
