! SPDX-License-Identifier: MIT
!> Pass 1, the loops over the direct neighbours of a particle, eight pairs at a time.
!>
!> The compiler turns the inner loops into vector code: constant length, no branch.
module brz_solid_gradient_sums
    use brz_gradient, only: moment_terms, outer_terms
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, int32, rk
    use brz_solid_lanes, only: add_lanes, centre_t
    use brz_solid_state, only: lanes, n_near
    implicit none
    private
    public :: sum_plain, sum_bending, n_moment, n_outer, n_terms, at_g, at_x

    ! slots of the sums: moments of x_ij (x) x_ij, then v_ij (x) x_ij, then X_ij (x) x_ij
    integer, parameter :: n_moment = 6, n_outer = 9
    integer, parameter :: at_g = n_moment, at_x = n_moment + n_outer
    integer, parameter :: n_terms = n_moment + 2*n_outer

contains

    !> Sums over the direct neighbours: moments and velocity.
    !>
    !> Whole rows are loaded and turned in registers, which is faster than to gather their numbers
    !> one by one. The nil at the end of a row is added so that the compiler takes all of it.
    subroutine sum_plain(first, p, near, list, sums)
        integer, intent(in) :: first !! of the body: the particle of the first row
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: near(n_near, first:*)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: sums(n_terms)
        real(dp) :: row(n_near, lanes), own(n_near)
        real(rk) :: acc(lanes, at_x), r(3), dv(3), m(n_moment), g(n_outer), w
        integer :: k, l, t

        own = near(:, p%i)
        acc = 0
        do k = 0, p%count - 1, lanes
            !GCC$ novector
            do l = 1, lanes
                row(:, l) = near(:, list(k + l))
            end do
            !GCC$ unroll 1
            do l = 1, lanes
                do t = 1, 3
                    r(t) = real(own(t) - row(t, l), rk)
                    dv(t) = real(own(t + 3) - row(t + 3, l), rk)
                end do
                w = real(row(7, l) + row(8, l), rk) &
                    *kernel_slope(p%scale, p%half_over_h, sqrt(r(1)*r(1) + r(2)*r(2) + r(3)*r(3)))
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
        call add_lanes(at_x, acc, sums)
    end subroutine sum_plain

    !> Sums over the direct neighbours: moments, velocity and reference position.
    subroutine sum_bending(n, p, x, v, x_ref, volume, list, sums)
        integer, intent(in) :: n
        type(centre_t), intent(in) :: p
        real(dp), intent(in) :: x(3, n), x_ref(3, n)
        real(rk), intent(in) :: v(3, n), volume(n)
        integer(int32), intent(in) :: list(*)
        real(rk), intent(out) :: sums(n_terms)
        real(rk) :: acc(lanes, n_terms), r(3), dv(3), dx(3), m(n_moment), g(n_outer), a(n_outer), w
        integer :: k, l, j, t

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
                w = volume(j)*kernel_slope(p%scale, p%half_over_h, &
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
        call add_lanes(n_terms, acc, sums)
    end subroutine sum_bending
end module brz_solid_gradient_sums
