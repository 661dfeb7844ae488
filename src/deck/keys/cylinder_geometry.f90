! SPDX-License-Identifier: MIT
!> Bodies of shape='cylinder', which may have a hole along the axis.
module brz_cylinder_geometry
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    use brz_body_geometry, only: away, ball, centred, nothing_left, body_geometry_t
    implicit none
    private
    public :: cylinder

contains

    pure type(body_geometry_t) function cylinder()
        cylinder = body_geometry_t('cylinder', needs='centre radius length axis', &
                             takes='inner_radius', fits='axis', round=.true., corners=corners, &
                             holds=holds, volume=volume, fault=nothing_left)
    end function cylinder

    pure subroutine corners(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3) !! [m]
        real(dp) :: half(3)

        half = body%radius
        half(index('xyz', body%axis)) = body%length/2
        call centred(body, half, lo, hi)
    end subroutine corners

    pure logical function holds(body, dimension, x, margin)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension
        real(dp), intent(in) :: x(3), margin !! [m]
        real(dp) :: square

        square = away(body, dimension, x, index('xyz', body%axis))
        holds = square <= (body%radius - margin)**2
        if (body%inner_radius > 0) holds = holds .and. square >= (body%inner_radius + margin)**2
    end function holds

    pure real(dp) function volume(body, dimension)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension

        if (index('xyz', body%axis) <= dimension) then
            volume = body%length*(ball(dimension - 1, body%radius) &
                                  - ball(dimension - 1, body%inner_radius))
        else
            volume = ball(dimension, body%radius) - ball(dimension, body%inner_radius)
        end if
    end function volume
end module brz_cylinder_geometry
