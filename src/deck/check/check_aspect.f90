! SPDX-License-Identifier: MIT
!> Wide particles (`aspect`): what they do not go with.
module brz_check_aspect
    use brz_case, only: body_case_t, case_t
    use brz_deck, only: complain, deck_t
    implicit none
    private
    public :: check_aspect, check_meeting

contains

    !> Wide particles of a body itself, and the air.
    subroutine check_aspect(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body

        if (.not. any(body%aspect > 1)) return
        if (any(body%aspect(case%run%dimension + 1:) > 1)) call complain(deck, g, 'aspect', &
            'aspect has widths along directions that are not modelled; set them to 1')
        if (minval(body%aspect(:case%run%dimension)) > 1) call complain(deck, g, 'aspect', &
            'spacing is the smallest width of a particle: one number of aspect must be 1')
        if (body%shape /= 'box') call complain(deck, g, 'aspect', &
            "wide particles (aspect) fill boxes alone; leave aspect out, or take shape='box'")
        if (all(body%formulation /= [character(19) :: 'auto', 'total_lagrangian'])) &
            call complain(deck, g, 'aspect', "wide particles (aspect) need formulation="// &
            "'total_lagrangian', where the unloaded body weighs the pairs; leave one of them out")
        if (case%air%present) call complain(deck, g, 'aspect', 'a wide particle (aspect) '// &
            'would cover several cells of air; load the body by &load, or leave aspect out')
    end subroutine check_aspect

    !> Wide particles and other bodies.
    subroutine check_meeting(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: g, i, k
        logical :: meets

        meets = size(case%bodies) > 1
        do i = 1, size(case%interactions)
            associate (rule => case%interactions(i))
                if (rule%law == 'none' .and. rule%body(1) == 0 .and. rule%body(2) == 0) &
                    meets = .false.
                if (rule%law /= 'none' .and. size(case%bodies) > 1) meets = .true.
            end associate
        end do
        k = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'body') cycle
            k = k + 1
            if (.not. any(case%bodies(k)%aspect > 1)) cycle
            if (meets) call complain(deck, g, 'aspect', &
                'wide particles (aspect) have no contact and no bonds: nothing in their scene '// &
                "may meet; leave aspect out, or add &interaction law = 'none' /")
        end do
    end subroutine check_meeting
end module brz_check_aspect
