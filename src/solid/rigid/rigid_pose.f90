! SPDX-License-Identifier: MIT
!> Where a rigid body is and how it moves, as numbers that loops over its particles take. Point
!> physics: compiled for the CPU and for the GPU.
module brz_rigid_pose
    use brz_kinds, only: dp
    use brz_rigid, only: attitude, cross
    use brz_rigid_body, only: rigid_t
    implicit none
    private
    public :: pose_t, pose_of, resting_pose, place_point, velocity_at, arm_at, spin_at

    type :: pose_t
        real(dp) :: centre(3), x(3) !! unloaded and now [m]
        real(dp) :: velocity(3), spin(3) !! [m/s], [1/s]
        real(dp) :: turn(9), half(9) !! attitude at the step and in its middle
    end type pose_t

contains

    !> Pose of a body.
    pure function pose_of(body, v, omega, q_mid) result(pose)
        type(rigid_t), intent(in) :: body
        real(dp), intent(in) :: v(3), omega(3) !! velocity and spin [m/s, 1/s]
        real(dp), intent(in) :: q_mid(4) !! attitude in the middle of the step
        type(pose_t) :: pose

        pose%centre = body%centre_ref
        pose%x = body%x
        pose%velocity = v
        pose%spin = omega
        pose%turn = reshape(attitude(body%q), [9])
        pose%half = reshape(attitude(q_mid), [9])
    end function pose_of

    !> Pose of a body at the step, with its spin half a step before.
    pure function resting_pose(body) result(pose)
        type(rigid_t), intent(in) :: body
        type(pose_t) :: pose

        pose = pose_of(body, spread(0.0_dp, 1, 3), body%spin, body%q)
    end function resting_pose

    !> Place at the step, and velocity in its middle, of a point of the body.
    !@cuf attributes(host,device) &
    pure subroutine place_point(pose, x_ref, x, v)
        type(pose_t), intent(in) :: pose
        real(dp), intent(in) :: x_ref(3) !! unloaded [m]
        real(dp), intent(out) :: x(3), v(3) !! [m, m/s]
        real(dp) :: d(3), arm(3), spin(3)
        integer :: t

        do t = 1, 3
            d(t) = x_ref(t) - pose%centre(t)
            spin(t) = pose%spin(t)
        end do
        do t = 1, 3
            arm(t) = pose%half(t)*d(1) + pose%half(3 + t)*d(2) &
                     + pose%half(6 + t)*d(3)
            x(t) = pose%x(t) + (pose%turn(t)*d(1) + pose%turn(3 + t)*d(2) &
                                       + pose%turn(6 + t)*d(3))
        end do
        v = cross(spin, arm)
        do t = 1, 3
            v(t) = pose%velocity(t) + v(t)
        end do
    end subroutine place_point

    !> Velocity of a point that moves with the body [m/s].
    !@cuf attributes(host,device) &
    pure function velocity_at(pose, x) result(v)
        type(pose_t), intent(in) :: pose
        real(dp), intent(in) :: x(3) !! [m]
        real(dp) :: v(3), arm(3), spin(3)
        integer :: t

        arm = arm_at(pose, x)
        spin = spin_at(pose)
        v = cross(spin, arm)
        do t = 1, 3
            v(t) = pose%velocity(t) + v(t)
        end do
    end function velocity_at

    !> From the centre to a point [m].
    !@cuf attributes(host,device) &
    pure function arm_at(pose, x) result(arm)
        type(pose_t), intent(in) :: pose
        real(dp), intent(in) :: x(3) !! [m]
        real(dp) :: arm(3)
        integer :: t

        do t = 1, 3
            arm(t) = x(t) - pose%x(t)
        end do
    end function arm_at

    !@cuf attributes(host,device) &
    pure function spin_at(pose) result(spin)
        type(pose_t), intent(in) :: pose
        real(dp) :: spin(3) !! [1/s]
        integer :: t

        do t = 1, 3
            spin(t) = pose%spin(t)
        end do
    end function spin_at
end module brz_rigid_pose
