! SPDX-License-Identifier: MIT
!> Particles of rigid bodies, and those that a motion drives, one at a time.
module brz_rigid_loop_bodies
    use brz_kinds, only: dp, int32, int64, rk
    use brz_push_layout, only: push_layout_t
    use brz_rigid, only: cross
    use brz_rigid_pose, only: arm_at, place_point, pose_t, velocity_at
    use brz_support, only: is_driven, is_kept
    implicit none
    private
    public :: drive_particle, follow_drive, follow_rigid, place_rigid, settle_heat, sum_pairs

contains

    !> Carry a held particle, or one of a region that is moved, along.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine drive_particle(p, first, wide, region, dt, vx, vy, vz, fixed, x, v)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: region !! its motion; 0: that of what is held
        real(dp), intent(in) :: dt, vx, vy, vz !! step [s], mean velocity in it [m/s]
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(inout) :: x(wide, *)
        real(rk), intent(inout) :: v(wide, *)
        real(dp) :: drive(3)
        integer :: d, i

        i = first - 1 + p
        if (.not. is_driven(fixed(i), region)) return
        drive(1) = vx
        drive(2) = vy
        drive(3) = vz
        do d = 1, 3
            if (.not. is_kept(fixed(i), d)) cycle
            v(d, i) = real(drive(d), rk)
            x(d, i) = x(d, i) + dt*drive(d)
        end do
    end subroutine drive_particle

    !> Acceleration of such a particle that brings it to the velocity of the step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine follow_drive(p, first, wide, region, stride_d, stride_p, dt, vx, vy, vz, &
                                 fixed, v, accel)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: region !! its motion; 0: that of what is held
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in accel
        real(dp), intent(in) :: dt, vx, vy, vz !! step [s], velocity at its end [m/s]
        integer(int32), intent(in) :: fixed(*)
        real(rk), intent(in) :: v(wide, *)
        real(rk), intent(inout) :: accel(*)
        real(dp) :: drive(3)
        integer :: d, i

        i = first - 1 + p
        if (.not. is_driven(fixed(i), region)) return
        drive(1) = vx
        drive(2) = vy
        drive(3) = vz
        do d = 1, 3
            if (.not. is_kept(fixed(i), d)) cycle
            accel(1 + (i - 1)*stride_p + (d - 1)*stride_d) = real(2/dt*(drive(d) - v(d, i)), rk)
        end do
    end subroutine follow_drive

    !> Position of a particle of a rigid body at the step, and its velocity in the middle.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine place_rigid(p, first, wide, pose, x_ref, x, v)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        type(pose_t), intent(in) :: pose
        real(dp), intent(in) :: x_ref(wide, *)
        real(dp), intent(inout) :: x(wide, *)
        real(rk), intent(inout) :: v(wide, *)
        real(dp) :: place(3), speed(3)
        integer :: d, i

        i = first - 1 + p
        call place_point(pose, x_ref(1, i), place, speed)
        do d = 1, 3
            x(d, i) = place(d)
            v(d, i) = real(speed(d), rk)
        end do
    end subroutine place_rigid

    !> Acceleration of a particle of a rigid body that brings it to the velocity of the step.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine follow_rigid(p, first, wide, stride_d, stride_p, dt, pose, x, v, accel)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in accel
        real(dp), intent(in) :: dt !! [s]
        type(pose_t), intent(in) :: pose
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *)
        real(rk), intent(inout) :: accel(*)
        real(dp) :: speed(3)
        integer :: d, i

        i = first - 1 + p
        speed = velocity_at(pose, x(1, i))
        do d = 1, 3
            accel(1 + (i - 1)*stride_p + (d - 1)*stride_d) = real(2/dt*(speed(d) - v(d, i)), rk)
        end do
    end subroutine follow_rigid

    !> Add what other bodies do to a particle to the force and the torque on its rigid body.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_pairs(p, first, wide, lay, pose, row, id, node, cohesive, x, pairs, push)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x
        type(push_layout_t), intent(in) :: lay
        type(pose_t), intent(in) :: pose !! of the body
        integer(int32), intent(in) :: row(*), id(*), node(*)
        real(dp), intent(in) :: cohesive(3, 0:*) !! forces on the nodes of interfaces [N]
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: pairs(*) !! forces [N], and torques of drag [N m]
        real(dp), intent(inout) :: push(6) !@exact force [N], torque [N m]
        real(dp) :: arm(3), f(3), torque(3)
        integer(int64) :: at
        integer :: c, i

        i = first - 1 + p
        at = i
        if (lay%compact == 1) at = row(i)
        if (at == 0 .and. lay%glued == 0) return
        at = 1 + (at - 1)*lay%stride_p
        do c = 1, 3
            f(c) = 0
            if (at > 0) f(c) = pairs(at + (c - 1)*lay%step_c) &
                + pairs(at + (lay%drag + c - 1)*lay%step_c)
            if (lay%glued == 1) f(c) = f(c) + cohesive(c, node(id(i)))
        end do
        arm = arm_at(pose, x(1, i))
        torque = cross(arm, f)
        do c = 1, 3
            push(c) = push(c) + f(c)
            push(3 + c) = push(3 + c) + torque(c)
            if (at > 0) push(3 + c) = push(3 + c) + pairs(at + (lay%torque + c - 1)*lay%step_c)
        end do
    end subroutine sum_pairs

    !> Give a particle of a rigid body the heat of drag. The pairs made it with the velocity before
    !> the kick, but drag works with the mean of those before and after it: the rest is made good.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine settle_heat(p, first, lay, stride_d, stride_p, dt, wx, wy, wz, row, mass, &
                                pairs, accel, energy, diag)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(push_layout_t), intent(in) :: lay
        integer, intent(in) :: stride_d, stride_p !! distances in `accel`
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(in) :: wx, wy, wz !! change of the spin in the kick [1/s]
        integer(int32), intent(in) :: row(*)
        real(rk), intent(in) :: mass(*), pairs(*), accel(*)
        real(rk), intent(inout) :: energy(*)
        real(dp), intent(inout) :: diag(*) !! [J]
        real(dp) :: drag, heat, turning, turn(3)
        integer(int64) :: at
        integer :: c, i

        i = first - 1 + p
        at = i
        if (lay%compact == 1) at = row(i)
        if (at == 0) return
        at = 1 + (at - 1)*lay%stride_p
        turn(1) = wx
        turn(2) = wy
        turn(3) = wz
        drag = 0
        turning = 0
        do c = 1, 3
            drag = drag + pairs(at + (lay%drag + c - 1)*lay%step_c) &
                   *accel(1 + (i - 1)*stride_p + (c - 1)*stride_d)
            turning = turning + pairs(at + (lay%torque + c - 1)*lay%step_c)*turn(c)
        end do
        heat = -dt*(dt/2*drag + turning)
        if (lay%heat > 0) heat = heat + dt*pairs(at + (lay%heat - 1)*lay%step_c)
        energy(i) = energy(i) + real(heat/mass(i), rk)
        diag(i) = diag(i) + heat
    end subroutine settle_heat
end module brz_rigid_loop_bodies
