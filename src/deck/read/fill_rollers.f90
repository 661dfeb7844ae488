! SPDX-License-Identifier: MIT
!> Regions of a body that are held along one axis alone.
module brz_fill_rollers
    use brz_case, only: body_case_t, name_len
    use brz_deck, only: complain, deck_t
    use brz_get, only: get, get_boxes, is_usable
    use brz_text, only: to_text
    implicit none
    private
    public :: fill_rollers

contains

    !> Boxes and an axis for each.
    subroutine fill_rollers(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g !! group of the body
        type(body_case_t), intent(inout) :: body
        character(name_len) :: axes(size(body%roller_axis))
        integer :: n

        n = 0
        axes = ''
        if (is_usable(deck%groups(g), 'roller_axis')) &
            call get(deck%groups(g), 'roller_axis', axes, n)
        call get_boxes(deck, g, 'roller_box', body%roller_box, body%n_rollers)
        body%roller_axis = axes(:) (:1)
        if (n /= body%n_rollers) call complain(deck, g, merge('roller_axis', 'roller_box ', n > &
            body%n_rollers), 'roller_axis has '//to_text(n)//' axes for '// &
            to_text(body%n_rollers)//' regions of roller_box; give one for each')
        if (body%n_rollers == 0) return
        if (body%formulation == 'rigid') call complain(deck, g, 'roller_box', 'rollers are for '// &
            "bodies that deform; hold a rigid body by fix='all' or drive it")
        if (body%n_motion > 0) call complain(deck, g, 'roller_box', 'a body with a prescribed '// &
            'motion has no rollers; press on it by a rigid body instead')
    end subroutine fill_rollers
end module brz_fill_rollers
