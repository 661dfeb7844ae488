! SPDX-License-Identifier: MIT
!> Forces on a whole body, for gauges, and the impulse of its load.
module brz_force_driver
    use brz_air_force, only: reaction_force_of, load_of
    use brz_force_loops, only: for_each_sum_forces
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp
    use brz_rigid_motion, only: rigid_forces
    use brz_bodies, only: bodies_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: forces_on_body, record_impulse, n_forces

    integer, parameter :: n_forces = 12 !! sums of brz_force_loop_bodies

contains

    !> Force and moment of body b on what holds it, force of its load and of other bodies; on all
    !> processes the same bits.
    subroutine forces_on_body(solid, b, at, sums, err)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: at(3) !! point of the moment [m]
        real(dp), intent(out) :: sums(n_forces)
        type(error_t), intent(inout) :: err

        associate (body => solid%bodies(b), there => solid%bodies(b))
            sums = rigid_forces(body, at)
            if (body%formulation == form_rigid) return
            call for_each_sum_forces(solid%on_gpu, there%last - there%first + 1, solid%ranks, &
                there%first, solid%wide, solid%stride_d, solid%stride_p, merge(1, 0, &
                allocated(solid%load)), merge(1, 0, allocated(solid%reaction_force)), at(1), &
                at(2), at(3), solid%x, solid%mass, solid%fixed, solid%a, load_of(solid), &
                reaction_force_of(solid), sums, err)
        end associate
    end subroutine forces_on_body

    !> Impulse of the load on all bodies that are active, over a step.
    subroutine record_impulse(solid, dt, err)
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: sums(n_forces)
        integer :: b

        if (.not. solid%impulses) return
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%inactive) cycle
            call forces_on_body(solid, b, [0.0_dp, 0.0_dp, 0.0_dp], sums, err)
            solid%bodies(b)%impulse = solid%bodies(b)%impulse + dt*sums(7:9)
        end do
    end subroutine record_impulse
end module brz_force_driver
