! SPDX-License-Identifier: MIT
!> Gauges: what they measure must be there.
module brz_check_gauges
    use brz_case, only: case_t, gauge_case_t
    use brz_check_air, only: box_text, point_text
    use brz_check_bodies, only: miss_body
    use brz_body_geometries, only: body_box
    use brz_check_start, only: is_axial, is_radial
    use brz_deck, only: complain, deck_t, find_group, may_be_misspelt
    use brz_gauge_quantities, only: find_quantity, is_motion, is_of_body, quantities
    use brz_get, only: count_values, is_given, is_usable
    use brz_kinds, only: dp
    implicit none
    private
    public :: check_gauges

contains

    !> Check all gauges and find their bodies.
    subroutine check_gauges(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g, k

        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'gauge') cycle
            k = k + 1
            call find_body(deck, g, case, case%gauges(k))
            call find_other(deck, g, case, case%gauges(k))
            call find_motion(deck, g, case, case%gauges(k))
            if (.not. deck%groups(g)%bad) call check_quantity(deck, g, case, case%gauges(k))
            if (.not. deck%groups(g)%bad) call check_points(deck, g, case%gauges(k))
            if (.not. deck%groups(g)%bad) call check_width(deck, g, case, case%gauges(k))
            if (is_radial(case)) cycle
            if (.not. deck%groups(g)%bad) call check_place(deck, g, case, case%gauges(k))
        end do
    end subroutine check_gauges

    subroutine find_body(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(inout) :: gauge
        integer :: i

        if (.not. is_usable(deck%groups(g), 'body')) return
        do i = 1, size(case%bodies)
            if (case%bodies(i)%id == gauge%body) gauge%body_index = i
            if (gauge%body_index > 0) return
        end do
        call miss_body(deck, g, case, 'body', gauge%body)
    end subroutine find_body

    !> The other body of a force between two.
    subroutine find_other(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(inout) :: gauge

        if (.not. is_given(deck%groups(g), 'with')) return
        gauge%with_index = findloc(case%bodies%id, gauge%with, 1)
        if (all(index(gauge%quantity, ['contact', 'impulse']) /= 1)) then
            call complain(deck, g, 'with', "with belongs to quantity='contact_x' or "// &
                          "'impulse_x', ...; take it out")
        else if (gauge%with_index == 0) then
            call miss_body(deck, g, case, 'with', gauge%with)
        else if (gauge%with_index == gauge%body_index) then
            call complain(deck, g, 'with', 'a body does nothing to itself; name another one')
        end if
        if (deck%groups(g)%bad) gauge%with_index = 0
    end subroutine find_other

    !> The motion whose force is measured.
    subroutine find_motion(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(inout) :: gauge

        if (.not. is_given(deck%groups(g), 'motion')) return
        if (index(gauge%quantity, 'reaction') /= 1) then
            call complain(deck, g, 'motion', "motion belongs to quantity='reaction_x', ...; "// &
                          'take it out')
        else if (gauge%body_index > 0) then
            associate (body => case%bodies(gauge%body_index))
                if (allocated(body%regions)) &
                    gauge%motion_index = findloc(body%regions%id, gauge%motion, 1)
            end associate
            if (gauge%motion_index == 0) call complain(deck, g, 'motion', 'body '// &
                trim(gauge%body)//" has no &motion with id='"//trim(gauge%motion)//"'")
        end if
    end subroutine find_motion

    !> A quantity of the air, of a body, or of both.
    subroutine check_quantity(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: gauge
        logical :: of_body, of_air
        integer :: row

        row = find_quantity(trim(gauge%quantity))
        if (row == 0) return ! told where the key was read
        of_body = quantities(row)%gas == 0
        of_air = .not. is_of_body(quantities(row))
        if (is_radial(case) .and. .not. is_axial(case) .and. &
            index(gauge%quantity, 'velocity') == 1) then
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' needs a direction; along a radius measure the speed")
        else if (of_body .and. gauge%body_index == 0) then
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' is that of a body: add body='...'")
        else if (of_air .and. gauge%body_index > 0) then
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' is that of the air: take body out, or measure what the body has")
        else if (gauge%body_index == 0 .and. .not. case%air%present) then
            if (may_be_misspelt(deck)) return
            call complain(deck, g, 'quantity', "quantity='"//trim(gauge%quantity)// &
                          "' needs &air; for a body add body='...'")
        else if (gauge%body_index > 0 .and. .not. quantities(row)%whole > 0) then
            if (case%bodies(gauge%body_index)%formulation == 'rigid' .and. &
                .not. is_motion(quantities(row))) call complain(deck, g, 'quantity', &
                'a rigid body has no '//trim(gauge%quantity)//'; measure how it moves, or '// &
                'forces on it')
        else if (quantities(row)%whole > 0) then
            call check_whole(deck, g, case, trim(gauge%quantity))
        end if
    end subroutine check_quantity

    !> Forces on a whole body: what they come from must be there.
    subroutine check_whole(deck, g, case, quantity)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        character(*), intent(in) :: quantity
        logical :: loaded
        integer :: axis

        axis = index('xyz', quantity(len(quantity):))
        loaded = case%air%present .or. is_given(deck%groups(g), 'with')
        if (allocated(case%loads)) loaded = loaded .or. size(case%loads) > 0
        if ((index(quantity, 'contact') == 1 .or. is_given(deck%groups(g), 'with')) &
            .and. case%run%symmetry(axis)) then
            call complain(deck, g, 'quantity', quantity//' holds what the plane of symmetry '// &
                          'takes up, too; measure along the plane, or take symmetry out')
        else if (index(quantity, 'contact') == 1 .and. size(case%bodies) == 1 .and. &
                 .not. any(case%run%symmetry)) then
            call complain(deck, g, 'quantity', 'there is no other body that the body could touch')
        else if (index(quantity, 'load') + index(quantity, 'impulse') == 1 .and. .not. loaded) then
            call complain(deck, g, 'quantity', quantity//' is that of the air or of a &load, '// &
                          'and the deck has neither; take the gauge out')
        end if
    end subroutine check_whole

    !> The points that a quantity needs, and no others.
    subroutine check_points(deck, g, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(gauge_case_t), intent(in) :: gauge
        logical :: whole

        associate (group => deck%groups(g))
            whole = find_quantity(trim(gauge%quantity)) > 0
            if (whole) whole = quantities(find_quantity(trim(gauge%quantity)))%whole > 0
            if (whole .and. index(gauge%quantity, 'moment') == 0) then
                if (is_given(group, 'at')) call complain(deck, g, 'at', "quantity='"// &
                    trim(gauge%quantity)//"' is that of the whole body; take at out")
            else if (.not. is_given(group, 'at')) then
                call complain(deck, g, 'quantity', 'a gauge needs its place; add at = x, y, z')
            end if
            if (is_given(group, 'to') .neqv. gauge%quantity == 'strain') then
                if (gauge%quantity == 'strain') then
                    call complain(deck, g, 'quantity', 'a strain gauge needs its other end; '// &
                                  'add to = x, y, z')
                else
                    call complain(deck, g, 'to', "to belongs to quantity='strain'; take it out")
                end if
            end if
        end associate
    end subroutine check_points

    !> A mean over a box is that of something that has a value at every point of it.
    subroutine check_width(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: gauge

        if (.not. is_given(deck%groups(g), 'width')) return
        associate (of => quantities(find_quantity(trim(gauge%quantity))))
            if (of%whole > 0 .or. of%name == 'strain') then
                call complain(deck, g, 'width', 'there is no mean of '//trim(gauge%quantity)// &
                              ' over a box; take width out')
            else if (count_values(deck%groups(g), 'width') == 2) then
                call complain(deck, g, 'width', 'give one side for all, or three')
            else if (any(case%air%geometry == [character(11) :: 'planar', 'cylindrical']) .and. &
                     is_radial(case)) then
                call complain(deck, g, 'width', "geometry='"//trim(case%air%geometry)// &
                              "' knows the distance alone and no box; take width out")
            end if
        end associate
    end subroutine check_width

    !> A gauge of the air lies in the air, one of a body in or on the body.
    subroutine check_place(deck, g, case, gauge)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(gauge_case_t), intent(in) :: gauge
        character(:), allocatable :: where
        real(dp) :: lo(3), hi(3), slack(3)
        integer :: d

        if (find_quantity(trim(gauge%quantity)) == 0) return
        if (quantities(find_quantity(trim(gauge%quantity)))%whole > 0) return
        if (gauge%body_index > 0) then
            call body_box(case%bodies(gauge%body_index), lo, hi)
            slack = 1.001_dp*case%bodies(gauge%body_index)%spacing &
                    *case%bodies(gauge%body_index)%aspect
            where = 'the body, which is '
            if (deck%groups(find_group(deck, 'body', trim(gauge%body)))%bad) return
        else
            if (.not. case%air%present) return
            lo = case%air%lo
            hi = case%air%hi
            slack = 1e-9_dp*(hi - lo)
            where = 'the air, which is '
            if (deck%groups(find_group(deck, 'air'))%bad) return
        end if
        call look('at', gauge%at)
        if (gauge%quantity == 'strain') call look('to', gauge%to)

    contains

        subroutine look(key, at)
            character(*), intent(in) :: key
            real(dp), intent(in) :: at(3) !! [m]

            d = case%run%dimension
            if (any(at(:d) < lo(:d) - slack(:d) .or. at(:d) > hi(:d) + slack(:d))) &
                call complain(deck, g, key, 'the gauge at '//point_text(at)// &
                              ' lies outside '//where//box_text(lo, hi))
        end subroutine look
    end subroutine check_place
end module brz_check_gauges
