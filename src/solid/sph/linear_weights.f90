! SPDX-License-Identifier: MIT
!> Weights by which a linear field at scattered points is continued to a place: moving least
!> squares (Lancaster and Salkauskas 1981), with a constant in directions that the points do not
!> span.
module brz_linear_weights
    use brz_eigen, only: diagonalise
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: linear_weights

    real(dp), parameter :: flat = 1e-4_dp !! second moment over the reach squared that is none

contains

    !> Value and gradient at `at`: sums of `value` and `slope` times what the points have.
    pure subroutine linear_weights(x, at, reach, value, slope)
        real(dp), intent(in) :: x(:, :) !! (3, n) points, all within the reach [m]
        real(dp), intent(in) :: at(3), reach !! [m]
        real(dp), intent(out) :: value(:) !! (n)
        real(dp), intent(out) :: slope(:, :) !! (3, n) [1/m]
        real(dp) :: w(size(value)), centre(3), s(3, 3), d(3)
        integer :: i, a

        do i = 1, size(value)
            w(i) = weight_of(norm2(x(:, i) - at)/reach)
        end do
        w = w/sum(w)
        centre = matmul(x, w)
        s = 0
        do i = 1, size(value)
            d = (x(:, i) - centre)/reach
            do a = 1, 3
                s(:, a) = s(:, a) + w(i)*d*d(a)
            end do
        end do
        call invert(s)
        do i = 1, size(value)
            slope(:, i) = w(i)*matmul(s, x(:, i) - centre)/reach**2
            value(i) = w(i) + dot_product(slope(:, i), at - centre)
        end do
    end subroutine linear_weights

    !> Wendland C2, of the distance over the reach.
    pure real(dp) function weight_of(q) result(w)
        real(dp), intent(in) :: q

        w = max(1 - q, 0.0_dp)**4*(4*q + 1)
    end function weight_of

    !> Inverse of a symmetric matrix where it has one: by eigenvalues, then by Newton's method to
    !> the last digit of real64.
    pure subroutine invert(s)
        real(dp), intent(inout) :: s(3, 3)
        real(rk) :: a(3, 3), q(3, 3)
        real(dp) :: p(3, 3)
        integer :: i, k

        a = real(s, rk)
        call diagonalise(a, q)
        p = 0
        do k = 1, 3
            if (a(k, k) <= flat) cycle
            do i = 1, 3
                p(:, i) = p(:, i) + q(:, k)*q(i, k)/a(k, k)
            end do
        end do
        do k = 1, 2
            p = 2*p - matmul(p, matmul(s, p))
        end do
        s = p
    end subroutine invert
end module brz_linear_weights
