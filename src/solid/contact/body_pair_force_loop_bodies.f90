! SPDX-License-Identifier: MIT
!> Body-pair force: that of contact between two bodies, summed over the particles of one.
module brz_body_pair_force_loop_bodies
    use brz_body_pair, only: body_pair_force_t
    use brz_contact_loop_bodies, only: add_pair, look_along, owner_of, trace_at
    use brz_contact_release, only: is_tied
    use brz_force_layout, only: at_drag, n_terms
    use brz_interaction, only: law_shared, interaction_t
    use brz_kinds, only: dp, int32, int64, real32, rk
    use brz_link_layout, only: link_layout_t, links_of, n_press
    use brz_pair_layout, only: n_pair
    implicit none
    private
    public :: sum_body_pair_force, add_impulse

contains

    !> Give a pair of bodies the force after a step and, by the trapezoid, its impulse in the step.
    pure subroutine add_impulse(between, force, dt)
        type(body_pair_force_t), intent(inout) :: between
        real(dp), intent(in) :: force(3), dt !! [N], [s]

        between%impulse = between%impulse + dt/2*(between%force + force)
        between%force = force
    end subroutine add_impulse

    !> Add what body `other` does to a particle: springs and drag, as push_particle has them.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_body_pair_force(k, first, other, lay, ends, table, cell, x, v, mass, &
                                weight, stress, pair, press, bond, joined, row, slice, count, &
                                list, total)
        integer, intent(in) :: k !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: other
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(rk), intent(in) :: cell(*)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*), stress(*)
        real(real32), intent(in) :: weight(*)
        real(rk), intent(in) :: pair(n_pair, *), press(n_press, *)
        integer(int32), intent(in) :: bond(*), joined(*), row(*), slice(*), count(*), list(*)
        real(dp), intent(inout) :: total(3) !@exact [N]
        real(rk) :: f(n_terms), s(3), r(3), dv(3), own, theirs, d, energy, lost, stiffness, damping
        integer :: a, b, i, j, m, n, q, t, u
        integer(int64) :: at

        i = first - 1 + k
        call links_of(lay, i, row, slice, count, q, n, at)
        if (n == 0) return
        a = owner_of(lay%bodies, ends, i)
        own = cell(a)*mass(i)*weight(i)
        energy = 0
        lost = 0
        stiffness = 0
        damping = 0
        do t = 1, n_terms
            f(t) = 0
        end do
        do m = 0, n - 1
            call look_along(lay, list(at + m*lay%side), i, x, v, j, s, r, dv)
            b = owner_of(lay%bodies, ends, j)
            if (b /= other .or. table(a, b)%law == law_shared) cycle
            d = sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3))
            if (d > 2*table(a, b)%h) cycle
            if (is_tied(table(a, b), bond(i), bond(j), joined(i), joined(j))) cycle
            u = j
            if (lay%compact == 1) u = row(j)
            theirs = cell(b)*mass(j)*weight(j)
            call add_pair(lay, table(a, b), table(b, a), 0.0_rk, own, theirs, mass(i), mass(j), &
                          s, r, dv, d, r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3), press(1, q), &
                          press(1, u), pair(1, i), pair(1, j), trace_at(lay, stress, i), &
                          trace_at(lay, stress, j), .false., f, energy, lost, stiffness, damping)
        end do
        do t = 1, 3
            total(t) = total(t) + (real(f(t), dp) + f(at_drag + t))
        end do
    end subroutine sum_body_pair_force
end module brz_body_pair_force_loop_bodies
