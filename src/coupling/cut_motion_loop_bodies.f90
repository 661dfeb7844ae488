! SPDX-License-Identifier: MIT
!> Walls of cut cells that move: their velocities, what they sweep in a step, and what the gas would
!> do to the bodies that carry them.
module brz_cut_motion_loop_bodies
    use brz_air_grid, only: cell_at, is_between
    use brz_cut_cells, only: bare, node_grid_t, of_plane, see_image
    use brz_cut_list_loop_bodies, only: entry_at, nodes_around
    use brz_cut_load_loop_bodies, only: find_shares
    use brz_cut_node_loop_bodies, only: tent, turns_to
    use brz_driven_body_rules, only: add_force, add_yield, carried_velocity, driven_body_at, &
        carries_all, driven_body_t, is_carried
    use brz_gas, only: to_primitive
    use brz_kinds, only: dp, int32, int64, rk
    use brz_particle_marks, only: is_fixed
    use brz_scheme, only: mixture_gamma, scheme_t
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: cut_find_carrier, cut_find_push, cut_wall_velocity, cut_sum_push, &
        cut_tame, cut_sweep, cut_sum_load

    real(rk), parameter :: most_taken = 0.5_rk !! of a cluster's gas that walls take in a step
    real(rk), parameter :: band = 0.3_rk !! volume that a cell may be off its geometry, in cells
    real(rk), parameter :: part = 0.05_rk !! of what is beyond it that the wall makes up in a step
    real(rk), parameter :: farthest = 0.02_rk !! way of the wall for that, in cells

contains

    !> Place of the middle of the wall in a cell, or in its image at the body that carries it [m].
    !@cuf attributes(host,device) &
    pure function wall_place(nodes, number, turns, middle, d) result(x)
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: number !! of the cell
        integer(int32), intent(in) :: turns(3) !! periods to the image
        real(rk), intent(in) :: middle(3)
        integer, intent(in) :: d !! direction
        real(dp) :: x
        integer :: ijk(3)

        ijk = cell_at(nodes%n, number)
        x = nodes%lo(d) + (nodes%before(d) + ijk(d) - 1 + turns(d)*nodes%whole(d) + middle(d)) &
            *nodes%dx(d)
    end function wall_place

    !> The body that carries the wall in a cell, by the heaviest particle at its heaviest node; 0
    !> where the particles there move as they like or there is no wall. In a periodic box the image
    !> of the cell beside that particle is part of the body.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_carrier(s, nodes, bodies, driven, wide, cell, slot, area, mass, &
                                     heaviest, fixed, x, carrier, turns)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: bodies
        type(driven_body_t), intent(in) :: driven(bodies)
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: cell(*), slot(*)
        real(rk), intent(in) :: area(3, *)
        real(dp), intent(in) :: mass(*) !! of the nodes
        integer(int32), intent(in) :: heaviest(*) !! particle at each node
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(inout) :: carrier(*)
        integer(int32), intent(inout) :: turns(3, *) !! periods from the cell to the image
        integer :: b, d, far, high(3), i, ijk(3), j, k, low(3), node, p
        real(dp) :: most

        carrier(s) = 0
        do d = 1, 3
            turns(d, s) = 0
        end do
        if (.not. abs(area(1, s)) + abs(area(2, s)) + abs(area(3, s)) > 0) return
        ijk = cell_at(nodes%n, cell(s))
        most = 0
        p = 0
        do far = 0, 1
            call nodes_around(nodes, ijk, far, 1 + far, low, high)
            do k = low(3), high(3)
                do j = low(2), high(2)
                    do i = low(1), high(1)
                        node = entry_at(nodes, i, j, k, slot)
                        if (node == 0) cycle
                        if (.not. mass(node) > most) cycle
                        most = mass(node)
                        p = heaviest(node)
                    end do
                end do
            end do
            if (p > 0) exit
        end do
        if (p == 0) return
        b = driven_body_at(bodies, driven, p)
        if (.not. is_carried(driven(b)%carries, fixed(p) == is_fixed)) return
        carrier(s) = b
        do d = 1, 3
            turns(d, s) = turns_to(nodes, d, ijk(d), x(d, p))
        end do
    end subroutine cut_find_carrier

    !> Velocity of the wall in a cell, at its middle: that of the body that carries it, else the
    !> mean by mass of the nodes of the cell (of those around, where they are bare).
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_wall_velocity(s, nodes, bodies, driven, cell, slot, area, middle, mass, &
                                      momentum, carrier, turns, v)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: bodies
        type(driven_body_t), intent(in) :: driven(bodies)
        integer(int32), intent(in) :: cell(*), slot(*)
        real(rk), intent(in) :: area(3, *), middle(3, *)
        real(dp), intent(in) :: mass(*), momentum(3, *)
        integer(int32), intent(in) :: carrier(*), turns(3, *)
        real(rk), intent(inout) :: v(3, *)
        real(dp) :: all, at(3), p(3), weight
        real(rk) :: w(3), x(3)
        integer :: d, high(3), i, ijk(3), j, k, low(3), node, wide, to(3)
        integer :: beyond
        logical :: turned(3)
        integer(int32) :: image(3)

        do d = 1, 3
            v(d, s) = 0
            x(d) = middle(d, s)
            image(d) = turns(d, s)
        end do
        if (.not. abs(area(1, s)) + abs(area(2, s)) + abs(area(3, s)) > 0) return
        do d = 1, 3
            at(d) = wall_place(nodes, cell(s), image, x, d)
            p(d) = 0
        end do
        if (carrier(s) > 0) then
            w = carried_velocity(driven(carrier(s)), at)
            do d = 1, 3
                if (nodes%n(d) > 1) v(d, s) = w(d)
            end do
            return
        end if
        ijk = cell_at(nodes%n, cell(s))
        do wide = 0, 1
            call nodes_around(nodes, ijk, wide, 1 + wide, low, high)
            all = 0
            do k = low(3), high(3)
                do j = low(2), high(2)
                    do i = low(1), high(1)
                        to(1) = i
                        to(2) = j
                        to(3) = k
                        weight = 1
                        if (wide == 0) weight = tent(nodes, to, at)
                        do d = 1, 3
                            call see_image(nodes, d, 1, to(d), beyond)
                            turned(d) = beyond == of_plane
                        end do
                        node = entry_at(nodes, to(1), to(2), to(3), slot)
                        if (node == 0) cycle
                        all = all + weight*mass(node)
                        do d = 1, 3
                            p(d) = p(d) + merge(-weight, weight, turned(d))*momentum(d, node)
                        end do
                    end do
                end do
            end do
            if (all > 0) exit
        end do
        do d = 1, 3
            if (all > 0 .and. nodes%n(d) > 1) v(d, s) = real(p(d)/all, rk)
        end do
    end subroutine cut_wall_velocity

    !> Force of the gas on the wall of a cell if it keeps its motion, and how it falls if it yields.
    !@cuf attributes(host,device) &
    pure subroutine push_on_wall(s, nodes, scheme, reference, place, area, v, u, force, yield)
        integer, intent(in) :: s !! entry
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: reference !! pressure that is taken off [Pa]
        integer(int32), intent(in) :: place(*)
        real(rk), intent(in) :: area(3, *), v(3, *), u(*)
        real(rk), intent(out) :: force(3) !! [N]
        real(rk), intent(out) :: yield(3) !! loss of force per velocity [N s/m]
        real(rk) :: du, gamma, p_star, q(5), rho_star, w(5), whole
        integer :: c, d

        do d = 1, 3
            force(d) = 0
            yield(d) = 0
        end do
        whole = sqrt(area(1, s)**2 + area(2, s)**2 + area(3, s)**2)
        if (.not. whole > 0) return
        do c = 1, 5
            q(c) = u(place(s) + (c - 1)*nodes%grid%apart)
        end do
        gamma = scheme%gamma
        if (nodes%grid%n_var == 6) gamma = mixture_gamma(scheme, u(place(s) + 5*nodes%grid%apart) &
                                                         /q(1))
        call to_primitive(gamma, q, w)
        du = 0
        do d = 1, 3
            du = du + (w(1 + d) - v(d, s))*area(d, s)/whole
        end do
        call wall_star(gamma, w(1), w(5), du, p_star, rho_star)
        do d = 1, 3
            force(d) = (p_star - reference)*area(d, s)
            yield(d) = sqrt(gamma*p_star*rho_star)*area(d, s)**2/whole
        end do
    end subroutine push_on_wall

    !> The same for the walls that no body carries; none for the others.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_find_push(s, nodes, scheme, reference, place, shut, area, v, carrier, u, &
                                  press, give)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: reference !! pressure that is taken off [Pa]
        integer(int32), intent(in) :: place(*), shut(*)
        real(rk), intent(in) :: area(3, *), v(3, *)
        integer(int32), intent(in) :: carrier(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: press(3, *) !! force [N]
        real(rk), intent(inout) :: give(3, *) !! loss of it per velocity [N s/m]
        real(rk) :: force(3), yield(3)
        integer :: d

        do d = 1, 3
            press(d, s) = 0
            give(d, s) = 0
        end do
        if (place(s) == 0 .or. shut(s) /= 0 .or. carrier(s) > 0) return
        call push_on_wall(s, nodes, scheme, reference, place, area, v, u, force, yield)
        do d = 1, 3
            press(d, s) = force(d)
            give(d, s) = yield(d)
        end do
    end subroutine cut_find_push

    !> Force and torque of the gas on the walls that a body carries if it keeps its motion, and how
    !> they fall if it yields.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_sum_push(s, body, nodes, scheme, reference, driven, cell, place, shut, &
                                 area, middle, v, carrier, turns, u, push)
        integer, intent(in) :: s !! entries
        integer, intent(in) :: body !! its number
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: reference !! pressure that is taken off [Pa]
        type(driven_body_t), intent(in) :: driven
        integer(int32), intent(in) :: cell(*), place(*), shut(*)
        real(rk), intent(in) :: area(3, *), middle(3, *), v(3, *)
        integer(int32), intent(in) :: carrier(*), turns(3, *)
        real(rk), intent(in) :: u(*)
        real(dp), intent(inout) :: push(18) !@exact n_push of brz_driven_body_rules
        real(dp) :: arm(3)
        real(rk) :: force(3), x(3), yield(3)
        integer :: d
        integer(int32) :: image(3)

        if (carrier(s) /= body .or. shut(s) /= 0) return
        if (.not. is_between(nodes%n, nodes%own, cell(s))) return
        call push_on_wall(s, nodes, scheme, reference, place, area, v, u, force, yield)
        do d = 1, 3
            x(d) = middle(d, s)
            image(d) = turns(d, s)
        end do
        do d = 1, 3
            arm(d) = wall_place(nodes, cell(s), image, x, d) - driven%centre(d)
        end do
        call add_force(arm, force, push)
        call add_yield(arm, yield, push)
    end subroutine cut_sum_push

    !> Slow the walls of a cluster that would take more than half of its gas in a step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_tame(s, nodes, dt, place, shut, master, ends, member, volume, area, v, &
                             slowed)
        integer, intent(in) :: s !! entries; masters alone do something
        type(node_grid_t), intent(in) :: nodes
        real(rk), intent(in) :: dt !! [s]
        integer(int32), intent(in) :: place(*), shut(*), master(*), ends(*), member(*)
        real(rk), intent(in) :: volume(*), area(3, *)
        real(rk), intent(inout) :: v(3, *)
        integer, intent(inout) :: slowed !@count clusters
        real(rk) :: all, swept, taken
        integer :: d, m, q

        if (master(s) /= s .or. place(s) == 0 .or. shut(s) /= 0) return
        all = 0
        taken = 0
        do q = ends(s) + 1, ends(s + 1)
            m = member(q)
            all = all + volume(m)
            swept = 0
            do d = 1, 3
                swept = swept + v(d, m)*area(d, m)*dt/nodes%volume
            end do
            taken = taken + max(-swept, 0.0_rk)
        end do
        if (taken <= most_taken*all) return
        slowed = slowed + 1
        do q = ends(s) + 1, ends(s + 1)
            do d = 1, 3
                v(d, member(q)) = v(d, member(q))*(most_taken*all/taken)
            end do
        end do
    end subroutine cut_tame

    !> Volume that the wall of a cell frees in a step. Where the gas is farther off the geometry
    !> than a band, as in bodies that swell or tear, the wall itself makes up for part of it.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_sweep(s, nodes, dt, shut, gas, volume, area, v, swept)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        real(rk), intent(in) :: dt !! [s]
        integer(int32), intent(in) :: shut(*)
        real(rk), intent(in) :: gas(*), volume(*), area(3, *)
        real(rk), intent(inout) :: v(3, *)
        real(rk), intent(inout) :: swept(*)
        real(rk) :: extra, off, most, whole
        integer :: d

        swept(s) = 0
        if (shut(s) /= 0) return
        whole = sqrt(area(1, s)**2 + area(2, s)**2 + area(3, s)**2)
        if (whole <= 1e3_rk*bare*max(nodes%area(1), nodes%area(2), nodes%area(3))) return
        off = gas(s) - volume(s)
        if (abs(off) > band) then
            extra = part*(off - sign(band, off))
            most = farthest*whole/max(nodes%area(1), nodes%area(2), nodes%area(3))
            extra = max(-most, min(most, extra))
            do d = 1, 3
                v(d, s) = v(d, s) + extra*nodes%volume*area(d, s)/(whole*whole*dt)
            end do
        end if
        do d = 1, 3
            swept(s) = swept(s) + v(d, s)*area(d, s)*dt/nodes%volume
        end do
    end subroutine cut_sweep

    !> Force and torque of the air on a body by its particles' shares of forces and torques on
    !> nodes: those of the walls at their middles.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_sum_load(p, first, nodes, driven, wide, fixed, home, cell, slots, x, mass, &
                                 node_mass, force, moment, push)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(node_grid_t), intent(in) :: nodes
        type(driven_body_t), intent(in) :: driven
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: fixed(*), home(*), cell(*), slots(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: mass(*)
        real(dp), intent(in) :: node_mass(*), force(3, *)
        real(dp), intent(in) :: moment(3, *) !! about the low corner of the grid [N m]
        real(dp), intent(inout) :: push(6) !@exact force [N], torque [N m]
        real(dp) :: arm(3), share(8), y(3)
        integer :: at(8), c, d, i, ijk(3), j, k, node(3), part, s

        part = first - 1 + p
        if (home(part) == 0) return
        if (.not. is_between(nodes%n, nodes%own, cell(home(part)))) return
        if (.not. is_carried(driven%carries, fixed(part) == is_fixed)) return
        ijk = cell_at(nodes%n, cell(home(part)))
        do d = 1, 3
            y(d) = x(d, part)
        end do
        call find_shares(nodes, ijk, y, mass(part), slots, node_mass, at, share)
        do c = 1, 8
            s = at(c)
            if (s == 0) cycle
            node = cell_at(nodes%n, cell(s))
            do d = 1, 3 ! from the low corner of the grid, or its image, to the centre
                arm(d) = driven%centre(d) - nodes%lo(d) &
                         - turns_to(nodes, d, node(d), y(d))*nodes%whole(d)*nodes%dx(d)
            end do
            do d = 1, 3
                i = mod(d, 3) + 1
                j = mod(d + 1, 3) + 1
                k = 3 + d
                push(d) = push(d) + share(c)*force(d, s)
                push(k) = push(k) + share(c)*(moment(d, s) - arm(i)*force(j, s) &
                                              + arm(j)*force(i, s))
            end do
        end do
    end subroutine cut_sum_load
end module brz_cut_motion_loop_bodies
