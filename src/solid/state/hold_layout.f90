! SPDX-License-Identifier: MIT
!> What the tensile control of a pair needs of a particle: the places of its numbers in a row of
!> `held`, see brz_tensile_control.
module brz_hold_layout
    implicit none
    private
    public :: n_control, control_affine, control_energy, control_stiffness, control_whole

    integer, parameter :: control_affine = 0 !! + 1..9: K dx/dX [Pa]
    integer, parameter :: control_energy = 10 !! that it holds [J]
    integer, parameter :: control_stiffness = 11 !! K [Pa]
    integer, parameter :: control_whole = 12 !! 0: lost its support, holds nothing; else 1
    integer, parameter :: n_control = 12
end module brz_hold_layout
