! SPDX-License-Identifier: MIT
!> Gas that a cell must give away goes to the ledgers of the solid cells nearby that touch gas.
module brz_coupling_donors
    use brz_air_state, only: air_t
    use brz_coupling_bins, only: at_least, running_sum
    use brz_coupling_debts, only: size_debts
    use brz_coupling_state, only: coupling_t
    use brz_donor_loops, only: each_choose_shell, each_collect_shares, each_fill_left, &
        each_flag_buried, each_list_buried, each_owe_donation
    use brz_kinds, only: int32, rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: fill_uncovered, donate

contains

    !> Give the cells that the solid left the state of the gas around; what is over they give away.
    subroutine fill_uncovered(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling

        call size_donors(coupling, coupling%n_uncovered)
        if (coupling%n_uncovered == 0) return
        call each_fill_left(coupling%n_uncovered, coupling%box, air%scheme, air%rho_rest, &
                            air%p_rest, coupling%shells, coupling%uncovered, coupling%mark, &
                            coupling%wall%solid, coupling%wall%index, coupling%wall%v, air%u, &
                            coupling%donor, coupling%donation)
    end subroutine fill_uncovered

    !> Hand the gas of the donors to the ledgers nearby; what finds none is owed, or waits.
    subroutine donate(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: kept, left, n, opened

        n = coupling%wall%n_cells
        left = coupling%n_uncovered
        call at_least(coupling%start, left + n + 1)
        call each_flag_buried(n, coupling%box, coupling%cell, coupling%face_of, air%u, &
                              coupling%start)
        call running_sum(coupling%start, n, coupling%n_buried)
        coupling%n_donors = left + coupling%n_buried
        if (coupling%n_donors == 0) return
        call size_donors(coupling, coupling%n_donors)
        call each_list_buried(n, left, coupling%box, coupling%cell, coupling%start, air%u, &
                              coupling%mark, coupling%donor, coupling%donation)
        kept = 0
        call each_choose_shell(coupling%n_donors, left, coupling%box, coupling%shells, &
                               coupling%donor, coupling%wall%solid, coupling%wall%index, &
                               coupling%face_of, air%u, coupling%donor_shell, coupling%donation, &
                               coupling%start, kept)
        coupling%kept = coupling%kept + kept
        call running_sum(coupling%start, coupling%n_donors, opened)
        call size_debts(coupling, coupling%n_debts + opened)
        if (opened > 0) &
            call each_owe_donation(left, coupling%n_var, coupling%n_debts, coupling%start, &
                                   coupling%donor, coupling%donation, coupling%slot, &
                                   coupling%debt_cell, coupling%debt)
        coupling%n_debts = coupling%n_debts + opened
        call each_collect_shares(n, coupling%n_donors, left, coupling%box, coupling%shells, &
                                 coupling%cell, coupling%face_of, coupling%mark, coupling%donor, &
                                 coupling%donor_shell, coupling%donation, air%u)
    end subroutine donate

    !> Room for n donors; those already listed are kept.
    subroutine size_donors(coupling, n)
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: n
        integer(int32), allocatable :: donor(:)
        real(rk), allocatable :: donation(:, :)
        integer :: have, room

        have = 0
        if (allocated(coupling%donor)) have = size(coupling%donor)
        if (have >= n) return
        room = 2*n
        allocate (donor(room), donation(max_var, room))
        if (have > 0) then
            donor(1:have) = coupling%donor
            donation(:, 1:have) = coupling%donation
            deallocate (coupling%donor_shell)
        end if
        call move_alloc(donor, coupling%donor)
        call move_alloc(donation, coupling%donation)
        allocate (coupling%donor_shell(room))
    end subroutine size_donors
end module brz_coupling_donors
