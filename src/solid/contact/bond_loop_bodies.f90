! SPDX-License-Identifier: MIT
!> Tied contact, called bonds, a particle at a time: particles take part in each other's sums as one
!> continuum does, until a bond breaks for good. Bodies that share their sums do so whenever they
!> approach or are compressed, though they start apart.
module brz_bond_loop_bodies
    use brz_bond_marks, only: bond_breaks, bond_broken, tie_intact
    use brz_contact, only: bond_effort, joins, takes_part
    use brz_contact_loop_bodies, only: look_ahead, look_along, next_owner, owner_of
    use brz_force_layout, only: at_drag, at_heat, at_stiff, n_terms
    use brz_formulation_names, only: form_bending, form_corrected_hourglass
    use brz_gradient, only: moment_terms, outer_terms
    use brz_hold_layout, only: control_affine, control_stiffness, n_control
    use brz_interaction, only: law_bonded, law_shared, interaction_t
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, int64, real32, rk
    use brz_link_layout, only: link_layout_t, links_of
    use brz_moment_layout, only: at_g, at_s, at_x, at_y, n_moments
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, jump_speed, most_bent, viscous_force
    use brz_pair_layout, only: n_pair, pair_affine, pair_keep, pair_linear, pair_quadratic, &
        pair_stress, pair_tilt, pair_volume, pair_zeta
    use brz_pair_rows, only: add_drag, add_hold, axes_of_pair, mirror_row
    use brz_shared_sums, only: carried_along
    use brz_one_sided_arm, only: one_sided_arm, tilted_force, wall_arm
    implicit none
    private
    public :: sum_bonds, pull_bonds, break_bond, pull_links

contains

    !> Add the bonded partners of particle i to its moments and gradients (see pass 1). Those within
    !> the support may be kept for pass 2, as lists reach a skin further; they lie as the list does.
    !@cuf attributes(host,device) &
    pure subroutine sum_bonds(i, lay, tilt, ends, table, x, x_ref, v, volume, mass, bond, row, &
                              slice, count, list, keeps, found, near, sums)
        integer, intent(in) :: i
        type(link_layout_t), intent(in) :: lay
        real(rk), intent(in) :: tilt !! [1/m]
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(dp), intent(in) :: x(lay%wide, *), x_ref(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), volume(lay%step_v, *), mass(*)
        integer(int32), intent(in) :: bond(*), row(*), slice(*), count(*), list(*)
        logical, intent(in) :: keeps !! else `near` is not touched
        integer(int32), intent(out) :: found !! how many are kept
        integer(int32), intent(inout) :: near(*) !! entries of these
        real(rk), intent(inout) :: sums(n_moments) !! slots at_g, ...
        real(rk) :: s(3), r(3), dv(3), dx(3), y(3), m(6), g(9), other(6), one(3), w, vr
        integer :: a, b, j, k, n, t
        integer(int32) :: next
        integer(int64) :: at

        found = 0
        a = owner_of(lay%bodies, ends, i)
        b = a
        do t = 1, 6
            other(t) = 0
        end do
        call links_of(lay, i, row, slice, count, t, n, at)
        do k = 1, n
            call look_ahead(lay, list, at, k, n, i, x, v, next, j, s, r, dv)
            b = next_owner(lay%bodies, ends, j, b)
            if (.not. joins(table(a, b), bond(i) == tie_intact .and. bond(j) == tie_intact)) cycle
            w = volume(1, j)*kernel_slope(table(a, b)%scale/lay%depth, table(a, b)%half_over_h, &
                                          sqrt(r(1)**2 + r(2)**2 + r(3)**2))
            if (.not. w > 0) cycle ! beyond the support
            if (keeps) near(at + found*lay%side) = list(at + (k - 1)*lay%side)
            found = found + 1
            w = w*table(a, b)%part(1)
            call moment_terms(w, r, m)
            if (table(a, b)%law == law_shared) then
                vr = dot_product(r, dv)
                if (.not. takes_part(table(a, b), mass(i), volume(1, i), mass(j), volume(1, j), &
                                     vr)) cycle
                do t = 1, 6
                    other(t) = other(t) + m(t)
                end do
                call add_outer(w, dv, r, sums(at_g + 1))
                call add_outer(w, r, r, sums(at_y + 1))
                cycle
            end if
            do t = 1, 3
                dx(t) = real(x_ref(t, i) - s(t)*x_ref(t, j), rk)
                one(t) = 1
            end do
            call arm_of(table(a, b), 1, tilt, x_ref(1, i), one, dx, r, y)
            do t = 1, 6
                sums(t) = sums(t) + m(t)
            end do
            call add_outer(w, dv, y, sums(at_g + 1))
            call add_outer(w, dx, r, sums(at_x + 1))
            call moment_terms(w, dx, m)
            do t = 1, 6
                sums(at_s + t) = sums(at_s + t) + m(t)
            end do
            call add_outer(w, r, y, sums(at_y + 1))
        end do
        if (.not. max(other(1), other(2), other(3)) > 0) return
        call carried_along(lay%dimension, sums(1), sums(at_x + 1), other, g, m)
        do t = 1, 6
            sums(t) = sums(t) + other(t)
            sums(at_s + t) = sums(at_s + t) + m(t)
        end do
        do t = 1, 9
            sums(at_x + t) = sums(at_x + t) + g(t)
        end do
    end subroutine sum_bonds

    !> Add w b (x) a, see outer_terms, to a sum.
    !@cuf attributes(host,device) &
    pure subroutine add_outer(w, a, b, total)
        real(rk), intent(in) :: w, a(3), b(3)
        real(rk), intent(inout) :: total(9) !! column by column
        real(rk) :: terms(9)
        integer :: t

        call outer_terms(w, a, b, terms)
        do t = 1, 9
            total(t) = total(t) + terms(t)
        end do
    end subroutine add_outer

    !> Add the forces of the bonded partners of particle i (see pass 2).
    !@cuf attributes(host,device) &
    pure subroutine pull_bonds(i, lay, ends, table, x, x_ref, v, mass, pair, k_axes, control, &
                               bond, row, slice, count, list, f)
        integer, intent(in) :: i
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(dp), intent(in) :: x(lay%wide, *), x_ref(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*), pair(n_pair, *)
        real(real32), intent(in) :: k_axes(6, *)
        real(rk), intent(in) :: control(n_control, *)
        integer(int32), intent(in) :: bond(*), row(*), slice(*), count(*), list(*)
        real(rk), intent(inout) :: f(n_terms)
        real(dp) :: unloaded(3)
        real(rk) :: own(n_pair), other(n_pair), s(3), r(3), dv(3), dx(3), g(3)
        real(rk) :: w, vr, share, slope
        integer :: a, b, j, k, n, t
        integer(int32) :: next
        integer(int64) :: at

        a = owner_of(lay%bodies, ends, i)
        b = a
        do t = 1, 3
            unloaded(t) = x_ref(t, i)
        end do
        do t = 1, n_pair
            own(t) = pair(t, i)
        end do
        call links_of(lay, i, row, slice, count, t, n, at)
        do k = 1, n
            call look_ahead(lay, list, at, k, n, i, x, v, next, j, s, r, dv)
            b = next_owner(lay%bodies, ends, j, b)
            if (.not. joins(table(a, b), bond(i) == tie_intact .and. bond(j) == tie_intact)) cycle
            slope = kernel_slope(table(a, b)%scale/lay%depth, table(a, b)%half_over_h, &
                                 sqrt(r(1)**2 + r(2)**2 + r(3)**2))
            if (.not. slope > 0) cycle ! beyond the support
            vr = dot_product(r, dv)
            if (table(a, b)%law == law_shared) then
                if (.not. takes_part(table(a, b), mass(i), own(pair_volume), mass(j), &
                                     pair(pair_volume, j), vr)) cycle
            end if
            do t = 1, 3
                dx(t) = real(unloaded(t) - s(t)*x_ref(t, j), rk)
            end do
            do t = 1, n_pair
                other(t) = pair(t, j)
            end do
            call mirror_row(s, other)
            w = own(pair_volume)*other(pair_volume)*slope
            call drag_bond(table(a, b), w, r, vr, own, other, f)
            w = w*table(a, b)%part(1)
            share = table(a, b)%part(2)/table(a, b)%part(1)
            do t = 1, 9
                other(pair_stress + t) = share*other(pair_stress + t)
            end do
            other(pair_zeta) = share*other(pair_zeta)
            if (table(a, b)%law == law_shared) then
                call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), r, r, g)
                do t = 1, 3
                    f(t) = f(t) + g(t)
                end do
                cycle
            end if
            call pull_bond(table(a, b), w, s, r, dx, unloaded, x_ref(1, j), own, other, f)
            w = w*own(pair_keep)*other(pair_keep)
            if (table(a, b)%formulation == form_bending) then
                do t = 1, 9
                    other(pair_affine + t) = share*other(pair_affine + t)
                end do
                call bend_bond(table(a, b), share, w, s, r, dx, own, other, k_axes(1, i), &
                               k_axes(1, j), f)
            else if (table(a, b)%formulation == form_corrected_hourglass) then
                call add_drag(w, r, dv, own, other, f)
                if (lay%holds == 1) call control_bond(share, w, s, r, dv, dx, control(1, i), &
                                                   control(1, j), f)
            end if
        end do
    end subroutine pull_bonds

    !> Viscosity of a bonded pair, and its heat.
    !@cuf attributes(host,device) &
    pure subroutine drag_bond(m, w, r, vr, own, other, f)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: w, r(3), vr !! vr: v_ij.x_ij [m2/s]
        real(rk), intent(in) :: own(n_pair), other(n_pair)
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: u, jump
        integer :: t

        jump = vr
        if (m%spares > 0) jump = jump_speed(own(pair_affine + 1), other(pair_affine + 1), r, vr)
        u = viscous_force(w, m%h, dot_product(r, r), jump, m%viscous(1)*own(pair_linear) &
                          + m%viscous(2)*other(pair_linear), m%viscous(1)*own(pair_quadratic) &
                          + m%viscous(2)*other(pair_quadratic))
        do t = 1, 3
            f(at_drag + t) = f(at_drag + t) + u*r(t)
        end do
        f(at_heat) = f(at_heat) - u*vr/2
    end subroutine drag_bond

    !> Force of the stress of a bonded pair.
    !@cuf attributes(host,device) &
    pure subroutine pull_bond(m, w, s, r, dx, x_i, x_j, own, other, f)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: w, s(3), r(3), dx(3), own(n_pair), other(n_pair)
        real(dp), intent(in) :: x_i(3), x_j(3) !! places in the unloaded bodies [m]
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: arm(3), arm_j(3), one(3), g(3)
        integer :: t

        do t = 1, 3
            one(t) = 1
        end do
        call arm_of(m, 1, own(pair_tilt), x_i, one, dx, r, arm)
        call arm_of(m, 2, -other(pair_tilt), x_j, s, dx, r, arm_j)
        call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, arm_j, g)
        do t = 1, 3
            f(t) = f(t) + g(t)
        end do
    end subroutine pull_bond

    !> Arm of a bonded pair at the particle of one of the two bodies, or at its image.
    !@cuf attributes(host,device) &
    pure subroutine arm_of(m, side, c, x, s, dx, r, y)
        type(interaction_t), intent(in) :: m
        integer, intent(in) :: side !! 1: first body, 2: second
        real(rk), intent(in) :: c, s(3), dx(3), r(3) !! tilt; signs of an image; X_ij, x_ij [m]
        real(dp), intent(in) :: x(3) !! place in the unloaded body [m]
        real(rk), intent(out) :: y(3) !! [m]
        real(rk) :: normal(3), lift
        real(dp) :: image(3)
        integer :: t

        do t = 1, 3
            normal(t) = s(t)*m%normal(t, side)
            image(t) = s(t)*x(t)
        end do
        lift = m%lift(side)
        if (.not. m%curved(side)) call one_sided_arm(c, lift, normal, dx, r, y)
        if (m%curved(side)) call wall_arm(m%normal(1, side), m%middle(1, side), image, c, lift, &
                                          dx, r, y)
    end subroutine arm_of

    !> Stiff hourglass force of a bonded pair.
    !@cuf attributes(host,device) &
    pure subroutine bend_bond(m, share, y, s, r, dx, own, other, hold_i, hold_j, f)
        type(interaction_t), intent(in) :: m
        real(rk), intent(in) :: share !! of the other particle, in its row already
        real(rk), intent(in) :: y, s(3), r(3), dx(3), own(n_pair), other(n_pair)
        real(real32), intent(in) :: hold_i(6), hold_j(6)
        real(rk), intent(inout) :: f(n_terms)
        real(real32) :: theirs(6)
        real(rk) :: stiff(6), g(3)
        integer :: t

        if (m%directional) then
            do t = 1, 6
                theirs(t) = real(share, real32)*hold_j(t)
            end do
            call axes_of_pair(s, hold_i, theirs, stiff)
            call hourglass_axial(y, stiff, own(pair_affine + 1), other(pair_affine + 1), dx, &
                                 dx, r, g)
        else
            call hourglass_stiff(most_bent, y, own(pair_zeta) + other(pair_zeta), &
                                 own(pair_affine + 1), other(pair_affine + 1), dx, r, g)
        end if
        do t = 1, 3
            f(at_stiff + t) = f(at_stiff + t) + g(t)
        end do
    end subroutine bend_bond

    !> Hold of a bonded pair.
    !@cuf attributes(host,device) &
    pure subroutine control_bond(share, y, s, r, dv, dx, own, other, f)
        real(rk), intent(in) :: share !! of the other particle
        real(rk), intent(in) :: y, s(3), r(3), dv(3), dx(3), own(n_control), other(n_control)
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: theirs(n_control)
        integer :: t

        do t = 1, n_control
            theirs(t) = other(t)
        end do
        theirs(control_stiffness) = share*theirs(control_stiffness)
        do t = 1, 9
            theirs(control_affine + t) = share*theirs(control_affine + t)
        end do
        call add_hold(y, s, r, dv, dx, own, theirs, f)
    end subroutine control_bond

    !> Add the forces of the bonded partners to `extra`, which pass 2 starts from.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine pull_links(k, linked, particles, lay, ends, table, x, x_ref, v, mass, pair, &
                               k_axes, control, bond, row, slice, count, list, extra)
        integer, intent(in) :: k !! particles that have links
        integer(int32), intent(in) :: linked(*) !! they
        integer, intent(in) :: particles !! all
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(dp), intent(in) :: x(lay%wide, *), x_ref(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), mass(*), pair(n_pair, *)
        real(real32), intent(in) :: k_axes(6, *)
        real(rk), intent(in) :: control(n_control, *)
        integer(int32), intent(in) :: bond(*), row(*), slice(*), count(*), list(*)
        real(rk), intent(inout) :: extra(particles, *)
        real(rk) :: f(n_terms)
        integer :: i, t

        i = linked(k)
        do t = 1, n_terms
            f(t) = 0
        end do
        call pull_bonds(i, lay, ends, table, x, x_ref, v, mass, pair, k_axes, control, bond, row, &
                        slice, count, list, f)
        do t = 1, n_terms
            extra(i, t) = extra(i, t) + f(t)
        end do
    end subroutine pull_links

    !> Break the bond of a particle whose traction on it exceeds its strength.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine break_bond(k, first, lay, ends, table, x, v, pair, stress, row, slice, &
                               count, list, bond)
        integer, intent(in) :: k !! particles
        integer, intent(in) :: first !! the first of them
        type(link_layout_t), intent(in) :: lay
        integer(int32), intent(in) :: ends(*)
        type(interaction_t), intent(in) :: table(lay%bodies, *)
        real(dp), intent(in) :: x(lay%wide, *)
        real(rk), intent(in) :: v(lay%wide, *), pair(n_pair, *), stress(*)
        integer(int32), intent(in) :: row(*), slice(*), count(*), list(*)
        integer(int32), intent(inout) :: bond(*)
        real(rk) :: s(3), r(3), dv(3), normal(3), own(6), w, length, effort
        integer :: a, b, i, j, n, p, t
        integer(int64) :: at

        i = first - 1 + k
        if (bond(i) == bond_breaks) bond(i) = bond_broken
        if (bond(i) /= tie_intact) return
        a = owner_of(lay%bodies, ends, i)
        b = a
        do t = 1, 3
            normal(t) = 0
        end do
        call links_of(lay, i, row, slice, count, t, n, at)
        do p = 0, n - 1
            call look_along(lay, list(at + p*lay%side), i, x, v, j, s, r, dv)
            b = next_owner(lay%bodies, ends, j, b)
            if (table(a, b)%law /= law_bonded) cycle
            w = pair(pair_volume, j)*kernel_slope(table(a, b)%scale, table(a, b)%half_over_h, &
                                                  sqrt(r(1)**2 + r(2)**2 + r(3)**2))
            do t = 1, 3
                normal(t) = normal(t) + w*r(t)
            end do
        end do
        length = sqrt(dot_product(normal, normal))
        if (.not. length > 0) return
        do t = 1, 3
            normal(t) = normal(t)/length
        end do
        do t = 1, 6
            own(t) = stress((i - 1_int64)*lay%stride_p + (t - 1_int64)*lay%step_c + 1)
        end do
        effort = 0
        do p = 0, n - 1
            call look_along(lay, list(at + p*lay%side), i, x, v, j, s, r, dv)
            b = next_owner(lay%bodies, ends, j, b)
            if (table(a, b)%law == law_bonded) &
                effort = max(effort, bond_effort(table(a, b), own, normal))
        end do
        if (effort >= 1) bond(i) = bond_breaks
    end subroutine break_bond
end module brz_bond_loop_bodies
