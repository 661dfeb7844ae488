! SPDX-License-Identifier: MIT
!> Layered lattices (`lattice='layered'`): the walls that they fill.
module brz_check_lattice
    use brz_case, only: body_case_t, case_t
    use brz_deck, only: complain, deck_t
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_lattice

    integer, parameter :: least_layers = 3 !! within, one that damps waves of two spacings
    real(dp), parameter :: apart = 4 !! spacings beyond which no pair reaches
    real(dp), parameter :: slack = 1e-9_dp !! relative rounding of positions in the deck

contains

    !> A layered lattice is a wall round an axis, of three layers at least; planes of symmetry go
    !> through the axis or lie off the body.
    subroutine check_lattice(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        real(dp) :: wall, gap
        integer :: a, axis

        if (.not. body%layered) return
        wall = body%radius - body%inner_radius
        axis = index('xyz', body%axis)
        if (body%shape /= 'cylinder' .or. .not. body%inner_radius > 0) then
            call complain(deck, g, 'lattice', "lattice='layered' is for shape='cylinder' "// &
                          'with an inner_radius; give it one, or leave lattice out')
            return
        end if
        if (case%run%dimension == 1 .or. case%run%dimension == 2 .and. axis < 3) &
            call complain(deck, g, 'lattice', "lattice='layered' lays rings round the axis, "// &
                          'which must lie in the plane of the scene or in space; leave it out')
        if (body%spacing*(least_layers - 0.5_dp) > wall) call complain(deck, g, 'spacing', &
            'a wall of '//to_text(wall)//' m has less than three layers of '// &
            to_text(body%spacing)//' m and does not bend right; use a smaller spacing')
        if (body%spacing > body%inner_radius) call complain(deck, g, 'spacing', 'the inmost '// &
            'ring of a layered lattice needs a spacing of at most the inner_radius, '// &
            to_text(body%inner_radius)//' m')
        if (any(body%plate_axis == ['x   ', 'y   ', 'z   '])) &
            call complain(deck, g, 'plate_axis', 'a layered lattice has radial normals; '// &
                          "plate_axis may be 'auto' or 'none'")
        if (body%variable_h) call complain(deck, g, 'variable_h', 'a layered lattice has a '// &
                                           'constant smoothing length; leave variable_h out')
        if (body%n_plies > 0) call complain(deck, g, 'plies', 'plies are flat, a layered '// &
                                            'lattice is not; leave one of them out')
        do a = 1, case%run%dimension
            if (a == axis .or. .not. case%run%symmetry(a)) cycle
            gap = body%centre(a) - body%radius
            if (abs(body%centre(a)) <= slack*body%radius .or. gap >= apart*body%spacing) cycle
            call complain(deck, g, 'centre', 'a plane of symmetry must go through the axis of '// &
                          'a layered lattice, or lie four spacings off it; move the body')
        end do
    end subroutine check_lattice
end module brz_check_lattice
