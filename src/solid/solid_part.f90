! SPDX-License-Identifier: MIT
!> What one process has to do with the others where several share the particles: the regions of all,
!> and whose ghosts are where.
module brz_solid_part
    use brz_kinds, only: dp
    use brz_mail, only: mail_t
    implicit none
    private
    public :: part_t

    !> Regions fill all of space. Parcel r is entries first(r) to first(r + 1) - 1.
    type :: part_t
        real(dp), allocatable :: region(:, :, :) !! (3, 2, 0:processes-1) corners [m]
        integer :: most = 0 !! most particles of a process when the regions were cut
        integer, allocatable :: out(:) !! particles of this process that others have ghosts of
        integer, allocatable :: in(:) !! ghosts of this process
        integer, allocatable :: out_first(:), in_first(:) !! (0:processes) parcels of both
        type(mail_t) :: mail
    end type part_t
end module brz_solid_part
