! SPDX-License-Identifier: MIT
!> Debts of gas cells, and the band that ledgers are kept in.
module brz_coupling_debts
    use brz_air_state, only: air_t
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: int32, rk
    use brz_ledger_rules, only: ledger_excess, ledger_ratio, release_debt
    use brz_positivity, only: floors_of
    use brz_scheme, only: max_var
    use brz_solid_state, only: worth_threads
    implicit none
    private
    public :: add_debt, limit_ledgers, release_debts, settle_covered

contains

    !> Add to the debt of a gas cell.
    subroutine add_debt(air, coupling, cell, q)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer(int32), intent(in) :: cell !! number of the cell
        real(rk), intent(in) :: q(:) !! (n_var)
        integer :: c(3), e

        c = cell_at(air%n, cell)
        e = coupling%slot(c(1), c(2), c(3))
        if (e == 0) then
            call size_debts(coupling, coupling%n_debts + 1)
            e = coupling%n_debts + 1
            coupling%n_debts = e
            coupling%slot(c(1), c(2), c(3)) = e
            coupling%debt_cell(e) = cell
            coupling%debt(:, e) = 0
        end if
        coupling%debt(:, e) = coupling%debt(:, e) + q
    end subroutine add_debt

    !> A cell that was covered takes its debt into its ledger.
    subroutine settle_covered(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: c(3), e

        do e = 1, coupling%n_debts
            c = cell_at(air%n, coupling%debt_cell(e))
            if (coupling%wall%solid(c(1), c(2), c(3)) == 0) cycle
            air%u(c(1), c(2), c(3), :) = air%u(c(1), c(2), c(3), :) + coupling%debt(:, e)
            coupling%debt(:, e) = 0
        end do
        call drop_paid(air, coupling)
    end subroutine settle_covered

    !> Keep each ledger between -1 and +2 cells of the gas beside it; the excess becomes debt there.
    subroutine limit_ledgers(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        real(rk) :: low, high, ratio
        integer :: c, over

        low = coupling%ledger_low
        high = coupling%ledger_high
        over = 0
        !$omp parallel do if(coupling%wall%n_cells >= worth_threads) schedule(static) &
        !$omp private(ratio) reduction(+:over) reduction(min:low) reduction(max:high)
        do c = 1, coupling%wall%n_cells
            coupling%excess(c) = 0
            if (.not. any(coupling%face_of(:, c) > 0)) cycle
            ratio = ratio_of(air, coupling, c)
            coupling%excess(c) = ledger_excess(ratio)
            ratio = ratio*(1 - coupling%excess(c))
            low = min(low, ratio)
            high = max(high, ratio)
            if (coupling%excess(c) > 0) over = over + 1
        end do
        coupling%ledger_low = low
        coupling%ledger_high = high
        if (over == 0) return
        do c = 1, coupling%wall%n_cells
            if (coupling%excess(c) > 0) call move_excess(air, coupling, c)
        end do
    end subroutine limit_ledgers

    !> Ledger of a solid cell over the mean of the gas cells that it touches.
    pure real(rk) function ratio_of(air, coupling, c) result(ratio)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk) :: rho, energy, u(5)
        integer :: f, n, side, g(3)

        rho = 0
        energy = 0
        n = 0
        do side = 1, 6
            f = coupling%face_of(side, c)
            if (f == 0) cycle
            g = coupling%wall%face(1:3, f)
            rho = rho + air%u(g(1), g(2), g(3), 1)
            energy = energy + air%u(g(1), g(2), g(3), 5)
            n = n + 1
        end do
        g = coupling%wall%cell(:, c)
        u = air%u(g(1), g(2), g(3), 1:5)
        ratio = ledger_ratio(u, rho/n, energy/n)
    end function ratio_of

    !> Move the excess of a ledger, in equal shares, to the debts of the gas cells that it touches.
    subroutine move_excess(air, coupling, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk) :: q(air%n_var)
        integer :: f, side, ijk(3)

        ijk = coupling%wall%cell(:, c)
        q = coupling%excess(c)*air%u(ijk(1), ijk(2), ijk(3), :)
        air%u(ijk(1), ijk(2), ijk(3), :) = air%u(ijk(1), ijk(2), ijk(3), :) - q
        q = q/count(coupling%face_of(:, c) > 0)
        do side = 1, 6
            f = coupling%face_of(side, c)
            if (f > 0) call add_debt(air, coupling, number_of(air%n, coupling%wall%face(1:3, f)), q)
        end do
    end subroutine move_excess

    !> Pay a part of each debt.
    subroutine release_debts(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        real(rk) :: u(max_var), debt(max_var), floors(3)
        integer :: c(3), e

        if (coupling%n_debts == 0) return
        floors = floors_of(.true., air%scheme%gamma, air%rho_rest, air%p_rest)
        !$omp parallel do if(coupling%n_debts >= worth_threads) schedule(static) private(c, u, debt)
        do e = 1, coupling%n_debts
            c = cell_at(air%n, coupling%debt_cell(e))
            u(6) = 0
            debt(6) = 0
            u(:air%n_var) = air%u(c(1), c(2), c(3), :)
            debt(:air%n_var) = coupling%debt(:, e)
            call release_debt(floors, u, debt)
            air%u(c(1), c(2), c(3), :) = u(:air%n_var)
            coupling%debt(:, e) = debt(:air%n_var)
        end do
        call drop_paid(air, coupling)
    end subroutine release_debts

    !> Close the gaps in the list that paid debts leave.
    subroutine drop_paid(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: c(3), e, n

        n = 0
        do e = 1, coupling%n_debts
            c = cell_at(air%n, coupling%debt_cell(e))
            if (all(abs(coupling%debt(:, e)) <= 0)) then
                coupling%slot(c(1), c(2), c(3)) = 0
                cycle
            end if
            n = n + 1
            coupling%slot(c(1), c(2), c(3)) = n
            coupling%debt_cell(n) = coupling%debt_cell(e)
            coupling%debt(:, n) = coupling%debt(:, e)
        end do
        coupling%n_debts = n
    end subroutine drop_paid

    !> Room for n debts; those already listed are kept.
    subroutine size_debts(coupling, n)
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: n
        integer(int32), allocatable :: cell(:)
        real(rk), allocatable :: debt(:, :)
        integer :: have

        have = 0
        if (allocated(coupling%debt_cell)) have = size(coupling%debt_cell)
        if (have >= n) return
        allocate (cell(2*n + 64), debt(coupling%n_var, 2*n + 64))
        if (have > 0) then
            cell(1:have) = coupling%debt_cell
            debt(:, 1:have) = coupling%debt
        end if
        call move_alloc(cell, coupling%debt_cell)
        call move_alloc(debt, coupling%debt)
    end subroutine size_debts
end module brz_coupling_debts
