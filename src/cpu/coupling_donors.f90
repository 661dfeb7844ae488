! SPDX-License-Identifier: MIT
!> Gas that a cell must give away goes to the ledgers of the solid cells nearby that touch gas.
!>
!> Donors are cells that the solid has left and solid cells that no longer touch gas. A donor looks
!> for receivers, then each receiver gathers from the donors around it.
module brz_coupling_donors
    use brz_air_state, only: air_t
    use brz_cell_shells, only: cell_at, neighbour, number_of
    use brz_coupling_debts, only: add_debt
    use brz_coupling_state, only: coupling_t, from_buried, from_uncovered, mark_solid
    use brz_kinds, only: int32, int8, rk
    use brz_solid_state, only: worth_threads
    implicit none
    private
    public :: list_buried, choose_receivers, collect, size_donors

contains

    !> Solid cells that no longer touch gas but have a ledger: donors too, behind the uncovered.
    subroutine list_buried(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: c, n, ijk(3)

        n = 0
        !$omp parallel do if(coupling%wall%n_cells >= worth_threads) schedule(static) private(ijk) &
        !$omp reduction(+:n)
        do c = 1, coupling%wall%n_cells
            coupling%excess(c) = 0
            if (any(coupling%face_of(:, c) > 0)) cycle
            ijk = coupling%wall%cell(:, c)
            if (all(abs(air%u(ijk(1), ijk(2), ijk(3), :)) <= 0)) cycle
            coupling%excess(c) = 1
            n = n + 1
        end do
        coupling%n_donors = coupling%n_uncovered
        coupling%n_buried = n
        if (n == 0) return
        call size_donors(coupling, coupling%n_uncovered + n)
        n = coupling%n_uncovered
        do c = 1, coupling%wall%n_cells
            if (.not. coupling%excess(c) > 0) cycle
            n = n + 1
            ijk = coupling%wall%cell(:, c)
            coupling%donor(n) = number_of(air%n, ijk)
            coupling%donation(:, n) = air%u(ijk(1), ijk(2), ijk(3), :)
            coupling%mark(ijk(1), ijk(2), ijk(3)) = from_buried
        end do
        coupling%n_donors = n
    end subroutine list_buried

    !> For each donor the nearest shell with solid cells that touch gas, and the share of each.
    !>
    !> Without any within reach an uncovered cell owes the gas to itself, and a buried one keeps it.
    subroutine choose_receivers(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: e, c(3), n, s
        integer :: kept

        kept = 0
        !$omp parallel do if(27*coupling%n_donors >= worth_threads) schedule(dynamic, 16) &
        !$omp private(c, n, s) reduction(+:kept)
        do e = 1, coupling%n_donors
            c = cell_at(air%n, coupling%donor(e))
            coupling%donor_shell(e) = 0
            do s = 1, coupling%shells%n
                n = receivers(air, coupling, c, s)
                if (n == 0) cycle
                coupling%donor_shell(e) = s
                coupling%donation(:, e) = coupling%donation(:, e)/n
                exit
            end do
            if (e <= coupling%n_uncovered) cycle
            if (coupling%donor_shell(e) > 0) then
                air%u(c(1), c(2), c(3), :) = 0
            else
                kept = kept + 1
            end if
        end do
        coupling%kept = coupling%kept + kept
        do e = 1, coupling%n_uncovered
            if (coupling%donor_shell(e) > 0) cycle
            call add_debt(air, coupling, coupling%donor(e), coupling%donation(:, e))
        end do
    end subroutine choose_receivers

    !> Solid cells that touch gas in one shell around a cell.
    pure integer function receivers(air, coupling, c, s) result(n)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c(3), s !! cell and shell
        integer :: m, at, to(3)
        logical :: inside

        n = 0
        do m = coupling%shells%first(s), coupling%shells%first(s + 1) - 1
            call neighbour(air%n, coupling%wraps, c, coupling%shells%offset(:, m), to, inside)
            if (.not. inside) cycle
            if (coupling%wall%solid(to(1), to(2), to(3)) == 0) cycle
            at = coupling%wall%index(to(1), to(2), to(3))
            if (any(coupling%face_of(:, at) > 0)) n = n + 1
        end do
    end function receivers

    !> Each solid cell that touches gas takes its shares from the donors around it.
    subroutine collect(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(in) :: coupling
        integer :: c, e, m, s, ijk(3), from(3)
        integer(int8) :: kind_of
        real(rk) :: share(coupling%n_var)
        logical :: inside

        if (coupling%n_donors == 0) return
        !$omp parallel do if(27*coupling%wall%n_cells >= worth_threads) schedule(dynamic, 64) &
        !$omp private(e, m, s, ijk, from, kind_of, share, inside)
        do c = 1, coupling%wall%n_cells
            if (.not. any(coupling%face_of(:, c) > 0)) cycle
            ijk = coupling%wall%cell(:, c)
            share = 0
            do s = 1, coupling%shells%n
                do m = coupling%shells%first(s), coupling%shells%first(s + 1) - 1
                    call neighbour(air%n, coupling%wraps, ijk, coupling%shells%offset(:, m), &
                                   from, inside)
                    if (.not. inside) cycle
                    kind_of = coupling%mark(from(1), from(2), from(3))
                    if (kind_of <= mark_solid) cycle
                    e = donor_number(coupling, kind_of == from_uncovered, number_of(air%n, from))
                    if (coupling%donor_shell(e) == s) share = share + coupling%donation(:, e)
                end do
            end do
            air%u(ijk(1), ijk(2), ijk(3), :) = air%u(ijk(1), ijk(2), ijk(3), :) + share
        end do
    end subroutine collect

    !> Place of a cell in the list of donors, each half of which is in the order of the cells.
    pure integer function donor_number(coupling, is_uncovered, cell) result(e)
        type(coupling_t), intent(in) :: coupling
        logical, intent(in) :: is_uncovered
        integer(int32), intent(in) :: cell
        integer :: low, high

        low = merge(1, coupling%n_uncovered + 1, is_uncovered)
        high = merge(coupling%n_uncovered, coupling%n_donors, is_uncovered)
        do while (low < high)
            e = (low + high)/2
            if (coupling%donor(e) < cell) then
                low = e + 1
            else
                high = e
            end if
        end do
        e = low
    end function donor_number

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
        allocate (donor(room), donation(coupling%n_var, room))
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
