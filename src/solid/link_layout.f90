! SPDX-License-Identifier: MIT
!> How lists of particles are written: an entry is a particle plus mask_unit times the mask of the
!> axes in which it is mirrored, bits 0..2.
module brz_link_layout
    use brz_kinds, only: rk
    implicit none
    private
    public :: mask_unit, link_unit, n_press, link_layout_t

    integer, parameter :: mask_unit = 2**28
    integer, parameter :: link_unit = 8 !! entries by which places in the list are counted on a CPU
    integer, parameter :: n_press = 8 !! rows of `press`, a whole number of cache lines

    !> What the loops over links are told about the bodies and about how arrays lie.
    type :: link_layout_t
        integer :: bodies, dimension
        integer :: holds !! 1: some body has the hold
        integer :: wide !! rows of positions and velocities
        integer :: step_c, step_p !! distances in `stress` of components, of particles
        integer :: step_v !! distance of volumes
        integer :: compact !! 1: lists and sums of contact are those of rows; 0: of particles
        integer :: side !! lists side by side, entry by entry
        integer :: unit !! entries by which places in the list are counted
        real(rk) :: depth !! of directions that are not modelled [m or m2]
    end type link_layout_t
end module brz_link_layout
