! SPDX-License-Identifier: MIT
!> Points of cohesive interfaces on several processes: what all must be told.
!>
!> Every process has all points, and the state of those that it computes. Before particles change
!> processes, and where results need all of it, the state of each comes from the process that has
!> the first particle of the point.
module brz_cohesive_part
    use brz_kinds, only: dp, int32, int64
    use brz_ranks, only: bits_of_all, most_of_all, several
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: share_points, tell_owners

contains

    !> The state of all points, in all processes; all must call.
    subroutine share_points(solid)
        class(interacting_bodies_t), intent(inout) :: solid
        integer :: p
        real(dp), allocatable :: state(:)

        if (.not. (solid%cohesive%present .and. several(solid%ranks))) return
        associate (cohesive => solid%cohesive)
            if (all(cohesive%owner == 0)) return ! all have all of it yet
            do p = 1, cohesive%n
                if (cohesive%owner(cohesive%node(cohesive%first(p))) == solid%ranks%rank + 1) cycle
                cohesive%damage(p) = 0
                cohesive%spent(p) = 0
                cohesive%held(p) = 0
            end do
            state = [cohesive%damage, cohesive%spent, cohesive%held]
            call bits_of_all(solid%ranks, state)
            cohesive%damage = state(:cohesive%n)
            cohesive%spent = state(cohesive%n + 1:2*cohesive%n)
            cohesive%held = state(2*cohesive%n + 1:)
        end associate
    end subroutine share_points

    !> Which process has the particle of each node: each knows its own, and 0 of all others.
    subroutine tell_owners(solid)
        class(interacting_bodies_t), intent(inout) :: solid
        integer(int64), allocatable :: own(:)

        allocate (own(size(solid%cohesive%owner)), source=int(solid%cohesive%owner, int64))
        call most_of_all(solid%ranks, own)
        solid%cohesive%owner = int(own, int32)
    end subroutine tell_owners
end module brz_cohesive_part
