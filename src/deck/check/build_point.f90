! SPDX-License-Identifier: MIT
!> From the deck as read to a validated material point and its path.
module brz_build_point
    use brz_build_case, only: fill_material, take_warnings
    use brz_case, only: point_case_t, segment_case_t
    use brz_check_bodies, only: reference_hint
    use brz_check_plausible, only: check_plausible
    use brz_deck, only: add_error, complain, deck_t, find_group, may_be_misspelt, report_errors
    use brz_errors, only: error_t, failed
    use brz_fill_case, only: name_job
    use brz_get, only: get, is_given, is_usable
    use brz_key, only: key_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: build_point

contains

    !> Fill a point from &material, &point and &segment. Raises all errors of the deck together.
    subroutine build_point(deck, keys, point, err)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(point_case_t), intent(out) :: point
        type(error_t), intent(inout) :: err
        integer :: g, k

        allocate (point%warnings(0))
        if (failed(err)) return
        call check_presence(deck)
        call name_job(deck, point%job)
        call fill_point(deck, keys, point)
        allocate (point%segments(count(deck%groups(:deck%n)%name == 'segment')))
        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'segment') cycle
            k = k + 1
            call fill_segment(deck, g, point%steps, point%segments(k))
        end do
        call check_plausible(deck, keys)
        call take_warnings(deck, point%warnings)
        call report_errors(deck, err)
    end subroutine build_point

    subroutine check_presence(deck)
        type(deck_t), intent(inout) :: deck

        if (may_be_misspelt(deck)) return
        if (find_group(deck, 'point') == 0) call add_error(deck, 0, &
            "the group &point is missing; write at least &point material='...' /")
        if (find_group(deck, 'segment') == 0) call add_error(deck, 0, &
            'there is no &segment: the point has no path; write &segment duration=..., l=... /')
    end subroutine check_presence

    !> The point and the material it is made of.
    subroutine fill_point(deck, keys, point)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        type(point_case_t), intent(inout) :: point
        character(len(point%material%id)) :: id
        integer :: g, m

        g = find_group(deck, 'point')
        if (g == 0) return
        id = ''
        call get(deck%groups(g), 'material', id)
        call get(deck%groups(g), 'steps', point%steps)
        call get(deck%groups(g), 'output_every', point%output_every)
        call get(deck%groups(g), 'rotation', point%rotation)
        call get(deck%groups(g), 'ply_axis', point%ply_axis)
        call get(deck%groups(g), 'crack_length', point%crack_length)
        if (.not. is_usable(deck%groups(g), 'material')) return
        m = find_group(deck, 'material', trim(id))
        if (m > 0) then
            call fill_material(deck, deck%groups(m), keys, point%material)
        else
            call complain(deck, g, 'material', "there is no &material with id='"//trim(id)//"'"// &
                          known_materials(deck, trim(id)))
        end if
    end subroutine fill_point

    !> Which material may have been meant.
    pure function known_materials(deck, id) result(text)
        type(deck_t), intent(in) :: deck
        character(*), intent(in) :: id
        character(:), allocatable :: text
        character(32) :: ids(deck%n)
        integer :: g, n

        n = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'material') cycle
            n = n + 1
            ids(n) = deck%groups(g)%id
        end do
        text = reference_hint(id, ids(:n))
    end function known_materials

    !> One segment; its control decides which keys it needs.
    subroutine fill_segment(deck, g, steps, segment)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        integer, intent(in) :: steps !! of a segment that does not say
        type(segment_case_t), intent(inout) :: segment
        real(dp) :: rows(9)

        rows = 0
        segment%steps = steps
        call get(deck%groups(g), 'steps', segment%steps)
        call get(deck%groups(g), 'control', segment%control)
        call get(deck%groups(g), 'l', rows)
        call get(deck%groups(g), 'axis', segment%axis)
        call get(deck%groups(g), 'rate', segment%rate)
        call get(deck%groups(g), 'lateral_stress', segment%lateral_stress)
        call get(deck%groups(g), 'pressure', segment%pressure)
        segment%l = transpose(reshape(rows, [3, 3]))
        if (.not. is_usable(deck%groups(g), 'control')) return
        associate (control => segment%control)
            call belongs(deck, g, 'l', control, control == 'strain')
            call belongs(deck, g, 'rate', control, control == 'uniaxial_stress' .or. &
                         control == 'triaxial')
            call belongs(deck, g, 'lateral_stress', control, control == 'triaxial')
            call belongs(deck, g, 'pressure', control, control == 'pressure')
            if (control == 'strain' .or. control == 'pressure') then
                call refuse(deck, g, 'axis', control)
                call refuse(deck, g, 'strain', control)
            end if
        end associate
        call find_duration(deck, g, segment)
    end subroutine fill_segment

    !> The duration as given, or as strain over rate.
    subroutine find_duration(deck, g, segment)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(segment_case_t), intent(inout) :: segment
        real(dp) :: strain

        strain = 0
        call get(deck%groups(g), 'duration', segment%duration)
        call get(deck%groups(g), 'strain', strain)
        if (is_given(deck%groups(g), 'duration') .neqv. is_given(deck%groups(g), 'strain')) then
            if (.not. is_usable(deck%groups(g), 'strain')) return
            if (strain*segment%rate > 0) then
                segment%duration = strain/segment%rate
            else if (is_usable(deck%groups(g), 'rate')) then
                call complain(deck, g, 'strain', "'strain' and 'rate' need the same sign: the "// &
                              'rate leads away from that strain')
            end if
        else if (is_given(deck%groups(g), 'duration')) then
            call complain(deck, g, 'strain', "'duration' and 'strain' are both given; take one out")
        else
            call complain(deck, g, 'duration', "key 'duration' [s] is missing"// &
                          trim(merge(", or 'strain' in place of it", repeat(' ', 28), &
                                     is_given(deck%groups(g), 'rate'))))
        end if
    end subroutine find_duration

    !> A key that one control needs and every other refuses.
    subroutine belongs(deck, g, key, control, mine)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), intent(in) :: key, control
        logical, intent(in) :: mine !! the control needs it

        if (mine) then
            call need(deck, g, key, control)
        else
            call refuse(deck, g, key, control)
        end if
    end subroutine belongs

    subroutine need(deck, g, key, control)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), intent(in) :: key, control

        if (is_given(deck%groups(g), key)) return
        call complain(deck, g, key, "key '"//key//"' is missing: control='"//trim(control)// &
                      "' needs it")
    end subroutine need

    subroutine refuse(deck, g, key, control)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), intent(in) :: key, control

        if (.not. is_given(deck%groups(g), key)) return
        call complain(deck, g, key, "key '"//key//"' has no place with control='"// &
                      trim(control)//"'; take it out or change the control")
    end subroutine refuse
end module brz_build_point
