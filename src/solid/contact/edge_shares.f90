! SPDX-License-Identifier: MIT
!> What edges of flat faces take of a load, from the sums of a regular lattice.
!>
!> Under uniform stress the forces of a body balance a load whose columns of particles, from a free
!> edge inwards, take `edge_shares` of what their cells would: with smoothing lengths of 1.2
!> spacings 0.76, 1.23, 1.01 and 1. A load that is spread otherwise strains the first three layers
!> below an edge unevenly.
!>
!> Source: docs/theory/solids.md, loaded faces
module brz_edge_shares
    use brz_kernel, only: kernel_slope
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: edge_shares, share_of, n_edge

    integer, parameter :: n_edge = 4 !! columns from an edge that differ from those within
    integer, parameter :: n = 16 !! layers and columns of the lattice that is looked at

contains

    !> The share of a column that is so far from the edges on both sides, counted from 1. Those of
    !> all columns add up to their number, so that the whole load is that of the face.
    pure real(dp) function share_of(shares, low, high) result(share)
        real(dp), intent(in) :: shares(n_edge)
        integer, intent(in) :: low, high !! beyond n_edge: an edge is far
        integer :: columns

        share = 1
        if (low <= n_edge) share = share + (shares(low) - 1)
        if (high <= n_edge) share = share + (shares(high) - 1)
        columns = low + high - 1
        if (columns <= n_edge) share = share*columns/(2*sum(shares(:columns)) - columns)
    end function share_of

    !> Loads of the columns that balance a uniform stress across a face, over their areas: D^T 1 of
    !> the gradient D across the layers, summed over depth.
    pure function edge_shares(dimension, h) result(area)
        integer, intent(in) :: dimension
        real(dp), intent(in) :: h !! smoothing length over spacing
        real(dp) :: area(n_edge)
        real(dp) :: b(2, 2, n, n), m(2, 2), r(2), w
        integer :: i, j, k, l

        area = 1
        if (dimension == 1) return
        do j = 1, n
            do i = 1, n
                m = 0
                do l = max(j - 3, 1), min(j + 3, n)
                    do k = max(i - 3, 1), min(i + 3, n)
                        r = [i - k, j - l]
                        w = slope_of(dimension, h, norm2(r))
                        m = m + w*reshape([r(1)*r(1), r(1)*r(2), r(1)*r(2), r(2)*r(2)], [2, 2])
                    end do
                end do
                w = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
                b(:, :, i, j) = reshape([m(2, 2), -m(1, 2), -m(1, 2), m(1, 1)], [2, 2])/w
            end do
        end do
        area = 0
        do i = 1, n_edge ! columns; the face is the first layer
            do j = 1, n/2
                do l = max(j - 3, 1), min(j + 3, n)
                    do k = max(i - 3, 1), min(i + 3, n)
                        r = [i - k, j - l]
                        w = slope_of(dimension, h, norm2(r))
                        area(i) = area(i) - w*dot_product(b(2, :, i, j) + b(2, :, k, l), r)
                    end do
                end do
            end do
        end do
        area = area*n_edge/sum(area)
    end function edge_shares

    !> Slope of the kernel between two rows of particles along the edge.
    pure real(dp) function slope_of(dimension, h, distance) result(f)
        integer, intent(in) :: dimension
        real(dp), intent(in) :: h, distance
        integer :: k, most

        most = merge(3, 0, dimension == 3)
        f = 0
        do k = -most, most
            f = f + kernel_slope(1.0_rk, real(1/(2*h), rk), real(sqrt(distance**2 + k**2), rk))
        end do
    end function slope_of
end module brz_edge_shares
