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
    public :: check_start, check_geometry, is_radial

contains

    !> True if the air is computed along the radius of a charge and nothing else.
    pure logical function is_radial(case)
        type(case_t), intent(in) :: case

        is_radial = case%air%present .and. case%air%geometry /= 'cartesian'
    end function is_radial

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
                              "'cylindrical' or 'planar' can run")
            end if
        end do
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
            call complain(deck, g, 'eos', "eos='jwl' is computed in one dimension only: add "// &
                          "start='1d', or use eos='ideal'")
        if (charge%start == '3d') return
        if (size(case%charges) > 1) &
            call complain(deck, g, 'start', "start='1d' is for a single charge; start several "// &
                          "with start='3d'")
        if (.not. fits(case, charge)) &
            call complain(deck, g, 'start', "start='1d' is for a sphere in three dimensions "// &
                          "and a disc in two; this shape needs start='3d'")
    end subroutine check_start

    !> Burning with the air is known along the radius alone.
    subroutine check_afterburn(deck, g, case, charge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the charge
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge

        if (.not. charge%afterburn > 0) return
        if (.not. charge%afterburn_time > 0) &
            call complain(deck, g, 'afterburn', 'over which time? give afterburn_time [s]')
        if (.not. is_radial(case)) &
            call complain(deck, g, 'afterburn', 'in a box the products do not burn on; use '// &
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
