! SPDX-License-Identifier: MIT
!> Inter-body neighbours: pairs of particles of different bodies, and what passes between them.
module brz_links
    use brz_interaction, only: interaction_t
    use brz_kinds, only: dp, int32, real32, rk
    use brz_link_layout, only: link_layout_t
    implicit none
    private
    public :: links_t

    !> Pairs of particles of different bodies. Nothing is allocated where no two bodies meet.
    type :: links_t
        logical :: present = .false.
        logical :: bonds = .false. !! some bodies are bonded
        logical :: faces = .false. !! those of some may be in contact, see brz_contact_face
        type(interaction_t), allocatable :: table(:, :) !! (bodies, bodies) law of i's and j's body
        logical, allocatable :: met(:, :) !! (bodies, bodies) some particles of both have links
        real(dp), allocatable :: drift(:, :, :) !! (3, bodies, bodies) what the first had drifted
                                                !! beyond the second when links were built [m]
        real(dp) :: drifted = 0 !! the longest of these [m]
        real(dp), allocatable :: spare(:, :) !! (bodies, bodies) what they were further apart than
                                             !! links reach [m]
        logical, allocatable :: stale(:, :) !! (bodies, bodies) both are about to be linked anew
        type(link_layout_t) :: lay !! how lists and arrays lie
        real(dp), allocatable :: box(:, :, :) !! (3, 2, bodies) corners of x_built [m]
        integer(int32), allocatable :: ends(:) !! (bodies) last particle or ghost of each
        integer(int32), allocatable :: row(:) !! (n) row of a particle that has links, else 0
        integer :: rows = 0 !! particles that have links
        integer(int32), allocatable :: slice(:) !! (rows) entries before its own, over link_unit
        integer(int32), allocatable :: count(:) !! (rows) its links
        integer(int32), allocatable :: list(:) !! entries, see brz_link_layout
        real(rk), allocatable :: cell(:) !! (bodies) lattice volume per mass of particle [m3/kg]
        real(real32), allocatable :: touch(:) !! (n) kernel sum at which contact begins
        real(real32), allocatable :: face(:, :) !! (n_face, n) see brz_contact_face
        real(real32), allocatable :: weight(:) !! (n) of its cell in sums of contact, 1 but at the
                                               !! surface of round bodies
        integer(int32), allocatable :: bond(:) !! (n) bond_none, ..., bond_breaks
        integer(int32), allocatable :: joined(:) !! (n) cohesive interfaces that still hold a
                                                 !! particle, a bit each, and, see loose_by, those
                                                 !! that let go of it; only where there are some
        real(rk), allocatable :: press(:, :) !! (n_press, 0:rows) pressure of contact [Pa]; its
                                             !! gradient of the kernel sum [1/m]; stiffness [Pa];
                                             !! what its face adds to the row, see strain_face
        real(rk), allocatable :: push(:, :) !! (9, 0:rows) forces of contact: springs, drag [N];
                                            !! moment of drag on what turns [N m]
    end type links_t
end module brz_links
