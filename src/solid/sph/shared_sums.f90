! SPDX-License-Identifier: MIT
!> What particles of another body add to the sums over unloaded places, where two bodies share all
!> their sums though they start apart. Point physics.
!>
!> Unloaded places of two bodies say nothing about each other. So a particle of the other body
!> counts as one that has come along with the deformation of the particle's own body; that of its
!> own pairs stays what it is.
!>
!> Source: docs/theory/contact.md
module brz_shared_sums
    use brz_algebra, only: multiply3, to_matrix
    use brz_gradient, only: correction
    use brz_kinds, only: rk
    implicit none
    private
    public :: carried_along

contains

    !> Sums of X_ij (x) x_ij and X_ij (x) X_ij over particles with the moments `other`, were they
    !> carried along: X = G x, G = N M^-1 of its own pairs.
    !@cuf attributes(host,device) &
    pure subroutine carried_along(dimension, m, n, other, cross_sum, reference_sum)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: m(6), n(9) !! M and N of its own pairs
        real(rk), intent(in) :: other(6) !! sum of V F x_ij (x) x_ij over the other body
        real(rk), intent(out) :: cross_sum(9)
        real(rk), intent(out) :: reference_sum(6) !! xx, yy, zz, xy, yz, xz
        real(rk) :: a(6), own(9), b(3, 3), g(3, 3), f(3, 3), c(3, 3), s(3, 3), t(3, 3)
        integer :: i, j, weak

        do i = 1, 6
            a(i) = m(i)
        end do
        do i = 1, 9
            own(i) = n(i)
        end do
        do i = 1, 3 ! not to dimension: arrays would lie in memory on a GPU
            if (i <= dimension) cycle
            a(i) = 1
            own(4*i - 3) = 1
        end do
        call correction(dimension, a, b, weak)
        call multiply3(own, b, g)
        call to_matrix(other, f)
        call multiply3(g, f, c)
        do j = 1, 3
            do i = 1, 3
                cross_sum(i + 3*(j - 1)) = c(i, j)
                t(i, j) = g(j, i)
            end do
        end do
        call multiply3(c, t, s)
        reference_sum(1) = s(1, 1)
        reference_sum(2) = s(2, 2)
        reference_sum(3) = s(3, 3)
        reference_sum(4) = s(1, 2)
        reference_sum(5) = s(2, 3)
        reference_sum(6) = s(1, 3)
    end subroutine carried_along
end module brz_shared_sums
