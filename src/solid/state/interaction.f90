! SPDX-License-Identifier: MIT
!> The interaction of two bodies: its law, and the numbers that the law takes.
module brz_interaction
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: interaction_t, law_none, law_contact, law_bonded, law_shared, law_cohesive

    integer, parameter :: law_none = 0, law_contact = 1, law_bonded = 2, law_shared = 3, &
                          law_cohesive = 4

    !> How a particle of one body meets those of another.
    type :: interaction_t
        integer :: law !! law_none, ...
        real(rk) :: h, scale, half_over_h !! mean smoothing length, see brz_kernel
        real(rk) :: spacing !! mean distance of particles [m]
        real(rk) :: touch !! kernel sum of a flat surface of the other body one spacing away
        real(rk) :: slope !! force of such a surface per pressure, for areas of pairs [-]
        real(rk) :: steep !! how fast that sum grows over itself as the face moves [1/m]
        real(rk) :: reach(2) !! how far the faces of both move for a unit of strain [m]
        real(rk) :: stiffness !! kappa [Pa]
        real(rk) :: core !! bulk modulus times area of the hard core [N]
        real(rk) :: impedance !! of damping, alpha/2 sqrt(K rho) [kg/(m2 s)]
        real(rk) :: friction !! Coulomb's coefficient
        real(rk) :: stick !! impedance of friction below Coulomb's limit [kg/(m2 s)]
        logical :: shared !! pressures of the two bodies are shared
        logical :: rigid !! the first body is
        real(rk) :: part(2) !! weight of a bonded pair in the gradients of the first, of the second
        real(rk) :: viscous(2) !! what each of two bonded bodies gives of its viscosity [-]
        integer :: formulation !! common to both bodies, 0: they differ
        real(rk) :: spares !! 1: the viscosity of both spares smooth flow, see jump_speed
        logical :: directional !! both have a hourglass stiffness along axes
        real(rk) :: arm(2) !! share of x_ij from each to the common surface; 0: it does not turn
        real(rk) :: rest(2) !! volume per mass of both, unloaded [m3/kg]
        real(rk) :: weight(2) !! bulk moduli over their mean [-]
        real(rk) :: normal(3, 2) !! of the layers of the first and of the second, 0: no tilts
        real(rk) :: lift(2) !! of the faces of both over their tilts, see brz_one_sided_arm
        logical :: curved(2) !! these are radial at each particle, see brz_body
        real(dp) :: middle(3, 2) !! a point of the axes of such walls [m]
        real(rk) :: tensile, shear !! strengths of a bond [Pa]
        logical :: quadratic !! both strengths act together
        integer :: bit !! of a cohesive interface in `joined` of links_t, else 0
    end type interaction_t
end module brz_interaction
