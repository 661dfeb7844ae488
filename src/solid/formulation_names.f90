! SPDX-License-Identifier: MIT
!> The formulations of bodies: their numbers, and their names in decks.
module brz_formulation_names
    implicit none
    private
    public :: form_names, form_corrected, form_corrected_hourglass, form_bending, &
              form_uncorrected, form_rigid, form_total

    integer, parameter :: form_corrected = 1, form_corrected_hourglass = 2, form_bending = 3, &
                          form_uncorrected = 4, form_rigid = 5, form_total = 6
    character(19), parameter :: form_names(6) = [character(19) :: 'corrected', &
                                                 'corrected_hourglass', 'bending', &
                                                 'uncorrected', 'rigid', 'total_lagrangian']
end module brz_formulation_names
