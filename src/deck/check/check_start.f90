! SPDX-License-Identifier: MIT
!> How charges start, and air that is computed along the radius alone.
module brz_check_start
    use brz_case, only: case_t, charge_case_t
    use brz_deck, only: add_error, add_warning, complain, deck_t, find_group, group_label
    use brz_explosives, only: explosives, find_explosive
    use brz_get, only: is_given
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_start, check_geometry, is_radial, is_axial

contains

    !> True if the air is computed along the radius of a charge, or in the plane through its axis,
    !> and nothing else.
    pure logical function is_radial(case)
        type(case_t), intent(in) :: case

        is_radial = case%air%present .and. case%air%geometry /= 'cartesian'
    end function is_radial

    !> True if that radius lies in a plane through the axis of the charge.
    pure logical function is_axial(case)
        type(case_t), intent(in) :: case

        is_axial = case%air%present .and. case%air%geometry == 'axial'
    end function is_axial

    !> Along the radius there is one charge and gauges, and no box.
    subroutine check_geometry(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        character(8), parameter :: keys(2) = [character(8) :: 'box', 'cells']
        character(8), parameter :: others(2) = [character(8) :: 'gas', 'body']
        integer :: g, i

        g = find_group(deck, 'air')
        if (g == 0) return
        do i = 1, 2
            if (is_radial(case) .and. is_given(deck%groups(g), trim(keys(i)))) then
                call complain(deck, g, trim(keys(i)), "geometry='"//trim(case%air%geometry)// &
                              "' takes no "//trim(keys(i))//': the air has no end; take it out')
            else if (.not. is_radial(case) .and. .not. is_given(deck%groups(g), &
                                                                trim(keys(i)))) then
                call complain(deck, g, trim(keys(i)), "key '"//trim(keys(i))// &
                              "' is missing; without it only geometry='spherical', "// &
                              "'cylindrical', 'planar' or 'axial' can run")
            end if
        end do
        if (is_given(deck%groups(g), 'floor') .and. .not. is_axial(case)) &
            call complain(deck, g, 'floor', "a floor is for geometry='axial'; in a box use bc")
        if (.not. is_radial(case)) return
        do i = 1, 2
            if (find_group(deck, trim(others(i))) == 0) cycle
            call complain(deck, g, 'geometry', "geometry='"//trim(case%air%geometry)// &
                          "' has no room for &"//trim(others(i))//"; use 'cartesian'")
        end do
        if (any(case%run%symmetry)) &
            call complain(deck, g, 'geometry', 'planes of symmetry have no meaning along a '// &
                          'radius; take symmetry out of &run')
        if (size(case%charges) /= 1) call complain( &
            deck, g, 'geometry', "geometry='"//trim(case%air%geometry)//"' needs one &charge, "// &
            'found '//to_text(size(case%charges)))
        if (is_axial(case) .and. any(case%charges%shape == 'box')) call complain( &
            deck, g, 'geometry', "geometry='axial' needs a sphere or a cylinder")
    end subroutine check_geometry

    !> A charge that starts in one dimension, or needs to.
    subroutine check_start(deck, g, case, charge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the charge
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        integer :: row

        row = find_explosive(charge%explosive)
        if (charge%eos == 'jwl' .and. row > 0) then
            if (abs(charge%density/explosives(row)%density - 1) > 0.01_dp) &
                call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                                 'the constants of JWL hold for a density of '// &
                                 to_text(explosives(row)%density)//' kg/m3')
        end if
        call check_afterburn(deck, g, case, charge)
        if (is_radial(case)) return
        if (charge%eos == 'jwl' .and. charge%start == '3d') &
            call complain(deck, g, 'eos', "eos='jwl' is computed in one or two dimensions "// &
                          "only: add start='1d' or '2d', or use eos='ideal'")
        call check_ignition(deck, g, case, charge)
        if (charge%start == '3d') return
        if (size(case%charges) > 1) &
            call complain(deck, g, 'start', "start='"//trim(charge%start)//"' is for a single "// &
                          "charge; start several with start='3d'")
        if (charge%start == '2d') then
            if (count(case%air%cells > 1) < 3 .or. charge%shape == 'box') &
                call complain(deck, g, 'start', "start='2d' is for a sphere or a cylinder in "// &
                              "three dimensions; use start='3d'")
        else if (.not. fits(case, charge)) then
            call complain(deck, g, 'start', "start='1d' is for a sphere in three dimensions "// &
                          "and a disc in two; this shape needs start='2d' or '3d'")
        end if
    end subroutine check_start

    !> A detonation begins at a point on the axis of the charge.
    subroutine check_ignition(deck, g, case, charge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the charge
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        real(dp) :: arm(3)

        if (.not. is_given(deck%groups(g), 'ignition')) return
        if (.not. (is_axial(case) .or. charge%start == '2d') .or. charge%eos /= 'jwl' .or. &
            charge%burn /= 'programmed') &
            call complain(deck, g, 'ignition', "a detonation from a point needs start='2d' or "// &
                          "geometry='axial', eos='jwl' and burn='programmed'; elsewhere take "// &
                          'ignition out')
        arm = charge%ignition - charge%at
        arm(index('xyz', charge%axis)) = 0
        if (norm2(arm) > 1e-9_dp) &
            call complain(deck, g, 'ignition', 'the point must lie on the axis along '// &
                          charge%axis//' through the centre of the charge')
    end subroutine check_ignition

    !> Burning with the air is known along the radius alone.
    subroutine check_afterburn(deck, g, case, charge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the charge
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge

        if (.not. charge%afterburn > 0) return
        if (.not. charge%afterburn_time > 0) &
            call complain(deck, g, 'afterburn', 'over which time? give afterburn_time [s]')
        if (.not. is_radial(case) .or. is_axial(case)) &
            call complain(deck, g, 'afterburn', 'there the products do not burn on; use '// &
                          "geometry='spherical', or take it out")
    end subroutine check_afterburn

    !> True if the blast of the charge depends on the radius alone.
    pure logical function fits(case, charge)
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        integer :: axis

        axis = index('xyz', charge%axis)
        select case (count(case%air%cells > 1))
        case (3)
            fits = charge%shape == 'sphere'
        case (2)
            fits = charge%shape == 'sphere' .or. charge%shape == 'cylinder' &
                   .and. case%air%cells(axis) == 1
        case default
            fits = .true.
        end select
    end function fits
end module brz_check_start
