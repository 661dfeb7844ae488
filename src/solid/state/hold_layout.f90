! SPDX-License-Identifier: MIT
!> What the hold of a pair needs of a particle: the places of its numbers in a row of `held`, see
!> brz_tension_hold.
module brz_hold_layout
    implicit none
    private
    public :: n_held, held_affine, held_energy, held_stiffness, held_whole

    integer, parameter :: held_affine = 0 !! + 1..9: K dx/dX [Pa]
    integer, parameter :: held_energy = 10 !! that it holds [J]
    integer, parameter :: held_stiffness = 11 !! K [Pa]
    integer, parameter :: held_whole = 12 !! 0: lost its support, holds nothing; else 1
    integer, parameter :: n_held = 12
end module brz_hold_layout
