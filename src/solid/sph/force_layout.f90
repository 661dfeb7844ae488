! SPDX-License-Identifier: MIT
!> Sums over the neighbours of a particle in pass 2: 1..3 is the force of the stress [N]; the places
!> of the others.
module brz_force_layout
    implicit none
    private
    public :: at_heat, at_friction, at_drag, at_stiff, at_work, n_terms

    integer, parameter :: at_heat = 4 !! heat of the viscosity [W]
    integer, parameter :: at_friction = 5 !! heat of the viscous hourglass force [W]
    integer, parameter :: at_drag = 5 !! + 1..3: viscous forces [N]
    integer, parameter :: at_stiff = 8 !! + 1..3: stiff hourglass force, or artificial stress [N]
    integer, parameter :: at_work = 12 !! work against the tensile control, half of it to each of a
                                       !! pair [W]
    integer, parameter :: n_terms = 12
end module brz_force_layout
