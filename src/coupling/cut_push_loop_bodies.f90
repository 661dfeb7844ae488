! SPDX-License-Identifier: MIT
!> Velocities of the nodes in the middle of the coming step, where the particles move as they like:
!> each goes on as in the last step, changed by what the gas now pushes more (see pushed_velocity),
!> so that solids of less weight than a cell of gas stay stable. Nodes hand pushes to particles as
!> they do loads: those on both sides of a layer move with the particles that they share.
module brz_cut_push_loop_bodies
    use brz_air_grid, only: cell_at
    use brz_cut_cells, only: at_corner, node_grid_t, ring_of_loads
    use brz_cut_load_loop_bodies, only: find_shares
    use brz_cut_node_loop_bodies, only: cell_below, row_beyond, see_images, tent
    use brz_driven_body_rules, only: carries_all, driven_body_at, driven_body_t
    use brz_kinds, only: dp, int32, rk
    use brz_load_rules, only: pushed_velocity
    use brz_particle_marks, only: is_fixed
    implicit none
    private
    public :: cut_push_particle, cut_push_corner, cut_push_node

contains

    !> Change of momentum of a particle to the middle of the coming step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_push_particle(p, nodes, bodies, dt, dt_before, driven, wide, stride_d, &
                                      stride_p, home, cell, slot, ring, x, v, mass, fixed, load, &
                                      v_before, column, node_mass, force, impedance, change)
        integer, intent(in) :: p !! particles
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: bodies
        real(rk), intent(in) :: dt !! of the coming step of the air [s]
        real(rk), intent(in) :: dt_before !! of the last one; 0: none [s]
        type(driven_body_t), intent(in) :: driven(bodies)
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: stride_d, stride_p !! distances in `load` of directions, of particles
        integer(int32), intent(in) :: home(*), cell(*), slot(*), ring(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *), mass(*)
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: load(*) !! of the gas in the last step [N]
        real(rk), intent(in) :: v_before(3, *) !! [m/s]
        integer(int32), intent(in) :: column(*) !! of each particle in it
        real(dp), intent(in) :: node_mass(*)
        real(dp), intent(in) :: force(3, *), impedance(3, *) !! of the gas on the nodes
        real(rk), intent(inout) :: change(3, *) !! [kg m/s]
        real(dp) :: share(8), y(3)
        real(rk) :: all_force, gives(3), pushed(3)
        integer :: at(8), c, d, ijk(3)

        do d = 1, 3
            change(d, p) = 0
            gives(d) = 0
            pushed(d) = 0
        end do
        if (home(p) == 0) return
        if (ring(home(p)) > ring_of_loads) return ! no wall moves with it
        do d = 1, 3
            y(d) = x(d, p)
        end do
        if (fixed(p) == is_fixed .or. .not. mass(p) > 0) return
        if (driven(driven_body_at(bodies, driven, p))%carries == carries_all) return
        ijk = cell_at(nodes%n, cell(home(p)))
        call find_shares(nodes, ijk, y, mass(p), slot, node_mass, at, share)
        do c = 1, 8
            if (at(c) == 0) cycle
            do d = 1, 3
                pushed(d) = pushed(d) + real(share(c)*force(d, at(c)), rk)
                gives(d) = gives(d) + real(share(c)*impedance(d, at(c)), rk)
            end do
        end do
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            all_force = 0
            if (dt_before > 0) all_force = mass(p)*(v(d, p) - v_before(d, column(p)))/dt_before
            change(d, p) = mass(p)*(pushed_velocity(v(d, p), all_force, &
                pushed(d) - load(1 + (d - 1)*stride_d + (p - 1)*stride_p), gives(d), mass(p), dt) &
                                    - v(d, p))
        end do
    end subroutine cut_push_particle

    !> What the particles of a cell bring of it to one of its corners.
    !@loop_body if(n >= worth_threads) schedule(dynamic, 256)
    !@cuf attributes(host,device) &
    pure subroutine cut_push_corner(t, nodes, wide, cell, ring, ends, binned, x, change, sums)
        integer, intent(in) :: t !! corners of entries
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: wide !! rows of x
        integer(int32), intent(in) :: cell(*), ring(*), ends(*), binned(*)
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: change(3, *)
        real(dp), intent(inout) :: sums(3, 8, *)
        real(dp) :: own(3), share, y(3)
        integer :: at(3), c, d, ijk(3), p, q, s

        s = (t - 1)/8 + 1
        c = t - 8*(s - 1) - 1
        ijk = cell_at(nodes%n, cell(s))
        do d = 1, 3
            own(d) = 0
            at(d) = ijk(d) + iand(ishft(c, 1 - d), 1)
        end do
        do q = ends(s) + 1, merge(ends(s + 1), ends(s), ring(s) <= ring_of_loads)
            p = binned(q)
            do d = 1, 3
                y(d) = x(d, p)
            end do
            share = tent(nodes, at, y)
            do d = 1, 3
                own(d) = own(d) + share*change(d, p)
            end do
        end do
        do d = 1, 3
            sums(d, c + 1, s) = own(d)
        end do
    end subroutine cut_push_corner

    !> Bring the momentum of a node to the middle of the coming step.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_push_node(s, nodes, cell, slot, ring, filled, sums, momentum)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), slot(*), ring(*)
        real(dp), intent(in) :: filled(at_corner, 8, *) !! sums of cut_fill_corner
        real(dp), intent(in) :: sums(3, 8, *)
        real(dp), intent(inout) :: momentum(3, *)
        real(dp) :: all(3), fill, mass, times(3)
        integer :: b, c, corner, d, ijk(3)
        logical :: beyond, halved(3)

        if (ring(s) > ring_of_loads) return
        ijk = cell_at(nodes%n, cell(s))
        beyond = .false.
        fill = 0
        do d = 1, 3
            all(d) = 0
        end do
        do c = 0, 7
            call cell_below(nodes, ijk, c, slot, b, corner)
            if (b == 0) cycle
            beyond = beyond .or. filled(row_beyond, corner, b) > 0
            do d = 1, 3
                all(d) = all(d) + sums(d, corner, b)
            end do
        end do
        call see_images(nodes, ijk, beyond, fill, mass, times, halved)
        do d = 1, 3
            momentum(d, s) = momentum(d, s) + times(d)*all(d)
        end do
    end subroutine cut_push_node
end module brz_cut_push_loop_bodies
