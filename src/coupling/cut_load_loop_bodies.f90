! SPDX-License-Identifier: MIT
!> Loads by cut cells, the wall traction: a cell hands the force on its wall to its nodes in shares
!> of the mass of the particles there, a node to its particles likewise. Both are gathers, and
!> nothing is lost.
module brz_cut_load_loop_bodies
    use brz_air_grid, only: cell_at, is_between
    use brz_cut_cells, only: node_grid_t, of_plane, ring_of_loads, see_image
    use brz_cut_list_loop_bodies, only: entries_of_corners, entry_at, nodes_around
    use brz_cut_node_loop_bodies, only: tent_at, tents_of
    use brz_kinds, only: dp, int32, rk
    implicit none
    private
    public :: cut_find_bearing, cut_bear, cut_bear_push, cut_load_particle, cut_record, cut_feel
    public :: find_shares

contains

    !> Mass of the nodes that bear the load of a cell: its own or, where these are bare, those
    !> around it, with the opposite sign.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_bearing(s, nodes, cell, place, slot, mass, bearing)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), place(*), slot(*)
        real(dp), intent(in) :: mass(*) !! of the nodes [kg]
        real(dp), intent(inout) :: bearing(*)
        real(dp) :: around
        integer :: at(3), d, high(3), i, ijk(3), j, k, low(3), node, wide
        integer :: image

        bearing(s) = 0
        if (place(s) == 0) return
        ijk = cell_at(nodes%n, cell(s))
        do wide = 0, 1
            call nodes_around(nodes, ijk, wide, 1 + wide, low, high)
            around = 0
            do k = low(3), high(3)
                do j = low(2), high(2)
                    do i = low(1), high(1)
                        at(1) = i
                        at(2) = j
                        at(3) = k
                        do d = 1, 3
                            call see_image(nodes, d, 1, at(d), image)
                        end do
                        node = entry_at(nodes, at(1), at(2), at(3), slot)
                        if (node > 0) around = around + mass(node)
                    end do
                end do
            end do
            bearing(s) = around*(1 - 2*wide)
            if (around > 0) return
        end do
    end subroutine cut_find_bearing

    !> Share that a node has in what the wall of a cell near it hands on.
    !@cuf attributes(host,device) &
    pure subroutine find_borne(nodes, ijk, at, mass, slot, bearing, to, b, share, turned)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3), at(3) !! node, cell
        real(dp), intent(in) :: mass !! of the node [kg]
        integer(int32), intent(in) :: slot(*)
        real(dp), intent(in) :: bearing(*)
        integer, intent(out) :: to(3) !! the cell, or that whose image it is
        integer, intent(out) :: b !! its entry; 0: it is not listed, or hands nothing to this node
        real(dp), intent(out) :: share
        logical, intent(out) :: turned(3) !! directions that a plane of symmetry turns
        integer :: d, image
        logical :: own

        own = .true.
        do d = 1, 3
            if (nodes%n(d) > 1) own = own .and. at(d) >= ijk(d) - 1 .and. at(d) <= ijk(d)
            to(d) = at(d)
            call see_image(nodes, d, 0, to(d), image)
            turned(d) = image == of_plane
        end do
        share = 0
        b = entry_at(nodes, to(1), to(2), to(3), slot)
        if (b == 0) return
        if (bearing(b) > 0 .and. own) share = mass/bearing(b)
        if (bearing(b) < 0) share = -mass/bearing(b)
        if (.not. share > 0) b = 0
    end subroutine find_borne

    !> Force and torque on a node: its shares of those on the walls of the cells around.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine cut_bear(s, nodes, dt, reference, cell, slot, ring, mass, bearing, area, &
                             middle, impulse, force, from_low, faces, moment)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        real(dp), intent(in) :: dt !! step of the air [s]
        real(rk), intent(in) :: reference !! pressure that is taken off [Pa]
        integer(int32), intent(in) :: cell(*), slot(*), ring(*)
        real(dp), intent(in) :: mass(*), bearing(*)
        real(rk), intent(in) :: area(3, *), middle(3, *), impulse(3, *)
        real(dp), intent(inout) :: force(3, *) !! [N]
        real(rk), intent(inout) :: from_low(3, *) !! what of it gas on the low side brings [N]
        real(rk), intent(inout) :: faces(2, 3, *)
        !! area of the walls with gas on the low, the high side that the node bears, in faces
        real(dp), intent(inout) :: moment(3, *) !! about the low corner of the grid [N m]
        real(dp) :: arm(3), borne(2, 3), low_side(3), push(3), share
        integer :: at(3), b, d, high(3), i, ijk(3), j, k, low(3), side, to(3)
        logical :: on_low, turned(3)

        do d = 1, 3
            force(d, s) = 0
            low_side(d) = 0
            borne(1, d) = 0
            borne(2, d) = 0
            from_low(d, s) = 0
            faces(1, d, s) = 0
            faces(2, d, s) = 0
            moment(d, s) = 0
        end do
        if (ring(s) > ring_of_loads .or. .not. mass(s) > 0) return
        ijk = cell_at(nodes%n, cell(s))
        call nodes_around(nodes, ijk, 2, 1, low, high)
        do k = low(3), high(3)
            do j = low(2), high(2)
                do i = low(1), high(1)
                    at(1) = i
                    at(2) = j
                    at(3) = k
                    call find_borne(nodes, ijk, at, mass(s), slot, bearing, to, b, share, turned)
                    if (b == 0) cycle
                    ! a cell that is held for a step brings no impulse, but is not the reference
                    if (.not. abs(impulse(1, b)) + abs(impulse(2, b)) + abs(impulse(3, b)) &
                        + abs(area(1, b)) + abs(area(2, b)) + abs(area(3, b)) > 0) cycle
                    do d = 1, 3
                        push(d) = share*(impulse(d, b)/dt - reference*area(d, b))
                        arm(d) = (nodes%before(d) + to(d) - 1 + middle(d, b))*nodes%dx(d)
                        if (turned(d)) push(d) = -push(d)
                        if (turned(d)) arm(d) = 2*merge(nodes%whole(d), 0, at(d) > to(d)) &
                            *nodes%dx(d) - arm(d)
                        force(d, s) = force(d, s) + push(d)
                        on_low = (area(d, b) > 0) .neqv. turned(d)
                        if (on_low) low_side(d) = low_side(d) + push(d)
                        side = merge(1, 2, on_low)
                        borne(side, d) = borne(side, d) + share*abs(area(d, b))/nodes%area(d)
                    end do
                    moment(1, s) = moment(1, s) + (arm(2)*push(3) - arm(3)*push(2))
                    moment(2, s) = moment(2, s) + (arm(3)*push(1) - arm(1)*push(3))
                    moment(3, s) = moment(3, s) + (arm(1)*push(2) - arm(2)*push(1))
                end do
            end do
        end do
        do d = 1, 3
            from_low(d, s) = real(low_side(d), rk)
            faces(1, d, s) = real(borne(1, d), rk)
            faces(2, d, s) = real(borne(2, d), rk)
        end do
    end subroutine cut_bear

    !> Force on a node if the walls around keep their motion, and how it falls if they yield.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine cut_bear_push(s, nodes, cell, slot, ring, mass, bearing, press, give, force, &
                                  impedance)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*), ring(*)
        real(dp), intent(in) :: mass(*), bearing(*)
        real(rk), intent(in) :: press(3, *), give(3, *) !! of the walls [N], [N s/m]
        real(dp), intent(inout) :: force(3, *), impedance(3, *) !! [N], [N s/m]
        real(dp) :: push, share
        integer :: at(3), b, d, high(3), i, ijk(3), j, k, low(3), to(3)
        logical :: turned(3)

        do d = 1, 3
            force(d, s) = 0
            impedance(d, s) = 0
        end do
        if (ring(s) > ring_of_loads .or. .not. mass(s) > 0) return
        ijk = cell_at(nodes%n, cell(s))
        call nodes_around(nodes, ijk, 2, 1, low, high)
        do k = low(3), high(3)
            do j = low(2), high(2)
                do i = low(1), high(1)
                    at(1) = i
                    at(2) = j
                    at(3) = k
                    call find_borne(nodes, ijk, at, mass(s), slot, bearing, to, b, share, turned)
                    if (b == 0) cycle
                    do d = 1, 3
                        push = merge(-press(d, b), press(d, b), turned(d))
                        force(d, s) = force(d, s) + share*push
                        impedance(d, s) = impedance(d, s) + share*give(d, b)
                    end do
                end do
            end do
        end do
    end subroutine cut_bear_push

    !> Shares that a particle has in what the nodes at the corners of its cell hand on.
    !@cuf attributes(host,device) &
    pure subroutine find_shares(nodes, ijk, x, mass, slot, node_mass, at, share)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! its cell
        real(dp), intent(in) :: x(3) !! [m]
        real(rk), intent(in) :: mass !! of the particle [kg]
        integer(int32), intent(in) :: slot(*)
        real(dp), intent(in) :: node_mass(*) !! [kg]
        integer, intent(out) :: at(8) !! entries of the nodes; 0: one is not listed, or bare
        real(dp), intent(out) :: share(8)
        real(dp) :: tents(2, 3)
        integer :: c

        call entries_of_corners(nodes, ijk, slot, at)
        call tents_of(nodes, ijk, x, tents)
        do c = 1, 8
            share(c) = 0
            if (at(c) == 0) cycle
            if (node_mass(at(c)) > 0) then
                share(c) = mass*tent_at(tents, c - 1)/node_mass(at(c))
            else
                at(c) = 0
            end if
        end do
    end subroutine find_shares

    !> Load of a particle: its shares of the forces on the nodes of its cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_load_particle(p, nodes, wide, stride_d, stride_p, home, cell, slot, ring, &
                                      x, mass, node_mass, force, load)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        integer, intent(in) :: stride_d, stride_p !! distances in `load` of directions, of particles
        integer(int32), intent(in) :: home(*), cell(*), slot(*), ring(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(dp), intent(in) :: node_mass(*), force(3, *)
        real(rk), intent(inout) :: load(*) !! [N]
        real(dp) :: share(8), sums(3), y(3)
        integer :: at(8), c, d, ijk(3)
        logical :: loaded

        do d = 1, 3
            sums(d) = 0
        end do
        loaded = home(p) > 0
        if (loaded) loaded = ring(home(p)) <= ring_of_loads
        if (loaded) then
            do d = 1, 3
                y(d) = x(d, p)
            end do
            ijk = cell_at(nodes%n, cell(home(p)))
            call find_shares(nodes, ijk, y, mass(p), slot, node_mass, at, share)
            do c = 1, 8
                if (at(c) == 0) cycle
                do d = 1, 3
                    sums(d) = sums(d) + share(c)*force(d, at(c))
                end do
            end do
        end if
        do d = 1, 3
            load(1 + (d - 1)*stride_d + (p - 1)*stride_p) = real(sums(d), rk)
        end do
    end subroutine cut_load_particle

    !> Add the wall of a cell to the diagnostics.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_record(s, nodes, dt, reference, cell, area, v, impulse, work, given, taken)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        real(dp), intent(in) :: dt !! step of the air [s]
        real(rk), intent(in) :: reference !! pressure that is taken off [Pa]
        integer(int32), intent(in) :: cell(*)
        real(rk), intent(in) :: area(3, *), v(3, *), impulse(3, *)
        real(dp), intent(inout) :: work(2) !@sum of all pressure, of the reference pressure [J]
        real(dp), intent(inout) :: given(3) !@sum of impulses given to the solid [N s]
        real(dp), intent(inout) :: taken(3) !@sum of what was taken off [N s]
        real(dp) :: off
        integer :: d

        if (.not. is_between(nodes%n, nodes%own, cell(s))) return
        do d = 1, 3
            off = reference*real(area(d, s), dp)*dt
            work(1) = work(1) + impulse(d, s)*real(v(d, s), dp)
            work(2) = work(2) + off*v(d, s)
            given(d) = given(d) + (impulse(d, s) - off)
            taken(d) = taken(d) + off
        end do
    end subroutine cut_record

    !> felt = 1 where a particle of a body has a load beyond rounding.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_feel(t, first, stride_d, stride_p, negligible, load, felt)
        integer, intent(in) :: t !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: stride_d, stride_p !! distances in `load` of directions, of particles
        real(rk), intent(in) :: negligible !! force that counts as none [N]
        real(rk), intent(in) :: load(*)
        integer(int32), intent(inout) :: felt(*)
        integer :: d

        do d = 1, 3
            if (abs(load(1 + (d - 1)*stride_d + (first + t - 2)*stride_p)) > negligible) felt(1) = 1
        end do
    end subroutine cut_feel
end module brz_cut_load_loop_bodies
