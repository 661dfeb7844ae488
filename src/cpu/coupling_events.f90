! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid: the solid moved, the gas must be accounted for.
!>
!> Everything is a gather over cells in their own order, so the result depends neither on the order
!> of the particles nor on the number of threads; only debts, which are few, are booked one by one.
module brz_coupling_events
    use brz_air_state, only: air_t
    use brz_air_walls, only: build_walls
    use brz_cell_shells, only: cell_at, neighbour, number_of
    use brz_coupling_bins, only: at_least, fill_bins, find_cells, index_faces, mark_cells
    use brz_coupling_debts, only: add_debt, limit_ledgers, release_debts, settle_covered
    use brz_coupling_state, only: coupling_t, from_buried, from_uncovered, mark_solid
    use brz_kinds, only: int32, rk
    use brz_ledger_rules, only: fresh_gas, to_primitive
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: reclassify, size_walls

contains

    !> Bring walls, ledgers and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, ledgers and debts together do not change.
    subroutine reclassify(air, solid, coupling)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        logical :: moved

        call find_cells(air, solid, coupling, moved)
        if (moved) then
            call mark_cells(air, solid, coupling)
            call list_changes(air, coupling)
            if (coupling%n_covered + coupling%n_uncovered > 0) call change_hands(air, coupling)
            call fill_bins(air, solid, coupling)
        end if
        call limit_ledgers(air, coupling)
        call release_debts(air, coupling)
    end subroutine reclassify

    !> Cells newly covered and newly uncovered, in their order.
    subroutine list_changes(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: i, j, k, n_covered, n_uncovered

        n_covered = 0
        n_uncovered = 0
        !$omp parallel do schedule(static) collapse(2) reduction(+:n_covered, n_uncovered)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    if (coupling%mark(i, j, k) > coupling%wall%solid(i, j, k)) n_covered = n_covered + 1
                    if (coupling%mark(i, j, k) < coupling%wall%solid(i, j, k)) n_uncovered = n_uncovered + 1
                end do
            end do
        end do
        coupling%n_covered = n_covered
        coupling%n_uncovered = n_uncovered
        if (n_covered + n_uncovered == 0) return
        call at_least(coupling%covered, n_covered)
        call at_least(coupling%uncovered, n_uncovered)
        n_covered = 0
        n_uncovered = 0
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    if (coupling%mark(i, j, k) == coupling%wall%solid(i, j, k)) cycle
                    if (coupling%mark(i, j, k) == mark_solid) then
                        n_covered = n_covered + 1
                        coupling%covered(n_covered) = number_of(air%n, [i, j, k])
                    else
                        n_uncovered = n_uncovered + 1
                        coupling%uncovered(n_uncovered) = number_of(air%n, [i, j, k])
                    end if
                end do
            end do
        end do
        coupling%covered_total = coupling%covered_total + n_covered
        coupling%uncovered_total = coupling%uncovered_total + n_uncovered
    end subroutine list_changes

    !> The map has changed: fill what the solid left, put the new walls up, pass the rest on.
    subroutine change_hands(air, coupling)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: e, c(3)

        call size_donors(coupling, coupling%n_uncovered)
        !$omp parallel do schedule(dynamic, 16)
        do e = 1, coupling%n_uncovered
            call fill_uncovered(air, coupling, e)
        end do
        do e = 1, coupling%n_covered
            c = cell_at(air%n, coupling%covered(e))
            coupling%wall%solid(c(1), c(2), c(3)) = 1
        end do
        do e = 1, coupling%n_uncovered
            c = cell_at(air%n, coupling%uncovered(e))
            coupling%wall%solid(c(1), c(2), c(3)) = 0
            coupling%mark(c(1), c(2), c(3)) = from_uncovered
        end do
        call build_walls(air, coupling%wall)
        call index_faces(coupling)
        call size_walls(coupling)
        call settle_covered(air, coupling)
        call list_buried(air, coupling)
        call choose_receivers(air, coupling)
        call collect(air, coupling)
    end subroutine change_hands

    !> Give a cell that the solid left the state of the gas around; what is left over is its donation.
    !>
    !> Its velocity normal to the faces it shared with that gas is that of the solid that left.
    subroutine fill_uncovered(air, coupling, e)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: e !! number of the event
        real(rk) :: w(5), u(5), rest(5), v(3)
        integer :: c(3)
        logical :: normal(3)

        c = cell_at(air%n, coupling%uncovered(e))
        call surroundings(air, coupling, c, w, normal)
        v = coupling%wall%v(:, coupling%wall%index(c(1), c(2), c(3)))
        w(2:4) = merge(v, w(2:4), normal)
        u = air%u(c(1), c(2), c(3), :)
        call fresh_gas(w, air%gamma, u, rest)
        air%u(c(1), c(2), c(3), :) = u
        coupling%donor(e) = coupling%uncovered(e)
        coupling%donation(:, e) = rest
    end subroutine fill_uncovered

    !> Mean state of the nearest cells that were gas and still are; air at rest where there are none.
    subroutine surroundings(air, coupling, c, w, normal)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c(3)
        real(rk), intent(out) :: w(5) !! density, velocity, pressure
        logical, intent(out) :: normal(3) !! directions in which the solid pushed the gas
        real(rk) :: u(5), q(5)
        integer :: m, n, s, to(3)
        logical :: inside

        normal = .true.
        w = 0
        do s = 1, coupling%shells%n
            n = 0
            if (s == 1) normal = .false.
            do m = coupling%shells%first(s), coupling%shells%first(s + 1) - 1
                call neighbour(air%n, coupling%wraps, c, coupling%shells%offset(:, m), to, inside)
                if (.not. inside) cycle
                if (coupling%wall%solid(to(1), to(2), to(3)) == 1) cycle
                if (coupling%mark(to(1), to(2), to(3)) == mark_solid) cycle
                u = air%u(to(1), to(2), to(3), :)
                call to_primitive(u, air%gamma, q)
                w = w + q
                n = n + 1
                if (s == 1) normal = normal .or. coupling%shells%offset(:, m) /= 0
            end do
            if (n > 0) then
                w = w/n
                return
            end if
            normal = .true.
        end do
        w = 0
        w(1) = air%rho_rest
        w(5) = air%p_rest
    end subroutine surroundings

    !> Solid cells that no longer touch gas but have a ledger: donors too, behind the uncovered.
    subroutine list_buried(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: c, n, ijk(3)

        n = 0
        !$omp parallel do schedule(static) private(ijk) reduction(+:n)
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
        !$omp parallel do schedule(dynamic, 16) private(c, n, s) reduction(+:kept)
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
            if (coupling%donor_shell(e) == 0) call add_debt(air, coupling, coupling%donor(e), coupling%donation(:, e))
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
        real(rk) :: sum(5)
        logical :: inside

        if (coupling%n_donors == 0) return
        !$omp parallel do schedule(dynamic, 64) private(e, m, s, ijk, from, sum, inside)
        do c = 1, coupling%wall%n_cells
            if (.not. any(coupling%face_of(:, c) > 0)) cycle
            ijk = coupling%wall%cell(:, c)
            sum = 0
            do s = 1, coupling%shells%n
                do m = coupling%shells%first(s), coupling%shells%first(s + 1) - 1
                    call neighbour(air%n, coupling%wraps, ijk, coupling%shells%offset(:, m), from, inside)
                    if (.not. inside) cycle
                    if (coupling%mark(from(1), from(2), from(3)) <= mark_solid) cycle
                    e = donor_number(coupling, coupling%mark(from(1), from(2), from(3)) == from_uncovered, &
                                     number_of(air%n, from))
                    if (coupling%donor_shell(e) == s) sum = sum + coupling%donation(:, e)
                end do
            end do
            air%u(ijk(1), ijk(2), ijk(3), :) = air%u(ijk(1), ijk(2), ijk(3), :) + sum
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
        allocate (donor(room), donation(5, room))
        if (have > 0) then
            donor(1:have) = coupling%donor
            donation(:, 1:have) = coupling%donation
            deallocate (coupling%donor_shell)
        end if
        call move_alloc(donor, coupling%donor)
        call move_alloc(donation, coupling%donation)
        allocate (coupling%donor_shell(room))
    end subroutine size_donors

    !> Room for what is kept per solid cell and per wall face.
    subroutine size_walls(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer :: n

        n = coupling%wall%n_cells
        if (allocated(coupling%excess)) then
            if (size(coupling%excess) < n) deallocate (coupling%excess)
        end if
        if (.not. allocated(coupling%excess)) allocate (coupling%excess(n + n/4))
        n = coupling%wall%n_faces
        if (allocated(coupling%surface)) then
            if (size(coupling%surface) < n) deallocate (coupling%surface, coupling%force)
        end if
        if (.not. allocated(coupling%surface)) allocate (coupling%surface(n + n/4), coupling%force(n + n/4))
    end subroutine size_walls
end module brz_coupling_events
