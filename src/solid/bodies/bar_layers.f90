! SPDX-License-Identifier: MIT
!> Rows of bars on a lattice: which layers each bar takes, and how much of it is modelled.
!>
!> A bar has the number of layers nearest to its diameter that puts it within a quarter of a
!> spacing of its place: even or odd, as its centre lies nearer to a border or to the middle of a
!> layer. So a bar on a plane of symmetry has the layers of half the whole one, with the plane or
!> without it.
module brz_bar_layers
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: span_t, bar_at, bar_count, bar_offset, bar_span, bars_modelled, layers_across

    real(dp), parameter :: farthest = 0.25_dp + 1e-6_dp !! from its place [spacings]

    !> The layers of a bar across it.
    type :: span_t
        integer :: first = 1, last = 0 !! layers, from 1 at the low corner of the lattice
        real(dp) :: share = 0 !! of the bar that is modelled: 1, 1/2 on a plane, 0 behind it
    end type span_t

contains

    !> Bars of a row along direction a, which is across them.
    pure integer function bar_count(body, a)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: a

        bar_count = body%bars(merge(1, 2, a == mod(index('xyz', body%axis), 3) + 1))
    end function bar_count

    !> Layers nearest to the diameter.
    pure integer function layers_across(body, spacing)
        type(body_case_t), intent(in) :: body
        real(dp), intent(in) :: spacing !! of the layers [m]

        layers_across = max(1, nint(body%diameter/spacing))
    end function layers_across

    !> Low corner of a free lattice that has its layers where the first bar is [m].
    pure real(dp) function bar_offset(body, a, spacing)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: a
        real(dp), intent(in) :: spacing !! [m]

        bar_offset = bar_centre(body, a, 1) - layers_across(body, spacing)*spacing/2
    end function bar_offset

    !> Layers of bar k of the row along a, on layers `spacing` apart from `start` on.
    pure function bar_span(body, a, k, start, spacing, on_plane) result(span)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: a, k
        real(dp), intent(in) :: start, spacing !! [m]
        logical, intent(in) :: on_plane !! the lattice is cut by a plane of symmetry at 0
        type(span_t) :: span
        real(dp) :: centre
        integer :: n, plane

        centre = bar_centre(body, a, k)
        plane = nint(-start/spacing) ! layers behind the plane
        if (on_plane .and. abs(centre) < 1e-6_dp*body%diameter) then
            n = max(1, nint(body%diameter/(2*spacing)))
            span = span_t(plane + 1, plane + n, 0.5_dp)
            return
        end if
        if (on_plane .and. centre < 0) return
        centre = (centre - start)/spacing
        n = layers_across(body, spacing)
        if (abs(centre - 0.5_dp*n - anint(centre - 0.5_dp*n)) > farthest) &
            n = n + merge(1, -1, n == 1 .or. body%diameter >= n*spacing)
        span%first = nint(centre - 0.5_dp*n) + 1
        span%last = span%first + n - 1
        span%share = 1
        if (on_plane) span%first = max(span%first, plane + 1)
    end function bar_span

    !> The bar of a row that a layer belongs to, the first one if several would; 0: none.
    pure integer function bar_at(spans, layer) result(k)
        type(span_t), intent(in) :: spans(:)
        integer, intent(in) :: layer

        do k = 1, size(spans)
            if (spans(k)%first <= layer .and. layer <= spans(k)%last) return
        end do
        k = 0
    end function bar_at

    !> Number of bars of a row on the positive side; one on the plane is half a bar.
    pure real(dp) function bars_modelled(body, a, start, spacing, on_plane) result(n)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: a
        real(dp), intent(in) :: start, spacing !! [m]
        logical, intent(in) :: on_plane
        type(span_t) :: span
        integer :: k

        n = 0
        do k = 1, bar_count(body, a)
            span = bar_span(body, a, k, start, spacing, on_plane)
            n = n + span%share
        end do
    end function bars_modelled

    !> Centre of bar k of a row: the outer ones touch the sides of the box, one alone is in its
    !> middle [m].
    pure real(dp) function bar_centre(body, a, k)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: a, k
        integer :: n

        n = bar_count(body, a)
        bar_centre = (body%lo(a) + body%hi(a))/2
        if (n > 1) bar_centre = body%lo(a) + body%diameter/2 &
                                + (body%hi(a) - body%lo(a) - body%diameter)*(k - 1)/(n - 1)
    end function bar_centre
end module brz_bar_layers
