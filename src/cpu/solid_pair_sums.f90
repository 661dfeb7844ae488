! SPDX-License-Identifier: MIT
!> Pass 2, the loops over the direct neighbours of a group of particles.
!>
!> One loop for each set of forces, so that no body pays for a force that it does not use. The
!> compiler turns the inner loops, over the lanes, into vector code: constant length, no branch.
module brz_solid_pair_sums
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, real32, rk
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, hourglass_viscous, most_bent, &
                              most_drawn, stress_force, viscous_force
    use brz_solid_lanes, only: body_kernel, group_t, kernel_t, pair_kernels
    use brz_solid_state, only: at_drag, at_friction, at_heat, at_hold, at_work, &
                               held_affine, held_stiffness, held_whole, lanes, n_held, n_pair, &
                               n_terms, pair_affine, pair_hold, pair_keep, pair_linear, &
                               pair_quadratic, &
                               pair_stress, pair_tilt, pair_volume
    use brz_tilted_arm, only: ply_arm, tilted_arm, tilted_force
    implicit none
    private
    public :: sum_plain, sum_viscous, sum_held, sum_plate, sum_stiff, sum_axial, viscosity

contains

    !> Stress and viscosity over the direct neighbours, to p%sums, as in all that follow.
    subroutine sum_plain(p, x, v, pair, h, list)
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, at_hold), r(3), dv(3), own(n_pair), g(3), w, u, r2, vr
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums(:, :at_hold)
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), sqrt(r2))
                call stress_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), r, g)
                u = viscosity(q%h(l), own, pair(1, j), w, r2, vr)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        p%sums(:, :at_hold) = acc
        p%sums(:, at_hold + 1:) = 0
    end subroutine sum_plain

    !> Stress, viscosity and viscous hourglass force over the direct neighbours.
    subroutine sum_viscous(p, x, v, pair, h, list)
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, at_hold), r(3), dv(3), own(n_pair), g(3), d(3)
        real(rk) :: w, u, y, r2, vr, heat
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums(:, :at_hold)
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), sqrt(r2))
                call stress_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), r, g)
                u = viscosity(q%h(l), own, pair(1, j), w, r2, vr)
                y = w*own(pair_keep)*pair(pair_keep, j)
                call hourglass_viscous(y*own(pair_hold), y*pair(pair_hold, j), &
                                       own(pair_affine + 1), pair(pair_affine + 1, j), dv, r, d, &
                                       heat)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + (u*r(t) + d(t))
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
                acc(l, at_friction) = acc(l, at_friction) + heat
            end do
        end do
        p%sums(:, :at_hold) = acc
        p%sums(:, at_hold + 1:) = 0
    end subroutine sum_viscous

    !> The same and the hold, where some pair of the group has it.
    subroutine sum_held(p, x, v, x_ref, held, pair, h, list)
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), held(n_held, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), own(n_pair), hold(n_held), g(3), d(3)
        real(rk) :: e(3), w, u, y, r2, vr, heat
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                do t = 1, 6
                    hold(t) = p%own(l, t)
                    hold(t + 6) = p%own(l, t + 6)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), sqrt(r2))
                call stress_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), r, g)
                u = viscosity(q%h(l), own, pair(1, j), w, r2, vr)
                y = w*own(pair_keep)*pair(pair_keep, j)
                call hourglass_viscous(y*own(pair_hold), y*pair(pair_hold, j), &
                                       own(pair_affine + 1), pair(pair_affine + 1, j), dv, r, d, &
                                       heat)
                call hourglass_stiff(most_drawn, y*hold(held_whole)*held(held_whole, j), &
                                     hold(held_stiffness) + held(held_stiffness, j), &
                                     hold(held_affine + 1), held(held_affine + 1, j), dx, r, e)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + (u*r(t) + d(t))
                    acc(l, at_hold + t) = acc(l, at_hold + t) + e(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
                acc(l, at_friction) = acc(l, at_friction) + heat
                acc(l, at_work) = acc(l, at_work) - (e(1)*dv(1) + e(2)*dv(2) + e(3)*dv(3))/2
            end do
        end do
        p%sums = acc
    end subroutine sum_held

    !> The same with the arms of tilted gradients: plates.
    subroutine sum_plate(p, x, v, x_ref, held, pair, h, list)
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), held(n_held, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), own(n_pair), hold(n_held), g(3), d(3)
        real(rk) :: e(3), arm(3), arm_j(3), w, u, y, r2, vr, heat
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                do t = 1, 6
                    hold(t) = p%own(l, t)
                    hold(t + 6) = p%own(l, t + 6)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), sqrt(r2))
                call tilted_arm(own(pair_tilt), p%normal, dx, r, arm)
                call tilted_arm(-pair(pair_tilt, j), p%normal, dx, r, arm_j)
                call tilted_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), arm, arm_j, &
                                  g)
                u = viscosity(q%h(l), own, pair(1, j), w, r2, vr)
                y = w*own(pair_keep)*pair(pair_keep, j)
                call hourglass_viscous(y*own(pair_hold), y*pair(pair_hold, j), &
                                       own(pair_affine + 1), pair(pair_affine + 1, j), dv, r, d, &
                                       heat)
                call hourglass_stiff(most_drawn, y*hold(held_whole)*held(held_whole, j), &
                                     hold(held_stiffness) + held(held_stiffness, j), &
                                     hold(held_affine + 1), held(held_affine + 1, j), dx, r, e)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + (u*r(t) + d(t))
                    acc(l, at_hold + t) = acc(l, at_hold + t) + e(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
                acc(l, at_friction) = acc(l, at_friction) + heat
                acc(l, at_work) = acc(l, at_work) - (e(1)*dv(1) + e(2)*dv(2) + e(3)*dv(3))/2
            end do
        end do
        p%sums = acc
    end subroutine sum_plate

    !> Stress, viscosity and stiff hourglass force over the direct neighbours. In a total-Lagrangian
    !> body X_ij weighs the pairs, and the stress (there Piola's) acts along it.
    subroutine sum_stiff(total, p, x, v, x_ref, pair, h, list)
        real(rk), intent(in) :: total !! 1 in a total-Lagrangian body, else 0
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), arm(3), own(n_pair), g(3), d(3)
        real(rk) :: w, u, r2, vr
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                do t = 1, 3 ! a choice would not be vector code
                    arm(t) = total*dx(t) + (1 - total)*r(t)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), &
                                  sqrt(arm(1)*arm(1) + arm(2)*arm(2) + arm(3)*arm(3)))
                call stress_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), arm, g)
                u = viscosity(q%h(l), own, pair(1, j), w, r2, vr)
                call hourglass_stiff(most_bent, w*own(pair_keep)*pair(pair_keep, j), &
                                     own(pair_hold) + pair(pair_hold, j), own(pair_affine + 1), &
                                     pair(pair_affine + 1, j), dx, r, d)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                    acc(l, at_hold + t) = acc(l, at_hold + t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        p%sums = acc
    end subroutine sum_stiff

    !> Stress (with the arms of tilted gradients), viscosity, and stiff hourglass force along the
    !> axes of the material.
    subroutine sum_axial(p, x, v, x_ref, hold, pair, h, list)
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *), h(*)
        real(real32), intent(in) :: hold(6, *)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), own(n_pair), g(3), d(3)
        real(rk) :: w, u, r2, vr, stiffness(6), arm(3), arm_j(3)
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            if (p%variable) call pair_kernels(p, h(j), q)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                do t = 1, 8
                    own(t) = p%row(l, t)
                    own(t + 8) = p%row(l, t + 8)
                    own(t + 16) = p%row(l, t + 16)
                end do
                do t = 1, 6
                    stiffness(t) = p%hold(l, t) + real(hold(t, j), rk)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*pair(pair_volume, j) &
                    *kernel_slope(q%scale(l), q%half_over_h(l), sqrt(r2))
                call ply_arm(own(pair_tilt), p%normal, dx, r, arm)
                call ply_arm(-pair(pair_tilt, j), p%normal, dx, r, arm_j)
                call tilted_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), arm, arm_j, &
                                  g)
                u = viscosity(q%h(l), own, pair(1, j), w, r2, vr)
                call hourglass_axial(w*own(pair_keep)*pair(pair_keep, j), stiffness, &
                                     own(pair_affine + 1), pair(pair_affine + 1, j), dx, dx, r, d)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                    acc(l, at_hold + t) = acc(l, at_hold + t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        p%sums = acc
    end subroutine sum_axial

    !> Monaghan's viscosity of a pair, as a factor of x_ij.
    pure function viscosity(h, own, other, w, r2, vr) result(u)
        real(rk), intent(in) :: h !! smoothing length [m]
        real(rk), intent(in) :: own(n_pair), other(n_pair), w, r2, vr
        real(rk) :: u

        u = viscous_force(w, h, r2, vr, own(pair_linear) + other(pair_linear), &
                          own(pair_quadratic) + other(pair_quadratic))
    end function viscosity
end module brz_solid_pair_sums
