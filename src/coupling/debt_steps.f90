! SPDX-License-Identifier: MIT
!> Gas that is stored in solid cells (ledgers) and deferred sources of gas cells (debts): flux
!> redistribution. The operations of every step, in their order, and what donors hand over.
!> scripts/steps.py writes the same for the GPU.
module brz_debt_steps
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_debt_loops, only: each_enter_debt, each_flag_own, each_move_debt, each_pay_debt, &
        each_settle_debt, each_total_debt
    use brz_donor_loops, only: each_choose_shell, each_collect_shares, each_fill_left, &
        each_flag_buried, each_list_buried, each_owe_donation
    use brz_kinds, only: dp
    use brz_ledger_loops, only: each_book_level, each_copy_ledger, each_first_excess, &
        each_give_excess, each_judge_ledger, each_level_ledger, each_open_excess, &
        each_take_excess, each_total_ledger
    use brz_lists, only: at_least, copy_first, room_of, running_sum, swap
    use brz_scheme, only: max_var
    implicit none
    private
    public :: level_ledgers, limit_ledgers, release_debts, settle_covered, enter_debts
    public :: fill_uncovered, donate, size_debts, size_next, keep_own, ledger_totals

contains

    !> Exchange parts of the ledgers of neighbours. In one dimension there are no such neighbours.
    subroutine level_ledgers(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c

        if (.not. c%level > 0) return
        call each_copy_ledger(c%wall%n_cells, c%box, c%cell, air%u, c%ledger)
        if (any(c%box%mirrors)) then
            call each_book_level(c%wall%n_cells, c%box, c%shells, c%level, c%cell, c%wall%solid, &
                                 c%wall%index, c%wall%face_of, c%ledger, &
                                 c%books%images) !@gpu book_images
        end if
        call each_level_ledger(c%wall%n_cells, c%box, c%shells, c%level, c%cell, c%wall%solid, &
                               c%wall%index, c%wall%face_of, c%ledger, air%u)
    end subroutine level_ledgers

    !> Keep each ledger in its band; the excess becomes debt of the gas beside.
    subroutine limit_ledgers(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        integer :: opened, over

        over = 0
        call each_judge_ledger(c%wall%n_cells, c%box, c%cell, c%gas, c%wall%face_of, air%u, &
                               c%excess, c%books%ledger_low, c%books%ledger_high, &
                               over) !@gpu book_low count_over
        if (over == 0) return
        call each_take_excess(c%wall%n_cells, c%box, c%cell, c%wall%face_of, c%excess, air%u, &
                              c%ledger)
        call at_least(c%start, c%wall%n_faces + 1)
        call each_first_excess(c%wall%n_faces, c%box, c%gas, c%wall%face_cell, c%wall%solid, &
                               c%wall%index, c%wall%face_of, c%excess, c%slot, c%start)
        call running_sum(c%start, c%wall%n_faces, opened)
        call size_debts(c, c%n_debts + opened)
        call each_open_excess(c%wall%n_faces, c%n_var, c%n_debts, c%start, c%gas, c%slot, &
                              c%debt_cell, c%debt)
        c%n_debts = c%n_debts + opened
        call each_give_excess(c%wall%n_faces, c%box, c%n_var, c%gas, c%wall%face_cell, &
                              c%wall%solid, c%wall%index, c%wall%face_of, c%excess, c%ledger, &
                              c%slot, c%debt)
    end subroutine limit_ledgers

    !> Pay a part of each debt.
    subroutine release_debts(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c

        if (c%n_debts == 0) return
        call at_least(c%start, c%n_debts + 1)
        call each_pay_debt(c%n_debts, c%box, c%n_var, c%debt_cell, air%u, c%debt, c%start)
        call drop_paid(c)
    end subroutine release_debts

    !> Cells that were covered take their debts into their ledgers.
    subroutine settle_covered(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c

        if (c%n_debts == 0) return
        call at_least(c%start, c%n_debts + 1)
        call each_settle_debt(c%n_debts, c%box, c%n_var, c%debt_cell, c%wall%solid, air%u, c%debt, &
                              c%start)
        call drop_paid(c)
    end subroutine settle_covered

    !> Drop the debts of cells of other processes.
    subroutine keep_own(c)
        type(coupling_t), intent(inout) :: c

        if (c%n_debts == 0) return
        call at_least(c%start, c%n_debts + 1)
        call each_flag_own(c%n_debts, c%box, c%debt_cell, c%start)
        call drop_paid(c)
    end subroutine keep_own

    !> Close the gaps in the list that paid debts leave; `start` holds 1 for each that stays.
    subroutine drop_paid(c)
        type(coupling_t), intent(inout) :: c
        integer :: left

        call running_sum(c%start, c%n_debts, left)
        if (left == c%n_debts) return
        call size_next(c, c%n_debts)
        call each_move_debt(c%n_debts, c%n_var, c%start, c%debt_cell, c%debt, c%slot, c%next_cell, &
                            c%next_debt)
        c%n_debts = left
        call swap(c%debt_cell, c%next_cell)
        call swap(c%debt, c%next_debt)
    end subroutine drop_paid

    !> Enter all debts in the map of cells, which holds none.
    subroutine enter_debts(c)
        type(coupling_t), intent(inout) :: c

        if (c%n_debts > 0) call each_enter_debt(c%n_debts, c%debt_cell, c%slot)
    end subroutine enter_debts

    !> Room for n debts; those already listed are kept.
    subroutine size_debts(c, n)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n

        if (room_of(c%debt_cell) >= max(n, 1)) return
        call size_next(c, 2*n + 64)
        call copy_first(c%n_debts, c%debt_cell, c%next_cell)
        call copy_first(c%n_debts, c%n_var, c%debt, c%next_debt)
        call swap(c%debt_cell, c%next_cell)
        call swap(c%debt, c%next_debt)
    end subroutine size_debts

    !> Room for a list of n debts that is to take the place of the one that is there.
    subroutine size_next(c, n)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n

        ! the two always have the same room: no buffer of a GPU is shorter than two entries of one
        call at_least(c%next_cell, max(n, 2))
        call at_least(c%next_debt, c%n_var, max(n, 2))
    end subroutine size_next

    !> Give the cells that the solid left the state of the gas around; what is over they give away.
    subroutine fill_uncovered(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        integer :: n

        n = c%wall%n_cells + c%n_covered ! most donors: these cells, and all solid ones to come
        call at_least(c%donor, n)
        call at_least(c%donor_shell, n)
        call at_least(c%donation, max_var, n)
        if (c%n_uncovered == 0) return
        call each_fill_left(c%n_uncovered, c%box, air%scheme, air%rho_rest, air%p_rest, c%shells, &
                            c%uncovered, c%mark, c%wall%solid, c%wall%index, c%ends, c%wall%v, &
                            air%u, c%donor, c%donation)
    end subroutine fill_uncovered

    !> Hand the gas of the donors to the ledgers nearby; what finds none is owed, or waits.
    subroutine donate(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        integer :: buried, donors, kept, left, n, opened

        n = c%wall%n_cells
        left = c%n_uncovered
        call at_least(c%start, left + n + 1)
        call each_flag_buried(n, c%box, c%cell, c%wall%face_of, air%u, c%start)
        call running_sum(c%start, n, buried)
        donors = left + buried
        if (donors == 0) return
        call each_list_buried(n, left, c%box, c%cell, c%start, air%u, c%mark, c%donor, c%donation)
        kept = 0
        call each_choose_shell(donors, left, c%box, c%shells, c%donor, c%wall%solid, c%wall%index, &
                               c%wall%face_of, air%u, c%donor_shell, c%donation, c%start, &
                               kept) !@gpu count_kept
        c%books%kept = c%books%kept + kept
        call running_sum(c%start, donors, opened)
        call size_debts(c, c%n_debts + opened)
        if (opened > 0) call each_owe_donation(left, c%n_var, c%n_debts, c%start, c%donor, &
            c%donation, c%slot, c%debt_cell, c%debt)
        c%n_debts = c%n_debts + opened
        call each_collect_shares(n, donors, left, c%box, c%shells, c%cell, c%wall%face_of, c%mark, &
                                 c%donor, c%donor_shell, c%donation, air%u)
    end subroutine donate

    !> Totals of ledgers and debts, of all processes.
    subroutine ledger_totals(air, c, kept, products)
        type(air_t), intent(in) :: air !! read in solid cells
        type(coupling_t), intent(inout) :: c
        real(dp), intent(out) :: kept(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: products !! mass of products of explosives [kg]
        real(dp) :: total(6), owed(6)

        call each_total_ledger(c%wall%n_cells, air%part%ranks, c%box, c%cell, air%u, total)
        call each_total_debt(c%n_debts, air%part%ranks, c%box, c%n_var, c%debt_cell, c%debt, owed)
        total = (total + owed)*product(c%box%dx)
        kept = total(1:5)
        products = total(6)
    end subroutine ledger_totals
end module brz_debt_steps
