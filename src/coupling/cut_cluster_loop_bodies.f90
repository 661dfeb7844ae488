! SPDX-License-Identifier: MIT
!> Clusters of small cells (cell merging): a cell with little gas shares one state with a neighbour,
!> so that the time step is that of whole cells. No cluster reaches through a face that is shut.
module brz_cut_cluster_loop_bodies
    use brz_air_grid, only: cell_at, rest_t
    use brz_cut_cells, only: node_grid_t
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: cut_weigh, cut_point, cut_follow, cut_adopt, cut_shut_pocket, cut_empty_shut, &
        cut_mean_state

    real(rk), parameter :: small = 0.5_rk !! cells with less gas join a neighbour
    real(rk), parameter :: pocket = 0.25_rk !! clusters with less gas are shut
    real(rk), parameter :: trifle = max(1e-9_rk, 16*epsilon(1.0_rk))
    !! differences that rounding makes

contains

    !> Gas by which a cell is judged: by geometry, or what a fresh cell holds.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_weigh(s, gas, volume, held)
        integer, intent(in) :: s !! entries
        real(rk), intent(in) :: gas(*), volume(*)
        real(rk), intent(inout) :: held(*)

        held(s) = gas(s)
        if (gas(s) > 0 .and. volume(s) < pocket) held(s) = min(gas(s), max(volume(s), 1e-6_rk))
    end subroutine cut_weigh

    !> The faces of a cell by turns, of a direction first the one nearer to the plane through
    !> the origin: among equals the first one counts, and so does its image where that plane is one
    !> of symmetry.
    !@cuf attributes(host,device) &
    pure integer function row_in_turn(nodes, number, turn) result(row)
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: number !! of the cell
        integer, intent(in) :: turn !! 1 to 6
        integer :: d, ijk(3)

        ijk = cell_at(nodes%n, number)
        d = (turn + 1)/2
        row = turn
        if (nodes%lo(d) + (nodes%before(d) + ijk(d) - 0.5_dp)*nodes%dx(d) < 0) &
            row = merge(2*d, 2*d - 1, turn == 2*d - 1)
    end function row_in_turn

    !> The neighbour that a small cell joins: of those that hold more, the one with the widest
    !> opening, weighted by its gas.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_point(s, nodes, cell, beside, aperture, held, master)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), beside(6, *)
        real(rk), intent(in) :: aperture(6, *), held(*)
        integer(int32), intent(inout) :: master(*)
        real(rk) :: best, score
        integer :: next, row, turn

        master(s) = s
        if (.not. held(s) > 0 .or. held(s) >= small) return
        best = -1
        do turn = 1, 6
            row = row_in_turn(nodes, cell(s), turn)
            next = beside(row, s)
            if (next == 0) cycle
            if (.not. aperture(row, s) > 0 .or. .not. held(next) > held(s)*(1 + trifle)) cycle
            score = aperture(row, s)*min(held(next), small)
            if (.not. score > best + trifle) cycle
            best = score
            master(s) = next
        end do
    end subroutine cut_point

    !> Follow the pointers of a list by one.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_follow(s, from, to)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: from(*)
        integer(int32), intent(inout) :: to(*)

        to(s) = from(from(s))
    end subroutine cut_follow

    !> A small cell that is the largest about it joins the cluster of a neighbour.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_adopt(s, nodes, cell, beside, aperture, held, from, to)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), beside(6, *)
        real(rk), intent(in) :: aperture(6, *), held(*)
        integer(int32), intent(in) :: from(*) !! master of each
        integer(int32), intent(inout) :: to(*)
        real(rk) :: best
        integer :: next, row, turn

        to(s) = from(s)
        if (.not. held(s) > 0 .or. held(s) >= small .or. from(s) /= s) return
        best = 0
        do turn = 1, 6
            row = row_in_turn(nodes, cell(s), turn)
            next = beside(row, s)
            if (next == 0) cycle
            if (.not. aperture(row, s) > best + trifle .or. held(from(next)) < small) cycle
            best = aperture(row, s)
            to(s) = from(next)
        end do
    end subroutine cut_adopt

    !> Shut the cells of a cluster with too little gas, a pocket.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_shut_pocket(s, place, master, ends, member, volume, gas, shut, pockets)
        integer, intent(in) :: s !! entries; masters alone do something
        integer(int32), intent(in) :: place(*), master(*), ends(*), member(*)
        real(rk), intent(in) :: volume(*)
        real(rk), intent(inout) :: gas(*)
        integer(int32), intent(inout) :: shut(*)
        integer, intent(inout) :: pockets !@count clusters that are shut
        real(rk) :: total
        integer :: q

        if (master(s) /= s .or. place(s) == 0 .or. shut(s) /= 0) return
        total = 0
        do q = ends(s) + 1, ends(s + 1)
            total = total + volume(member(q))
        end do
        if (total >= pocket) return
        pockets = pockets + 1
        do q = ends(s) + 1, ends(s + 1)
            gas(member(q)) = 0
            shut(member(q)) = 1
        end do
    end subroutine cut_shut_pocket

    !> A cell that is shut holds no gas by geometry either.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_empty_shut(s, shut, gas)
        integer, intent(in) :: s !! entries
        integer(int32), intent(in) :: shut(*)
        real(rk), intent(inout) :: gas(*)

        if (shut(s) /= 0) gas(s) = 0
    end subroutine cut_empty_shut

    !> One state for the members of a cluster: the mean by volume.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_mean_state(s, nodes, rest, place, master, ends, member, volume, u)
        integer, intent(in) :: s !! entries; masters alone do something
        type(node_grid_t), intent(in) :: nodes
        type(rest_t), intent(in) :: rest !! what is shut
        integer(int32), intent(in) :: place(*), master(*), ends(*), member(*)
        real(rk), intent(in) :: volume(*)
        real(rk), intent(inout) :: u(*)
        real(rk) :: all, mean, own
        integer :: c, q

        if (master(s) /= s .or. place(s) == 0) return
        if (volume(s) > 0 .and. ends(s + 1) == ends(s) + 1) return
        do c = 1, nodes%grid%n_var
            all = 0
            mean = 0
            own = u(place(s) + (c - 1)*nodes%grid%apart)
            do q = ends(s) + 1, ends(s + 1)
                all = all + volume(member(q))
                ! in differences: what is even does not change by a bit
                mean = mean + volume(member(q))*(u(place(member(q)) + (c - 1)*nodes%grid%apart) &
                                                 - own)
            end do
            if (all > 0) mean = own + mean/all
            if (.not. all > 0) mean = rest%u(c)
            do q = ends(s) + 1, ends(s + 1)
                u(place(member(q)) + (c - 1)*nodes%grid%apart) = mean
            end do
        end do
    end subroutine cut_mean_state
end module brz_cut_cluster_loop_bodies
