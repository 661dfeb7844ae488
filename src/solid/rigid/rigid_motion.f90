! SPDX-License-Identifier: MIT
!> The two halves of the time step of one rigid body: kick and drift, and the balance at the step.
module brz_rigid_motion
    use brz_body, only: body_t
    use brz_kinds, only: dp
    use brz_motion, only: velocity_of
    use brz_solid_diagnostics, only: record_rigid_load
    use brz_rigid, only: cross, spin_of, turn
    implicit none
    private
    public :: advance_rigid, settle_rigid, rigid_forces, rigid_step

    real(dp), parameter :: least_move = 0.1_dp !! spacings that a step may go without a skin

contains

    !> Momentum by contact and load, then position and attitude.
    subroutine advance_rigid(body, mean, dt, v, omega, q_mid)
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: mean !! of the last and this time step [s]
        real(dp), intent(in) :: dt !! [s]
        real(dp), intent(out) :: v(3), omega(3) !! velocity and spin in the middle of the step
        real(dp), intent(out) :: q_mid(4) !! attitude there
        real(dp) :: before(3)

        associate (b => body%rigid, force => body%rigid%load(1:3), torque => body%rigid%load(4:6))
            before = b%p/b%mass
            if (body%motion%n == 0) then
                b%p = (b%p + mean*b%force + dt*force)*b%moves
                b%l = (b%l + mean*b%torque + dt*torque)*b%turns
            end if
            call turn(b, dt, omega, q_mid)
            v = b%p/b%mass
            call record_rigid_load(body, dt, v + before, omega + b%spin)
            body%reaction = body%reaction + dt*force*(1 - b%moves)
            b%spin = omega
            b%x = b%x + dt*v
        end associate
    end subroutine advance_rigid

    !> Velocity and spin at the step, from force and torque there.
    subroutine settle_rigid(body, time, dt, v)
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: time, dt !! at the step; of the step just made [s]
        real(dp), intent(out) :: v(3) !! [m/s]

        associate (b => body%rigid)
            v = (b%p + dt/2*b%force*b%moves)/b%mass
            if (body%motion%n > 0) v = velocity_of(body%motion, time)
            b%omega = spin_of(b%compliance, b%q, b%l + dt/2*b%torque*b%turns)
            if (body%motion%n > 0) b%omega = spin_of(b%compliance, b%q, b%l)
            body%reaction = body%reaction + dt*b%force*(1 - b%moves)
        end associate
    end subroutine settle_rigid

    !> Forces on a rigid body, as sum_forces has them: force and moment about a point of the body on
    !> what holds or drives it, force of the load, force of other bodies.
    pure function rigid_forces(body, at) result(sums)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: at(3) !! [m]
        real(dp) :: sums(12) !! [N], [N m], [N], [N]
        real(dp) :: moves(3), turns(3)

        associate (b => body%rigid)
            moves = b%moves
            turns = b%turns
            if (body%motion%n > 0) moves = 0
            if (body%motion%n > 0) turns = 0
            sums(1:3) = (b%force + b%load(1:3))*(1 - moves)
            sums(4:6) = (b%torque + b%load(4:6))*(1 - turns) + cross(b%x - at, sums(1:3))
            sums(7:9) = b%load(1:3)
            sums(10:12) = b%force
        end associate
    end function rigid_forces

    !> Time step that a rigid body bears [s]: no waves run through it, so its parts may move by half
    !> the skin of the lists, for the diagnostics of contact look back by a step.
    pure real(dp) function rigid_step(body, skin) result(dt)
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: skin !! of the lists [m]
        real(dp) :: speed
        integer :: k

        associate (b => body%rigid)
            speed = norm2(b%p)/b%mass
            do k = 1, body%motion%n
                speed = max(speed, norm2(body%motion%v(:, k)))
            end do
            speed = speed + norm2(b%omega)*b%reach
            dt = min(minval(b%steps), max(skin/2, least_move*body%spacing)/max(speed, tiny(speed)))
        end associate
    end function rigid_step
end module brz_rigid_motion
