! SPDX-License-Identifier: MIT
!> Gas and its volume go over to the new shapes of cut cells, once bodies have moved.
!>
!> The volume of the gas is a quantity of its own: it is integrated with the walls, and what it is
!> off the geometry is exchanged between neighbours together with its gas. So a uniform stream stays
!> uniform whatever the shapes do. Every loop body gathers.
module brz_cut_exchange_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: node_grid_t
    use brz_cut_list_loop_bodies, only: entry_at
    use brz_kinds, only: int32, rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: cut_remap, cut_take, cut_find_takers, cut_hand_on, cut_forget, cut_settle, &
        cut_find_band, cut_find_off, cut_leave, cut_level, cut_apply

    real(rk), parameter :: pocket = 0.25_rk !! clusters with less gas are shut
    real(rk), parameter :: small = 0.5_rk !! unless they have this much room

contains

    !> Place that a cell had in the list before, 0: none.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_remap(s, listed, cell, old_cell, from)
        integer, intent(in) :: s !! entries
        integer, intent(in) :: listed !! entries before
        integer(int32), intent(in) :: cell(*)
        integer(int32), intent(in) :: old_cell(*) !! in ascending order
        integer(int32), intent(inout) :: from(*)
        integer :: high, low, middle

        from(s) = 0
        low = 1
        high = listed
        do while (low <= high)
            middle = (low + high)/2
            if (old_cell(middle) == cell(s)) then
                from(s) = middle
                return
            else if (old_cell(middle) < cell(s)) then
                low = middle + 1
            else
                high = middle - 1
            end if
        end do
    end subroutine cut_remap

    !> Has a cell got its gas on another side of a body: no face that was open is open still? What
    !> it held is not what it holds now.
    !@cuf attributes(host,device) &
    pure logical function has_turned(s, beside, was_open, aperture) result(turned)
        integer, intent(in) :: s !! entry
        integer(int32), intent(in) :: beside(6, *)
        real(rk), intent(in) :: was_open(6, *), aperture(6, *)
        logical :: any_now, any_then, any_still
        integer :: row

        any_now = .false.
        any_then = .false.
        any_still = .false.
        do row = 1, 6
            if (beside(row, s) == 0) cycle
            any_now = any_now .or. aperture(row, s) > 0
            any_then = any_then .or. was_open(row, s) > 0
            any_still = any_still .or. (aperture(row, s) > 0 .and. was_open(row, s) > 0)
        end do
        turned = any_now .and. any_then .and. .not. any_still
    end function has_turned

    !> Content and volume of a cell after the step, and how its faces were open. What a cell without
    !> gas held, or one that has turned, waits in it, and is gas again once the cell opens.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_take(s, nodes, from, place, shut, beside, aperture, old_shut, old_open, &
                             old_volume, swept, old_kept, u, content, volume, kept, was_open)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: from(*), place(*), shut(*), beside(6, *), old_shut(*)
        real(rk), intent(in) :: aperture(6, *)
        real(rk), intent(in) :: old_open(6, *), old_volume(*), swept(*)
        real(rk), intent(in) :: old_kept(max_var + 1, *) !! waiting content, and its volume
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: content(max_var, *), volume(*), kept(max_var + 1, *)
        real(rk), intent(inout) :: was_open(6, *)
        real(rk) :: full, waits
        integer :: c, o, row
        logical :: closed, was_gas

        o = from(s)
        was_gas = place(s) > 0
        full = 1
        if (o > 0) then
            was_gas = was_gas .and. old_shut(o) == 0
            full = old_volume(o) + swept(o)
        end if
        if (.not. was_gas) full = 0
        do row = 1, 6
            was_open(row, s) = 1
            if (o > 0) was_open(row, s) = old_open(row, o)
        end do
        closed = place(s) == 0 .or. shut(s) /= 0
        if (was_gas .and. .not. closed) closed = has_turned(s, beside, was_open, aperture)
        do c = 1, max_var
            waits = 0
            if (o > 0) waits = old_kept(c, o)
            if (was_gas .and. c <= nodes%grid%n_var) &
                waits = waits + full*u(place(s) + (c - 1)*nodes%grid%apart)
            kept(c, s) = merge(waits, 0.0_rk, closed)
            content(c, s) = merge(0.0_rk, waits, closed)
        end do
        waits = full
        if (o > 0) waits = waits + old_kept(max_var + 1, o)
        kept(max_var + 1, s) = merge(waits, 0.0_rk, closed)
        volume(s) = merge(0.0_rk, waits, closed)
    end subroutine cut_take

    !> How wide a cell that has closed was open to cells that hold gas.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_takers(s, place, shut, beside, aperture, was_open, kept, opening)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: place(*), shut(*), beside(6, *)
        real(rk), intent(in) :: aperture(6, *), was_open(6, *), kept(max_var + 1, *)
        real(rk), intent(inout) :: opening(*)
        integer :: b, row

        opening(s) = 0
        if (place(s) == 0) return
        if (.not. (abs(kept(max_var + 1, s)) > 0 .or. abs(kept(1, s)) > 0)) return
        do row = 1, 6
            b = beside(row, s)
            if (b == 0) cycle
            if (shut(b) /= 0 .or. .not. was_open(row, s) > 0) cycle
            if (has_turned(b, beside, was_open, aperture)) cycle
            opening(s) = opening(s) + was_open(row, s)
        end do
    end subroutine cut_find_takers

    !> Take the shares of what cells beside one that have closed hold.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_hand_on(s, place, shut, beside, aperture, was_open, kept, opening, &
                                content, volume)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: place(*), shut(*), beside(6, *)
        real(rk), intent(in) :: aperture(6, *), was_open(6, *), kept(max_var + 1, *), opening(*)
        real(rk), intent(inout) :: content(max_var, *), volume(*)
        real(rk) :: share
        integer :: b, c, row

        if (place(s) == 0 .or. shut(s) /= 0) return
        if (has_turned(s, beside, was_open, aperture)) return
        do row = 1, 6
            b = beside(row, s)
            if (b == 0) cycle
            if (.not. opening(b) > 0) cycle
            share = was_open(row, s)/opening(b)
            do c = 1, max_var
                content(c, s) = content(c, s) + share*kept(c, b)
            end do
            volume(s) = volume(s) + share*kept(max_var + 1, b)
        end do
    end subroutine cut_hand_on

    !> What has been handed on no longer waits.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_forget(s, opening, kept)
        integer, intent(in) :: s !! entries
        real(rk), intent(in) :: opening(*)
        real(rk), intent(inout) :: kept(max_var + 1, *)
        integer :: c

        if (.not. opening(s) > 0) return
        do c = 1, max_var + 1
            kept(c, s) = 0
        end do
    end subroutine cut_forget

    !> One state for a cluster, and its volume in proportion to the gas by geometry. A pocket with
    !> too little gas is shut: its gas waits. Where a body that had the room has gone, torn or
    !> eroded, the gas takes the room instead.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_settle(s, nodes, place, master, ends, member, content, volume, gas, shut, &
                               kept, u, pockets)
        integer, intent(in) :: s !! entries; masters alone do something
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: place(*), master(*), ends(*), member(*)
        real(rk), intent(in) :: content(max_var, *)
        real(rk), intent(inout) :: volume(*), gas(*)
        integer(int32), intent(inout) :: shut(*)
        real(rk), intent(inout) :: kept(max_var + 1, *), u(*)
        integer, intent(inout) :: pockets !@count clusters that are shut
        real(rk) :: all(max_var), full, room
        integer :: c, m, q

        if (master(s) /= s .or. place(s) == 0 .or. shut(s) /= 0) return
        full = 0
        room = 0
        do c = 1, max_var
            all(c) = 0
        end do
        do q = ends(s) + 1, ends(s + 1)
            m = member(q)
            full = full + volume(m)
            room = room + gas(m)
            do c = 1, max_var
                all(c) = all(c) + content(c, m)
            end do
        end do
        if (full <= pocket .and. room >= small) full = room ! thin, as what it came from has gone
        if (full > pocket .and. all(1) > 0 .and. all(5)*all(1) > 0.5_rk*(all(2)**2 + all(3)**2 &
                                                                         + all(4)**2)) then
            do q = ends(s) + 1, ends(s + 1)
                m = member(q)
                volume(m) = full*(gas(m)/room)
                do c = 1, nodes%grid%n_var
                    u(place(m) + (c - 1)*nodes%grid%apart) = all(c)/full
                end do
            end do
            return
        end if
        pockets = pockets + 1
        do q = ends(s) + 1, ends(s + 1)
            m = member(q)
            do c = 1, max_var
                kept(c, m) = kept(c, m) + content(c, m)
            end do
            kept(max_var + 1, m) = kept(max_var + 1, m) + volume(m)
            volume(m) = 0
            gas(m) = 0
            shut(m) = 1
        end do
    end subroutine cut_settle

    !> band = 1 for the masters near cut and shut cells, which level their volumes.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_band(s, nodes, cell, place, slot, shut, master, gas, band)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), place(*), slot(*), shut(*), master(*)
        real(rk), intent(in) :: gas(*)
        integer(int32), intent(inout) :: band(*)
        integer :: b, i, ijk(3), j, k, r(3)

        band(s) = 0
        if (place(s) == 0 .or. shut(s) /= 0 .or. master(s) /= s) return
        ijk = cell_at(nodes%n, cell(s))
        r(1) = merge(1, 0, nodes%n(1) > 1)
        r(2) = merge(1, 0, nodes%n(2) > 1)
        r(3) = merge(1, 0, nodes%n(3) > 1)
        do k = ijk(3) - r(3), ijk(3) + r(3)
            do j = ijk(2) - r(2), ijk(2) + r(2)
                do i = ijk(1) - r(1), ijk(1) + r(1)
                    b = entry_at(nodes, i, j, k, slot)
                    if (b == 0) cycle
                    if (place(b) == 0) cycle
                    if (gas(b) < 1) band(s) = 1
                end do
            end do
        end do
    end subroutine cut_find_band

    !> What a master lacks of its volume by geometry, and the neighbours that level it where it has
    !> left the band.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_find_off(s, place, shut, master, beside, aperture, band, gas, volume, off, &
                                 takers)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: place(*), shut(*), master(*), beside(6, *), band(*)
        real(rk), intent(in) :: aperture(6, *), gas(*), volume(*)
        real(rk), intent(inout) :: off(*)
        integer(int32), intent(inout) :: takers(*)
        integer :: b, row

        off(s) = 0
        takers(s) = 0
        if (place(s) == 0 .or. shut(s) /= 0 .or. master(s) /= s) return
        off(s) = gas(s) - volume(s)
        do row = 1, 6
            b = beside(row, s)
            if (b == 0) cycle
            if (aperture(row, s) > 0 .and. band(b) == 1) takers(s) = takers(s) + 1
        end do
    end subroutine cut_find_off

    !> Add to the flow into a cell what comes from one beside it, with the state of the side that it
    !> comes from, which keeps half of its volume whatever its neighbours ask for.
    !@cuf attributes(host,device) &
    pure subroutine add_flow(nodes, into, from, amount, place, volume, u, flow)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: into, from !! entries
        real(rk), intent(in) :: amount !! volume, in cells
        integer(int32), intent(in) :: place(*)
        real(rk), intent(in) :: volume(*), u(*)
        real(rk), intent(inout) :: flow(max_var + 1)
        real(rk) :: least, passes
        integer :: c, giver

        giver = merge(from, into, amount > 0)
        least = volume(giver)/(4*nodes%dimensions)
        passes = max(-least, min(least, amount))
        do c = 1, nodes%grid%n_var
            flow(c) = flow(c) + passes*u(place(giver) + (c - 1)*nodes%grid%apart)
        end do
        flow(max_var + 1) = flow(max_var + 1) + passes
    end subroutine add_flow

    !> A master that has left the band gives what it is off to neighbours in the band, in equal
    !> shares. Where there is none the gas takes the volume as it is.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_leave(s, nodes, place, beside, aperture, band, off, takers, gas, volume, &
        u, &
                              flow, absorbed)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: place(*), beside(6, *), band(*)
        real(rk), intent(in) :: aperture(6, *), off(*)
        integer(int32), intent(in) :: takers(*)
        real(rk), intent(in) :: gas(*)
        real(rk), intent(inout) :: volume(*), u(*), flow(max_var + 1, *)
        integer, intent(inout) :: absorbed !@count cells
        real(rk) :: sums(max_var + 1)
        integer :: b, c, row

        do c = 1, max_var + 1
            sums(c) = 0
        end do
        if (band(s) == 0 .and. abs(off(s)) > 0 .and. takers(s) == 0) then
            if (abs(off(s)) > 1e-9_rk) absorbed = absorbed + 1
            do c = 1, nodes%grid%n_var
                u(place(s) + (c - 1)*nodes%grid%apart) = u(place(s) + (c - 1)*nodes%grid%apart) &
                                                         *(volume(s)/gas(s))
            end do
            volume(s) = gas(s)
        else if (band(s) == 1 .or. abs(off(s)) > 0) then
            do row = 1, 6
                b = beside(row, s)
                if (b == 0) cycle
                if (.not. aperture(row, s) > 0) cycle
                if (band(s) == 1) then
                    if (band(b) == 1 .or. takers(b) == 0 .or. .not. abs(off(b)) > 0) cycle
                    call add_flow(nodes, s, b, -off(b)/takers(b), place, volume, u, sums)
                else if (band(b) == 1) then
                    call add_flow(nodes, s, b, off(s)/takers(s), place, volume, u, sums)
                end if
            end do
        end if
        do c = 1, max_var + 1
            flow(c, s) = sums(c)
        end do
    end subroutine cut_leave

    !> Masters in the band exchange part of what they are off by, through open faces.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_level(s, nodes, place, beside, aperture, band, off, volume, u, flow)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: place(*), beside(6, *), band(*)
        real(rk), intent(in) :: aperture(6, *), off(*), volume(*), u(*)
        real(rk), intent(inout) :: flow(max_var + 1, *)
        real(rk) :: sums(max_var + 1)
        integer :: b, c, row

        do c = 1, max_var + 1
            sums(c) = 0
        end do
        do row = 1, 6
            if (band(s) == 0) exit
            b = beside(row, s)
            if (b == 0) cycle
            if (.not. aperture(row, s) > 0 .or. band(b) == 0) cycle
            call add_flow(nodes, s, b, &
                          aperture(row, s)*(off(s) - off(b))/(2*nodes%dimensions + 1), place, &
                          volume, u, sums)
        end do
        do c = 1, max_var + 1
            flow(c, s) = sums(c)
        end do
    end subroutine cut_level

    !> Gas and volume of a cell after an exchange.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_apply(s, nodes, place, flow, volume, u)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: place(*)
        real(rk), intent(in) :: flow(max_var + 1, *)
        real(rk), intent(inout) :: volume(*), u(*)
        real(rk) :: now
        integer :: at, c

        if (.not. (abs(flow(max_var + 1, s)) > 0 .or. abs(flow(1, s)) > 0)) return
        now = volume(s) + flow(max_var + 1, s)
        do c = 1, nodes%grid%n_var
            at = int(place(s) + (c - 1)*nodes%grid%apart)
            ! in differences: a stream that is even does not change by a bit
            u(at) = u(at) + (flow(c, s) - flow(max_var + 1, s)*u(at))/now
        end do
        volume(s) = now
    end subroutine cut_apply
end module brz_cut_exchange_loop_bodies
