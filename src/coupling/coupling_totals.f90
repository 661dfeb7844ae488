! SPDX-License-Identifier: MIT
!> Mass, momentum and energy of gas, cell stores and deferred sources.
module brz_coupling_totals
    use brz_air_state, only: air_t
    use brz_air_totals, only: air_totals
    use brz_coupling_state, only: coupling_diagnostics_t, coupling_t, n_sums, put_sums, sums_in
    use brz_coupling_sum_loops, only: each_total_deferred_source
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, int64, rk
    use brz_ranks, only: least_of_all, ranks_t, several, sum_of_all
    implicit none
    private
    public :: coupling_totals, diagnostics_of_all

contains

    !> Totals over the box. Their sum changes only by outflow and by what reaches the solid.
    subroutine coupling_totals(air, coupling, gas, stored, deferred, kinetic, products)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(out) :: gas(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: stored(5), deferred(5) !! likewise
        real(dp), intent(out), optional :: kinetic !! energy of the gas [J]
        real(dp), intent(out), optional :: products !! of explosives in all three [kg]
        real(dp) :: remains(6)

        call air_totals(air, coupling%wall, gas, stored, kinetic, products)
        if (coupling%paper) stored = 0 ! there is none: solid cells hold gas that is made up
        remains = 0
        if (coupling%present .and. .not. coupling%wall%cells%present) &
            call each_total_deferred_source(coupling%n_deferred, air%part%ranks, &
            coupling%box, coupling%n_var, coupling%deferred_cell, coupling%deferred, remains)
        remains = remains*product(air%dx)
        deferred = remains(1:5)
        if (present(products)) products = products + remains(6)
    end subroutine coupling_totals

    !> What all processes have recorded. All must call.
    subroutine diagnostics_of_all(ranks, coupling, diagnostics)
        type(ranks_t), intent(in) :: ranks
        type(coupling_t), intent(in) :: coupling
        type(coupling_diagnostics_t), intent(out) :: diagnostics
        real(dp) :: sums(n_sums), least(2)
        integer(int64) :: counts(3)

        diagnostics = coupling%diagnostics
        if (.not. several(ranks)) return
        call exact_sums(ranks, reshape(sums_in(diagnostics), [n_sums, 1]), sums)
        call put_sums(sums, diagnostics)
        counts = [diagnostics%covered, diagnostics%cleared, diagnostics%kept]
        call sum_of_all(ranks, counts)
        diagnostics%covered = counts(1)
        diagnostics%cleared = counts(2)
        diagnostics%kept = counts(3)
        least = [diagnostics%stored_low, -diagnostics%stored_high]
        call least_of_all(ranks, least)
        diagnostics%stored_low = real(least(1), rk)
        diagnostics%stored_high = real(-least(2), rk)
    end subroutine diagnostics_of_all
end module brz_coupling_totals
