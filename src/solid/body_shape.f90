! SPDX-License-Identifier: MIT
!> Bodies as lattices of particles: layers, spacings, the test of a shape, its exact volume.
!>
!> Symmetry planes cut a body to the positive side; the first layer is half a spacing off a plane.
module brz_body_shape
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: shape_t, lay_shape, point_of, inside, particle_volume

    !> A lattice that covers a body, cut at the symmetry planes.
    type :: shape_t
        integer :: dimension = 3
        real(dp) :: lo(3) = 0, hi(3) = 0 !! corners of what is modelled [m]
        real(dp) :: full_lo(3) = 0, full_hi(3) = 0 !! the same before cutting [m]
        real(dp) :: spacing(3) = 0 !! of the layers [m]
        integer :: n(3) = 1 !! layers
        logical :: on_plane(3) = .false. !! cut, or resting on a symmetry plane
        real(dp) :: depth = 1 !! extent of what is not modelled [m or m2]
    end type shape_t

contains

    !> Lattice of a body. `middle` is where the directions that are not modelled are put.
    subroutine lay_shape(body, dimension, mirror, depth, middle, s)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension
        logical, intent(in) :: mirror(3) !! symmetry planes
        real(dp), intent(in) :: depth, middle(3) !! [m]
        type(shape_t), intent(out) :: s
        real(dp) :: side
        integer :: a

        s%dimension = dimension
        s%depth = depth
        call extent(body, s%lo, s%hi)
        s%full_lo = s%lo
        s%full_hi = s%hi
        do a = 1, 3
            s%spacing(a) = body%spacing
            if (a > dimension) then
                s%lo(a) = middle(a) - body%spacing/2
                s%hi(a) = middle(a) + body%spacing/2
                cycle
            end if
            s%on_plane(a) = mirror(a) .and. s%lo(a) < body%spacing/4
            if (s%on_plane(a)) s%lo(a) = 0
            side = s%hi(a) - s%lo(a)
            if (body%shape == 'box') then
                s%n(a) = max(1, nint(side/body%spacing))
                s%spacing(a) = side/s%n(a)
            else
                s%n(a) = max(1, 2*ceiling(side/(2*body%spacing)))
                if (s%on_plane(a)) s%n(a) = ceiling(side/body%spacing)
                if (.not. s%on_plane(a)) s%lo(a) = (s%lo(a) + s%hi(a) - s%n(a)*body%spacing)/2
            end if
        end do
    end subroutine lay_shape

    !> Corners of the box around a body.
    pure subroutine extent(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3)
        real(dp) :: half(3)

        if (body%shape == 'box') then
            lo = body%lo
            hi = body%hi
            return
        end if
        half = body%radius
        if (body%shape == 'cylinder') half(axis_of(body)) = body%length/2
        lo = body%centre - half
        hi = body%centre + half
    end subroutine extent

    pure integer function axis_of(body)
        type(body_case_t), intent(in) :: body

        axis_of = max(1, index('xyz', body%axis))
    end function axis_of

    !> Lattice point of the layers i.
    pure function point_of(s, i) result(x)
        type(shape_t), intent(in) :: s
        integer, intent(in) :: i(3) !! from 1
        real(dp) :: x(3)

        x = s%lo + (i - 0.5_dp)*s%spacing
    end function point_of

    !> True for a point of the body; directions that are not modelled do not count.
    pure logical function inside(body, dimension, x)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension
        real(dp), intent(in) :: x(3)
        real(dp) :: d(3)
        integer :: a

        inside = .true.
        if (body%shape == 'box') return
        d = x - body%centre
        d(dimension + 1:) = 0
        if (body%shape == 'cylinder') then
            a = axis_of(body)
            inside = abs(d(a)) <= body%length/2
            d(a) = 0
        end if
        inside = inside .and. dot_product(d, d) <= body%radius**2
    end function inside

    !> Volume of a particle that makes the volume of the whole body exact.
    real(dp) function particle_volume(body, s) result(volume)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s
        integer :: count, i, j, k, lo(3)
        real(dp), parameter :: pi = acos(-1.0_dp)
        real(dp) :: exact

        volume = product(s%spacing(:s%dimension))*s%depth
        if (body%shape == 'box') return
        lo = 1
        where (s%on_plane) lo = 1 - s%n
        count = 0
        do k = lo(3), s%n(3)
            do j = lo(2), s%n(2)
                do i = lo(1), s%n(1)
                    if (inside(body, s%dimension, point_of(s, [i, j, k]))) count = count + 1
                end do
            end do
        end do
        if (s%dimension == 1) then
            exact = 2*body%radius
            if (body%shape == 'cylinder' .and. axis_of(body) == 1) exact = body%length
        else if (s%dimension == 2) then
            exact = pi*body%radius**2
            if (body%shape == 'cylinder' .and. axis_of(body) < 3) exact = 2*body%radius*body%length
        else
            exact = 4*pi/3*body%radius**3
            if (body%shape == 'cylinder') exact = pi*body%radius**2*body%length
        end if
        volume = exact*s%depth/max(count, 1)
    end function particle_volume
end module brz_body_shape
