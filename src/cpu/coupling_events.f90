! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid: the solid moved, the gas must be accounted for.
!>
!> Everything is a gather over cells in their own order, so the result depends neither on the order
!> of the particles nor on the number of threads; only debts, which are few, are booked one by one.
module brz_coupling_events
    use brz_air_state, only: air_t, cell_gamma
    use brz_air_walls, only: build_walls
    use brz_cell_shells, only: cell_at, neighbour, number_of
    use brz_coupling_bins, only: at_least, fill_bins, find_cells, index_faces, mark_cells, &
                                 move_walls
    use brz_coupling_debts, only: level_ledgers, limit_ledgers, release_debts, settle_covered
    use brz_coupling_donors, only: choose_receivers, collect, list_buried, size_donors
    use brz_coupling_state, only: coupling_t, from_uncovered, mark_solid
    use brz_fresh_rules, only: add_gas, mean_gas, no_gas, surrounding_t
    use brz_kinds, only: rk
    use brz_ledger_rules, only: fresh_gas
    use brz_positivity, only: floors_of
    use brz_scheme, only: max_var, mixture_gamma
    use brz_solid_state, only: solid_t, worth_threads
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
        call level_ledgers(air, coupling)
        call limit_ledgers(air, coupling)
        call release_debts(air, coupling)
        ! the next time step depends on these alone, so that a restart finds the same
        call move_walls(air, solid, coupling)
    end subroutine reclassify

    !> Cells newly covered and newly uncovered, in their order.
    subroutine list_changes(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: i, j, k, change, n_covered, n_uncovered

        n_covered = 0
        n_uncovered = 0
        !$omp parallel do if(size(coupling%mark) >= worth_threads) schedule(static) collapse(2) &
        !$omp private(change) reduction(+:n_covered, n_uncovered)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    change = coupling%mark(i, j, k) - coupling%wall%solid(i, j, k)
                    if (change > 0) n_covered = n_covered + 1
                    if (change < 0) n_uncovered = n_uncovered + 1
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
        !$omp parallel do if(27*coupling%n_uncovered >= worth_threads) schedule(dynamic, 16)
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
        call index_faces(air, coupling)
        call size_walls(coupling)
        call settle_covered(air, coupling)
        call list_buried(air, coupling)
        call choose_receivers(air, coupling)
        call collect(air, coupling)
    end subroutine change_hands

    !> Give a cell that the solid left the state of the gas around; what is left over it gives away.
    subroutine fill_uncovered(air, coupling, e)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: e !! number of the event
        real(rk) :: w(max_var), u(max_var), rest(max_var), follows
        integer :: c(3)

        c = cell_at(air%n, coupling%uncovered(e))
        call surroundings(air, coupling, c, w, follows)
        u(6) = 0
        u(:air%n_var) = air%u(c(1), c(2), c(3), :)
        call fresh_gas(floors_of(.true., air%scheme%gamma, air%rho_rest, air%p_rest), &
                       mixture_gamma(air%scheme, w(6)), w, follows, u, rest)
        air%u(c(1), c(2), c(3), :) = u(:air%n_var)
        coupling%donor(e) = coupling%uncovered(e)
        coupling%donation(:, e) = rest(:air%n_var)
    end subroutine fill_uncovered

    !> Mean state of the nearest cells that were gas and still are; air at rest where there is none.
    !>
    !> Its velocity across the faces to that gas is that of the solid that left. `follows` is the
    !> density of gas that can keep up with the solid over the mean: one for a slow solid, zero
    !> where no gas is near.
    subroutine surroundings(air, coupling, c, w, follows)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c(3)
        real(rk), intent(out) :: w(max_var) !! density, velocity, pressure, fraction of products
        real(rk), intent(out) :: follows
        type(surrounding_t) :: around
        real(rk) :: v(3), u(max_var)
        integer :: m, s, to(3)

        v = coupling%wall%v(:, coupling%wall%index(c(1), c(2), c(3)))
        do s = 1, coupling%shells%n
            call no_gas(s, around)
            do m = coupling%shells%first(s), coupling%shells%first(s + 1) - 1
                if (.not. stays_gas(air, coupling, c, coupling%shells%offset(:, m), to)) cycle
                u(6) = 0
                u(:air%n_var) = air%u(to(1), to(2), to(3), :)
                call add_gas(s, coupling%shells%offset(:, m), &
                             cell_gamma(air, to(1), to(2), to(3)), u, v, around)
            end do
            if (around%n == 0) cycle
            call mean_gas(v, around)
            w = around%w
            follows = around%follows
            return
        end do
        w(1) = air%rho_rest
        w(2:4) = v
        w(5) = air%p_rest
        w(6) = 0
        follows = 0
    end subroutine surroundings

    !> True for a neighbour that was gas and still is.
    logical function stays_gas(air, coupling, c, offset, to)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c(3), offset(3)
        integer, intent(out) :: to(3) !! the neighbour

        call neighbour(air%n, coupling%wraps, c, offset, to, stays_gas)
        if (.not. stays_gas) return
        stays_gas = coupling%wall%solid(to(1), to(2), to(3)) == 0 &
                    .and. coupling%mark(to(1), to(2), to(3)) /= mark_solid
    end function stays_gas

    !> Room for what is kept per solid cell and per wall face.
    subroutine size_walls(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer :: n

        n = coupling%wall%n_cells
        if (allocated(coupling%excess)) then
            if (size(coupling%excess) < n) deallocate (coupling%excess, coupling%ledger)
        end if
        if (.not. allocated(coupling%excess)) then
            allocate (coupling%excess(n + n/4), coupling%ledger(max_var, n + n/4))
        end if
        n = coupling%wall%n_faces
        if (allocated(coupling%surface)) then
            if (size(coupling%surface) < n) &
                deallocate (coupling%surface, coupling%weight, coupling%force, coupling%impedance)
        end if
        if (.not. allocated(coupling%surface)) then
            n = n + n/4
            allocate (coupling%surface(n), coupling%weight(n), coupling%force(n))
            allocate (coupling%impedance(n))
        end if
    end subroutine size_walls
end module brz_coupling_events
