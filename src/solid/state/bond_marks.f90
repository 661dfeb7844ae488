! SPDX-License-Identifier: MIT
!> What is left of the bonds of a particle: the states of a tied contact, and what lets go of it.
module brz_bond_marks
    use brz_kinds, only: int32
    implicit none
    private
    public :: bond_none, tie_intact, bond_broken, bond_breaks, loose_by

    integer(int32), parameter :: bond_none = 0, tie_intact = 1, bond_broken = 2
    integer(int32), parameter :: bond_breaks = 3 !! broke in this step
    integer, parameter :: loose_by = 15 !! what lets go in this step stands so many bits higher
end module brz_bond_marks
