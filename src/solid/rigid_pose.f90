! SPDX-License-Identifier: MIT
!> Where a rigid body is and how it moves, as numbers that loops over its particles take. Point
!> physics: compiled for the CPU and for the GPU.
module brz_rigid_pose
    use brz_kinds, only: dp
    use brz_rigid, only: attitude, cross, rigid_t
    implicit none
    private
    public :: n_pose, pose_of, place_point, velocity_at, arm_at, spin_at

    ! centre unloaded and now [m], velocity, spin, attitude at the step and in its middle; + 1..3 or
    ! + 1..9
    integer, parameter :: pose_centre = 0, pose_x = 3, pose_velocity = 6, pose_spin = 9, &
                          pose_turn = 12, pose_half = 21, n_pose = 30

contains

    !> Pose of a body.
    pure function pose_of(body, v, omega, q_mid) result(pose)
        type(rigid_t), intent(in) :: body
        real(dp), intent(in) :: v(3), omega(3) !! velocity and spin [m/s, 1/s]
        real(dp), intent(in) :: q_mid(4) !! attitude in the middle of the step
        real(dp) :: pose(n_pose)

        pose(pose_centre + 1:pose_centre + 3) = body%centre_ref
        pose(pose_x + 1:pose_x + 3) = body%x
        pose(pose_velocity + 1:pose_velocity + 3) = v
        pose(pose_spin + 1:pose_spin + 3) = omega
        pose(pose_turn + 1:pose_turn + 9) = reshape(attitude(body%q), [9])
        pose(pose_half + 1:pose_half + 9) = reshape(attitude(q_mid), [9])
    end function pose_of

    !> Place at the step, and velocity in its middle, of a point of the body.
    !@cuf attributes(host,device) &
    pure subroutine place_point(pose, x_ref, x, v)
        real(dp), intent(in) :: pose(n_pose)
        real(dp), intent(in) :: x_ref(3) !! unloaded [m]
        real(dp), intent(out) :: x(3), v(3) !! [m, m/s]
        real(dp) :: d(3), arm(3), spin(3)
        integer :: t

        do t = 1, 3
            d(t) = x_ref(t) - pose(pose_centre + t)
            spin(t) = pose(pose_spin + t)
        end do
        do t = 1, 3
            arm(t) = pose(pose_half + t)*d(1) + pose(pose_half + 3 + t)*d(2) &
                     + pose(pose_half + 6 + t)*d(3)
            x(t) = pose(pose_x + t) + (pose(pose_turn + t)*d(1) + pose(pose_turn + 3 + t)*d(2) &
                                       + pose(pose_turn + 6 + t)*d(3))
        end do
        v = cross(spin, arm)
        do t = 1, 3
            v(t) = pose(pose_velocity + t) + v(t)
        end do
    end subroutine place_point

    !> Velocity of a point that moves with the body [m/s].
    !@cuf attributes(host,device) &
    pure function velocity_at(pose, x) result(v)
        real(dp), intent(in) :: pose(n_pose), x(3) !! [m]
        real(dp) :: v(3), arm(3), spin(3)
        integer :: t

        arm = arm_at(pose, x)
        spin = spin_at(pose)
        v = cross(spin, arm)
        do t = 1, 3
            v(t) = pose(pose_velocity + t) + v(t)
        end do
    end function velocity_at

    !> From the centre to a point [m].
    !@cuf attributes(host,device) &
    pure function arm_at(pose, x) result(arm)
        real(dp), intent(in) :: pose(n_pose), x(3) !! [m]
        real(dp) :: arm(3)
        integer :: t

        do t = 1, 3
            arm(t) = x(t) - pose(pose_x + t)
        end do
    end function arm_at

    !@cuf attributes(host,device) &
    pure function spin_at(pose) result(spin)
        real(dp), intent(in) :: pose(n_pose)
        real(dp) :: spin(3) !! [1/s]
        integer :: t

        do t = 1, 3
            spin(t) = pose(pose_spin + t)
        end do
    end function spin_at
end module brz_rigid_pose
