! SPDX-License-Identifier: MIT
!> The loaded segments that carry pressure within and outside walls on layered lattices.
!>
!> A particle of the first or last ring has a loaded segment: from half way to its neighbours in the
!> ring and along the axis. The surface of the shape lies half a layer off the ring, so loaded
!> segments are wider than the ring by their radii, and by 1/cos(pi/n): their edges then lie on that
!> surface, and the push on half of the unloaded wall is pressure times diameter times length.
!>
!> Source: docs/manual/blast.md, loads without air
module brz_loaded_wall
    use brz_body, only: body_t
    use brz_body_shape, only: axis_of, layers_of, shape_t
    use brz_case, only: body_case_t
    use brz_face_load, only: lay_out
    use brz_kinds, only: dp
    use brz_layered_wall, only: ring_of, turned_place
    use brz_loads, only: loaded_segments_t
    use brz_particles, only: particles_t
    implicit none
    private
    public :: find_loaded_wall

    real(dp), parameter :: pi = acos(-1.0_dp)

contains

    !> Loaded segments on the inside, the outside or both.
    subroutine find_loaded_wall(input, shape, faces, most, solid, body, segments)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        logical, intent(in) :: faces(2) !! inside, outside
        real(dp), intent(in) :: most !! stretch of a loaded segment that still carries more load
        class(particles_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(loaded_segments_t), intent(out) :: segments
        integer, allocatable :: number(:, :) !! (round the axis, along it) of a ring's particles
        integer :: count, f, j, k, l, m, pass

        do pass = 1, 2
            count = 0
            do f = 1, 2
                if (.not. faces(f)) cycle
                call number_ring(input, shape, f, solid, body, number)
                do l = 1, ubound(number, 2) - 1
                    do m = 1, ubound(number, 1) - 1
                        if (number(m, l) == 0) cycle
                        count = count + 1
                        if (pass == 1) cycle
                        segments%id(count) = solid%id(number(m, l))
                        call lay_loaded_segment(input, shape, f, m, l, number, segments, count)
                        segments%most(:, count) = most*segments%most(:, count)
                        do k = 1, 4
                            j = segments%beside(k, count)
                            if (j > 0) segments%beside(k, count) = solid%id(j)
                        end do
                    end do
                end do
            end do
            if (pass == 1) call lay_out(segments, count)
        end do
    end subroutine find_loaded_wall

    !> Find the particles of the first or the last ring.
    subroutine number_ring(input, shape, f, solid, body, number)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        integer, intent(in) :: f !! 1: inside, 2: outside
        class(particles_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, allocatable, intent(out) :: number(:, :) !! from 0, with its neighbours
        real(dp) :: radius, thick, x(3)
        integer :: a, b, c, i, n

        c = axis_of(input)
        a = mod(c, 3) + 1
        b = mod(c + 1, 3) + 1
        call ring_of(input, merge(1, layers_of(input), f == 1), radius, thick, n)
        allocate (number(0:n + 1, 0:shape%n(c) + 1), source=0)
        do i = body%first, body%last
            x = solid%x_ref(:, i) - input%centre
            if (nint((norm2(x([a, b])) - radius)/thick) /= 0) cycle
            number(1 + modulo(nint(atan2(x(b), x(a))*n/(2*pi) - 0.5_dp), n), &
                   nint((solid%x_ref(c, i) - shape%start(c))/shape%spacing(c) + 0.5_dp)) = i
        end do
        number(0, :) = number(n, :)
        number(n + 1, :) = number(1, :)
    end subroutine number_ring

    !> Loaded segment k: that of particle m in section l of a ring, its neighbours by their places.
    !> One beyond a plane of symmetry is its own image; at an edge the span is that to the other
    !> one.
    subroutine lay_loaded_segment(input, shape, f, m, l, number, segments, k)
        type(body_case_t), intent(in) :: input
        type(shape_t), intent(in) :: shape
        integer, intent(in) :: f, m, l, k !! f: 1: inside, 2: outside
        integer, intent(in) :: number(0:, 0:) !! see number_ring
        type(loaded_segments_t), intent(inout) :: segments
        real(dp) :: place(3), radius, thick, wide(2)
        integer :: a, at, axis, n, step(2), t, up

        axis = axis_of(input)
        call ring_of(input, merge(1, layers_of(input), f == 1), radius, thick, n)
        segments%side(k) = (2*f - 3)*(mod(axis, 3) + 1)
        wide = [merge(input%inner_radius, input%radius, f == 1)/(radius*cos(pi/n)), 1.0_dp]
        segments%most(:, k) = [2*pi*radius/n, shape%spacing(axis)]
        do t = 1, 2
            segments%width(t, k) = 0
            do up = 0, 1
                at = 2*t - 1 + up
                segments%beside(at, k) = 0
                segments%mirror(at, k) = 0
                if (t == 2 .and. axis > shape%dimension) cycle
                step = 0
                step(t) = 1 - 2*up
                segments%beside(at, k) = number(m + step(1), l + step(2))
                if (segments%beside(at, k) == 0) then
                    place = turned_place(input, shape, radius, m + step(1), n, l + step(2))
                    a = findloc(shape%on_plane .and. place < 0, .true., 1)
                    if (a == 0) cycle
                    segments%mirror(at, k) = a
                end if
                segments%width(t, k) = segments%width(t, k) + 1
            end do
            if (segments%width(t, k) > 0) segments%width(t, k) = wide(t)/segments%width(t, k)
        end do
    end subroutine lay_loaded_segment
end module brz_loaded_wall
