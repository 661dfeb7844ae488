! SPDX-License-Identifier: MIT
!> Mass, momentum and energy of gas, ledgers and debts.
module brz_coupling_totals
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: coupling_totals

    integer, parameter :: blocks = 256 !! of rows, whatever the number of threads

contains

    !> Totals over the box. Their sum changes only by outflow and by what reaches the solid.
    !>
    !> Summed row by row in blocks of a fixed number, so that the bits do not depend on the threads.
    subroutine coupling_totals(air, coupling, gas, ledger, debt)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: gas(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: ledger(5), debt(5) !! likewise
        real(dp) :: part(5, 2, blocks), volume
        integer :: b, e, row, rows

        rows = air%n(2)*air%n(3)
        volume = product(air%dx)
        !$omp parallel do schedule(static) private(row)
        do b = 1, blocks
            part(:, :, b) = 0
            do row = 1 + int((b - 1)*int(rows, 8)/blocks), int(b*int(rows, 8)/blocks)
                call add_row(air, coupling, mod(row - 1, air%n(2)) + 1, &
                             (row - 1)/air%n(2) + 1, part(:, :, b))
            end do
        end do
        gas = 0
        ledger = 0
        do b = 1, blocks
            gas = gas + part(:, 1, b)*volume
            ledger = ledger + part(:, 2, b)*volume
        end do
        debt = 0
        do e = 1, coupling%n_debts
            debt = debt + coupling%debt(:, e)*volume
        end do
    end subroutine coupling_totals

    !> Add one row of cells.
    pure subroutine add_row(air, coupling, j, k, part)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: j, k
        real(dp), intent(inout) :: part(5, 2) !! of gas and of ledgers
        integer :: i, m

        do m = 1, 5
            do i = 1, air%n(1)
                if (coupling%wall%solid(i, j, k) == 0) then
                    part(m, 1) = part(m, 1) + air%u(i, j, k, m)
                else
                    part(m, 2) = part(m, 2) + air%u(i, j, k, m)
                end if
            end do
        end do
    end subroutine add_row
end module brz_coupling_totals
