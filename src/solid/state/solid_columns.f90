! SPDX-License-Identifier: MIT
!> Where fields of the particles lie on a GPU: the columns of `state(n, ...)` and of `tag(n, ...)`.
module brz_solid_columns
    implicit none
    private
    public :: at_mu, at_energy, at_stress, at_damage, at_wave, at_bulk, at_mass, at_accel, at_hist
    public :: tag_id, tag_ply, tag_support, tag_fixed, tag_unsupported, tag_fault, &
              tag_bond, tag_joined, tag_touch, tag_weight, tag_face, n_tag, n_linked_tag

    ! columns of `state`
    integer, parameter :: at_mu = 1, at_energy = 2
    integer, parameter :: at_stress = 2 !! + 1..6
    integer, parameter :: at_damage = 9, at_wave = 10, at_bulk = 11, at_mass = 12
    integer, parameter :: at_accel = 12 !! + 1..3
    integer, parameter :: at_hist = 15 !! + 1..n_hist; then what brz_solid_fields adds

    ! columns of `tag`
    integer, parameter :: tag_id = 1, tag_ply = 2, tag_support = 3, tag_fixed = 4, &
        tag_unsupported = 5
    integer, parameter :: tag_fault = 6 !! 1: an impossible state was seen here
    integer, parameter :: tag_bond = 7 !! bond_none, ...
    integer, parameter :: tag_joined = 8 !! cohesive interfaces that still hold it, a bit each
    integer, parameter :: tag_touch = 9, tag_weight = 10 !! real32, see links_t
    integer, parameter :: n_tag = 10
    integer, parameter :: tag_face = 11 !! the first of n_face, real32; only where bodies meet
    integer, parameter :: n_linked_tag = 16
end module brz_solid_columns
