! SPDX-License-Identifier: MIT
!> Two bodies whose force on each other is asked for.
module brz_body_pair
    use brz_kinds, only: dp
    implicit none
    private
    public :: between_t

    !> What a gauge asks of two bodies.
    type :: between_t
        integer :: body(2) = 0
        real(dp) :: force(3) = 0 !! on the first by the second, at the step [N]
        real(dp) :: impulse(3) = 0 !! the same from the start to the step [N s]
    end type between_t
end module brz_body_pair
