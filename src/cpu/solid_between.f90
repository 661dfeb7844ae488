! SPDX-License-Identifier: MIT
!> Forces of contact between two bodies that gauges name, and the impulses of these forces.
!>
!> Velocities change by the mean of two steps times the force at a step: the impulse up to a step
!> is the sum over trapezoids, and exactly what the momentum at the step shows.
module brz_solid_between
    use brz_between_items, only: add_impulse
    use brz_between_loops, only: each_sum_between
    use brz_kinds, only: dp, int32
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: begin_between, book_between, force_between

contains

    !> The forces at the start.
    subroutine begin_between(solid)
        type(solid_t), intent(inout) :: solid
        integer :: k

        if (.not. allocated(solid%between)) return
        do k = 1, size(solid%between)
            call force_between(solid, solid%between(k)%body, solid%between(k)%force)
        end do
    end subroutine begin_between

    !> The forces after a step, and what they gave in it.
    subroutine book_between(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: force(3)
        integer :: k

        if (.not. allocated(solid%between)) return
        do k = 1, size(solid%between)
            call force_between(solid, solid%between(k)%body, force)
            call add_impulse(solid%between(k), force, dt)
        end do
    end subroutine book_between

    !> Force on the first of two bodies by the second, on all processes the same bits [N].
    subroutine force_between(solid, body, force)
        type(solid_t), intent(in), target :: solid
        integer, intent(in) :: body(2)
        real(dp), intent(out) :: force(3)
        integer(int32), pointer :: joined(:)

        force = 0
        if (.not. solid%links%present) return
        joined => solid%links%bond ! not read without an interface
        if (allocated(solid%links%joined)) joined => solid%links%joined
        associate (s => solid, l => solid%links, own => solid%bodies(body(1)))
            call each_sum_between(own%last - own%first + 1, s%ranks, own%first, body(2), l%lay, &
                                  l%ends, l%table, l%cell, s%x, s%v, s%mass, l%weight, s%stress, &
                                  s%pair, l%press(:, 1:), l%bond, joined, l%row, l%slice(1:), &
                                  l%count(1:), l%list, force)
        end associate
    end subroutine force_between
end module brz_solid_between
