! SPDX-License-Identifier: MIT
!> Groups of particles that are consecutive and share one list of neighbours.
module brz_particle_groups
    implicit none
    private
    public :: lanes

    integer, parameter :: lanes = 8 !! particles of a group, in vector code one in each lane
end module brz_particle_groups
