! SPDX-License-Identifier: MIT
!> Deferred sources of gas cells, called debts: pay a part, settle those of covered cells, close the
!> gaps in the list. One item is one debt. This is flux redistribution, spread over time.
module brz_debt_items
    use brz_coupling_box, only: box_t, is_own, place_at
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_cell_store_rules, only: release_debt
    use brz_scheme, only: max_var
    implicit none
    private
    public :: pay_debt, settle_debt, move_debt, enter_debt, total_debt, flag_own

contains

    !> 1 for a debt that is not paid.
    !@cuf attributes(host,device) &
    pure function is_owed(n_var, e, debt) result(owed)
        integer, intent(in) :: n_var, e !! variables, debt
        real(rk), intent(in) :: debt(n_var, *)
        integer :: owed, k

        owed = 0
        do k = 1, n_var
            if (.not. abs(debt(k, e)) <= 0) owed = 1
        end do
    end function is_owed

    !> stays(e) = 1 for a debt of a cell of this process, else 0.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine flag_own(e, box, cell, stays)
        integer, intent(in) :: e !! debts
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: stays(*)

        stays(e) = 0
        if (is_own(box, cell(e))) stays(e) = 1
    end subroutine flag_own

    !> Pay a part of each debt; owed(e) = 1 where some is left.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine pay_debt(e, box, n_var, cell, u, debt, owed)
        integer, intent(in) :: e !! debts
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(inout) :: u(*), debt(n_var, *)
        integer(int32), intent(inout) :: owed(*)
        real(rk) :: q(max_var), rest(max_var)
        integer(int64) :: at
        integer :: k

        at = place_at(box, cell(e))
        q(max_var) = 0
        rest(max_var) = 0
        do k = 1, max_var
            if (k > n_var) cycle
            q(k) = u(at + (k - 1)*box%grid%apart)
            rest(k) = debt(k, e)
        end do
        call release_debt(box%floors, q, rest)
        do k = 1, max_var
            if (k > n_var) cycle
            u(at + (k - 1)*box%grid%apart) = q(k)
            debt(k, e) = rest(k)
        end do
        owed(e) = is_owed(n_var, e, debt)
    end subroutine pay_debt

    !> A cell that was covered takes its debt into its cell store.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine settle_debt(e, box, n_var, cell, solid, u, debt, owed)
        integer, intent(in) :: e !! debts
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(in) :: solid(*)
        real(rk), intent(inout) :: u(*), debt(n_var, *)
        integer(int32), intent(inout) :: owed(*)
        integer(int64) :: at
        integer :: k

        at = place_at(box, cell(e))
        if (solid(at) /= 0) then
            do k = 1, n_var
                u(at + (k - 1)*box%grid%apart) = u(at + (k - 1)*box%grid%apart) + debt(k, e)
                debt(k, e) = 0
            end do
        end if
        owed(e) = is_owed(n_var, e, debt)
    end subroutine settle_debt

    !> Bring the debts that are not paid to another list; `start` holds how many are before each.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine move_debt(e, n_var, start, cell, debt, slot, to_cell, to_debt)
        integer, intent(in) :: e !! debts
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: start(*), cell(*)
        real(rk), intent(in) :: debt(n_var, *)
        integer(int32), intent(inout) :: slot(*), to_cell(*)
        real(rk), intent(inout) :: to_debt(n_var, *)
        integer :: k, m

        m = start(e + 1)
        if (m == start(e)) then
            slot(cell(e)) = 0
            return
        end if
        slot(cell(e)) = m
        to_cell(m) = cell(e)
        do k = 1, n_var
            to_debt(k, m) = debt(k, e)
        end do
    end subroutine move_debt

    !> Enter the debts in the map of cells.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine enter_debt(e, cell, slot)
        integer, intent(in) :: e !! debts
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: slot(*)

        slot(cell(e)) = e
    end subroutine enter_debt

    !> Sum of the debts of this process.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine total_debt(e, box, n_var, cell, debt, total)
        integer, intent(in) :: e !! debts
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(in) :: debt(n_var, *)
        real(dp), intent(inout) :: total(6) !@exact per cell volume
        integer :: k

        if (.not. is_own(box, cell(e))) return
        do k = 1, 6
            if (k <= n_var) total(k) = total(k) + debt(k, e)
        end do
    end subroutine total_debt
end module brz_debt_items
