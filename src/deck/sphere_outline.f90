! SPDX-License-Identifier: MIT
!> Bodies of shape='sphere'.
module brz_sphere_outline
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    use brz_outline, only: away, ball, centred, outline_t
    implicit none
    private
    public :: sphere

contains

    !> A ball, a disc in two dimensions.
    pure type(outline_t) function sphere()
        sphere = outline_t('sphere', needs='centre radius', round=.true., corners=corners, &
                           holds=holds, volume=volume)
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

        holds = away(body, dimension, x, 0) <= (body%radius - margin)**2
    end function holds

    pure real(dp) function volume(body, dimension)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension

        volume = ball(dimension, body%radius)
    end function volume
end module brz_sphere_outline
