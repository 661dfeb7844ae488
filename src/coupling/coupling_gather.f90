! SPDX-License-Identifier: MIT
!> The coupling of all processes in one, for checkpoints, and back.
module brz_coupling_gather
    use brz_air_grid, only: nodes_along
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_state, only: coupling_t
    use brz_coupling_totals, only: diagnostics_of_all
    use brz_cut_cells, only: cut_before_t, cut_cells_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_message_exchange, only: message_exchange_t, make_room, post, put_numbers, &
        take_numbers, tell_counts
    use brz_ranks, only: ranks_t
    use brz_row_order, only: order_rows
    use brz_scheme, only: max_var
    use brz_particles, only: particles_t
    implicit none
    private
    public :: gather_coupling, keep_before, begin_sharing, share_coupling

contains

    !> What a checkpoint holds of the coupling but for what keep_before adds, in the first process.
    !> All must call.
    subroutine gather_coupling(coupling, all)
        type(coupling_t), intent(in) :: coupling
        type(coupling_t), intent(inout) :: all

        all%present = coupling%present
        all%n_var = coupling%n_var
        all%dt_before = coupling%dt_before
        associate (ranks => coupling%ranks)
            call diagnostics_of_all(ranks, coupling, all%diagnostics)
            if (coupling%wall%cells%present) call gather_cut_cells(ranks, coupling%wall%cells, &
                all%wall%cells)
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

    !> Rows of all processes in the first one, in the order of their first numbers.
    subroutine gather_rows(ranks, own, all)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: own(:, :) !! (numbers, rows)
        real(dp), allocatable, intent(out) :: all(:, :)
        integer(int64) :: out(1, 0:ranks%n - 1), in(1, 0:ranks%n - 1)
        real(dp), allocatable :: there(:, :)
        integer, allocatable :: order(:)
        type(message_exchange_t) :: exchange
        integer :: n, r

        out = 0
        out(1, 0) = size(own, 2)
        call tell_counts(ranks, out, in)
        n = size(own, 1)
        call make_room(ranks, 8*n*out(1, :), 8*n*in(1, :), exchange)
        call put_numbers(exchange, 0, own)
        call post(ranks, exchange)
        allocate (there(n, sum(in)))
        n = 0
        do r = 0, ranks%n - 1
            call take_numbers(exchange, r, there(:, n + 1:n + int(in(1, r))))
            n = n + int(in(1, r))
        end do
        allocate (order(n))
        call order_rows(there(1:1, :), order)
        all = there(:, order)
    end subroutine gather_rows

    !> All cut cells, in the first process.
    subroutine gather_cut_cells(ranks, cells, all)
        type(ranks_t), intent(in) :: ranks
        type(cut_cells_t), intent(in) :: cells
        type(cut_cells_t), intent(inout) :: all
        real(dp) :: own(max_var + 5, cells%n)
        real(dp), allocatable :: there(:, :)
        integer :: high(3), ijk(3), n, s

        n = 0
        associate (nodes => cells%nodes)
            high = nodes%own(:, 2)
            ! with the nodes at the end of the grid
            where (nodes%before + high == nodes%whole) &
                high = nodes_along(nodes%whole, nodes%wraps) - nodes%before
            do s = 1, cells%n
                ijk = cell_at(nodes%n, cells%cell(s))
                if (any(ijk < nodes%own(:, 1) .or. ijk > high)) cycle
                n = n + 1
                own(:4, n) = [real(in_grid(s), dp), real(in_grid(cells%master(s)), dp), &
                              real(cells%volume(s), dp), real(cells%shut(s), dp)]
                own(5:, n) = cells%kept(:, s)
            end do
        end associate
        call gather_rows(ranks, own(:, :n), there)
        all%present = .true.
        all%n = size(there, 2)
        all%cell = nint(there(1, :), int32)
        all%master = places_of(nint(there(2, :), int32), all%cell)
        all%volume = real(there(3, :), rk)
        all%shut = nint(there(4, :), int32)
        all%kept = real(there(5:, :), rk)

    contains

        !> Number of an entry in the nodes of the grid.
        pure integer(int32) function in_grid(entry)
            integer(int32), intent(in) :: entry

            associate (nodes => cells%nodes)
                in_grid = number_of(nodes_along(nodes%whole, nodes%wraps), &
                                    nodes%before + cell_at(nodes%n, cells%cell(entry)))
            end associate
        end function in_grid
    end subroutine gather_cut_cells

    !> Places of numbers in a list that ascends; 0: not there.
    pure function places_of(numbers, list) result(places)
        integer(int32), intent(in) :: numbers(:), list(:)
        integer(int32) :: places(size(numbers))
        integer :: high, low, middle, t

        do t = 1, size(numbers)
            places(t) = 0
            low = 1
            high = size(list)
            do while (low <= high)
                middle = (low + high)/2
                if (list(middle) == numbers(t)) places(t) = middle
                if (list(middle) >= numbers(t)) high = middle - 1
                if (list(middle) <= numbers(t)) low = middle + 1
            end do
        end do
    end function places_of

    !> Room for what a checkpoint holds of the coupling, while every process has all particles.
    subroutine begin_sharing(coupling, solid, all)
        type(coupling_t), intent(in) :: coupling
        class(particles_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: all

        all%present = coupling%present
        all%n_var = coupling%n_var
        all%wall%cells%present = coupling%wall%cells%present
        if (all%present) allocate (all%v_before(3, solid%n), source=0.0_rk)
    end subroutine begin_sharing

    !> Keep what this process needs of it. Every process has all particles; the first one keeps the
    !> diagnostics.
    subroutine share_coupling(all, solid, coupling)
        type(coupling_t), intent(in) :: all
        class(particles_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: i

        do i = 1, solid%n
            solid%v_before(:, i) = all%v_before(:, solid%id(i))
        end do
        coupling%dt_before = all%dt_before
        if (solid%ranks%rank == 0) coupling%diagnostics = all%diagnostics
        if (all%wall%cells%present) call share_cut_cells(all%wall%cells%before, coupling%wall%cells)
    end subroutine share_coupling

    !> Keep the cut cells that this process sees.
    subroutine share_cut_cells(all, cells)
        type(cut_before_t), intent(in) :: all
        type(cut_cells_t), intent(inout) :: cells
        integer :: e, ijk(3), n, whole(3)
        integer(int32) :: place(all%n) !! of an entry among those that this process sees, 0: none
        integer(int32), allocatable :: seen(:)

        place = 0
        n = 0
        whole = nodes_along(cells%nodes%whole, cells%nodes%wraps) ! nodes of the grid
        associate (nodes => cells%nodes, held => cells%before)
            do e = 1, all%n
                ijk = cell_at(whole, all%cell(e)) - nodes%before
                if (any(ijk < 1 .or. ijk > nodes%n)) cycle
                n = n + 1
                place(e) = n
            end do
            seen = pack([(e, e=1, all%n)], place > 0)
            held%n = n
            held%cell = [(number_of(nodes%n, cell_at(whole, all%cell(seen(e))) - nodes%before), &
                          e=1, n)]
            held%volume = all%volume(seen)
            held%kept = all%kept(:, seen)
            held%shut = all%shut(seen)
            held%master = place(all%master(seen))
            where (held%master == 0) held%master = [(e, e=1, n)]
        end associate
        cells%resumes = .true.
    end subroutine share_cut_cells
end module brz_coupling_gather
