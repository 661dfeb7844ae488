! SPDX-License-Identifier: MIT
!> Bodies and how they act on one another beyond contact: cohesive interfaces, and the forces of
!> pairs of bodies that somebody asks for.
module brz_interacting_bodies
    use brz_body_pair, only: body_pair_force_t
    use brz_cohesive_state, only: cohesive_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: interacting_bodies_t

    type, extends(listed_bodies_t) :: interacting_bodies_t
        type(cohesive_t) :: cohesive !! interfaces with a law of their own
        type(body_pair_force_t), allocatable :: between(:) !! pairs of bodies that gauges ask for
    end type interacting_bodies_t
end module brz_interacting_bodies
