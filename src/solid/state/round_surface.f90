! SPDX-License-Identifier: MIT
!> The surface of a body that is known to be round.
module brz_round_surface
    use brz_kinds, only: dp
    implicit none
    private
    public :: round_t

    !> Surface of a round body in its first place; radius 0: it is not round.
    type :: round_t
        real(dp) :: centre(3) = 0, radius(2) = 0 !! outer and inner, 0: none [m]
        integer :: axis = 0 !! of a cylinder, 0: a sphere
    end type round_t
end module brz_round_surface
