! SPDX-License-Identifier: MIT
!> Bodies of shape='cylinder', which may have a hole along the axis.
module brz_cylinder_outline
    use brz_case, only: body_case_t
    use brz_kinds, only: dp
    use brz_outline, only: ball, outline_t
    use brz_text, only: to_text
    implicit none
    private
    public :: cylinder

contains

    pure type(outline_t) function cylinder()
        cylinder%name = 'cylinder'
        cylinder%needs = 'centre radius length axis'
        cylinder%takes = 'inner_radius'
        cylinder%fits = 'axis'
        cylinder%round = .true.
        cylinder%corners => corners
        cylinder%holds => holds
        cylinder%volume => volume
        cylinder%fault => fault
    end function cylinder

    pure subroutine fault(body, key, text)
        type(body_case_t), intent(in) :: body
        character(:), allocatable, intent(out) :: key, text

        key = ''
        text = ''
        if (body%inner_radius < body%radius) return
        key = 'inner_radius'
        text = 'inner_radius '//to_text(body%inner_radius)//' m leaves nothing of the radius '// &
               to_text(body%radius)//' m'
    end subroutine fault

    pure subroutine corners(body, lo, hi)
        type(body_case_t), intent(in) :: body
        real(dp), intent(out) :: lo(3), hi(3) !! [m]
        real(dp) :: half(3)

        half = body%radius
        half(index('xyz', body%axis)) = body%length/2
        lo = body%centre - half
        hi = body%centre + half
    end subroutine corners

    pure logical function holds(body, dimension, x, margin)
        type(body_case_t), intent(in) :: body
        integer, intent(in) :: dimension
        real(dp), intent(in) :: x(3), margin !! [m]
        real(dp) :: d(3)

        d = x - body%centre
        d(dimension + 1:) = 0
        d(index('xyz', body%axis)) = 0
        holds = dot_product(d, d) <= (body%radius - margin)**2
        if (body%inner_radius > 0) &
            holds = holds .and. dot_product(d, d) >= (body%inner_radius + margin)**2
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
end module brz_cylinder_outline
