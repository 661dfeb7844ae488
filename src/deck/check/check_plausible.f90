! SPDX-License-Identifier: MIT
!> Numbers that can be computed with, but that no such thing has: mostly those in other units.
module brz_check_plausible
    use brz_deck, only: add_warning, deck_t, find_group, group_label
    use brz_key, only: key_t
    use brz_key_text, only: unit_text
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_plausible

contains

    !> Warn of every number that lies outside of what is usual for its key. A 0 switches off. Air of
    !> any units will do, but not around an explosive.
    subroutine check_plausible(deck, keys)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        logical :: free
        integer :: g, e

        free = find_group(deck, 'charge') == 0
        do g = 1, deck%n
            if (free .and. deck%groups(g)%name == 'air') cycle
            do e = 1, deck%groups(g)%n
                associate (entry => deck%groups(g)%entries(e))
                    if (entry%bad .or. entry%default .or. entry%row == 0) cycle
                    if (.not. allocated(entry%number)) cycle
                    if (size(entry%number) == 0) cycle
                    call check_number(deck, g, entry%line, keys(entry%row), &
                                      maxval(abs(entry%number)))
                end associate
            end do
        end do
    end subroutine check_plausible

    subroutine check_number(deck, g, line, row, value)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, line
        type(key_t), intent(in) :: row
        real(dp), intent(in) :: value !! the largest of them, without its sign

        if (.not. value > 0) return
        if (value >= row%likely(1) .and. value <= row%likely(2)) return
        call add_warning(deck, line, group_label(deck%groups(g))//trim(row%key)//' = '// &
            to_text(value)//unit_text(row)//' is not plausible: usual is '// &
            to_text(row%likely(1))//' to '//to_text(row%likely(2))//'; is it in SI units?')
    end subroutine check_number
end module brz_check_plausible
