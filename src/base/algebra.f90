! SPDX-License-Identifier: MIT
!> Algebra of 3x3 matrices and of symmetric tensors in six components.
!>
!> Symmetric tensors are stored as xx, yy, zz, xy, yz, xz (the order of VTK), tensor components
!> (shear strains are not doubled). Point physics: compiled for the CPU and for the GPU.
module brz_algebra
    use brz_kinds, only: rk
    implicit none
    private
    public :: inverse3, multiply3, determinant3, double_dot, copy_matrix
    public :: to_matrix, to_voigt, rotation_exp, rotate_voigt, turn_ratios

contains

    !> Determinant of a 3x3 matrix.
    !@cuf attributes(host,device) &
    pure function determinant3(a) result(d)
        real(rk), intent(in) :: a(3, 3)
        real(rk) :: d

        d = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) &
             - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
             + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
    end function determinant3

    !> Inverse of a 3x3 matrix by cofactors. `ok` is false, and `b` zero, where it is singular.
    !@cuf attributes(host,device) &
    pure subroutine inverse3(a, b, ok)
        real(rk), intent(in) :: a(3, 3)
        real(rk), intent(out) :: b(3, 3) !! inverse of a
        logical, intent(out) :: ok
        real(rk) :: d, r

        d = determinant3(a)
        ok = abs(d) > tiny(d)
        r = 0
        if (ok) r = 1/d
        b(1, 1) = (a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2))*r
        b(1, 2) = (a(1, 3)*a(3, 2) - a(1, 2)*a(3, 3))*r
        b(1, 3) = (a(1, 2)*a(2, 3) - a(1, 3)*a(2, 2))*r
        b(2, 1) = (a(2, 3)*a(3, 1) - a(2, 1)*a(3, 3))*r
        b(2, 2) = (a(1, 1)*a(3, 3) - a(1, 3)*a(3, 1))*r
        b(2, 3) = (a(1, 3)*a(2, 1) - a(1, 1)*a(2, 3))*r
        b(3, 1) = (a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))*r
        b(3, 2) = (a(1, 2)*a(3, 1) - a(1, 1)*a(3, 2))*r
        b(3, 3) = (a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1))*r
    end subroutine inverse3

    !> Copy a 3x3 matrix, or nine numbers side by side in memory.
    !@cuf attributes(host,device) &
    pure subroutine copy_matrix(a, b)
        real(rk), intent(in) :: a(3, 3)
        real(rk), intent(out) :: b(3, 3)
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                b(i, j) = a(i, j)
            end do
        end do
    end subroutine copy_matrix

    !> Product c = a b of 3x3 matrices.
    !@cuf attributes(host,device) &
    pure subroutine multiply3(a, b, c)
        real(rk), intent(in) :: a(3, 3), b(3, 3)
        real(rk), intent(out) :: c(3, 3) !! not one of a, b
        integer :: i, j

        do j = 1, 3
            do i = 1, 3
                c(i, j) = a(i, 1)*b(1, j) + a(i, 2)*b(2, j) + a(i, 3)*b(3, j)
            end do
        end do
    end subroutine multiply3

    !> Symmetric 3x3 matrix of six components.
    !@cuf attributes(host,device) &
    pure subroutine to_matrix(s, m)
        real(rk), intent(in) :: s(6) !! xx, yy, zz, xy, yz, xz
        real(rk), intent(out) :: m(3, 3)

        m(1, 1) = s(1)
        m(2, 2) = s(2)
        m(3, 3) = s(3)
        m(1, 2) = s(4)
        m(2, 1) = s(4)
        m(2, 3) = s(5)
        m(3, 2) = s(5)
        m(1, 3) = s(6)
        m(3, 1) = s(6)
    end subroutine to_matrix

    !> Six components of the symmetric part of a 3x3 matrix.
    !@cuf attributes(host,device) &
    pure subroutine to_voigt(m, s)
        real(rk), intent(in) :: m(3, 3)
        real(rk), intent(out) :: s(6) !! xx, yy, zz, xy, yz, xz

        s(1) = m(1, 1)
        s(2) = m(2, 2)
        s(3) = m(3, 3)
        s(4) = (m(1, 2) + m(2, 1))/2
        s(5) = (m(2, 3) + m(3, 2))/2
        s(6) = (m(1, 3) + m(3, 1))/2
    end subroutine to_voigt

    !> Ratios sin(t)/t and (1 - cos(t))/t^2 of an angle t, by their series up to an angle of 1 and
    !> by doubling the angle beyond: no cancellation at small angles, and no sine of a large angle,
    !> which would need memory on a GPU.
    !@cuf attributes(host,device) &
    pure subroutine turn_ratios(t2, a, b)
        real(rk), intent(in) :: t2 !! t^2, at least 0 [rad2]
        real(rk), intent(out) :: a, b
        real(rk) :: x, cosine
        integer :: n

        x = t2
        n = 0
        do while (x > 1 .and. n < 60)
            x = x/4
            n = n + 1
        end do
        a = 1 - x*(1/6.0_rk)*(1 - x*(1/20.0_rk)*(1 - x*(1/42.0_rk)*(1 - x*(1/72.0_rk)*( &
            1 - x*(1/110.0_rk)*(1 - x*(1/156.0_rk)*(1 - x*(1/210.0_rk)*(1 - x*(1/272.0_rk))))))))
        b = (1 - x*(1/12.0_rk)*(1 - x*(1/30.0_rk)*(1 - x*(1/56.0_rk)*(1 - x*(1/90.0_rk)*( &
            1 - x*(1/132.0_rk)*(1 - x*(1/182.0_rk)*(1 - x*(1/240.0_rk)*(1 - x*(1/306.0_rk)))))))))/2
        do while (n > 0)
            cosine = 1 - b*x
            b = a*a/2
            a = a*cosine
            x = 4*x
            n = n - 1
        end do
    end subroutine turn_ratios

    !> Rotation exp(w t) of the skew part of a velocity gradient, by Rodrigues' formula (exact).
    !@cuf attributes(host,device) &
    pure subroutine rotation_exp(l, t, q)
        real(rk), intent(in) :: l(3, 3) !! velocity gradient dv_i/dx_j [1/s]
        real(rk), intent(in) :: t !! time [s]
        real(rk), intent(out) :: q(3, 3) !! rotation matrix
        real(rk) :: x, y, z, t2, a, b

        x = (l(3, 2) - l(2, 3))*t/2
        y = (l(1, 3) - l(3, 1))*t/2
        z = (l(2, 1) - l(1, 2))*t/2
        t2 = x*x + y*y + z*z
        call turn_ratios(t2, a, b)
        q(1, 1) = 1 - b*(y*y + z*z)
        q(2, 2) = 1 - b*(x*x + z*z)
        q(3, 3) = 1 - b*(x*x + y*y)
        q(1, 2) = b*x*y - a*z
        q(2, 1) = b*x*y + a*z
        q(1, 3) = b*x*z + a*y
        q(3, 1) = b*x*z - a*y
        q(2, 3) = b*y*z - a*x
        q(3, 2) = b*y*z + a*x
    end subroutine rotation_exp

    !> Tensor s turned by the rotation q: q s q^T, in place.
    !@cuf attributes(host,device) &
    pure subroutine rotate_voigt(q, s)
        real(rk), intent(in) :: q(3, 3) !! rotation matrix
        real(rk), intent(inout) :: s(6) !! xx, yy, zz, xy, yz, xz
        real(rk) :: t(3, 3)
        integer :: i

        do i = 1, 3
            t(i, 1) = q(i, 1)*s(1) + q(i, 2)*s(4) + q(i, 3)*s(6)
            t(i, 2) = q(i, 1)*s(4) + q(i, 2)*s(2) + q(i, 3)*s(5)
            t(i, 3) = q(i, 1)*s(6) + q(i, 2)*s(5) + q(i, 3)*s(3)
        end do
        do i = 1, 3
            s(i) = t(i, 1)*q(i, 1) + t(i, 2)*q(i, 2) + t(i, 3)*q(i, 3)
        end do
        s(4) = t(1, 1)*q(2, 1) + t(1, 2)*q(2, 2) + t(1, 3)*q(2, 3)
        s(5) = t(2, 1)*q(3, 1) + t(2, 2)*q(3, 2) + t(2, 3)*q(3, 3)
        s(6) = t(1, 1)*q(3, 1) + t(1, 2)*q(3, 2) + t(1, 3)*q(3, 3)
    end subroutine rotate_voigt

    !> Double contraction a : b of two symmetric tensors (the shears count twice).
    !@cuf attributes(host,device) &
    pure function double_dot(a, b) result(c)
        real(rk), intent(in) :: a(6), b(6)
        real(rk) :: c

        c = a(1)*b(1) + a(2)*b(2) + a(3)*b(3) + 2*(a(4)*b(4) + a(5)*b(5) + a(6)*b(6))
    end function double_dot
end module brz_algebra
