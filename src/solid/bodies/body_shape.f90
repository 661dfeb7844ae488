! SPDX-License-Identifier: MIT
!> Body geometry as lattices of particles: layers, spacings, the test of a shape, its exact volume.
!>
!> Symmetry planes cut a body to the positive side; the first layer is half a spacing off a plane.
module brz_body_shape
    use brz_bar_layers, only: bar_at, bar_count, bar_offset, bar_span, bars_modelled, span_t
    use brz_case, only: body_case_t, is_from_file
    use brz_kinds, only: dp
    use brz_body_geometry, only: fits_along, body_geometry_t
    use brz_body_geometries, only: geometry_of
    implicit none
    private
    public :: shape_t, lay_shape, take_lattice, point_of, inside, exact_volume, modelled_share, &
              axis_of, bar_weight, layers_of, overlap, whole_sides

    real(dp), parameter :: pi = acos(-1.0_dp)

    !> A lattice that covers a body, cut at the symmetry planes.
    type :: shape_t
        integer :: dimension = 3
        type(body_geometry_t) :: geometry
        real(dp) :: lo(3) = 0, hi(3) = 0 !! corners of what is modelled [m]
        real(dp) :: full_lo(3) = 0, full_hi(3) = 0 !! the same before cutting [m]
        real(dp) :: spacing(3) = 0 !! of the layers [m]
        integer :: n(3) = 1 !! layers
        logical :: on_plane(3) = .false. !! cut, or resting on a symmetry plane
        real(dp) :: depth = 1 !! extent of what is not modelled [m or m2]
        real(dp) :: start(3) = 0 !! low corner of the lattice [m]
        logical, allocatable :: mark(:, :, :) !! (n) points within a surface of triangles
    end type shape_t

contains

    !> Lattice of a body. `middle` is where the directions that are not modelled are put.
    subroutine lay_shape(body, dimension, mirror, depth, middle, s, box)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension
        logical, intent(in) :: mirror(3) !! symmetry planes
        real(dp), intent(in) :: depth, middle(3) !! [m]
        type(shape_t), intent(out) :: s
        real(dp), intent(in), optional :: box(3, 2) !! corners of a body from a file [m]
        real(dp) :: apart, side
        integer :: a

        s%dimension = dimension
        s%depth = depth
        s%geometry = geometry_of(body)
        call s%geometry%corners(body, s%lo, s%hi)
        if (present(box)) then
            s%lo = box(:, 1)
            s%hi = box(:, 2)
        end if
        s%full_lo = s%lo
        s%full_hi = s%hi
        do a = 1, 3
            apart = body%spacing*body%aspect(a)
            s%spacing(a) = apart
            if (body%layered) s%spacing(a) = (body%radius - body%inner_radius)/layers_of(body)
            if (a > dimension) then
                s%lo(a) = middle(a) - apart/2
                s%hi(a) = middle(a) + apart/2
                s%start(a) = s%lo(a)
                cycle
            end if
            s%on_plane(a) = mirror(a) .and. s%lo(a) < apart/4
            if (s%on_plane(a)) s%lo(a) = 0
            side = s%hi(a) - s%lo(a)
            s%start(a) = s%lo(a)
            if (fits_along(s%geometry, body, a)) then
                s%n(a) = max(1, nint(side/apart))
                s%spacing(a) = side/s%n(a)
            else if (body%shape == 'bars') then
                if (.not. s%on_plane(a)) s%start(a) = bar_offset(body, a, apart)
                s%n(a) = ceiling((s%hi(a) - s%start(a))/apart) + 1
            else if (s%on_plane(a)) then
                s%n(a) = ceiling(side/apart)
            else
                s%n(a) = max(1, 2*ceiling(side/(2*apart)))
                s%start(a) = (s%lo(a) + s%hi(a) - s%n(a)*apart)/2
            end if
        end do
    end subroutine lay_shape

    !> Let a body use the layers of a box that it cuts: its particles then take the places of
    !> particles of the box. Where it goes beyond the box the layers go on.
    pure subroutine take_lattice(box, s)
        type(shape_t), intent(in) :: box
        type(shape_t), intent(inout) :: s
        integer :: a, first, last

        do a = 1, s%dimension
            if (s%on_plane(a) .and. .not. box%on_plane(a)) cycle ! the plane has the first layer
            first = floor((s%lo(a) - box%start(a))/box%spacing(a)) - 1
            if (box%on_plane(a)) first = max(0, first)
            last = ceiling((s%hi(a) - box%start(a))/box%spacing(a)) + 1
            s%spacing(a) = box%spacing(a)
            s%start(a) = box%start(a) + first*box%spacing(a)
            s%n(a) = max(0, last - first)
        end do
    end subroutine take_lattice

    !> Sides of a body with its images: whole where a symmetry plane cuts it.
    pure function whole_sides(shape) result(side)
        type(shape_t), intent(in) :: shape
        real(dp) :: side(3) !! [m]

        side = shape%full_hi - shape%full_lo
        where (shape%on_plane) side = 2*(shape%hi - shape%lo)
    end function whole_sides

    !> Volume that the boxes around two bodies have in common; 0 where they do not meet.
    pure real(dp) function overlap(a, b)
        type(shape_t), intent(in) :: a, b

        associate (d => a%dimension)
            overlap = product(max(0.0_dp, min(a%hi(:d), b%hi(:d)) - max(a%lo(:d), b%lo(:d))))
        end associate
    end function overlap

    pure integer function axis_of(body)
        type(body_case_t), intent(in) :: body

        axis_of = max(1, index('xyz', body%axis))
    end function axis_of

    !> Layers across the wall of a cylinder with a hole.
    pure integer function layers_of(body)
        type(body_case_t), intent(in) :: body

        layers_of = max(1, nint((body%radius - body%inner_radius)/body%spacing))
    end function layers_of

    !> Lattice point of the layers i.
    pure function point_of(s, i) result(x)
        type(shape_t), intent(in) :: s
        integer, intent(in) :: i(3) !! layers, from 1; below 1 beyond a symmetry plane
        real(dp) :: x(3) !! [m]

        x = s%start + (i - 0.5_dp)*s%spacing
    end function point_of

    !> True for a point more than `margin` inside a body, on its lattice `s`; directions that are
    !> not modelled do not count.
    pure logical function inside(body, s, x, margin)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s
        real(dp), intent(in) :: x(3), margin !! [m]
        integer :: a, n
        logical :: within(3)

        if (is_from_file(body)) then
            inside = near_mark(s, x, margin)
            return
        end if
        n = s%dimension
        within = x > s%full_lo + margin .and. x < s%full_hi - margin
        if (body%shape == 'bars') then ! which may stand a quarter of a spacing beside their box
            inside = within(axis_of(body)) .and. all(abs(x - (s%full_lo + s%full_hi)/2) < &
                                                     (s%full_hi - s%full_lo)/2 + s%spacing)
            do a = 1, 3
                if (a /= axis_of(body) .and. inside) inside = in_bar(body, s, a, x(a), margin)
            end do
            return
        end if
        inside = all(within(:n))
        if (inside .and. associated(s%geometry%holds)) &
            inside = s%geometry%holds(body, n, x, margin)
    end function inside

    !> True for a point within half a spacing of a marked point of the lattice.
    pure logical function near_mark(s, x, margin)
        type(shape_t), intent(in) :: s
        real(dp), intent(in) :: x(3), margin !! [m]
        integer :: i(3)

        near_mark = .false.
        if (.not. allocated(s%mark)) return
        i = nint((x - s%start)/s%spacing + 0.5_dp)
        if (any(i < 1 .or. i > s%n)) return
        near_mark = s%mark(i(1), i(2), i(3)) .and. &
                    norm2(x - point_of(s, i)) < minval(s%spacing)/2 - margin
    end function near_mark

    !> True for a coordinate within the layers of one of the bars.
    pure logical function in_bar(body, s, a, x, margin)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s
        integer, intent(in) :: a !! direction across the bars
        real(dp), intent(in) :: x, margin !! [m]
        type(span_t) :: span
        real(dp) :: depth
        integer :: k

        in_bar = .false.
        depth = x - s%start(a)
        do k = 1, bar_count(body, a)
            span = bar_span(body, a, k, s%start(a), s%spacing(a), s%on_plane(a))
            in_bar = in_bar .or. (depth > (span%first - 1)*s%spacing(a) + margin .and. &
                                  depth < span%last*s%spacing(a) - margin)
        end do
    end function in_bar

    !> Volumes of the particles of bars, relative to each other: every bar, and the half of one
    !> on a plane, has its own area over the layers that it takes.
    pure function bar_weight(body, s, x) result(weight)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s
        real(dp), intent(in) :: x(:, :) !! (3, n) [m]
        real(dp) :: weight(size(x, 2))
        integer :: a, i, k, n

        weight = 1
        do a = 1, 3
            if (a == axis_of(body)) cycle
            n = bar_count(body, a)
            block
                type(span_t) :: spans(n)
                integer :: layers(0:n)

                spans = [(bar_span(body, a, k, s%start(a), s%spacing(a), s%on_plane(a)), k=1, n)]
                layers = 0
                do i = 1, s%n(a)
                    k = bar_at(spans, i)
                    layers(k) = layers(k) + 1
                end do
                do i = 1, size(weight)
                    k = bar_at(spans, nint((x(a, i) - s%start(a))/s%spacing(a) + 0.5_dp))
                    if (k > 0) weight(i) = weight(i)*spans(k)%share/max(1, layers(k))
                end do
            end block
        end do
        if (size(weight) > 0) weight = weight/maxval(weight)
    end function bar_weight

    !> True where a plane of symmetry goes through the body, at the middle of it if `middle`.
    pure logical function is_cut(s, a, middle)
        type(shape_t), intent(in) :: s
        integer, intent(in) :: a !! direction
        logical, intent(in) :: middle
        real(dp) :: side

        side = s%full_hi(a) - s%full_lo(a)
        is_cut = s%on_plane(a) .and. s%full_lo(a) < -1e-9_dp*side .and. &
                 (abs(s%full_lo(a) + s%full_hi(a)) < 1e-6_dp*side .eqv. middle)
    end function is_cut

    !> Volume of the part of a shape that is modelled, where planes of symmetry cut it at its
    !> middle; 0 where it is not known, because a plane cuts it elsewhere [m3].
    pure real(dp) function exact_volume(body, s) result(volume)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s
        real(dp) :: area
        integer :: a

        select case (body%shape)
        case ('box')
            volume = product(s%hi(:s%dimension) - s%lo(:s%dimension))*s%depth
            return
        case ('bars')
            area = pi*body%diameter**2/4
            volume = area*(s%hi(axis_of(body)) - s%lo(axis_of(body)))
            do a = 1, 3
                if (a /= axis_of(body)) volume = volume* &
                    bars_modelled(body, a, s%start(a), s%spacing(a), s%on_plane(a))
            end do
            return
        case default
            volume = s%geometry%volume(body, s%dimension)*s%depth*modelled_share(s)
        end select
    end function exact_volume

    !> Share of a body on the positive side of the planes that cut it; 0: not known.
    pure real(dp) function modelled_share(s) result(share)
        type(shape_t), intent(in) :: s
        integer :: a

        share = 1
        do a = 1, s%dimension
            if (is_cut(s, a, .true.)) share = merge(share/2, 0.0_dp, s%geometry%even)
            if (is_cut(s, a, .false.)) share = 0
        end do
    end function modelled_share
end module brz_body_shape
