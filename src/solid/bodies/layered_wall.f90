! SPDX-License-Identifier: MIT
!> Walls round an axis in layers: rings of particles behind each other, whatever their radius.
!>
!> Layers of the cubic lattice lie in steps along a curved wall, and its particles give way in
!> patterns that no gradient sees: a ring of three layers swings with 1.6 times its period. Rings
!> of a spacing of their own have no such patterns. Each has a number of particles of its own, so
!> that they are about a spacing apart, a multiple of four, so that planes through the axis cut it
!> half a spacing off its particles.
!>
!> Source: docs/theory/plates.md
module brz_layered_wall
    use brz_body_shape, only: axis_of, layers_of, shape_t
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: lay_wall, ring_of, turned_place

    real(dp), parameter :: pi = acos(-1.0_dp)

contains

    !> Radius of layer k, from the hole, its thickness and its number of particles on a full circle.
    pure subroutine ring_of(body, k, radius, thick, n)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: k
        real(dp), intent(out) :: radius, thick !! [m]
        integer, intent(out) :: n

        thick = (body%radius - body%inner_radius)/layers_of(body)
        radius = body%inner_radius + (k - 0.5_dp)*thick
        n = 4*max(1, nint(pi*radius/(2*body%spacing)))
    end subroutine ring_of

    !> Place of particle m (from 1, round the axis) of a ring of n, in section l along the axis; the
    !> same bits in each quarter of the ring.
    pure function turned_place(body, s, radius, m, n, l) result(x)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s !! lattice along the axis
        real(dp), intent(in) :: radius !! [m]
        integer, intent(in) :: m, n, l
        real(dp) :: x(3), first, second, swap
        integer :: a, b, c, q, turn

        c = axis_of(body)
        a = mod(c, 3) + 1
        b = mod(c + 1, 3) + 1
        q = modulo(m - 1, n)/(n/4)
        first = radius*cos((modulo(m - 1, n/4) + 0.5_dp)*2*pi/n)
        second = radius*cos((n/4 - modulo(m - 1, n/4) - 0.5_dp)*2*pi/n)
        do turn = 1, q ! a quarter each
            swap = first
            first = -second
            second = swap
        end do
        x = s%start + 0.5_dp*s%spacing
        x(c) = s%start(c) + (l - 0.5_dp)*s%spacing(c)
        x(a) = body%centre(a) + first
        x(b) = body%centre(b) + second
    end function turned_place

    !> All particles of a wall on the positive side of the planes of symmetry that cut it, section
    !> by section, and their volumes.
    pure subroutine lay_wall(body, s, x, volume)
        type(body_case_t), intent(in) :: body
        type(shape_t), intent(in) :: s
        real(dp), allocatable, intent(out) :: x(:, :) !! (3, n) [m]
        real(dp), allocatable, intent(out) :: volume(:) !! (n) relative to each other
        real(dp) :: radius, thick, place(3)
        integer :: count, k, l, m, n, pass

        do pass = 1, 2
            count = 0
            do l = 1, s%n(axis_of(body))
                do k = 1, layers_of(body)
                    call ring_of(body, k, radius, thick, n)
                    do m = 1, n
                        place = turned_place(body, s, radius, m, n, l)
                        if (any(s%on_plane .and. place < 0)) cycle
                        count = count + 1
                        if (pass == 1) cycle
                        x(:, count) = place
                        volume(count) = radius/n
                    end do
                end do
            end do
            if (pass == 1) allocate (x(3, count), volume(count))
        end do
    end subroutine lay_wall
end module brz_layered_wall
