! SPDX-License-Identifier: MIT
!> Domain decomposition and load balancing of particles: a region of space for each process, its
!> subdomain, each with about as many particles as any other.
!>
!> All of space is cut in two, across the longest extent of the particles, and each half again, in
!> proportion to the processes on each side. Cuts lie on the edges of the bins of a histogram, whose
!> counts are whole numbers and added over all processes: all of them cut alike.
module brz_solid_regions
    use brz_owner_loop_bodies, only: owner_of
    use brz_kinds, only: dp, int64
    use brz_ranks, only: least_of_all, ranks_t, sum_of_all
    implicit none
    private
    public :: cut_regions, region_of

    integer, parameter :: bins = 2048

contains

    !> Cut space into regions for the particles that the processes hold.
    subroutine cut_regions(ranks, x, region)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x(:, :) !! (3, n) of this process [m]
        real(dp), intent(out) :: region(:, :, 0:) !! (3, 2, 0:regions-1) corners [m]
        integer :: first(0:size(region, 3)) !! of the regions that a piece still stands for
        integer :: piece(size(x, 2)), axis(0:size(region, 3) - 1)
        integer :: p, pieces, n
        real(dp) :: lo(3, 0:size(region, 3) - 1), hi(3, 0:size(region, 3) - 1)
        real(dp) :: cut(0:size(region, 3) - 1)

        n = size(region, 3)
        region(:, 1, :) = -huge(1.0_dp)
        region(:, 2, :) = huge(1.0_dp)
        first(0) = 0
        first(1) = n
        pieces = 1
        piece = 0
        do while (pieces < n)
            call find_extents(ranks, x, piece, lo(:, :pieces - 1), hi(:, :pieces - 1))
            do p = 0, pieces - 1
                axis(p) = findloc(hi(:, p) - lo(:, p) >= 0.99_dp*maxval(hi(:, p) - lo(:, p)), &
                                  .true., dim=1, back=.true.) ! as the air is cut: brz_boxes
            end do
            call find_cuts(ranks, x, piece, axis(:pieces - 1), lo(:, :pieces - 1), &
                           hi(:, :pieces - 1), first(:pieces), cut(:pieces - 1))
            call halve(x, axis, cut, region, first, piece, pieces)
        end do
    end subroutine cut_regions

    !> Corners of the particles of each piece.
    subroutine find_extents(ranks, x, piece, lo, hi)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x(:, :)
        integer, intent(in) :: piece(:)
        real(dp), intent(out) :: lo(:, 0:), hi(:, 0:) !! (3, 0:pieces-1)
        real(dp) :: ends(6*size(lo, 2))
        integer :: i

        lo = huge(lo)
        hi = -huge(hi)
        do i = 1, size(x, 2)
            lo(:, piece(i)) = min(lo(:, piece(i)), x(:, i))
            hi(:, piece(i)) = max(hi(:, piece(i)), x(:, i))
        end do
        ends = [lo, -hi]
        call least_of_all(ranks, ends)
        lo = reshape(ends(:3*size(lo, 2)), shape(lo))
        hi = reshape(-ends(3*size(lo, 2) + 1:), shape(hi))
        where (lo > hi)
            lo = 0
            hi = 0
        end where
    end subroutine find_extents

    !> Where to cut each piece that stands for several regions.
    subroutine find_cuts(ranks, x, piece, axis, lo, hi, first, cut)
        type(ranks_t), intent(in) :: ranks
        real(dp), intent(in) :: x(:, :)
        integer, intent(in) :: piece(:), axis(0:), first(0:)
        real(dp), intent(in) :: lo(:, 0:), hi(:, 0:)
        real(dp), intent(out) :: cut(0:)
        integer(int64) :: number(bins*size(axis)), below, wanted
        real(dp) :: width(0:size(axis) - 1)
        integer :: i, k, n, p

        do p = 0, size(axis) - 1
            width(p) = max((hi(axis(p), p) - lo(axis(p), p))/bins, tiny(1.0_dp))
        end do
        number = 0
        do i = 1, size(x, 2)
            p = piece(i)
            k = min(int((x(axis(p), i) - lo(axis(p), p))/width(p)), bins - 1)
            number(bins*p + k + 1) = number(bins*p + k + 1) + 1
        end do
        call sum_of_all(ranks, number)
        do p = 0, size(axis) - 1
            n = first(p + 1) - first(p)
            wanted = sum(number(bins*p + 1:bins*(p + 1)))*(n/2)/n
            below = 0
            do k = 1, bins - 1
                below = below + number(bins*p + k)
                if (2*below + number(bins*p + k + 1) > 2*wanted) exit
            end do
            cut(p) = lo(axis(p), p) + k*width(p)
        end do
    end subroutine find_cuts

    !> Cut the pieces that stand for several regions, and say in which piece each particle is.
    pure subroutine halve(x, axis, cut, region, first, piece, pieces)
        real(dp), intent(in) :: x(:, :)
        integer, intent(in) :: axis(0:)
        real(dp), intent(in) :: cut(0:)
        real(dp), intent(inout) :: region(:, :, 0:)
        integer, intent(inout) :: first(0:), piece(:), pieces
        integer :: begins(0:size(first) - 1), low(0:pieces - 1), i, m, n, p

        m = 0
        do p = 0, pieces - 1
            begins(m) = first(p)
            low(p) = m
            m = m + 1
            n = first(p + 1) - first(p)
            if (n == 1) cycle
            begins(m) = first(p) + n/2
            region(axis(p), 2, first(p):begins(m) - 1) = cut(p)
            region(axis(p), 1, begins(m):first(p + 1) - 1) = cut(p)
            m = m + 1
        end do
        begins(m) = first(pieces)
        do i = 1, size(piece)
            p = piece(i)
            piece(i) = low(p)
            if (first(p + 1) - first(p) > 1 .and. .not. x(axis(p), i) < cut(p)) &
                piece(i) = low(p) + 1
        end do
        pieces = m
        first(:m) = begins(:m)
    end subroutine halve

    !> The region in which a place is; the last one for what is no place.
    pure integer function region_of(region, x) result(r)
        real(dp), intent(in) :: region(:, :, 0:)
        real(dp), intent(in) :: x(3) !! [m]

        r = owner_of(size(region, 3), region, x)
    end function region_of
end module brz_solid_regions
