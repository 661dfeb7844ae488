! SPDX-License-Identifier: MIT
!> Particles of rigid bodies: what brz_rigid_steps leaves to each backend.
module brz_solid_rigid
    use brz_kinds, only: dp, int32, rk
    use brz_motion_items, only: heat_of_drag
    use brz_motion_loops, only: each_sum_pairs
    use brz_rigid_pose, only: resting_pose
    use brz_solid_state, only: form_rigid, solid_t
    implicit none
    private
    public :: sum_pushes, settle_drag

    real(dp), target :: no_glue(3, 0:1) = 0
    ! numbers of a row of links%push, what stands there before the forces and the torques of drag
    integer, parameter :: numbers = 9, drag = 3, hold = 6

contains

    !> Force and torque of contact and of interfaces on rigid bodies: exact sums, as they act back.
    subroutine sum_pushes(solid, dt, push)
        type(solid_t), intent(in), target :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(out) :: push(6, size(solid%bodies)) !! [N], [N m]
        integer(int32), pointer, contiguous :: node(:)
        real(dp), pointer, contiguous :: glue(:, :)
        integer :: b

        push = 0
        node => solid%id ! not read where there are no interfaces
        glue => no_glue
        if (solid%cohesive%present) node => solid%cohesive%row
        if (solid%cohesive%present) glue => solid%cohesive%push
        do b = 1, merge(size(solid%bodies), 0, solid%links%present)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid .or. body%asleep .and. dt > 0) cycle
                call each_sum_pairs(body%last - body%first + 1, solid%ranks, body%first, &
                    solid%wide, 1, 1, numbers, drag, hold, merge(1, 0, solid%cohesive%present), &
                    resting_pose(body%rigid), solid%links%row, solid%id, node, glue, solid%x, &
                    solid%links%push(:, 1:), push(:, b))
            end associate
        end do
    end subroutine sum_pushes

    !> The heat of drag on their particles, see heat_of_drag.
    subroutine settle_drag(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp) :: heat
        integer :: b, i

        do b = 1, merge(size(solid%bodies), 0, solid%links%present .and. dt > 0)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid .or. body%asleep) cycle
                do i = body%first, body%last
                    associate (push => solid%links%push(:, solid%links%row(i)))
                        heat = heat_of_drag(dt, push(drag + 1), push(hold + 1), solid%a(1, i), &
                                            body%rigid%omega - body%rigid%spin)
                    end associate
                    solid%energy(i) = solid%energy(i) + real(heat/solid%mass(i), rk)
                    body%ledger%contact_heat = body%ledger%contact_heat + heat
                end do
            end associate
        end do
    end subroutine settle_drag
end module brz_solid_rigid
