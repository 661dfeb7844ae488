! SPDX-License-Identifier: MIT
!> Keys of the method of a body that say nothing where others are as they are.
module brz_check_methods
    use brz_case, only: body_case_t
    use brz_deck, only: add_warning, deck_t, group_label
    use brz_get, only: is_given
    implicit none
    private
    public :: check_methods

    !> A key, and the formulations that read it.
    type :: read_by_t
        character(16) :: key
        character(40) :: formulations
    end type read_by_t

    type(read_by_t), parameter :: readers(5) = [ &
        read_by_t('zeta', 'bending, total_lagrangian'), read_by_t('hourglass_axes', 'bending'), &
        read_by_t('zeta_viscous', 'corrected_hourglass'), &
        read_by_t('tensile_control', 'corrected_hourglass'), &
        read_by_t('plate_axis', 'corrected_hourglass')]

contains

    !> Warn of keys of group g without effect. Which formulation 'auto' takes is not known yet.
    subroutine check_methods(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(in) :: body
        integer :: k

        do k = 1, size(readers)
            if (body%formulation == 'auto') exit
            if (index(', '//readers(k)%formulations, ', '//trim(body%formulation)) > 0) cycle
            call warn(readers(k)%key, "it is of formulation='"//trim(readers(k)%formulations)// &
                      "', and this is '"//trim(body%formulation)//"'")
        end do
        if (.not. body%variable_h) call warn('h_range', 'it is of variable_h = .true.')

    contains

        subroutine warn(key, why)
            character(*), intent(in) :: key, why

            if (.not. is_given(deck%groups(g), trim(key))) return
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))// &
                             trim(key)//' has no effect: '//why)
        end subroutine warn
    end subroutine check_methods
end module brz_check_methods
