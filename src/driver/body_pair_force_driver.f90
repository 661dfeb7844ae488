! SPDX-License-Identifier: MIT
!> Forces of contact between two bodies that gauges name, and the impulses of these forces.
!>
!> Velocities change by the mean of two steps times the force at a step: the impulse up to a step
!> is the sum over trapezoids, and exactly what the momentum at the step shows.
module brz_body_pair_force_driver
    use brz_body_pair_force_loop_bodies, only: add_impulse
    use brz_body_pair_force_loops, only: for_each_sum_body_pair_force
    use brz_kinds, only: dp
    use brz_link_rows, only: joined_of
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: begin_body_pair_force, record_body_pair_force, force_of_body_pair

contains

    !> The forces at the start.
    subroutine begin_body_pair_force(solid, err)
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: k

        if (.not. allocated(solid%between)) return
        do k = 1, size(solid%between)
            call force_of_body_pair(solid, solid%between(k)%body, solid%between(k)%force, err)
        end do
    end subroutine begin_body_pair_force

    !> The forces after a step, and what they gave in it.
    subroutine record_body_pair_force(solid, dt, err)
        class(interacting_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: force(3)
        integer :: k

        if (.not. allocated(solid%between)) return
        do k = 1, size(solid%between)
            call force_of_body_pair(solid, solid%between(k)%body, force, err)
            call add_impulse(solid%between(k), force, dt)
        end do
    end subroutine record_body_pair_force

    !> Force on the first of two bodies by the second, on all processes the same bits [N].
    subroutine force_of_body_pair(solid, body, force, err)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: body(2)
        real(dp), intent(out) :: force(3)
        type(error_t), intent(inout) :: err

        force = 0
        if (.not. solid%links%present) return
        associate (links => solid%links, there => solid%bodies(body(1)))
            call for_each_sum_body_pair_force(solid%on_gpu, there%last - there%first + 1, &
                solid%ranks, there%first, body(2), links%lay, links%ends, links%table, &
                links%cell, solid%x, solid%v, solid%mass, links%weight, solid%stress, solid%pair, &
                links%press(:, 1:), links%bond, joined_of(solid%links), links%row, &
                links%slice(1:), links%count(1:), links%list, force, err)
        end associate
    end subroutine force_of_body_pair
end module brz_body_pair_force_driver
