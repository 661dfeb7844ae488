! SPDX-License-Identifier: MIT
!> What the coupling of all processes has exchanged.
module brz_coupling_totals
    use brz_coupling_state, only: coupling_diagnostics_t, coupling_t, n_sums, put_sums, sums_in
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp
    use brz_ranks, only: ranks_t, several
    implicit none
    private
    public :: diagnostics_of_all

contains

    !> What all processes have recorded. All must call.
    subroutine diagnostics_of_all(ranks, coupling, diagnostics)
        type(ranks_t), intent(in) :: ranks
        type(coupling_t), intent(in) :: coupling
        type(coupling_diagnostics_t), intent(out) :: diagnostics
        real(dp) :: sums(n_sums)

        diagnostics = coupling%diagnostics
        if (.not. several(ranks)) return
        call exact_sums(ranks, reshape(sums_in(diagnostics), [n_sums, 1]), sums)
        call put_sums(sums, diagnostics)
    end subroutine diagnostics_of_all
end module brz_coupling_totals
