! SPDX-License-Identifier: MIT
!> Bodies of shape='sphere', which may be hollow.
module brz_sphere_geometry
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    use brz_body_geometry, only: away, ball, centred, nothing_left, body_geometry_t
    implicit none
    private
    public :: sphere

contains

    !> A ball, a disc in two dimensions.
    pure type(body_geometry_t) function sphere()
        sphere = body_geometry_t('sphere', needs='centre radius', takes='inner_radius', &
                           round=.true., corners=corners, holds=holds, volume=volume, &
                           fault=nothing_left)
    end function sphere

    pure subroutine corners(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3) !! [m]

        call centred(body, spread(body%radius, 1, 3), lo, hi)
    end subroutine corners

    pure logical function holds(body, dimension, x, margin)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension
        real(dp), intent(in) :: x(3), margin !! [m]
        real(dp) :: square

        square = away(body, dimension, x, 0)
        holds = square <= (body%radius - margin)**2
        if (body%inner_radius > 0) holds = holds .and. square >= (body%inner_radius + margin)**2
    end function holds

    pure real(dp) function volume(body, dimension)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension

        volume = ball(dimension, body%radius) - ball(dimension, body%inner_radius)
    end function volume
end module brz_sphere_geometry
