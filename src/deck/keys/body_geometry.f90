! SPDX-License-Identifier: MIT
!> What the shape of a body is: its keys, the box around it, which points it holds, its volume.
!>
!> A shape is a file NAME_outline.f90 and a line of brz_body_geometries. What a shape does not say
!> is that of a box. Lattices, planes of symmetry, cuts and checks follow from it for all shapes.
module brz_body_geometry
    use brz_case, only: body_case_t
    use brz_key, only: key_t
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: body_geometry_t, ball, centred, away, nothing_left, has_key, needs_key, fits_along

    type :: body_geometry_t
        character(12) :: name = ''
        character(48) :: needs = '' !! keys that must be given, one after the other
        character(48) :: takes = '' !! keys that may be given besides
        type(key_t), allocatable :: keys(:) !! those of them that no other shape has: numbers, which
                                            !! body%own holds in this order
        character(4) :: fits = 'none' !! directions that whole layers fill: none, axis, all
        logical :: round = .false. !! about its centre, or its axis
        logical :: even = .true. !! the same shape when it is mirrored through its middle
        procedure(box_around), pointer, nopass :: corners => box_around
        procedure(point_within), pointer, nopass :: holds => null() !! null: all of that box
        procedure(volume_in), pointer, nopass :: volume => null() !! null: known elsewhere
        procedure(fault_of), pointer, nopass :: fault => null() !! null: none is possible
    end type body_geometry_t

    abstract interface
        !> True for a point of the box around a body that is more than `margin` inside the body;
        !> directions beyond `dimension` do not count.
        pure logical function point_within(body, dimension, x, margin)
            import :: body_case_t, dp
            type(body_case_t), intent(in) :: body
            integer, intent(in) :: dimension
            real(dp), intent(in) :: x(3), margin !! [m]
        end function point_within

        !> Volume of the whole body, area in two dimensions, length in one [m3, m2, m].
        pure real(dp) function volume_in(body, dimension)
            import :: body_case_t, dp
            type(body_case_t), intent(in) :: body
            integer, intent(in) :: dimension
        end function volume_in

        !> What is wrong with the keys of a body that are all there: the key, '' where nothing is.
        pure subroutine fault_of(body, key, text)
            import :: body_case_t
            type(body_case_t), intent(in) :: body
            character(:), allocatable, intent(out) :: key, text
        end subroutine fault_of
    end interface

contains

    !> The fault of a round body whose hole is as wide as it is.
    pure subroutine nothing_left(body, key, text)
        type(body_case_t), intent(in) :: body
        character(:), allocatable, intent(out) :: key, text

        key = ''
        text = ''
        if (body%inner_radius < body%radius) return
        key = 'inner_radius'
        text = 'inner_radius '//to_text(body%inner_radius)//' m leaves nothing of the radius '// &
               to_text(body%radius)//' m'
    end subroutine nothing_left

    !> Corners of the smallest box around a body that the key `box` describes [m].
    pure subroutine box_around(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3)

        lo = body%lo
        hi = body%hi
    end subroutine box_around

    !> Corners of the box around the centre of a body [m].
    pure subroutine centred(body, half, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(in) :: half(3) !! sides [m]
        real(dp), intent(out) :: lo(3), hi(3)

        lo = body%centre - half
        hi = body%centre + half
    end subroutine centred

    !> Square of the distance of a point from the centre of a body, or from its axis [m2].
    pure real(dp) function away(body, dimension, x, axis)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension !! directions beyond it do not count
        real(dp), intent(in) :: x(3) !! [m]
        integer, intent(in) :: axis !! direction, 0: there is none
        real(dp) :: d(3)

        d = x - body%centre
        d(dimension + 1:) = 0
        if (axis > 0) d(axis) = 0
        away = dot_product(d, d)
    end function away

    !> True for a key that a shape needs.
    pure logical function needs_key(geometry, key)
        type(body_geometry_t), intent(in) :: geometry
        character(*), intent(in) :: key

        needs_key = index(' '//geometry%needs//' ', ' '//trim(key)//' ') > 0
    end function needs_key

    !> True for a key that a shape needs, or may have.
    pure logical function has_key(geometry, key)
        type(body_geometry_t), intent(in) :: geometry
        character(*), intent(in) :: key

        has_key = needs_key(geometry, key) .or. &
                  index(' '//geometry%takes//' ', ' '//trim(key)//' ') > 0
    end function has_key

    !> True where whole layers fill a body from side to side.
    pure logical function fits_along(geometry, body, a)
        type(body_geometry_t), intent(in) :: geometry
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: a !! direction

        fits_along = geometry%fits == 'all' .or. &
                     geometry%fits == 'axis' .and. a == index('xyz', body%axis)
    end function fits_along

    !> Volume of a ball in so many dimensions.
    pure real(dp) function ball(dimension, radius)
        integer, intent(in) :: dimension
        real(dp), intent(in) :: radius
        real(dp), parameter :: pi = acos(-1.0_dp)

        select case (dimension)
        case (0); ball = merge(1, 0, radius > 0)
        case (1); ball = 2*radius
        case (2); ball = pi*radius**2
        case default; ball = 4*pi/3*radius**3
        end select
    end function ball
end module brz_body_geometry
