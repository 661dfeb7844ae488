! SPDX-License-Identifier: MIT
!> Charges on the ground or near it, and in air that is closed on all sides.
module brz_check_ground
    use brz_case, only: case_t, charge_case_t
    use brz_deck, only: add_warning, complain, deck_t, find_group, group_label
    use brz_get, only: is_given
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_ground, check_closed, ground_of, burst_text

    real(dp), parameter :: on_plane = 1e-6_dp !! how exactly a plane must pass the centre, in cells
    real(dp), parameter :: near = 2 !! half sides of a charge over a floor that make a jet
    real(dp), parameter :: combustion = 14.5e6_dp !! heat of combustion of TNT [J/kg]

contains

    !> A charge on the ground says so, and has a ground; one near a floor is warned of.
    subroutine check_ground(deck, g, case, charge, half)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the charge
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        real(dp), intent(in) :: half(3) !! sides of it [m]
        character(:), allocatable :: ground
        real(dp) :: height
        integer :: axis

        ground = ground_of(case, charge)
        axis = index('xyz', charge%axis)
        height = height_over_floor(case, charge)
        if (charge%on_ground .and. ground == '') then
            call complain(deck, g, 'burst', "burst='surface' needs the ground to lie on: no "// &
                          'floor and no plane of symmetry passes through its centre; put at on '// &
                          'one, or take burst out')
        else if (.not. abs(height) > 0 .and. .not. is_given(deck%groups(g), 'burst')) then
            call complain(deck, g, 'mass', 'its centre lies on the '//ground//', which halves '// &
                          "it: give burst='surface' and the mass of the half that is there ("// &
                          to_text(charge%mass/2)//" kg for what this deck says), or "// &
                          "burst='air' where "//to_text(charge%mass)//' kg are meant with the '// &
                          'mirror image')
        else if (height > 0 .and. height < near*half(axis)) then
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))//'its '// &
                             'centre is '//to_text(height/half(axis))//' half sides over the '// &
                             'floor: it sends a jet along a rigid floor, and up to a quarter '// &
                             'of the peak is missing far away (docs/manual/blast.md); for a '// &
                             "charge on the ground put at on the floor, with burst='surface' "// &
                             'and the same mass')
        end if
    end subroutine check_ground

    !> Where a charge lies on the ground: 'floor z = 0', '' if nothing mirrors it there.
    function ground_of(case, charge) result(text)
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        character(:), allocatable :: text
        real(dp) :: plane
        integer :: d, s

        text = ''
        if (case%air%geometry == 'axial') then
            d = index('xyz', charge%axis)
            if (.not. abs(charge%at(d) - case%air%floor) > 0) &
                text = 'floor '//charge%axis//' = '//to_text(case%air%floor)
            return
        else if (case%air%geometry /= 'cartesian') then
            text = 'ground' ! a rigid plane through the centre changes nothing
            return
        end if
        do d = 1, 3
            do s = 1, 2
                plane = merge(case%air%lo(d), case%air%hi(d), s == 1)
                if (.not. is_on(case, charge, d, plane)) cycle
                if (case%air%bc(s, d) == 'symmetry') text = 'plane of symmetry '
                if (is_floor(case, charge, s, d)) text = 'floor '
                if (text == '' .or. index(text, '=') > 0) cycle
                text = text//'xyz' (d:d)//' = '//to_text(plane)
            end do
        end do
    end function ground_of

    !> True for a side of the box that is a wall across the axis of a charge that starts in a plane.
    pure logical function is_floor(case, charge, s, d)
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        integer, intent(in) :: s, d

        is_floor = charge%start == '2d' .and. case%air%bc(s, d) == 'wall' .and. &
                   d == index('xyz', charge%axis)
    end function is_floor

    !> True if the centre of a charge lies on a plane across direction d.
    pure logical function is_on(case, charge, d, plane)
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        integer, intent(in) :: d
        real(dp), intent(in) :: plane !! [m]

        is_on = case%air%cells(d) > 1 .and. abs(charge%at(d) - plane) <= &
                on_plane*(case%air%hi(d) - case%air%lo(d))/case%air%cells(d)
    end function is_on

    !> Height of the centre over the floor of a blast in the plane through its axis, exactly 0 on
    !> it; huge without a floor [m].
    pure real(dp) function height_over_floor(case, charge) result(height)
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        real(dp) :: plane
        integer :: d, s

        height = huge(height)
        d = index('xyz', charge%axis)
        if (case%air%geometry == 'axial') then
            if (case%air%floor > -huge(1.0_dp)) height = charge%at(d) - case%air%floor
        else if (case%air%geometry == 'cartesian') then
            do s = 1, 2
                plane = merge(case%air%lo(d), case%air%hi(d), s == 1)
                if (.not. is_floor(case, charge, s, d)) cycle
                height = min(height, abs(charge%at(d) - plane))
                if (is_on(case, charge, d, plane)) height = 0
            end do
        end if
    end function height_over_floor

    !> What a charge on the ground is, '' for one in free air.
    function burst_text(case, charge) result(text)
        type(case_t), intent(in) :: case
        type(charge_case_t), intent(in) :: charge
        character(:), allocatable :: text

        text = ''
        if (.not. charge%on_ground) return
        text = 'half a '//trim(charge%shape)
        if (charge%shape == 'sphere') text = 'hemispherical surface burst'
        text = to_text(charge%mass/2)//' kg, '//text//' on the '//ground_of(case, charge)// &
               ', the same as '//to_text(charge%mass)//' kg in free air'
    end function burst_text

    !> Charges in air that is closed on all sides: there their products would burn.
    subroutine check_closed(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        character(:), allocatable :: burnt
        real(dp) :: part, room, energy
        integer :: c, d, g, s

        if (size(case%charges) == 0 .or. case%air%geometry /= 'cartesian') return
        if (count(case%air%cells > 1) < 3 .or. .not. any(case%air%bc == 'wall')) return
        if (any(case%air%bc /= 'wall' .and. case%air%bc /= 'symmetry')) return
        room = product(case%air%hi - case%air%lo)
        energy = 0
        burnt = ''
        do c = 1, size(case%charges)
            part = case%charges(c)%mass
            do d = 1, 3
                do s = 1, 2
                    if (is_on(case, case%charges(c), d, merge(case%air%lo(d), case%air%hi(d), &
                                                              s == 1))) part = part/2
                end do
            end do
            energy = energy + part*case%charges(c)%energy
            if (case%charges(c)%explosive == 'tnt') burnt = burnt//'+'
        end do
        g = find_group(deck, 'charge')
        if (len(burnt) == size(case%charges)) burnt = '; burnt, it may be '//kilopascals( &
            (case%air%gamma - 1)*energy*combustion/case%charges(1)%energy/room)//' at most'
        if (index(burnt, ';') == 0) burnt = ''
        call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))//'the air is '// &
                         'closed on all sides, and products that burn with it there '// &
                         '(afterburning) are not modelled: the overpressure that stays comes '// &
                         'out as '//kilopascals((case%air%gamma - 1)*energy/room)//burnt// &
                         '; take the first reflections from this run, what stays from a hand '// &
                         'calculation or curves')
    end subroutine check_closed

    !> A pressure in whole kPa.
    function kilopascals(pressure) result(text)
        real(dp), intent(in) :: pressure !! [Pa]
        character(:), allocatable :: text

        text = to_text(nint(1e-3_dp*pressure))//' kPa'
    end function kilopascals
end module brz_check_ground
