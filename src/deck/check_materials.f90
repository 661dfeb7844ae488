! SPDX-License-Identifier: MIT
!> Constants of materials that can be computed with, but that no such material has.
module brz_check_materials
    use brz_deck, only: add_warning, deck_t, group_label
    use brz_key, only: key_t
    use brz_key_text, only: unit_text
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: check_materials

contains

    !> Warn of every number that lies outside of what is usual for its key. A 0 switches off.
    subroutine check_materials(deck, keys)
        type(deck_t), intent(inout) :: deck
        type(key_t), intent(in) :: keys(:)
        integer :: g, e

        do g = 1, deck%n
            if (deck%groups(g)%name /= 'material') cycle
            do e = 1, deck%groups(g)%n
                associate (entry => deck%groups(g)%entries(e))
                    if (entry%bad .or. entry%default .or. entry%row == 0) cycle
                    if (.not. allocated(entry%number)) cycle
                    if (size(entry%number) == 0) cycle
                    call check_number(deck, g, entry%line, keys(entry%row), entry%number(1))
                end associate
            end do
        end do
    end subroutine check_materials

    subroutine check_number(deck, g, line, row, value)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, line
        type(key_t), intent(in) :: row
        real(dp), intent(in) :: value

        if (.not. abs(value) > 0) return
        if (value >= row%likely(1) .and. value <= row%likely(2)) return
        call add_warning(deck, line, group_label(deck%groups(g))//trim(row%key)//' = '// &
            to_text(value)//unit_text(row)//' is not plausible: usual is '// &
            to_text(row%likely(1))//' to '//to_text(row%likely(2))//'; is it in SI units?')
    end subroutine check_number
end module brz_check_materials
