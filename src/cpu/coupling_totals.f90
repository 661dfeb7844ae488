! SPDX-License-Identifier: MIT
!> Mass, momentum and energy of gas, ledgers and debts.
module brz_coupling_totals
    use brz_air_state, only: air_t
    use brz_air_sums, only: air_totals, products_mass
    use brz_coupling_state, only: coupling_t
    use brz_debt_loops, only: each_total_debt
    use brz_kinds, only: dp
    use brz_ledger_loops, only: each_total_ledger
    implicit none
    private
    public :: coupling_totals, coupling_products, ledger_totals

contains

    !> Totals over the box. Their sum changes only by outflow and by what reaches the solid.
    subroutine coupling_totals(air, coupling, gas, ledger, debt)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: gas(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: ledger(5), debt(5) !! likewise
        integer :: e

        call air_totals(air, coupling%wall, gas, ledger)
        if (coupling%paper) ledger = 0 ! there is none: solid cells hold gas that is made up
        debt = 0
        do e = 1, coupling%n_debts
            debt = debt + coupling%debt(1:5, e)*product(air%dx)
        end do
    end subroutine coupling_totals

    !> Totals of ledgers and debts alone.
    subroutine ledger_totals(air, coupling, kept, products)
        type(air_t), intent(in) :: air !! read in solid cells
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: kept(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: products !! mass of products of explosives [kg]
        real(dp) :: total(6)

        total = 0
        call each_total_ledger(coupling%wall%n_cells, coupling%box, coupling%cell, air%u, total)
        if (coupling%n_debts > 0) &
            call each_total_debt(coupling%n_debts, coupling%n_var, coupling%debt, total)
        kept = total(1:5)*product(air%dx)
        products = total(6)*product(air%dx)
    end subroutine ledger_totals

    !> Mass of the products of explosives in gas, ledgers and debts [kg].
    real(dp) function coupling_products(air, coupling)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(coupling_t), intent(in) :: coupling

        coupling_products = products_mass(air)
        if (air%n_var == 6 .and. coupling%n_debts > 0) coupling_products = coupling_products &
            + sum(real(coupling%debt(6, :coupling%n_debts), dp))*product(air%dx)
    end function coupling_products
end module brz_coupling_totals
