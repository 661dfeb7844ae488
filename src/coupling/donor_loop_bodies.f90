! SPDX-License-Identifier: MIT
!> Cells that the solid has left are filled with gas; what is over goes to the cell stores nearby.
!>
!> Donors are the cells left, then solid cells that no longer touch gas but have a cell store. A
!> donor looks for receivers, then each receiver gathers from the donors around it, so that nothing
!> depends on the order of the loop bodies.
module brz_donor_loop_bodies
    use brz_air_grid, only: place_of
    use brz_cell_shells, only: cell_at, neighbour, next_along, number_of, shells_t
    use brz_coupling_box, only: box_t, is_buried, is_gas, is_left, is_own, place_at, &
                                place_beside
    use brz_cleared_cell_rules, only: add_gas, mean_gas, no_gas, surrounding_t
    use brz_kinds, only: int32, int64, int8, rk
    use brz_cell_store_loop_bodies, only: faces_at
    use brz_cell_store_rules, only: gas_of_cleared
    use brz_scheme, only: max_var, mixture_gamma, scheme_t
    implicit none
    private
    public :: fill_left, flag_buried, list_buried, choose_shell, defer_donation, collect_shares

contains

    !> Give the cells that the solid left the state of the gas around; the rest is what they donate.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 16)
    !@cuf attributes(host,device) &
    pure subroutine fill_left(e, box, scheme, rho_rest, p_rest, shells, cell, mark, solid, &
                              cell_of, ends, v, u, donor, donation)
        integer, intent(in) :: e !! cells left
        type(box_t), intent(in) :: box
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: rho_rest, p_rest !! undisturbed air
        type(shells_t), intent(in) :: shells !@buffer
        integer(int32), intent(in) :: cell(*)
        integer(int8), intent(in) :: mark(*), solid(*)
        integer, intent(in) :: cell_of(*)
        integer(int32), intent(in) :: ends(*)
        real(rk), intent(in) :: v(3, *)
        real(rk), intent(inout) :: u(*)
        integer(int32), intent(inout) :: donor(*)
        real(rk), intent(inout) :: donation(max_var, *)
        type(surrounding_t) :: around
        real(rk) :: q(max_var), rest(max_var), speed(3)
        integer(int64) :: at
        integer :: k

        at = place_at(box, cell(e))
        speed = velocity_before(box, cell(e), at, cell_of, ends, v)
        around = look_around(box, scheme, shells, cell(e), speed, mark, solid, u)
        if (around%n == 0) then
            around%w(1) = rho_rest
            do k = 1, 3
                around%w(1 + k) = speed(k)
            end do
            around%w(5) = p_rest
            around%w(6) = 0
            around%follows = 0
        end if
        q(max_var) = 0
        do k = 1, max_var
            if (k <= box%n_var) q(k) = u(at + (k - 1)*box%grid%apart)
        end do
        call gas_of_cleared(box%floors, mixture_gamma(scheme, around%w(6)), around%w, &
                       around%follows, q, rest)
        donor(e) = cell(e)
        do k = 1, max_var
            if (k > box%n_var) cycle
            u(at + (k - 1)*box%grid%apart) = q(k)
            donation(k, e) = rest(k)
        end do
    end subroutine fill_left

    !> Velocity of the solid in a cell, of that on all sides where it was enclosed and held none.
    !@cuf attributes(host,device) &
    pure function velocity_before(box, cell, at, cell_of, ends, v) result(speed)
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell
        integer(int64), intent(in) :: at !! its place
        integer, intent(in) :: cell_of(*)
        integer(int32), intent(in) :: ends(*) !! of the particles of each solid cell
        real(rk), intent(in) :: v(3, *)
        real(rk) :: speed(3)
        integer(int32) :: next
        integer :: c, d, k, n, side

        c = cell_of(at)
        do k = 1, 3
            speed(k) = v(k, c)
        end do
        if (ends(c + 1) > ends(c)) return
        n = 0
        do d = 1, 3
            if (box%whole(d) == 1) cycle
            do side = -1, 1, 2
                next = next_along(box%n, box%wraps, cell, d, side)
                if (next == 0) cycle
                n = n + 1
                c = cell_of(place_at(box, next))
                do k = 1, 3
                    speed(k) = speed(k) + v(k, c)
                end do
            end do
        end do
        do k = 1, 3
            speed(k) = speed(k)/max(n, 1)
        end do
    end function velocity_before

    !> Means over the nearest cells that were gas and still are; around%n = 0 where there is none.
    !>
    !> The velocity across the faces to that gas is that of the solid that left. `follows` is the
    !> density of gas that can keep up with the solid over the mean: one for a slow solid.
    !@cuf attributes(host,device) &
    pure function look_around(box, scheme, shells, cell, v, mark, solid, u) result(around)
        type(box_t), intent(in) :: box
        type(scheme_t), intent(in) :: scheme
        type(shells_t), intent(in) :: shells
        integer(int32), intent(in) :: cell
        real(rk), intent(in) :: v(3) !! of the solid that left [m/s]
        integer(int8), intent(in) :: mark(*), solid(*)
        real(rk), intent(in) :: u(*)
        type(surrounding_t) :: around
        real(rk) :: gamma, q(max_var)
        integer(int64) :: at
        integer :: ijk(3), k, m, s, offset(3), to(3)
        logical :: inside

        ijk = cell_at(box%n, cell)
        call no_gas(1, around)
        do s = 1, shells%n
            call no_gas(s, around)
            do m = shells%first(s), shells%first(s + 1) - 1
                do k = 1, 3
                    offset(k) = shells%offset(k, m)
                end do
                call neighbour(box%n, box%wraps, ijk, offset, to, inside)
                if (.not. inside) cycle
                at = place_of(box%grid, to(1), to(2), to(3))
                if (solid(at) /= 0) cycle
                if (mark(number_of(box%n, to)) /= is_gas) cycle
                q(max_var) = 0
                do k = 1, max_var
                    if (k <= box%n_var) q(k) = u(at + (k - 1)*box%grid%apart)
                end do
                gamma = scheme%gamma
                if (scheme%mixture) gamma = mixture_gamma(scheme, q(max_var)/q(1))
                call add_gas(s, offset, gamma, q, v, around)
            end do
            if (around%n == 0) cycle
            call mean_gas(v, around)
            return
        end do
    end function look_around

    !> flag(c) = 1 for solid cells that no longer touch gas but have a cell store.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine flag_buried(c, box, cell, face_of, u, flag)
        integer, intent(in) :: c !! solid cells
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*)
        integer, intent(in) :: face_of(6, *)
        real(rk), intent(in) :: u(*)
        integer(int32), intent(inout) :: flag(*)
        integer(int64) :: at
        integer :: k

        flag(c) = 0
        if (faces_at(c, face_of) > 0) return
        at = place_at(box, cell(c))
        do k = 1, box%n_var
            if (.not. abs(u(at + (k - 1)*box%grid%apart)) <= 0) flag(c) = 1
        end do
    end subroutine flag_buried

    !> List them behind the cells left; `start` holds how many are before each solid cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine list_buried(c, left, box, cell, start, u, mark, donor, donation)
        integer, intent(in) :: c !! solid cells
        integer, intent(in) :: left !! cells that the solid left
        type(box_t), intent(in) :: box
        integer(int32), intent(in) :: cell(*), start(*)
        real(rk), intent(in) :: u(*)
        integer(int8), intent(inout) :: mark(*)
        integer(int32), intent(inout) :: donor(*)
        real(rk), intent(inout) :: donation(max_var, *)
        integer(int64) :: at
        integer :: e, k

        if (start(c + 1) == start(c)) return
        e = left + start(c + 1)
        at = place_at(box, cell(c))
        donor(e) = cell(c)
        mark(cell(c)) = is_buried
        do k = 1, box%n_var
            donation(k, e) = u(at + (k - 1)*box%grid%apart)
        end do
    end subroutine list_buried

    !> Nearest shell with solid cells that touch gas, and the share of each of them.
    !>
    !> Without any within reach a cell that was left defers the gas itself, and a buried one keeps
    !> it.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 16)
    !@cuf attributes(host,device) &
    pure subroutine choose_shell(e, left, box, shells, donor, solid, cell_of, face_of, u, shell, &
                                 donation, flag, kept)
        integer, intent(in) :: e !! donors
        integer, intent(in) :: left !! of them, cells that the solid left
        type(box_t), intent(in) :: box
        type(shells_t), intent(in) :: shells !@buffer
        integer(int32), intent(in) :: donor(*)
        integer(int8), intent(in) :: solid(*)
        integer, intent(in) :: cell_of(*), face_of(6, *)
        real(rk), intent(inout) :: u(*)
        integer(int32), intent(inout) :: shell(*) !! 0: none within reach
        real(rk), intent(inout) :: donation(max_var, *)
        integer(int32), intent(inout) :: flag(*) !! 1: a cell left that defers it
        integer, intent(inout) :: kept !@count buried cell stores that found no taker
        integer(int64) :: at
        integer :: k, m, s, takers, ijk(3), offset(3)

        ijk = cell_at(box%n, donor(e))
        takers = 0
        s = 0
        do while (takers == 0 .and. s < shells%n)
            s = s + 1
            do m = shells%first(s), shells%first(s + 1) - 1
                do k = 1, 3
                    offset(k) = shells%offset(k, m)
                end do
                at = place_beside(box, ijk, offset)
                if (at == 0) cycle
                if (solid(at) == 0) cycle
                if (faces_at(cell_of(at), face_of) > 0) takers = takers + 1
            end do
        end do
        flag(e) = 0
        shell(e) = 0
        if (takers > 0) then
            shell(e) = s
            do k = 1, box%n_var
                donation(k, e) = donation(k, e)/takers
            end do
            if (e <= left) return
            at = place_at(box, donor(e))
            do k = 1, box%n_var
                u(at + (k - 1)*box%grid%apart) = 0
            end do
        else if (e <= left) then
            flag(e) = 1
        else if (is_own(box, donor(e))) then
            kept = kept + 1
        end if
    end subroutine choose_shell

    !> Cells left that found no taker defer the gas themselves.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine defer_donation(e, n_var, so_many, start, donor, donation, slot, deferred_cell, &
    deferred)
        integer, intent(in) :: e !! cells left
        integer, intent(in) :: n_var, so_many !! variables, deferred sources so far
        integer(int32), intent(in) :: start(*), donor(*)
        real(rk), intent(in) :: donation(max_var, *)
        integer(int32), intent(inout) :: slot(*), deferred_cell(*)
        real(rk), intent(inout) :: deferred(n_var, *)
        integer :: d, k

        if (start(e + 1) == start(e)) return
        d = so_many + start(e + 1)
        slot(donor(e)) = d
        deferred_cell(d) = donor(e)
        do k = 1, n_var
            deferred(k, d) = donation(k, e)
        end do
    end subroutine defer_donation

    !> Each solid cell that touches gas takes its shares from the donors around it.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine collect_shares(c, donors, left, box, shells, cell, face_of, mark, donor, &
                                   shell, donation, u)
        integer, intent(in) :: c !! solid cells
        integer, intent(in) :: donors, left !! all donors, cells that the solid left
        type(box_t), intent(in) :: box
        type(shells_t), intent(in) :: shells !@buffer
        integer(int32), intent(in) :: cell(*)
        integer, intent(in) :: face_of(6, *)
        integer(int8), intent(in) :: mark(*)
        integer(int32), intent(in) :: donor(*), shell(*)
        real(rk), intent(in) :: donation(max_var, *)
        real(rk), intent(inout) :: u(*)
        real(rk) :: share(max_var)
        integer(int64) :: at
        integer :: e, k, number, o, s, ijk(3), offset(3), from(3)
        logical :: inside

        if (faces_at(c, face_of) == 0) return
        ijk = cell_at(box%n, cell(c))
        do k = 1, max_var
            share(k) = 0
        end do
        do s = 1, shells%n
            do o = shells%first(s), shells%first(s + 1) - 1
                do k = 1, 3
                    offset(k) = shells%offset(k, o)
                end do
                call neighbour(box%n, box%wraps, ijk, offset, from, inside)
                if (.not. inside) cycle
                number = number_of(box%n, from)
                if (mark(number) == is_left) then
                    e = place_in(number, 1, left, donor)
                else if (mark(number) == is_buried) then
                    e = place_in(number, left + 1, donors, donor)
                else
                    cycle
                end if
                if (shell(e) /= s) cycle
                do k = 1, max_var
                    if (k <= box%n_var) share(k) = share(k) + donation(k, e)
                end do
            end do
        end do
        at = place_at(box, cell(c))
        do k = 1, max_var
            if (k <= box%n_var) &
                u(at + (k - 1)*box%grid%apart) = u(at + (k - 1)*box%grid%apart) + share(k)
        end do
    end subroutine collect_shares

    !> Place of a number in a part of a list that is in order.
    !@cuf attributes(host,device) &
    pure function place_in(number, first, last, list) result(at)
        integer, intent(in) :: number
        integer, intent(in) :: first, last
        integer(int32), intent(in) :: list(*)
        integer :: at, high, middle

        at = first
        high = last
        do while (at < high)
            middle = (at + high)/2
            if (list(middle) < number) then
                at = middle + 1
            else
                high = middle
            end if
        end do
    end function place_in
end module brz_donor_loop_bodies
