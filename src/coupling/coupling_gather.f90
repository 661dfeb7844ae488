! SPDX-License-Identifier: MIT
!> The coupling of all processes in one, for checkpoints, and back.
module brz_coupling_gather
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_box, only: is_own
    use brz_coupling_state, only: coupling_t
    use brz_coupling_totals, only: diagnostics_of_all
    use brz_deferred_source_driver, only: size_deferred_sources
    use brz_errors, only: error_t
    use brz_kinds, only: dp, int64, rk
    use brz_message_exchange, only: message_exchange_t, make_room, post, put_numbers, &
        take_numbers, tell_counts
    use brz_ranks, only: ranks_t
    use brz_row_order, only: order_rows
    use brz_particles, only: particles_t
    implicit none
    private
    public :: gather_coupling, keep_before, begin_sharing, share_coupling

contains

    !> What a checkpoint holds of the coupling but for what keep_before adds, in the first process;
    !> deferred sources in the order of the grid. All must call.
    subroutine gather_coupling(coupling, all)
        type(coupling_t), intent(in) :: coupling
        type(coupling_t), intent(inout) :: all

        all%present = coupling%present
        all%n_var = coupling%n_var
        all%dt_before = coupling%dt_before
        associate (ranks => coupling%ranks)
            call diagnostics_of_all(ranks, coupling, all%diagnostics)
            call gather_deferred_sources(ranks, coupling, all)
        end associate
    end subroutine gather_coupling

    !> Velocities before the last step, of all particles.
    subroutine keep_before(whole, all)
        class(particles_t), intent(in) :: whole !! all particles, in the first process
        type(coupling_t), intent(inout) :: all
        integer :: i

        allocate (all%v_before(3, whole%n))
        do i = 1, whole%n
            all%v_before(:, whole%id(i)) = whole%v_before(:, i)
        end do
    end subroutine keep_before

    !> All deferred sources, in the first process.
    subroutine gather_deferred_sources(ranks, coupling, all)
        type(ranks_t), intent(in) :: ranks
        type(coupling_t), intent(in) :: coupling
        type(coupling_t), intent(inout) :: all
        integer(int64) :: out(1, 0:ranks%n - 1), in(1, 0:ranks%n - 1)
        real(dp) :: own(coupling%n_var + 1, coupling%n_deferred)
        real(dp), allocatable :: there(:, :)
        integer, allocatable :: order(:)
        type(message_exchange_t) :: exchange
        type(error_t) :: none !! nothing fails on the host
        integer :: e, n, r, rows

        rows = coupling%n_var + 1
        n = 0
        do e = 1, coupling%n_deferred
            if (.not. is_own(coupling%box, coupling%deferred_cell(e))) cycle
            n = n + 1
            own(1, n) = number_of(coupling%box%whole, coupling%box%before &
                                  + cell_at(coupling%box%n, coupling%deferred_cell(e)))
            own(2:, n) = coupling%deferred(:, e)
        end do
        out = 0
        out(1, 0) = n
        call tell_counts(ranks, out, in)
        call make_room(ranks, 8*rows*out(1, :), 8*rows*in(1, :), exchange)
        call put_numbers(exchange, 0, own(:, :n))
        call post(ranks, exchange)
        allocate (there(rows, sum(in)))
        n = 0
        do r = 0, ranks%n - 1
            call take_numbers(exchange, r, there(:, n + 1:n + int(in(1, r))))
            n = n + int(in(1, r))
        end do
        allocate (order(n))
        call order_rows(there(1:1, :), order)
        call size_deferred_sources(all, n, none)
        all%n_deferred = n
        all%deferred_cell(:n) = nint(there(1, order))
        all%deferred(:, :n) = real(there(2:, order), rk)
    end subroutine gather_deferred_sources

    !> Room for what a checkpoint holds of the coupling, while every process has all particles.
    subroutine begin_sharing(coupling, solid, all)
        type(coupling_t), intent(in) :: coupling
        class(particles_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: all

        all%present = coupling%present
        all%n_var = coupling%n_var
        if (all%present) allocate (all%v_before(3, solid%n), source=0.0_rk)
    end subroutine begin_sharing

    !> Keep what this process needs of it. Every process has all particles; the first one keeps the
    !> diagnostics.
    subroutine share_coupling(all, solid, coupling)
        type(coupling_t), intent(in) :: all
        class(particles_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        type(error_t) :: none
        integer :: e, i, ijk(3)

        do i = 1, solid%n
            solid%v_before(:, i) = all%v_before(:, solid%id(i))
        end do
        coupling%dt_before = all%dt_before
        coupling%n_deferred = 0
        call size_deferred_sources(coupling, all%n_deferred, none)
        do e = 1, all%n_deferred
            ijk = cell_at(coupling%box%whole, all%deferred_cell(e)) - coupling%box%before
            if (any(ijk < 1 .or. ijk > coupling%box%n)) cycle
            coupling%n_deferred = coupling%n_deferred + 1
            coupling%deferred_cell(coupling%n_deferred) = number_of(coupling%box%n, ijk)
            coupling%deferred(:, coupling%n_deferred) = all%deferred(:, e)
        end do
        if (solid%ranks%rank == 0) coupling%diagnostics = all%diagnostics
    end subroutine share_coupling
end module brz_coupling_gather
