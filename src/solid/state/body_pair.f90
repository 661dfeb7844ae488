! SPDX-License-Identifier: MIT
!> Two bodies whose force on each other is asked for.
module brz_body_pair
    use brz_kinds, only: dp
    implicit none
    private
    public :: body_pair_force_t

    !> What a gauge asks of two bodies.
    type :: body_pair_force_t
        integer :: body(2) = 0
        real(dp) :: force(3) = 0 !! on the first by the second, at the step [N]
        real(dp) :: impulse(3) = 0 !! the same from the start to the step [N s]
    end type body_pair_force_t
end module brz_body_pair
