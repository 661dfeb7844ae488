! SPDX-License-Identifier: MIT
!> Bodies that do not deform, and particles that are driven: their part of the time step.
!>
!> The particles of a rigid body carry its mass to contact, air and output. Their velocity is kept
!> at half steps like that of all others, and `a` is what brings it to the step.
module brz_solid_rigid
    use brz_drive, only: begin_motion, book_drive, end_motion
    use brz_force_loops, only: each_sum_region
    use brz_exact_sum, only: add_terms, close_sums, limbs, open_sums, scale_t, widen
    use brz_kinds, only: dp, int64, rk
    use brz_motion, only: mean_velocity, velocity_of
    use brz_motion_loops, only: each_drive_particle, each_follow_drive, each_follow_rigid, &
        each_place_rigid
    use brz_rigid, only: cross
    use brz_rigid_motion, only: advance_rigid, rigid_step, settle_rigid
    use brz_rigid_pose, only: pose_of
    use brz_solid_bonds, only: push_rigid_bonds
    use brz_solid_cohesive, only: cohesive_push
    use brz_solid_state, only: body_t, form_rigid, ledger_t, solid_t
    implicit none
    private
    public :: move_rigid, balance_rigid

contains

    !> Kick and drift of rigid and driven bodies over dt, from solid%time on.
    subroutine move_rigid(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(ledger_t) :: ledger
        real(dp) :: v(3), load(6), reaction(3)
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%asleep) cycle
                ledger = body%ledger
                reaction = body%reaction
                if (body%motion%n > 0) then
                    load = body%rigid%load
                    if (solid%ranks%rank > 0) body%rigid%load = 0 ! the first books it
                    call book_drive(body, solid%time, dt, v)
                    body%rigid%load = load
                    if (body%formulation /= form_rigid) &
                        call each_drive_particle(body%last - body%first + 1, body%first, 3, 0, dt, &
                                                 v(1), v(2), v(3), solid%fixed, solid%x, solid%v)
                    body%rigid%p = body%rigid%mass*v
                end if
                if (allocated(body%regions)) call move_regions(solid, body, dt)
                if (body%formulation == form_rigid) call move_body(solid, body, dt)
                if (body%formulation == form_rigid .and. solid%ranks%rank > 0) then
                    body%ledger = ledger ! all processes move the body, the first books it
                    body%reaction = reaction
                end if
            end associate
        end do
    end subroutine move_rigid

    !> One rigid body: momentum by contact and load, then position, attitude and particles.
    subroutine move_body(solid, body, dt)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt
        real(dp) :: omega(3), q_mid(4), v(3)

        call advance_rigid(body, (solid%dt_last + dt)/2, dt, v, omega, q_mid)
        call each_place_rigid(body%last - body%first + 1, body%first, 3, &
                              pose_of(body%rigid, v, omega, q_mid), solid%x_ref, solid%x, solid%v)
    end subroutine move_body

    !> Forces of contact on rigid and driven bodies at the step, and `a` of their particles.
    subroutine balance_rigid(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%asleep .and. dt > 0) cycle
                if (body%formulation == form_rigid) then
                    if (solid%links%bonds) call push_rigid_bonds(solid, body, dt)
                    call balance_body(solid, body, dt)
                end if
                if (body%motion%n > 0) call balance_drive(solid, body, b, dt)
                if (allocated(body%regions)) call balance_regions(solid, body, dt)
            end associate
        end do
    end subroutine balance_rigid

    subroutine balance_body(solid, body, dt)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt
        real(dp) :: v(3), reaction(3)

        associate (b => body%rigid)
            b%force = 0
            b%torque = 0
            if (solid%links%present) call sum_pushes(solid, body, b%force, b%torque)
            reaction = body%reaction
            call settle_rigid(body, solid%time, dt, v)
            if (solid%ranks%rank > 0) body%reaction = reaction ! the first books it
            body%dt_limit = rigid_step(body, solid%skin)
            solid%dt_limit = min(solid%dt_limit, body%dt_limit)
            if (.not. dt > 0) return
            call each_follow_rigid(body%last - body%first + 1, body%first, 3, 1, 3, dt, &
                                   pose_of(b, v, b%omega, b%q), solid%x, solid%v, solid%a)
        end associate
        if (solid%links%present) call settle_drag(solid, body, dt)
    end subroutine balance_body

    !> Force and torque of contact and of interfaces on a rigid body: exact sums, as they act back.
    subroutine sum_pushes(solid, body, force, torque)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(out) :: force(3), torque(3)
        type(scale_t) :: scales(6)
        real(dp) :: largest(6), sums(6)
        integer(int64) :: limb(limbs, 6)
        integer :: i

        largest = 0
        do i = body%first, body%last
            if (is_pushed(i)) call widen(push_on(i), largest)
        end do
        call open_sums(solid%ranks, largest, scales)
        limb = 0
        do i = body%first, body%last
            if (is_pushed(i)) call add_terms(scales, push_on(i), limb)
        end do
        call close_sums(solid%ranks, scales, limb, sums)
        force = sums(1:3)
        torque = sums(4:6)

    contains

        pure logical function is_pushed(i)
            integer, intent(in) :: i

            is_pushed = solid%cohesive%present .or. solid%links%row(i) > 0
        end function is_pushed

        pure function push_on(i) result(f)
            integer, intent(in) :: i
            real(dp) :: f(6)

            associate (push => solid%links%push(:, solid%links%row(i)))
                f(1:3) = push(1:3) + push(4:6)
                if (solid%cohesive%present) f(1:3) = f(1:3) + cohesive_push(solid, i)
                f(4:6) = cross(solid%x(:, i) - body%rigid%x, f(1:3)) + push(7:9)
            end associate
        end function push_on
    end subroutine sum_pushes

    !> The heat of drag is that of the velocity before the kick; it works with the mean of those
    !> before and after it (see `accelerate` of brz_solid_forces).
    subroutine settle_drag(solid, body, dt)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: heat
        integer :: i

        do i = body%first, body%last
            associate (push => solid%links%push(:, solid%links%row(i)))
                heat = -dt*(dt/2*dot_product(push(4:6), solid%a(:, i)) &
                            + dot_product(push(7:9), body%rigid%omega - body%rigid%spin))
            end associate
            solid%energy(i) = solid%energy(i) + real(heat/solid%mass(i), rk)
            body%ledger%contact_heat = body%ledger%contact_heat + heat
        end do
    end subroutine settle_drag

    !> Force of a body on what is driven, the work of the half step up to now, and its velocity.
    subroutine balance_drive(solid, body, b, dt)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        integer, intent(in) :: b
        real(dp), intent(in) :: dt
        real(dp) :: v(3)
        integer :: k

        if (.not. dt > 0) return
        v = velocity_of(body%motion, solid%time)
        body%motion%force = body%rigid%force
        if (body%formulation /= form_rigid) then
            body%motion%force = merge(-body%rigid%load(1:3), 0.0_dp, solid%ranks%rank == 0)
            do k = 1, size(solid%block, 2)
                if (solid%block(1, k) == b) &
                    body%motion%force = body%motion%force + solid%search%sums(3:5, k)/dt
            end do
            call each_follow_drive(body%last - body%first + 1, body%first, 3, 0, 1, 3, dt, v(1), &
                                   v(2), v(3), solid%fixed, solid%v, solid%a)
        end if
        if (body%formulation == form_rigid .and. solid%ranks%rank > 0) return ! the first books it
        body%ledger%drive = body%ledger%drive &
            - dt/2*dot_product(body%motion%force, mean_velocity(body%motion, solid%time - dt, dt))
    end subroutine balance_drive

    !> Carry the regions of a body along that are moved; the first process books the work.
    subroutine move_regions(solid, body, dt)
        type(solid_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt !! [s]
        type(ledger_t) :: ledger
        real(dp) :: v(3)
        integer :: m

        do m = 1, size(body%regions)
            ledger = body%ledger
            call begin_motion(body%regions(m), solid%time, dt, v, ledger)
            if (solid%ranks%rank == 0) body%ledger = ledger
            call each_drive_particle(body%last - body%first + 1, body%first, 3, m, dt, v(1), v(2), &
                                     v(3), solid%fixed, solid%x, solid%v)
        end do
    end subroutine move_regions

    !> Forces of a body on the regions of it that are moved, the work of the half step up to now,
    !> and their velocities.
    subroutine balance_regions(solid, body, dt)
        type(solid_t), intent(inout), target :: solid
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt !! [s]
        real(rk), pointer, contiguous :: load(:, :)
        type(ledger_t) :: ledger
        real(dp) :: sums(6), v(3), work
        integer :: m, n

        n = body%last - body%first + 1
        load => solid%a ! not read where there is no load
        if (allocated(solid%load)) load => solid%load
        do m = 1, size(body%regions)
            if (.not. dt > 0) cycle
            call each_sum_region(n, solid%ranks, body%first, m, 1, 3, &
                                 merge(1, 0, allocated(solid%load)), solid%fixed, load, &
                                 solid%grip, sums)
            ledger = body%ledger
            call end_motion(body%regions(m), solid%time, dt, sums, ledger, work)
            if (solid%ranks%rank == 0) body%ledger = ledger
            v = velocity_of(body%regions(m), solid%time)
            call each_follow_drive(n, body%first, 3, m, 1, 3, dt, v(1), v(2), v(3), solid%fixed, &
                                   solid%v, solid%a)
        end do
    end subroutine balance_regions
end module brz_solid_rigid
