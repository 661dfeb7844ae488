! SPDX-License-Identifier: MIT
!> Where the energy of a body went.
module brz_energy_account
    use brz_kinds, only: dp
    implicit none
    private
    public :: energy_account_t
    public :: kept_energy, kept_heat, kept_rub, kept_early, n_kept

    ! what contact does with the energy of a particle, see push_particle
    integer, parameter :: kept_energy = 1 !! that contact holds now
    integer, parameter :: kept_heat = 2, kept_rub = 3 !! heat of contact, of friction
    integer, parameter :: kept_early = 4 !! heat of the half step to come, see energy_account_t
    integer, parameter :: n_kept = 4

    !> What one body has done with its energy so far, all in J.
    type :: energy_account_t
        real(dp) :: viscous = 0 !! heat by artificial viscosity
        real(dp) :: hourglass_heat = 0 !! heat by the viscous hourglass force and by the tensile
                                       !! control
        real(dp) :: hourglass = 0 !! energy held by (or fed to) the stiff hourglass force
        real(dp) :: artificial = 0 !! energy held by the artificial stress
        real(dp) :: ahead = 0 !! change of one of these two in the half step to come
        real(dp) :: early = 0 !! heat of the half step to come, in the internal energy already
        real(dp) :: load = 0 !! work of the air on the body
        real(dp) :: plastic = 0 !! plastic work
        real(dp) :: damage = 0 !! work spent in damage
        real(dp) :: contact = 0 !! energy that the springs of contact hold
        real(dp) :: contact_heat = 0 !! heat of damping, and of shared pressure, in contact
        real(dp) :: friction = 0 !! heat of friction
        real(dp) :: drive = 0 !! work of prescribed motion
        real(dp) :: clamped = 0 !! no energy: particle steps at the edge of the material's range
    end type energy_account_t
end module brz_energy_account
