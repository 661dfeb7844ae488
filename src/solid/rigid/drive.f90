! SPDX-License-Identifier: MIT
!> Work of the prescribed motion of a body.
module brz_drive
    use brz_body, only: body_t
    use brz_energy_account, only: energy_account_t
    use brz_formulation_names, only: form_rigid
    use brz_kinds, only: dp
    use brz_motion, only: mean_velocity, motion_t, velocity_of
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: record_drive, begin_motion, end_motion, add_held_impulse

contains

    !> Work of what drives a body: its kinetic energy, less what the air and the body itself do. The
    !> second half of the latter is recorded with the force, the work of the air on a rigid body
    !> with its step.
    subroutine record_drive(body, time, dt, v)
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: time, dt !! start and length of the step [s]
        real(dp), intent(out) :: v(3) !! mean velocity in it [m/s]
        real(dp) :: work

        call begin_motion(body%motion, time, dt, v, body%account)
        if (body%formulation == form_rigid) return
        work = dt*dot_product(body%rigid%load(1:3), v)
        body%account%load = body%account%load + work
        body%account%drive = body%account%drive - work
    end subroutine record_drive

    !> Work of what moves a body, or a region of it, in a step to come: its kinetic energy, less
    !> half of the step by the force of the body on it at the start.
    pure subroutine begin_motion(motion, time, dt, v, account)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: time, dt !! start and length of the step [s]
        real(dp), intent(out) :: v(3) !! mean velocity in it [m/s]
        type(energy_account_t), intent(inout) :: account
        real(dp) :: before(3), after(3)

        v = mean_velocity(motion, time, dt)
        before = merge(velocity_of(motion, time), 0.0_dp, motion%along)
        after = merge(velocity_of(motion, time + dt), 0.0_dp, motion%along)
        account%drive = account%drive - dt/2*dot_product(motion%force, v) &
            + motion%mass/2*(dot_product(after, after) - dot_product(before, before))
    end subroutine begin_motion

    !> The other half, and the work of the load, which acted all through the step.
    pure subroutine end_motion(motion, time, dt, sums, account, work)
        type(motion_t), intent(inout) :: motion
        real(dp), intent(in) :: time, dt !! end and length of the step [s]
        real(dp), intent(in) :: sums(6) !! of brz_force_loop_bodies: sum_region
        type(energy_account_t), intent(inout) :: account
        real(dp), intent(out) :: work !! of the load [J]
        real(dp) :: v(3)

        v = mean_velocity(motion, time - dt, dt)
        motion%force = sums(1:3) - sums(4:6)
        motion%reaction_force = sums(1:3)
        work = dt*dot_product(sums(4:6), v)
        account%load = account%load + work
        account%drive = account%drive - dt/2*dot_product(motion%force, v) - work
    end subroutine end_motion

    !> Add the mean force of body b on what holds it, as pass 2 has summed it up block by block.
    pure subroutine add_held_impulse(solid, b, dt, force)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(inout) :: force(3) !! [N]
        integer :: k

        do k = 1, size(solid%block, 2)
            if (solid%block(1, k) == b) force = force + solid%search%sums(3:5, k)/dt
        end do
    end subroutine add_held_impulse
end module brz_drive
