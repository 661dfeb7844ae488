! SPDX-License-Identifier: MIT
!> Eigenvalues and eigenvectors of a symmetric 3x3 matrix by Jacobi rotations. Point physics.
module brz_eigen
    use brz_kinds, only: rk
    implicit none
    private
    public :: diagonalise

contains

    !> Turn a into its eigenvalues, on its diagonal, and q into its eigenvectors, column by column.
    !@cuf attributes(host,device) &
    pure subroutine diagonalise(a, q)
        real(rk), intent(inout) :: a(3, 3) !! symmetric
        real(rk), intent(out) :: q(3, 3)
        integer :: i, j, sweep

        do j = 1, 3
            do i = 1, 3
                q(i, j) = 0
            end do
            q(j, j) = 1
        end do
        do sweep = 1, 8
            call rotate_away(a, q, 1, 2)
            call rotate_away(a, q, 1, 3)
            call rotate_away(a, q, 2, 3)
        end do
    end subroutine diagonalise

    !> One Jacobi rotation: makes a(i, j) vanish and turns the eigenvectors q with it.
    !@cuf attributes(host,device) &
    pure subroutine rotate_away(a, q, i, j)
        real(rk), intent(inout) :: a(3, 3), q(3, 3)
        integer, intent(in) :: i, j
        real(rk), parameter :: least = epsilon(1.0_rk)**2 !! angle that is worth a rotation
        real(rk) :: half, t, c, s, u, w
        integer :: k

        if (abs(a(i, j)) <= tiny(1.0_rk) + least*abs(a(j, j) - a(i, i))) return
        half = (a(j, j) - a(i, i))/(2*a(i, j))
        t = sign(1.0_rk, half)/(abs(half) + sqrt(half*half + 1))
        c = 1/sqrt(t*t + 1)
        s = t*c
        do k = 1, 3
            u = a(k, i)
            w = a(k, j)
            a(k, i) = c*u - s*w
            a(k, j) = s*u + c*w
        end do
        do k = 1, 3
            u = a(i, k)
            w = a(j, k)
            a(i, k) = c*u - s*w
            a(j, k) = s*u + c*w
            u = q(k, i)
            w = q(k, j)
            q(k, i) = c*u - s*w
            q(k, j) = s*u + c*w
        end do
    end subroutine rotate_away
end module brz_eigen
