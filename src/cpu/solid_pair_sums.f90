! SPDX-License-Identifier: MIT
!> Pass 2, the loops over the direct neighbours of a particle, eight pairs at a time.
!>
!> One loop for each set of forces, so that no body pays for a force that it does not use. All
!> loops are vectorised by the compiler: their inner loop has constant length and no branch.
module brz_solid_pair_sums
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, real32, rk
    use brz_pair_force, only: hourglass_axial, hourglass_stiff, hourglass_viscous, stress_force, &
                              viscous_force
    use brz_solid_lanes, only: add_lanes, centre_t
    use brz_solid_state, only: lanes, n_near, n_pair, pair_affine, pair_hold, pair_keep, &
                               pair_linear, pair_quadratic, pair_stress, pair_volume
    implicit none
    private
    public :: sum_plain, sum_viscous, sum_stiff, sum_axial, viscosity, mirrored
    public :: n_terms, at_heat, at_friction, at_drag, at_hold

    ! slots of the sums: 1..3 force of the stress [N]
    integer, parameter :: at_heat = 4 !! heat of the viscosity [W]
    integer, parameter :: at_friction = 5 !! heat of the viscous hourglass force [W]
    integer, parameter :: at_drag = 5 !! + 1..3: viscous forces [N]
    integer, parameter :: at_hold = 8 !! + 1..3: stiff hourglass force, or artificial stress [N]
    integer, parameter :: n_terms = 11

contains

    !> Stress and viscosity over the direct neighbours.
    subroutine sum_plain(n, p, x, v, pair, list, f)
        integer, intent(in) :: n
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, n)
        real(rk), intent(in) :: v(3, n), pair(n_pair, n)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(rk) :: acc(lanes, at_hold), r(3), dv(3), own(n_pair), other(n_pair), g(3), w, u, r2, vr
        integer :: k, l, j, t

        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ unroll 1
            do l = 1, lanes
                j = list(k + l)
                do t = 1, 3
                    r(t) = real(x(t, p%i) - x(t, j), rk)
                    dv(t) = v(t, p%i) - v(t, j)
                end do
                do t = 1, pair_affine
                    other(t) = pair(t, j)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*other(pair_volume) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r2))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
                u = viscosity(p, own, other, w, r2, vr)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        call add_lanes(at_hold, acc, f)
    end subroutine sum_plain

    !> Stress, viscosity and viscous hourglass force over the direct neighbours. Whole rows are
    !> loaded and turned in registers.
    subroutine sum_viscous(first, p, near, pair, list, f)
        integer, intent(in) :: first !! of the body: the particle of the first rows
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: near(n_near, first:*)
        real(rk), intent(in) :: pair(n_pair, first:*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(dp) :: here(n_near), row(n_near, lanes)
        real(rk) :: one(8, lanes), two(8, lanes), three(8, lanes)
        real(rk) :: acc(lanes, at_hold), r(3), dv(3), own(n_pair), other(n_pair), g(3), d(3)
        real(rk) :: w, u, y, r2, vr, heat
        integer :: k, l, t

        here = near(:, p%i)
        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ novector
            do l = 1, lanes
                row(:, l) = near(:, list(k + l))
                one(:, l) = pair(1:8, list(k + l))
                two(:, l) = pair(9:16, list(k + l))
                three(:, l) = pair(17:24, list(k + l))
            end do
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(here(t) - row(t, l), rk)
                    dv(t) = real(here(t + 3) - row(t + 3, l), rk)
                end do
                do t = 1, 8
                    other(t) = one(t, l)
                    other(t + 8) = two(t, l)
                    other(t + 16) = three(t, l)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*(other(pair_volume) + real(row(n_near, l), rk)) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r2))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
                u = viscosity(p, own, other, w, r2, vr)
                y = w*own(pair_keep)*other(pair_keep)
                call hourglass_viscous(y*own(pair_hold), y*other(pair_hold), &
                                       own(pair_affine + 1), other(pair_affine + 1), dv, r, d, heat)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + (u*r(t) + d(t))
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
                acc(l, at_friction) = acc(l, at_friction) + heat
            end do
        end do
        call add_lanes(at_hold, acc, f)
    end subroutine sum_viscous

    !> Stress, viscosity and stiff hourglass force over the direct neighbours. In a total-Lagrangian
    !> body X_ij weighs the pairs, and the stress (there Piola's) acts along it.
    subroutine sum_stiff(total, p, x, v, x_ref, pair, list, f)
        real(rk), intent(in) :: total !! 1 in a total-Lagrangian body, else 0
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), arm(3), own(n_pair), other(n_pair)
        real(rk) :: g(3), d(3), w, u, r2, vr
        integer :: k, l, j, t

        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ unroll 1
            do l = 1, lanes
                j = list(k + l)
                do t = 1, 3
                    r(t) = real(x(t, p%i) - x(t, j), rk)
                    dx(t) = real(x_ref(t, p%i) - x_ref(t, j), rk)
                    dv(t) = v(t, p%i) - v(t, j)
                    arm(t) = total*dx(t) + (1 - total)*r(t) ! a choice would not be vector code
                end do
                do t = 1, pair_affine
                    other(t) = pair(t, j)
                end do
                do t = pair_affine + 1, n_pair
                    other(t) = pair(t, j)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*other(pair_volume) &
                    *kernel_slope(p%scale, p%half_over_h, &
                                  sqrt(arm(1)*arm(1) + arm(2)*arm(2) + arm(3)*arm(3)))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), arm, g)
                u = viscosity(p, own, other, w, r2, vr)
                call hourglass_stiff(w*own(pair_keep)*other(pair_keep), &
                                     own(pair_hold) + other(pair_hold), own(pair_affine + 1), &
                                     other(pair_affine + 1), dx, r, d)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                    acc(l, at_hold + t) = acc(l, at_hold + t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        call add_lanes(n_terms, acc, f)
    end subroutine sum_stiff

    !> Stress, viscosity and stiff hourglass force along the axes of the material.
    subroutine sum_axial(p, x, v, x_ref, hold, pair, list, f)
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *)
        real(real32), intent(in) :: hold(6, *)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: f(n_terms)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), own(n_pair), other(n_pair), g(3), d(3)
        real(rk) :: w, u, r2, vr, stiffness(6)
        integer :: k, l, j, t

        own = pair(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ unroll 1
            do l = 1, lanes
                j = list(k + l)
                do t = 1, 3
                    r(t) = real(x(t, p%i) - x(t, j), rk)
                    dx(t) = real(x_ref(t, p%i) - x_ref(t, j), rk)
                    dv(t) = v(t, p%i) - v(t, j)
                end do
                do t = 1, pair_affine
                    other(t) = pair(t, j)
                end do
                do t = pair_affine + 1, n_pair
                    other(t) = pair(t, j)
                end do
                do t = 1, 6
                    stiffness(t) = real(hold(t, p%i), rk) + real(hold(t, j), rk)
                end do
                r2 = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
                vr = r(1)*dv(1) + r(2)*dv(2) + r(3)*dv(3)
                w = own(pair_volume)*other(pair_volume) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r2))
                call stress_force(w, own(pair_stress + 1), other(pair_stress + 1), r, g)
                u = viscosity(p, own, other, w, r2, vr)
                call hourglass_axial(w*own(pair_keep)*other(pair_keep), stiffness, &
                                     own(pair_affine + 1), other(pair_affine + 1), dx, r, d)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                    acc(l, at_hold + t) = acc(l, at_hold + t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        call add_lanes(n_terms, acc, f)
    end subroutine sum_axial

    !> Monaghan's viscosity of a pair, as a factor of x_ij.
    pure function viscosity(p, own, other, w, r2, vr) result(u)
        type(centre_t), intent(in) :: p
        real(rk), intent(in) :: own(n_pair), other(n_pair), w, r2, vr
        real(rk) :: u

        u = viscous_force(w, p%h, r2, vr, own(pair_linear) + other(pair_linear), &
                          own(pair_quadratic) + other(pair_quadratic))
    end function viscosity

    !> A symmetric tensor seen in the mirror planes with s = -1.
    pure function mirrored(s, k) result(m)
        real(rk), intent(in) :: s(3)
        real(real32), intent(in) :: k(6)
        real(rk) :: m(6)

        m(1:3) = k(1:3)
        m(4:6) = k(4:6)*[s(1)*s(2), s(2)*s(3), s(1)*s(3)]
    end function mirrored
end module brz_solid_pair_sums
