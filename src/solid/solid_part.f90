! SPDX-License-Identifier: MIT
!> What one process has to do with the others where several share the particles: the regions of all,
!> and whose ghosts are where.
module brz_solid_part
    use brz_kinds, only: dp
    use brz_mail, only: mail_t
    implicit none
    private
    public :: part_t, parcels_t

    !> Particles that are in a message: parcel r is entries first(r) to first(r + 1) - 1.
    type :: parcels_t
        integer, allocatable :: place(:) !! of the particles
        integer, allocatable :: first(:) !! (0:processes)
    end type parcels_t

    !> Regions fill all of space.
    type :: part_t
        real(dp), allocatable :: region(:, :, :) !! (3, 2, 0:processes-1) corners [m]
        real(dp) :: lowest(3) = -huge(1.0_dp)
        !! no particle of any body is lower, where a plane of symmetry is [m]
        integer :: most = 0 !! most particles of a process when the regions were cut
        type(parcels_t) :: out !! particles of this process that others have ghosts of
        type(parcels_t) :: in !! ghosts of this process
        type(mail_t) :: mail
    end type part_t
end module brz_solid_part
