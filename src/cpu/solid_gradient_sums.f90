! SPDX-License-Identifier: MIT
!> Pass 1, the loops over the direct neighbours of a group of particles.
!>
!> The compiler turns the inner loops, over the lanes, into vector code: constant length, no branch.
module brz_solid_gradient_sums
    use brz_gradient, only: moment_terms, outer_terms
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, rk
    use brz_solid_lanes, only: body_kernel, group_t, kernel_t, pair_kernels
    use brz_solid_state, only: at_f, at_g, at_s, at_x, at_y, lanes, n_terms => n_sums
    use brz_tilted_arm, only: tilted_arm
    implicit none
    private
    public :: sum_plain, sum_bending, sum_drawn, sum_tilted
    public :: n_moment, n_outer

    integer, parameter :: n_moment = 6, n_outer = 9

contains

    !> Add the direct neighbours to the sums: moments and velocity.
    subroutine sum_plain(p, x, v, volume, h, list, sums)
        type(group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_terms)
        real(rk) :: acc(lanes, at_x), r(3), dv(3), m(n_moment), g(n_outer), w
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = sums(:, :at_x)
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
                w = volume(j)*kernel_slope(q%scale(l), q%half_over_h(l), &
                                           sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)))
                call moment_terms(w, r, m)
                call outer_terms(w, dv, r, g)
                do t = 1, n_moment
                    acc(l, t) = acc(l, t) + m(t)
                end do
                do t = 1, n_outer
                    acc(l, at_g + t) = acc(l, at_g + t) + g(t)
                end do
            end do
        end do
        sums(:, :at_x) = acc
        sums(:, at_x + 1:) = 0
    end subroutine sum_plain

    !> Add the direct neighbours to the sums: moments, velocity and reference position. A
    !> total-Lagrangian body has x and x_ref change places.
    subroutine sum_bending(p, x, v, x_ref, volume, h, list, sums)
        type(group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_terms)
        real(rk) :: acc(lanes, at_s), r(3), dv(3), dx(3), m(n_moment), g(n_outer), a(n_outer), w
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = sums(:, :at_s)
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
                w = volume(j)*kernel_slope(q%scale(l), q%half_over_h(l), &
                                           sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)))
                call moment_terms(w, r, m)
                call outer_terms(w, dv, r, g)
                call outer_terms(w, dx, r, a)
                do t = 1, n_moment
                    acc(l, t) = acc(l, t) + m(t)
                end do
                do t = 1, n_outer
                    acc(l, at_g + t) = acc(l, at_g + t) + g(t)
                    acc(l, at_x + t) = acc(l, at_x + t) + a(t)
                end do
            end do
        end do
        sums(:, :at_s) = acc
        sums(:, at_s + 1:) = 0
    end subroutine sum_bending

    !> The same with the moments of the reference position, for the hold.
    subroutine sum_drawn(p, x, v, x_ref, volume, h, list, sums)
        type(group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_terms)
        real(rk) :: acc(lanes, at_y), r(3), dv(3), dx(3), m(n_moment), g(n_outer), a(n_outer)
        real(rk) :: s(n_moment), w
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = sums(:, :at_y)
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
                w = volume(j)*kernel_slope(q%scale(l), q%half_over_h(l), &
                                           sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)))
                call moment_terms(w, r, m)
                call outer_terms(w, dv, r, g)
                call outer_terms(w, dx, r, a)
                call moment_terms(w, dx, s)
                do t = 1, n_moment
                    acc(l, t) = acc(l, t) + m(t)
                    acc(l, at_s + t) = acc(l, at_s + t) + s(t)
                end do
                do t = 1, n_outer
                    acc(l, at_g + t) = acc(l, at_g + t) + g(t)
                    acc(l, at_x + t) = acc(l, at_x + t) + a(t)
                end do
            end do
        end do
        sums(:, :at_y) = acc
        sums(:, at_y + 1:) = 0
    end subroutine sum_drawn

    !> All of it, for a group in which some have a tilt.
    subroutine sum_tilted(p, x, v, x_ref, volume, h, list, sums)
        type(group_t), intent(in) :: p
        real(dp), intent(in) :: x(3, *), x_ref(3, *)
        real(rk), intent(in) :: v(3, *), volume(*), h(*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(inout) :: sums(lanes, n_terms)
        real(rk) :: acc(lanes, at_f), r(3), dv(3), dx(3), y(3), m(n_moment), g(n_outer)
        real(rk) :: a(n_outer), b(n_outer), s(n_moment), w
        type(kernel_t) :: q
        integer :: k, l, j, t

        acc = sums(:, :at_f)
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
                w = volume(j)*kernel_slope(q%scale(l), q%half_over_h(l), &
                                           sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)))
                call tilted_arm(p%tilt(l), p%normal, dx, r, y)
                call moment_terms(w, r, m)
                call outer_terms(w, dv, y, g)
                call outer_terms(w, dx, r, a)
                call outer_terms(w, r, y, b)
                call moment_terms(w, dx, s)
                do t = 1, n_moment
                    acc(l, t) = acc(l, t) + m(t)
                    acc(l, at_s + t) = acc(l, at_s + t) + s(t)
                end do
                do t = 1, n_outer
                    acc(l, at_g + t) = acc(l, at_g + t) + g(t)
                    acc(l, at_x + t) = acc(l, at_x + t) + a(t)
                    acc(l, at_y + t) = acc(l, at_y + t) + b(t)
                end do
            end do
        end do
        sums(:, :at_f) = acc
        sums(:, at_f + 1:) = 0
    end subroutine sum_tilted
end module brz_solid_gradient_sums
