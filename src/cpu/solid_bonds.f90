! SPDX-License-Identifier: MIT
!> Bonds between bodies: their particles take part in each other's sums as one continuum does,
!> until a bond breaks for good. Bodies that share their sums do so whenever they approach or are
!> compressed, though they start apart.
module brz_solid_bonds
    use brz_contact, only: bond_effort, law_bonded, law_shared, takes_part
    use brz_gradient, only: moment_terms, outer_terms
    use brz_solid_gradient_sums, only: at_g, at_s, at_x, at_y, n_sum => n_terms
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int64, rk
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, hourglass_viscous, &
                              most_bent, most_drawn, viscous_force
    use brz_shared_sums, only: carried_along
    use brz_solid_links, only: first_link, is_joined, last_link, link_body
    use brz_solid_mirror, only: mirrored, mirrored_hold, mirrored_row, signs
    use brz_solid_pair_sums, only: at_drag, at_friction, at_heat, at_hold, at_work, &
                                   n_terms
    use brz_solid_state, only: body_t, bond_broken, bond_whole, form_bending, &
                               form_corrected_hourglass, held_affine, held_stiffness, &
                               held_whole, n_held, n_pair, pair_affine, pair_hold, pair_keep, &
                               pair_linear, pair_quadratic, pair_stress, pair_tilt, &
                               pair_volume, solid_t, worth_threads
    use brz_tilted_arm, only: tilted_arm, tilted_force
    implicit none
    private
    public :: add_bonded_gradients, add_bonded_forces, push_rigid_bonds, break_bonds

    !> Geometry of one bonded pair.
    type :: pair_t
        integer :: j = 0
        real(rk) :: s(3) = 1 !! signs of the mirrored components
        real(rk) :: r(3) = 0, dv(3) = 0, dx(3) = 0 !! x_ij, v_ij, X_ij
        real(rk) :: slope = 0 !! F_ij
        logical :: shared = .false. !! of bodies that share their sums
    end type pair_t

contains

    subroutine look(solid, i, k, p)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        integer(int64), intent(in) :: k !! link
        type(pair_t), intent(out) :: p
        integer :: a, b

        p%j = solid%links%list(k)
        p%s = signs(int(solid%links%mask(k)))
        p%r = real(solid%x(:, i) - p%s*solid%x(:, p%j), rk)
        p%dx = real(solid%x_ref(:, i) - p%s*solid%x_ref(:, p%j), rk)
        p%dv = solid%v(:, i) - p%s*solid%v(:, p%j)
        a = link_body(solid%links, i)
        b = link_body(solid%links, p%j)
        associate (m => solid%links%table(a, b))
            p%slope = kernel_slope(m%scale, m%half_over_h, &
                                   sqrt(p%r(1)**2 + p%r(2)**2 + p%r(3)**2))
            p%shared = m%law == law_shared
        end associate
    end subroutine look

    !> True where a pair that shares its sums takes part, by its volumes at the beginning of the
    !> step.
    pure logical function takes_part_now(solid, i, p, volume_i, volume_j)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        type(pair_t), intent(in) :: p
        real(rk), intent(in) :: volume_i, volume_j !! [m3]

        takes_part_now = takes_part(solid%links%table(link_body(solid%links, i), &
                                                      link_body(solid%links, p%j)), &
                                    solid%mass(i), volume_i, solid%mass(p%j), volume_j, &
                                    dot_product(p%r, p%dv))
    end function takes_part_now

    !> Add the bonded partners of particle i to its moments and gradients (see pass 1).
    subroutine add_bonded_gradients(solid, i, normal, sums)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk), intent(in) :: normal(3) !! of the plies of its body
        real(rk), intent(inout) :: sums(n_sum) !! see brz_solid_gradient_sums
        type(pair_t) :: p
        real(rk) :: y(3), m(6), g(9), w, other(6), cross_sum(9), reference_sum(6)
        integer(int64) :: k

        other = 0
        do k = first_link(solid%links, i), last_link(solid%links, i)
            if (.not. is_joined(solid%links, i, solid%links%list(k))) cycle
            call look(solid, i, k, p)
            w = solid%volume(p%j)*p%slope
            call moment_terms(w, p%r, m)
            if (p%shared) then
                if (.not. takes_part_now(solid, i, p, solid%volume(i), solid%volume(p%j))) cycle
                other = other + m
                call outer_terms(w, p%dv, p%r, g)
                sums(at_g + 1:at_x) = sums(at_g + 1:at_x) + g
                call outer_terms(w, p%r, p%r, g)
                sums(at_y + 1:) = sums(at_y + 1:) + g
                cycle
            end if
            call tilted_arm(solid%pair(pair_tilt, i), normal, p%dx, p%r, y)
            sums(:at_g) = sums(:at_g) + m
            call outer_terms(w, p%dv, y, g)
            sums(at_g + 1:at_x) = sums(at_g + 1:at_x) + g
            call outer_terms(w, p%dx, p%r, g)
            sums(at_x + 1:at_s) = sums(at_x + 1:at_s) + g
            call moment_terms(w, p%dx, m)
            sums(at_s + 1:at_y) = sums(at_s + 1:at_y) + m
            call outer_terms(w, p%r, y, g)
            sums(at_y + 1:) = sums(at_y + 1:) + g
        end do
        if (.not. maxval(other(:3)) > 0) return
        call carried_along(solid%dimension, sums(:at_g), sums(at_x + 1:at_s), other, cross_sum, &
                           reference_sum)
        sums(:at_g) = sums(:at_g) + other
        sums(at_x + 1:at_s) = sums(at_x + 1:at_s) + cross_sum
        sums(at_s + 1:at_y) = sums(at_s + 1:at_y) + reference_sum
    end subroutine add_bonded_gradients

    !> Add the forces of the bonded partners of particle i (see pass 2).
    subroutine add_bonded_forces(solid, i, f)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk), intent(inout) :: f(n_terms)
        type(pair_t) :: p
        real(rk) :: own(n_pair), other(n_pair), g(3), d(3), arm(3), arm_j(3), w, u, y, vr, heat
        integer(int64) :: k
        integer :: c

        c = link_body(solid%links, i)
        own = solid%pair(:, i)
        do k = first_link(solid%links, i), last_link(solid%links, i)
            if (.not. is_joined(solid%links, i, solid%links%list(k))) cycle
            call look(solid, i, k, p)
            other = mirrored_row(p%s, solid%pair(:, p%j))
            if (p%shared) then
                if (.not. takes_part_now(solid, i, p, own(pair_volume), other(pair_volume))) cycle
            end if
            associate (m => solid%links%table(c, link_body(solid%links, p%j)), &
                       drag => f(at_drag + 1:at_drag + 3), r => p%r)
                w = own(pair_volume)*other(pair_volume)*p%slope
                vr = dot_product(r, p%dv)
                u = viscous_force(w, m%h, dot_product(r, r), vr, &
                                  own(pair_linear) + other(pair_linear), &
                                  own(pair_quadratic) + other(pair_quadratic))
                drag = drag + u*r
                f(at_heat) = f(at_heat) - u*vr/2
                if (p%shared) then
                    call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), r, r, g)
                    if (dot_product(g, r) > 0) f(1:3) = f(1:3) + g ! never in tension
                    cycle
                end if
                call tilted_arm(own(pair_tilt), m%normal(:, 1), p%dx, r, arm)
                call tilted_arm(-other(pair_tilt), p%s*m%normal(:, 2), p%dx, r, arm_j)
                call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, arm_j, g)
                f(1:3) = f(1:3) + g
                y = w*own(pair_keep)*other(pair_keep)
                if (m%formulation == form_bending) then
                    if (m%directional) then
                        call hourglass_axial(y, real(solid%hold(:, i), rk) + mirrored(p%s, &
                                             solid%hold(:, p%j)), own(pair_affine + 1), &
                                             other(pair_affine + 1), p%dx, r, d)
                    else
                        call hourglass_stiff(most_bent, y, own(pair_hold) + other(pair_hold), &
                                             own(pair_affine + 1), other(pair_affine + 1), p%dx, &
                                             r, d)
                    end if
                    f(at_hold + 1:at_hold + 3) = f(at_hold + 1:at_hold + 3) + d
                else if (m%formulation == form_corrected_hourglass) then
                    call hourglass_viscous(y*own(pair_hold), y*other(pair_hold), &
                                           own(pair_affine + 1), other(pair_affine + 1), p%dv, r, &
                                           d, heat)
                    drag = drag + d
                    f(at_friction) = f(at_friction) + heat
                    if (allocated(solid%held)) call add_hold(y, solid%held(:, i), &
                        mirrored_hold(p%s, solid%held(:, p%j)), p%dx, r, p%dv, f)
                end if
            end associate
        end do
    end subroutine add_bonded_forces

    !> Forces of the bonded partners on the particles of a rigid body, to those of contact; their
    !> share of the heat over dt, the step just made.
    subroutine push_rigid_bonds(solid, body, dt)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt !! [s]
        real(rk) :: f(n_terms)
        integer :: i

        do i = body%first, body%last
            if (solid%links%row(i) == 0) cycle
            f = 0
            call add_bonded_forces(solid, i, f)
            associate (push => solid%links%push(:, solid%links%row(i)))
                push(1:3) = push(1:3) + f(1:3)
                push(4:6) = push(4:6) + f(at_drag + 1:at_drag + 3)
            end associate
            solid%energy(i) = solid%energy(i) + real(dt, rk)*f(at_heat)/solid%mass(i)
            body%ledger%contact_heat = body%ledger%contact_heat + dt*f(at_heat)
        end do
    end subroutine push_rigid_bonds

    !> Break the bonds of particles whose traction on the bond exceeds its strength.
    subroutine break_bonds(solid)
        type(solid_t), intent(inout) :: solid
        type(pair_t) :: p
        real(rk) :: n(3), effort
        integer :: a, b, i
        integer(int64) :: k

        if (.not. solid%links%bonds) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) &
        !$omp private(p, n, effort, a, b, k)
        do i = 1, solid%n
            if (solid%links%bond(i) /= bond_whole) cycle
            a = link_body(solid%links, i)
            n = 0
            effort = 0
            do k = first_link(solid%links, i), last_link(solid%links, i)
                b = link_body(solid%links, solid%links%list(k))
                if (solid%links%table(a, b)%law /= law_bonded) cycle
                call look(solid, i, k, p)
                n = n + solid%volume(p%j)*p%slope*p%r
            end do
            if (.not. dot_product(n, n) > 0) cycle
            n = n/norm2(n)
            do k = first_link(solid%links, i), last_link(solid%links, i)
                b = link_body(solid%links, solid%links%list(k))
                associate (m => solid%links%table(a, b))
                    if (m%law == law_bonded) &
                        effort = max(effort, bond_effort(m, solid%stress(:, i), n))
                end associate
            end do
            if (effort >= 1) solid%links%bond(i) = bond_broken
        end do
    end subroutine break_bonds

    !> Add the hold of a pair.
    pure subroutine add_hold(y, own, other, dx, r, dv, f)
        real(rk), intent(in) :: y !! see hourglass_stiff
        real(rk), intent(in) :: own(n_held), other(n_held)
        real(rk), intent(in) :: dx(3), r(3), dv(3) !! X_ij, x_ij [m], v_ij [m/s]
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: g(3)

        if (.not. own(held_stiffness) + other(held_stiffness) > 0) return
        call hourglass_stiff(most_drawn, y*own(held_whole)*other(held_whole), &
                             own(held_stiffness) + other(held_stiffness), &
                             own(held_affine + 1), other(held_affine + 1), dx, r, g)
        f(at_hold + 1:at_hold + 3) = f(at_hold + 1:at_hold + 3) + g
        f(at_work) = f(at_work) - dot_product(g, dv)/2
    end subroutine add_hold
end module brz_solid_bonds
