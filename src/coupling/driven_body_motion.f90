! SPDX-License-Identifier: MIT
!> How bodies that carry particles move: at the step, and in the middle of the coming step of the
!> air.
module brz_driven_body_motion
    use brz_algebra, only: inverse3
    use brz_driven_body_rules, only: driven_body_t, carries_all, carries_held, carries_none, &
                                 n_push, push_force, push_torque, push_turn, push_yield
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp, rk
    use brz_load_rules, only: lightness, pushed_velocity
    use brz_motion, only: mean_velocity, velocity_of
    use brz_rigid, only: attitude, spin_of, turn
    use brz_rigid_body, only: rigid_t
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: read_driven_bodies, foresee_driven_bodies

contains

    !> Motion of the bodies at the step: with the load up to it, and with what else acts on them
    !> half a step of theirs before, for that is the velocity that the load works on.
    subroutine read_driven_bodies(solid, driven)
        class(bodies_t), intent(in) :: solid
        type(driven_body_t), allocatable, intent(inout) :: driven(:) !! one for each body
        integer :: b

        if (.not. allocated(driven)) call number_driven_bodies(solid, driven)
        do b = 1, size(driven)
            if (allocated(solid%bodies)) then ! on several processes they change
                driven(b)%first = solid%bodies(b)%first
                driven(b)%last = solid%bodies(b)%last
            end if
            if (driven(b)%carries == carries_none) cycle
            if (driven(b)%carries == carries_all) then
                associate (r => solid%bodies(b)%rigid)
                    driven(b)%centre = r%x
                    driven(b)%v = r%p/r%mass
                    driven(b)%spin = spin_of(r%compliance, r%q, r%l)
                end associate
            end if
            if (solid%bodies(b)%motion%n > 0) &
                driven(b)%v = velocity_of(solid%bodies(b)%motion, solid%time)
        end do
    end subroutine read_driven_bodies

    !> Which bodies carry particles, and which.
    subroutine number_driven_bodies(solid, driven)
        class(bodies_t), intent(in) :: solid
        type(driven_body_t), allocatable, intent(out) :: driven(:)
        integer :: b

        if (.not. allocated(solid%bodies)) then
            allocate (driven(1))
            driven(1)%last = solid%n
            return
        end if
        allocate (driven(size(solid%bodies)))
        do b = 1, size(driven)
            associate (body => solid%bodies(b))
                driven(b)%first = body%first
                driven(b)%last = body%last
                if (body%motion%n > 0) driven(b)%carries = carries_held
                if (body%formulation == form_rigid) driven(b)%carries = carries_all
            end associate
        end do
    end subroutine number_driven_bodies

    !> Motion of the bodies in the middle of the coming step of the air, from that at its start.
    pure subroutine foresee_driven_bodies(solid, push, dt, driven)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(in) :: push(:, :) !! (n_push, bodies) of the gas, see add_push
        real(dp), intent(in) :: dt !! [s]
        type(driven_body_t), intent(inout) :: driven(:)
        type(rigid_t) :: there
        real(dp) :: q_mid(4)
        integer :: b

        do b = 1, size(driven)
            if (driven(b)%carries == carries_held) then
                driven(b)%v = mean_velocity(solid%bodies(b)%motion, solid%time, dt)
            else if (driven(b)%carries == carries_all) then
                associate (body => solid%bodies(b))
                    there = body%rigid
                    if (body%motion%n > 0) then
                        driven(b)%v = mean_velocity(body%motion, solid%time, dt)
                    else
                        call push_body(push(:, b), dt, there, driven(b)%v)
                    end if
                    call turn(there, dt, driven(b)%spin, q_mid)
                end associate
            end if
        end do
    end subroutine foresee_driven_bodies

    !> Velocity and angular momentum of a free rigid body in the middle of the step.
    !>
    !> As for a wall (pushed_velocity), but with mass, inertia and load of the whole body.
    pure subroutine push_body(push, dt, body, v)
        real(dp), intent(in) :: push(n_push) !! of the gas
        real(dp), intent(in) :: dt !! [s]
        type(rigid_t), intent(inout) :: body !! its angular momentum is brought there
        real(dp), intent(inout) :: v(3) !! at the step; on return half of dt later [m/s]
        integer :: d

        do d = 1, 3
            if (.not. body%moves(d) > 0) cycle
            v(d) = pushed_velocity(real(v(d), rk), real(body%load(d) + body%force(d), rk), &
                                   real(push(push_force + d) - body%load(d), rk), &
                                   real(push(push_yield + d), rk), real(body%mass, rk), &
                                   real(dt, rk))
        end do
        body%l = body%l + twist(body, push, dt)*body%turns
    end subroutine push_body

    !> Gain of angular momentum over half of dt: pushed_velocity for all axes at once [N m s].
    pure function twist(b, push, dt) result(gain)
        type(rigid_t), intent(in) :: b
        real(dp), intent(in) :: push(n_push) !! of the gas
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: gain(3), r(3, 3), yield(3, 3), light, torque(3)
        real(rk) :: rest(3, 3)
        integer :: i
        logical :: ok

        r = attitude(b%q)
        yield = dt/2*matmul(reshape(push(push_turn + 1:push_turn + 9), [3, 3]), &
                            matmul(r, matmul(b%compliance, transpose(r))))
        ! the trace is at least the largest yield of any axis
        light = lightness(real(yield(1, 1) + yield(2, 2) + yield(3, 3), rk))
        yield = light*yield
        do i = 1, 3
            yield(i, i) = 1 + yield(i, i)
        end do
        call inverse3(real(yield, rk), rest, ok)
        torque = b%load(4:6) + light*(push(push_torque + 1:push_torque + 3) - b%load(4:6))
        gain = dt/2*matmul(rest, torque + b%torque)
    end function twist
end module brz_driven_body_motion
