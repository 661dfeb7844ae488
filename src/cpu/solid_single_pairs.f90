! SPDX-License-Identifier: MIT
!> Pass 2, pair by pair: what the loops over the lanes leave out. This is slower.
module brz_solid_single_pairs
    use brz_kernel, only: kernel_shape, kernel_slope, pair_kernel
    use brz_kinds, only: int64, rk
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, hourglass_viscous, most_bent, &
                              most_drawn, stress_force
    use brz_solid_lanes, only: centre_t, group_of
    use brz_solid_mirror, only: mirrored, mirrored_hold, mirrored_row, signs
    use brz_solid_pair_sums, only: at_drag, at_friction, at_heat, at_hold, at_work, n_terms, &
                                   viscosity
    use brz_solid_state, only: body_t, form_bending, form_corrected_hourglass, held_affine, &
                               held_stiffness, held_whole, n_held, n_pair, pair_affine, &
                               pair_hold, pair_keep, pair_stress, pair_tilt, pair_volume, solid_t
    use brz_tilted_arm, only: tilted_arm, tilted_force
    implicit none
    private
    public :: visit_pairs, add_pair, add_artificial, add_hold

contains

    !> Add the force of one neighbour, and of one image, after the other.
    subroutine visit_pairs(solid, body, p, add, f)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(centre_t), intent(in) :: p
        procedure(add_pair) :: add
        real(rk), intent(inout) :: f(n_terms)
        integer(int64) :: k
        integer :: g

        g = group_of(body, p%i)
        do k = solid%first(g), solid%first(g + 1) - 1
            call add(solid, body, p, solid%list(k), 0, f)
        end do
        if (.not. any(solid%mirror)) return
        do k = solid%image_first(g), solid%image_first(g + 1) - 1
            call add(solid, body, p, solid%image(k), int(solid%mask(k)), f)
        end do
    end subroutine visit_pairs

    !> In a body of variable smoothing length: add the pair of p with j, or with its image, of which
    !> components of the mirrored axes change sign, tensors in both indices.
    subroutine add_pair(solid, body, p, j, mask, f)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(centre_t), intent(in) :: p
        integer, intent(in) :: j, mask !! mirrored axes, bits 0..2
        real(rk), intent(inout) :: f(n_terms)
        real(rk) :: s(3), r(3), dv(3), dx(3), arm(3), arm_j(3), own(n_pair), other(n_pair), g(3)
        type(centre_t) :: q
        real(rk) :: w, u, r2

        q = p
        s = signs(mask)
        r = real(solid%x(:, p%i) - s*solid%x(:, j), rk)
        dx = real(solid%x_ref(:, p%i) - s*solid%x_ref(:, j), rk)
        dv = solid%v(:, p%i) - s*solid%v(:, j)
        call pair_kernel(solid%dimension, solid%h(p%i), solid%h(j), q%h, q%scale, q%half_over_h)
        w = solid%pair(pair_volume, p%i)*solid%pair(pair_volume, j) &
            *kernel_slope(q%scale, q%half_over_h, norm2(r))
        if (w == 0) return
        own = solid%pair(:, p%i)
        other = mirrored_row(s, solid%pair(:, j))
        if (any(body%normal > 0)) then
            call tilted_arm(own(pair_tilt), p%normal, dx, r, arm)
            call tilted_arm(-other(pair_tilt), s*p%normal, dx, r, arm_j)
            call tilted_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, arm_j, g)
        else
            call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
        end if
        r2 = dot_product(r, r)
        u = viscosity(q%h, own, other, w, r2, dot_product(r, dv))
        f(1:3) = f(1:3) + g
        f(at_drag + 1:at_drag + 3) = f(at_drag + 1:at_drag + 3) + u*r
        f(at_heat) = f(at_heat) - u*dot_product(r, dv)/2
        w = w*own(pair_keep)*other(pair_keep)
        select case (body%formulation)
        case (form_corrected_hourglass)
            call hourglass_viscous(w*own(pair_hold), w*other(pair_hold), own(pair_affine + 1), &
                                   other(pair_affine + 1), dv, r, g, u)
            f(at_drag + 1:at_drag + 3) = f(at_drag + 1:at_drag + 3) + g
            f(at_friction) = f(at_friction) + u
            if (allocated(solid%held)) &
                call add_hold(w, solid%held(:, p%i), mirrored_hold(s, solid%held(:, j)), dx, r, &
                              dv, f)
        case (form_bending)
            if (body%directional) then
                call hourglass_axial(w, real(solid%hold(:, p%i), rk) &
                                     + mirrored(s, solid%hold(:, j)), own(pair_affine + 1), &
                                     other(pair_affine + 1), dx, r, g)
            else
                call hourglass_stiff(most_bent, w, own(pair_hold) + other(pair_hold), &
                                     own(pair_affine + 1), other(pair_affine + 1), dx, r, g)
            end if
            f(at_hold + 1:at_hold + 3) = f(at_hold + 1:at_hold + 3) + g
        end select
    end subroutine add_pair

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

    !> Add the artificial stress of such a pair, if either is in tension.
    subroutine add_artificial(solid, body, p, j, mask, f)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(centre_t), intent(in) :: p
        integer, intent(in) :: j, mask !! mirrored axes, bits 0..2
        real(rk), intent(inout) :: f(n_terms)
        type(centre_t) :: q
        real(rk) :: s(3), r(3), own(9), other(9), g(3), w, shape, distance
        integer :: t

        own = solid%pair(pair_affine + 1:pair_affine + 9, p%i)
        other = solid%pair(pair_affine + 1:pair_affine + 9, j)
        if (own(1) + own(5) + own(9) + other(1) + other(5) + other(9) <= 0) return
        q = p
        s = signs(mask)
        r = real(solid%x(:, p%i) - s*solid%x(:, j), rk)
        do t = 1, 3
            other(3*t - 2:3*t) = s(t)*s*other(3*t - 2:3*t)
        end do
        if (body%variable) call pair_kernel(solid%dimension, solid%h(p%i), solid%h(j), q%h, &
                                            q%scale, q%half_over_h)
        distance = norm2(r)
        w = solid%mass(p%i)*solid%mass(j)*kernel_slope(q%scale, q%half_over_h, distance)
        if (w == 0) return
        shape = kernel_shape(q%half_over_h, distance)/body%shape_at_spacing
        call stress_force(-w*shape**body%artificial_power, own, other, r, g)
        f(at_hold + 1:at_hold + 3) = f(at_hold + 1:at_hold + 3) + g
    end subroutine add_artificial
end module brz_solid_single_pairs
