! SPDX-License-Identifier: MIT
!> What several processes tell each other about the walls: the impulses of wall faces, and debts.
module brz_coupling_shared
    use brz_air_state, only: air_t
    use brz_boxes, only: box_t, widened
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_box, only: is_own
    use brz_coupling_debts, only: drop_debts, size_debts
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_mail, only: make_room, post, put_numbers, take_numbers, tell_counts
    use brz_ranks, only: ranks_t
    implicit none
    private
    public :: share_impulses, share_debts

contains

    !> Give every process the impulses of the faces whose columns may reach into its box. Both sides
    !> list them in the order of the grid.
    subroutine share_impulses(coupling, ranks)
        type(coupling_t), intent(inout) :: coupling
        type(ranks_t), intent(in) :: ranks
        integer(int64) :: out(0:ranks%n - 1), in(0:ranks%n - 1)
        real(dp), allocatable :: numbers(:, :)
        integer :: r

        associate (part => coupling%part, impulse => coupling%wall%impulse)
            do r = 0, ranks%n - 1
                out(r) = 8*(part%faces_out%first(r + 1) - part%faces_out%first(r))
                in(r) = 8*(part%faces_in%first(r + 1) - part%faces_in%first(r))
            end do
            call make_room(ranks, out, in, part%face_mail)
            allocate (numbers(1, max(maxval(out), maxval(in))/8))
            do r = 0, ranks%n - 1
                associate (i => part%faces_out%first(r), j => part%faces_out%first(r + 1) - 1)
                    numbers(1, :j - i + 1) = impulse(part%faces_out%place(i:j))
                    call put_numbers(part%face_mail, r, numbers(:, :j - i + 1))
                end associate
            end do
            call post(ranks, part%face_mail)
            do r = 0, ranks%n - 1
                associate (i => part%faces_in%first(r), j => part%faces_in%first(r + 1) - 1)
                    call take_numbers(part%face_mail, r, numbers(:, :j - i + 1))
                    impulse(part%faces_in%place(i:j)) = real(numbers(1, :j - i + 1), rk)
                end associate
            end do
        end associate
    end subroutine share_impulses

    !> Renew the debts of other processes that this one sees.
    subroutine share_debts(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer(int64) :: out(1, 0:air%part%ranks%n - 1), in(1, 0:air%part%ranks%n - 1)
        integer :: e, r

        associate (ranks => air%part%ranks, part => coupling%part, m => coupling%n_var + 1)
            call keep_own(coupling)
            do r = 0, ranks%n - 1
                out(1, r) = 0
                if (r == ranks%rank) cycle
                out(1, r) = count([(is_seen(coupling, part%windows(r), e), e=1, coupling%n_debts)])
            end do
            call tell_counts(ranks, out, in)
            call make_room(ranks, 8*m*out(1, :), 8*m*in(1, :), part%debt_mail)
            do r = 0, ranks%n - 1
                call write_debts(coupling, part%windows(r), int(out(1, r)), r)
            end do
            call post(ranks, part%debt_mail)
            do r = 0, ranks%n - 1
                call read_debts(coupling, int(in(1, r)), r)
            end do
        end associate
    end subroutine share_debts

    !> Drop the debts of cells of others.
    subroutine keep_own(coupling)
        type(coupling_t), intent(inout) :: coupling
        integer(int32) :: stays(coupling%n_debts)
        integer :: e

        if (coupling%n_debts == 0) return
        do e = 1, coupling%n_debts
            stays(e) = merge(1, 0, is_own(coupling%box, coupling%debt_cell(e)))
        end do
        call drop_debts(coupling, stays)
    end subroutine keep_own

    !> Cell of the grid that has a debt.
    pure function cell_of_debt(coupling, e) result(ijk)
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: e
        integer :: ijk(3)

        ijk = coupling%box%before + cell_at(coupling%box%n, coupling%debt_cell(e))
    end function cell_of_debt

    !> True for a debt in a window.
    pure logical function is_seen(coupling, window, e)
        type(coupling_t), intent(in) :: coupling
        type(box_t), intent(in) :: window
        integer, intent(in) :: e
        integer :: ijk(3)

        ijk = cell_of_debt(coupling, e)
        is_seen = all(ijk >= window%lo .and. ijk <= window%hi)
    end function is_seen

    !> Put the debts in a window into the parcel for its process.
    subroutine write_debts(coupling, window, n, r)
        type(coupling_t), intent(inout) :: coupling
        type(box_t), intent(in) :: window
        integer, intent(in) :: n, r !! their number, process
        real(dp) :: numbers(coupling%n_var + 1, n)
        integer :: e, k

        if (n == 0) return
        k = 0
        do e = 1, coupling%n_debts
            if (.not. is_seen(coupling, window, e)) cycle
            k = k + 1
            numbers(1, k) = number_of(coupling%box%whole, cell_of_debt(coupling, e))
            numbers(2:, k) = coupling%debt(:, e)
        end do
        call put_numbers(coupling%part%debt_mail, r, numbers)
    end subroutine write_debts

    !> Add the debts that came from a process to the list.
    subroutine read_debts(coupling, n, r)
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: n, r !! their number, process
        real(dp) :: numbers(coupling%n_var + 1, n)
        integer :: e, k, ijk(3)

        if (n == 0) return
        call take_numbers(coupling%part%debt_mail, r, numbers)
        call size_debts(coupling, coupling%n_debts + n)
        do k = 1, n
            e = coupling%n_debts + k
            ijk = cell_at(coupling%box%whole, nint(numbers(1, k))) - coupling%box%before
            coupling%debt_cell(e) = number_of(coupling%box%n, ijk)
            coupling%slot(ijk(1), ijk(2), ijk(3)) = e
            coupling%debt(:, e) = real(numbers(2:, k), rk)
        end do
        coupling%n_debts = coupling%n_debts + n
    end subroutine read_debts
end module brz_coupling_shared
