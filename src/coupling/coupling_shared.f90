! SPDX-License-Identifier: MIT
!> What several processes tell each other about the walls: the impulses of wall faces, and debts.
module brz_coupling_shared
    use brz_air_state, only: air_t
    use brz_boxes, only: box_t, widened
    use brz_cell_shells, only: cell_at, number_of
    use brz_coupling_state, only: coupling_t
    use brz_debt_steps, only: keep_own, size_debts
    use brz_kinds, only: dp, int64, rk
    use brz_mail, only: incoming, make_room, outgoing, post, tell_counts
    use brz_solid_part, only: parcels_t
    implicit none
    private
    public :: list_shared_faces, share_impulses, share_debts

contains

    !> List the faces whose gas is in the box of one process and whose columns may reach into that
    !> of another, in the order of the grid.
    subroutine list_shared_faces(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        type(box_t) :: near(0:air%part%ranks%n - 1) !! boxes and what loads them
        integer :: r, layers

        layers = coupling%box%layers + 2
        do r = 0, ubound(near, 1)
            near(r) = widened(air%part%boxes(r), [layers, layers, layers])
        end do
        associate (boxes => air%part%boxes, me => air%part%ranks%rank, part => coupling%part)
            call list_faces(spread(boxes(me), 1, size(near)), near, part%faces_out)
            call list_faces(boxes, spread(near(me), 1, size(near)), part%faces_in)
        end associate

    contains

        !> Faces with gas in a box and near another, for all processes but this one.
        subroutine list_faces(has, wants, parcels)
            type(box_t), intent(in) :: has(0:), wants(0:)
            type(parcels_t), intent(inout) :: parcels
            integer :: f, n, round, gas(3)

            if (.not. allocated(parcels%first)) allocate (parcels%first(0:size(has)))
            if (.not. allocated(parcels%place)) allocate (parcels%place(0))
            do round = 1, 2 ! count, then list
                n = 0
                do r = 0, ubound(has, 1)
                    parcels%first(r) = n + 1
                    if (r == air%part%ranks%rank) cycle
                    do f = 1, coupling%wall%n_faces
                        gas = air%before + coupling%wall%face(1:3, f)
                        if (any(gas < has(r)%lo .or. gas > has(r)%hi)) cycle
                        if (any(gas < wants(r)%lo .or. gas > wants(r)%hi)) cycle
                        n = n + 1
                        if (round == 2) parcels%place(n) = f
                    end do
                end do
                parcels%first(size(has)) = n + 1
                if (round == 2 .or. size(parcels%place) >= n) cycle
                deallocate (parcels%place)
                allocate (parcels%place(n + n/4))
            end do
        end subroutine list_faces
    end subroutine list_shared_faces

    !> Give every process the impulses of the faces whose columns may reach into its box. Both sides
    !> list them in the order of the grid.
    subroutine share_impulses(coupling)
        type(coupling_t), intent(inout), target :: coupling
        integer(int64), dimension(0:ubound(coupling%part%boxes, 1)) :: out, in
        real(dp), pointer, contiguous :: numbers(:, :)
        integer :: k, r

        associate (ranks => coupling%guests%ranks, out_faces => coupling%part%faces_out, &
                   in_faces => coupling%part%faces_in, &
                   mail => coupling%part%face_mail, impulse => coupling%wall%impulse)
            out = 8*(out_faces%first(1:ranks%n) - out_faces%first(0:ranks%n - 1))
            in = 8*(in_faces%first(1:ranks%n) - in_faces%first(0:ranks%n - 1))
            call make_room(ranks, out, in, mail)
            do r = 0, ranks%n - 1
                numbers => outgoing(mail, r, 1)
                do k = 1, size(numbers)
                    numbers(1, k) = impulse(out_faces%place(out_faces%first(r) - 1 + k))
                end do
            end do
            call post(ranks, mail)
            do r = 0, ranks%n - 1
                numbers => incoming(mail, r, 1)
                do k = 1, size(numbers)
                    impulse(in_faces%place(in_faces%first(r) - 1 + k)) = real(numbers(1, k), rk)
                end do
            end do
        end associate
    end subroutine share_impulses

    !> Renew the debts of other processes that this one sees.
    subroutine share_debts(coupling)
        type(coupling_t), intent(inout), target :: coupling
        integer(int64), dimension(1, 0:ubound(coupling%part%boxes, 1)) :: out, in
        integer :: e, r

        associate (ranks => coupling%guests%ranks, part => coupling%part, m => coupling%n_var + 1)
            call keep_own(coupling)
            out = 0
            do r = 0, ranks%n - 1
                if (r == ranks%rank) cycle
                do e = 1, coupling%n_debts
                    if (is_seen(coupling, part%windows(r), e)) out(1, r) = out(1, r) + 1
                end do
            end do
            call tell_counts(ranks, out, in)
            call make_room(ranks, 8*m*out(1, :), 8*m*in(1, :), part%debt_mail)
            do r = 0, ranks%n - 1
                if (out(1, r) > 0) &
                    call write_debts(coupling, part%windows(r), outgoing(part%debt_mail, r, m))
            end do
            call post(ranks, part%debt_mail)
            do r = 0, ranks%n - 1
                call read_debts(coupling, incoming(part%debt_mail, r, m))
            end do
        end associate
    end subroutine share_debts

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
    pure subroutine write_debts(coupling, window, numbers)
        type(coupling_t), intent(in) :: coupling
        type(box_t), intent(in) :: window
        real(dp), intent(inout) :: numbers(:, :) !! (1 + n_var, debts) number of the cell, debt
        integer :: e, k

        k = 0
        do e = 1, coupling%n_debts
            if (.not. is_seen(coupling, window, e)) cycle
            k = k + 1
            numbers(1, k) = number_of(coupling%box%whole, cell_of_debt(coupling, e))
            numbers(2:, k) = coupling%debt(:, e)
        end do
    end subroutine write_debts

    !> Add the debts that came from a process to the list.
    subroutine read_debts(coupling, numbers)
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: numbers(:, :) !! (1 + n_var, debts)
        integer :: e, k, ijk(3)

        if (size(numbers, 2) == 0) return
        call size_debts(coupling, coupling%n_debts + size(numbers, 2))
        do k = 1, size(numbers, 2)
            e = coupling%n_debts + k
            ijk = cell_at(coupling%box%whole, nint(numbers(1, k))) - coupling%box%before
            coupling%debt_cell(e) = number_of(coupling%box%n, ijk)
            coupling%slot(ijk(1), ijk(2), ijk(3)) = e
            coupling%debt(:, e) = real(numbers(2:, k), rk)
        end do
        coupling%n_debts = coupling%n_debts + size(numbers, 2)
    end subroutine read_debts
end module brz_coupling_shared
