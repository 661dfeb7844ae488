! SPDX-License-Identifier: MIT
!> What moves a particle, in `fixed`: its forces, something that holds it, or nothing any more.
module brz_particle_marks
    use brz_kinds, only: int32
    implicit none
    private
    public :: is_free, is_fixed, is_gone, is_leaving

    integer(int32), parameter :: is_free = 0, is_fixed = 1
    integer(int32), parameter :: is_gone = 2 !! has left the region and is out of the computation
    integer(int32), parameter :: is_leaving = -1 !! is about to be
end module brz_particle_marks
