! SPDX-License-Identifier: MIT
!> Deferred sources of gas cells: release a part, settle those of covered cells, close the
!> gaps in the list. One loop body is one deferred source. This is flux redistribution, spread over
!> time.
module brz_deferred_source_loop_bodies
    use brz_coupling_box, only: box_t, is_own, place_at
    use brz_kinds, only: int32, int64, int8, rk
    use brz_cell_store_rules, only: release_deferred
    use brz_scheme, only: max_var
    implicit none
    private
    public :: release_deferred_source, settle_deferred_source, move_deferred_source, &
        enter_deferred_source, flag_own

contains

    !> 1 for a deferred source that is not released.
    !@cuf attributes(host,device) &
    pure function some_is_left(n_var, e, deferred) result(remains)
        integer, intent(in) :: n_var, e !! variables, deferred source
        real(rk), intent(in) :: deferred(n_var, *)
        integer :: remains, k

        remains = 0
        do k = 1, n_var
            if (.not. abs(deferred(k, e)) <= 0) remains = 1
        end do
    end function some_is_left

    !> stays(e) = 1 for a deferred source of a cell of this process, else 0.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine flag_own(e, box, cell, stays)
        integer, intent(in) :: e !! deferred sources
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: stays(*)

        stays(e) = 0
        if (is_own(box, cell(e))) stays(e) = 1
    end subroutine flag_own

    !> Release a part of each deferred source; remains(e) = 1 where some is left.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine release_deferred_source(e, box, n_var, cell, u, deferred, remains)
        integer, intent(in) :: e !! deferred sources
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(inout) :: u(*), deferred(n_var, *)
        integer(int32), intent(inout) :: remains(*)
        real(rk) :: q(max_var), rest(max_var)
        integer(int64) :: at
        integer :: k

        at = place_at(box, cell(e))
        q(max_var) = 0
        rest(max_var) = 0
        do k = 1, max_var
            if (k > n_var) cycle
            q(k) = u(at + (k - 1)*box%grid%apart)
            rest(k) = deferred(k, e)
        end do
        call release_deferred(box%floors, q, rest)
        do k = 1, max_var
            if (k > n_var) cycle
            u(at + (k - 1)*box%grid%apart) = q(k)
            deferred(k, e) = rest(k)
        end do
        remains(e) = some_is_left(n_var, e, deferred)
    end subroutine release_deferred_source

    !> A cell that was covered takes its deferred source into its cell store.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine settle_deferred_source(e, box, n_var, cell, solid, u, deferred, remains)
        integer, intent(in) :: e !! deferred sources
        type(box_t), intent(in) :: box
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(in) :: solid(*)
        real(rk), intent(inout) :: u(*), deferred(n_var, *)
        integer(int32), intent(inout) :: remains(*)
        integer(int64) :: at
        integer :: k

        at = place_at(box, cell(e))
        if (solid(at) /= 0) then
            do k = 1, n_var
                u(at + (k - 1)*box%grid%apart) = u(at + (k - 1)*box%grid%apart) + deferred(k, e)
                deferred(k, e) = 0
            end do
        end if
        remains(e) = some_is_left(n_var, e, deferred)
    end subroutine settle_deferred_source

    !> Bring the deferred sources that are not released to another list; `start` holds how many are
    !> before each.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine move_deferred_source(e, n_var, start, cell, deferred, slot, to_cell, &
    to_deferred)
        integer, intent(in) :: e !! deferred sources
        integer, intent(in) :: n_var !! variables
        integer(int32), intent(in) :: start(*), cell(*)
        real(rk), intent(in) :: deferred(n_var, *)
        integer(int32), intent(inout) :: slot(*), to_cell(*)
        real(rk), intent(inout) :: to_deferred(n_var, *)
        integer :: k, m

        m = start(e + 1)
        if (m == start(e)) then
            slot(cell(e)) = 0
            return
        end if
        slot(cell(e)) = m
        to_cell(m) = cell(e)
        do k = 1, n_var
            to_deferred(k, m) = deferred(k, e)
        end do
    end subroutine move_deferred_source

    !> Enter the deferred sources in the map of cells.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine enter_deferred_source(e, cell, slot)
        integer, intent(in) :: e !! deferred sources
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(inout) :: slot(*)

        slot(cell(e)) = e
    end subroutine enter_deferred_source
end module brz_deferred_source_loop_bodies
