! SPDX-License-Identifier: MIT
!> Loaded faces on several processes: what all must be told.
module brz_load_part
    use brz_kinds, only: int32, int64
    use brz_ranks, only: most_of_all
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: tell_carriers

contains

    !> Which process has each particle that carries loaded segments: each knows its own, and 0 of
    !> all others.
    subroutine tell_carriers(solid)
        class(bodies_t), intent(inout) :: solid
        integer(int64), allocatable :: own(:)

        allocate (own(size(solid%loads%segments%owner)), &
            source=int(solid%loads%segments%owner, int64))
        call most_of_all(solid%ranks, own)
        solid%loads%segments%owner = int(own, int32)
    end subroutine tell_carriers
end module brz_load_part
