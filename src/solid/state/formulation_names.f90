! SPDX-License-Identifier: MIT
!> The formulations of bodies by number: their names in decks, and their forms of artificial stress.
module brz_formulation_names
    implicit none
    private
    public :: artificial_none, artificial_monaghan, artificial_gray
    public :: form_names, form_corrected, form_corrected_hourglass, form_bending, &
              form_uncorrected, form_rigid, form_total

    integer, parameter :: form_corrected = 1, form_corrected_hourglass = 2, form_bending = 3, &
                          form_uncorrected = 4, form_rigid = 5, form_total = 6
    character(19), parameter :: form_names(6) = [character(19) :: 'corrected', &
                                                 'corrected_hourglass', 'bending', &
                                                 'uncorrected', 'rigid', 'total_lagrangian']
    ! artificial stress, see brz_artificial_stress
    integer, parameter :: artificial_none = 0
    integer, parameter :: artificial_monaghan = 1 !! of a negative pressure
    integer, parameter :: artificial_gray = 2 !! of each tensile principal stress
end module brz_formulation_names
