! SPDX-License-Identifier: MIT
!> Loops over the direct neighbours of a group in total-Lagrangian bodies that bend: tilted
!> gradients, particles wider in some directions than in others.
!>
!> X_ij weighs the pairs, in coordinates of the lattice (brz_wide_lattice). The compiler turns the
!> inner loops, over the lanes, into vector code: constant length, no branch.
module brz_solid_wide_sums
    use brz_gradient, only: moment_terms, outer_terms
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, real32, rk
    use brz_pair_force, only: hourglass_axial, metric_square, viscous_force
    use brz_solid_lanes, only: body_kernel, group_t, kernel_t
    use brz_solid_state, only: at_drag, at_f, at_g, at_heat, at_hold, at_x, at_y, lanes, n_pair, &
                               n_sums, n_terms, pair_affine, pair_hold, pair_keep, &
                               pair_linear, pair_quadratic, pair_stress, pair_tilt, pair_volume
    use brz_tilted_arm, only: lifted_arm, tilted_force
    implicit none
    private
    public :: sum_referred, sum_wide

    integer, parameter :: n_moment = 6, n_outer = 9

contains

    !> Pass 1, for a group in which some have a tilt: moments of X_ij, velocity along the arms,
    !> x_ij (x) X_ij, X_ij (x) y_ij and x_ij (x) y_ij.
    subroutine sum_referred(p, x, v, x_ref, volume, list, sums)
        type(group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_sums)
        real(rk) :: acc(lanes, n_sums), r(3), dv(3), dx(3), y(3), m(n_moment), g(n_outer)
        real(rk) :: a(n_outer), b(n_outer), f(n_outer), w
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = sums
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                end do
                w = volume(j)*kernel_slope(q%scale(l), q%half_over_h(l), &
                                           sqrt(dx(1)*dx(1) + dx(2)*dx(2) + dx(3)*dx(3)))
                call lifted_arm(p%tilt(l), p%lift(l), p%normal, dx, y)
                call moment_terms(w, dx, m)
                call outer_terms(w, dv, y, g)
                call outer_terms(w, r, dx, a)
                call outer_terms(w, dx, y, b)
                call outer_terms(w, r, y, f)
                do t = 1, n_moment
                    acc(l, t) = acc(l, t) + m(t)
                end do
                do t = 1, n_outer
                    acc(l, at_g + t) = acc(l, at_g + t) + g(t)
                    acc(l, at_x + t) = acc(l, at_x + t) + a(t)
                    acc(l, at_y + t) = acc(l, at_y + t) + b(t)
                    acc(l, at_f + t) = acc(l, at_f + t) + f(t)
                end do
            end do
        end do
        sums = acc
    end subroutine sum_referred

    !> Pass 2: stress (Piola's) along the arms of tilted gradients, viscosity and stiff hourglass
    !> force along the axes of the lattice, both in its metric.
    subroutine sum_wide(p, x, v, x_ref, hold, pair, list)
        type(group_t), intent(inout) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), pair(n_pair, *)
        real(real32), intent(in) :: hold(6, *)
        integer(int32), intent(in) :: list(*)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), unloaded(3), own(n_pair), g(3), d(3)
        real(rk) :: w, u, r2, vr, s2, stiffness(6), arm(3), arm_j(3)
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = p%sums
        call body_kernel(p, q)
        do k = 1, p%count
            j = list(k)
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(p%x(l, t) - x(t, j), rk)
                    dx(t) = real(p%x_ref(l, t) - x_ref(t, j), rk)
                    dv(t) = p%v(l, t) - v(t, j)
                    unloaded(t) = p%width(t)*dx(t)
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
                    *kernel_slope(q%scale(l), q%half_over_h(l), &
                                  sqrt(dx(1)*dx(1) + dx(2)*dx(2) + dx(3)*dx(3)))
                call lifted_arm(own(pair_tilt), own(pair_hold), p%normal, dx, arm)
                call lifted_arm(-pair(pair_tilt, j), -pair(pair_hold, j), p%normal, dx, arm_j)
                call tilted_force(w, own(pair_stress + 1), pair(pair_stress + 1, j), arm, arm_j, &
                                  g)
                s2 = metric_square(dx, unloaded)
                u = viscous_force(w*s2, q%h(l)/sqrt(s2), r2, vr, &
                                  own(pair_linear) + pair(pair_linear, j), &
                                  own(pair_quadratic) + pair(pair_quadratic, j))
                call hourglass_axial(w*own(pair_keep)*pair(pair_keep, j), stiffness, &
                                     own(pair_affine + 1), pair(pair_affine + 1, j), dx, &
                                     unloaded, r, d)
                do t = 1, 3
                    acc(l, t) = acc(l, t) + g(t)
                    acc(l, at_drag + t) = acc(l, at_drag + t) + u*r(t)
                    acc(l, at_hold + t) = acc(l, at_hold + t) + d(t)
                end do
                acc(l, at_heat) = acc(l, at_heat) - u*vr/2
            end do
        end do
        p%sums = acc
    end subroutine sum_wide
end module brz_solid_wide_sums
