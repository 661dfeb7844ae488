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
    !>
    !> In changes of what is there (Rutishauser 1966): the trace and the length of the eigenvectors
    !> stay to the rounding of the changes, or bodies that are diagonalised in every step creep.
    !@cuf attributes(host,device) &
    pure subroutine rotate_away(a, q, i, j)
        real(rk), intent(inout) :: a(3, 3), q(3, 3)
        integer, intent(in) :: i, j
        real(rk), parameter :: least = epsilon(1.0_rk)**2 !! angle that is worth a rotation
        real(rk) :: half, t, c, s, tau, shift, u, w
        integer :: k

        if (abs(a(i, j)) <= tiny(1.0_rk) + least*abs(a(j, j) - a(i, i))) return
        half = (a(j, j) - a(i, i))/(2*a(i, j))
        t = sign(1.0_rk, half)/(abs(half) + sqrt(half*half + 1))
        c = 1/sqrt(t*t + 1)
        s = t*c
        tau = s/(1 + c)
        shift = t*a(i, j)
        a(i, i) = a(i, i) - shift
        a(j, j) = a(j, j) + shift
        a(i, j) = 0
        a(j, i) = 0
        k = 6 - i - j
        u = a(k, i)
        w = a(k, j)
        a(k, i) = u - s*(w + tau*u)
        a(k, j) = w + s*(u - tau*w)
        a(i, k) = a(k, i)
        a(j, k) = a(k, j)
        do k = 1, 3
            u = q(k, i)
            w = q(k, j)
            q(k, i) = u - s*(w + tau*u)
            q(k, j) = w + s*(u - tau*w)
        end do
    end subroutine rotate_away
end module brz_eigen
