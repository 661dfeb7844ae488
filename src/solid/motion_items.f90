! SPDX-License-Identifier: MIT
!> How particles move, one at a time: kick and drift, those that a motion drives, those of rigid
!> bodies; and how far they have gone since their lists were built.
module brz_motion_items
    use brz_kernel, only: smoothing_length
    use brz_kinds, only: dp, int32, int64, rk
    use brz_move_level, only: level_of, lost_level
    use brz_pair_layout, only: n_pair, pair_spin, pair_volume
    use brz_particle_marks, only: is_gone, is_held
    use brz_push_layout, only: push_layout_t
    use brz_rigid, only: cross
    use brz_rigid_pose, only: arm_at, place_point, pose_t, spin_at, velocity_at
    use brz_support, only: driven_by, is_driven, is_kept
    implicit none
    private
    public :: drift_particle, size_particle, drive_particle, place_rigid, note_particle
    public :: follow_drive, follow_rigid, fill_rigid_row, sum_pairs, settle_heat
    public :: kick_and_drift

contains

    !> Velocity of particle i by the mean of the last and this time step, then position. What is
    !> held or driven does not move by itself.
    !@cuf attributes(host,device) &
    pure subroutine kick_and_drift(i, wide, step_d, step_p, mean, dt, loaded, accel, load, mass, &
                                   fixed, x, v, work)
        integer, intent(in) :: i
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: step_d, step_p !! distances of directions and particles in forces
        real(rk), intent(in) :: mean !! [s]
        real(dp), intent(in) :: dt !! [s]
        integer, intent(in) :: loaded !! 1: `load` is there
        real(rk), intent(in) :: accel(*), load(*), mass(*) !! [m/s2], [N], [kg]
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(inout) :: x(wide, *)
        real(rk), intent(inout) :: v(wide, *)
        real(dp), intent(out) :: work !! of the load [J]
        real(rk) :: before, push, total
        integer :: at, d

        work = 0
        if (fixed(i) == is_held .or. fixed(i) == is_gone) return
        total = 0
        do d = 1, 3
            if (fixed(i) >= driven_by(1) .and. is_kept(fixed(i), d)) cycle
            at = 1 + (i - 1)*step_p + (d - 1)*step_d
            push = 0
            if (loaded == 1) then
                if (.not. is_kept(fixed(i), d)) push = load(at)
            end if
            before = v(d, i)
            v(d, i) = before + mean*accel(at) + real(dt, rk)*push/mass(i)
            x(d, i) = x(d, i) + dt*v(d, i)
            total = total + push*(before + v(d, i))
        end do
        work = dt*total/2
    end subroutine kick_and_drift

    !> Kick and drift, the work of the load, and how far the particle has gone.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine drift_particle(p, body, first, wide, step_d, step_p, mean, dt, loaded, unit, &
                                   dx, dy, dz, accel, load, mass, fixed, built, x, v, work, moved)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: step_d, step_p !! distances of directions and particles in forces
        real(rk), intent(in) :: mean !! [s]
        real(dp), intent(in) :: dt !! [s]
        integer, intent(in) :: loaded !! 1: `load` is there
        real(dp), intent(in) :: unit !! of levels of motion [m]
        real(dp), intent(in) :: dx, dy, dz !! drift of the body [m]
        real(rk), intent(in) :: accel(*), load(*), mass(*) !! [m/s2], [N], [kg]
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(in) :: built(wide, *)
        real(dp), intent(inout) :: x(wide, *)
        real(rk), intent(inout) :: v(wide, *)
        real(dp), intent(inout) :: work(*) !! of the load [J]
        integer, intent(inout) :: moved(lost_level, *)
        real(dp) :: share
        integer :: i

        i = first - 1 + p
        call kick_and_drift(i, wide, step_d, step_p, mean, dt, loaded, accel, load, mass, fixed, &
                            x, v, share)
        if (loaded == 1) work(i) = work(i) + share
        call note_particle(p, body, first, wide, unit, dx, dy, dz, fixed, x, built, moved)
    end subroutine drift_particle

    !> Mark how far a particle has moved, relative to its body, from where the lists were built; all
    !> that are as far write the same.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine note_particle(p, body, first, wide, unit, dx, dy, dz, fixed, x, built, moved)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: unit !! of levels of motion [m]
        real(dp), intent(in) :: dx, dy, dz !! drift of the body [m]
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(in) :: x(wide, *), built(wide, *)
        integer, intent(inout) :: moved(lost_level, *) !! (bodies) 1: some particle is there
        real(dp) :: e(3)
        integer :: i, level

        i = first - 1 + p
        if (fixed(i) == is_gone) return
        e(1) = x(1, i) - built(1, i) - dx
        e(2) = x(2, i) - built(2, i) - dy
        e(3) = x(3, i) - built(3, i) - dz
        level = level_of(e(1)*e(1) + e(2)*e(2) + e(3)*e(3), unit)
        if (level == 0) return
        if (moved(level, body) == 0) moved(level, body) = 1
    end subroutine note_particle

    !> Smoothing length of a particle of a body where it follows the density.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine size_particle(p, first, dimension, h, low, high, mu, place)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: dimension
        real(rk), intent(in) :: h, low, high !! unloaded [m], bounds over h
        real(rk), intent(in) :: mu(*)
        real(dp), intent(inout) :: place(4, *) !! in its last row [m]
        real(rk) :: bounds(2)

        bounds(1) = low
        bounds(2) = high
        place(4, first - 1 + p) = smoothing_length(h, bounds, dimension, mu(first - 1 + p))
    end subroutine size_particle

    !> Carry a held particle, or one of a region that is moved, along.
    !@item
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
    !@item
    !@cuf attributes(host,device) &
    pure subroutine follow_drive(p, first, wide, region, step_d, step_p, dt, vx, vy, vz, fixed, v, &
                                 accel)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of v
        integer, intent(in) :: region !! its motion; 0: that of what is held
        integer, intent(in) :: step_d, step_p !! distances of directions and particles in accel
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
            accel(1 + (i - 1)*step_p + (d - 1)*step_d) = real(2/dt*(drive(d) - v(d, i)), rk)
        end do
    end subroutine follow_drive

    !> Position of a particle of a rigid body at the step, and its velocity in the middle.
    !@item
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
    !@item
    !@cuf attributes(host,device) &
    pure subroutine follow_rigid(p, first, wide, step_d, step_p, dt, pose, x, v, accel)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: step_d, step_p !! distances of directions and particles in accel
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
            accel(1 + (i - 1)*step_p + (d - 1)*step_d) = real(2/dt*(speed(d) - v(d, i)), rk)
        end do
    end subroutine follow_rigid

    !> What contact gathers of a particle of a rigid body.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine fill_rigid_row(p, first, step_v, pose, volume, row)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: step_v !! distance of volumes
        type(pose_t), intent(in) :: pose
        real(rk), intent(in) :: volume(*)
        real(rk), intent(inout) :: row(n_pair, *)
        real(dp) :: spin(3)
        integer :: d, i

        i = first - 1 + p
        do d = 1, n_pair
            row(d, i) = 0
        end do
        row(pair_volume, i) = volume(1 + (i - 1)*step_v)
        spin = spin_at(pose)
        do d = 1, 3
            row(pair_spin + d, i) = real(spin(d), rk)
        end do
    end subroutine fill_rigid_row

    !> Add what other bodies do to a particle to the force and the torque on its rigid body.
    !@item
    !@cuf attributes(host,device) &
    pure subroutine sum_pairs(p, first, wide, lay, pose, row, id, node, glue, x, pairs, push)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x
        type(push_layout_t), intent(in) :: lay
        type(pose_t), intent(in) :: pose !! of the body
        integer(int32), intent(in) :: row(*), id(*), node(*)
        real(dp), intent(in) :: glue(3, 0:*) !! forces on the nodes of interfaces [N]
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
        at = 1 + (at - 1)*lay%step_p
        do c = 1, 3
            f(c) = 0
            if (at > 0) f(c) = pairs(at + (c - 1)*lay%step_c) &
                + pairs(at + (lay%drag + c - 1)*lay%step_c)
            if (lay%glued == 1) f(c) = f(c) + glue(c, node(id(i)))
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
    !@item
    !@cuf attributes(host,device) &
    pure subroutine settle_heat(p, first, lay, step_d, step_p, dt, wx, wy, wz, row, mass, pairs, &
                                accel, energy, book)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        type(push_layout_t), intent(in) :: lay
        integer, intent(in) :: step_d, step_p !! distances in `accel`
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(in) :: wx, wy, wz !! change of the spin in the kick [1/s]
        integer(int32), intent(in) :: row(*)
        real(rk), intent(in) :: mass(*), pairs(*), accel(*)
        real(rk), intent(inout) :: energy(*)
        real(dp), intent(inout) :: book(*) !! [J]
        real(dp) :: drag, heat, turning, turn(3)
        integer(int64) :: at
        integer :: c, i

        i = first - 1 + p
        at = i
        if (lay%compact == 1) at = row(i)
        if (at == 0) return
        at = 1 + (at - 1)*lay%step_p
        turn(1) = wx
        turn(2) = wy
        turn(3) = wz
        drag = 0
        turning = 0
        do c = 1, 3
            drag = drag + pairs(at + (lay%drag + c - 1)*lay%step_c) &
                   *accel(1 + (i - 1)*step_p + (c - 1)*step_d)
            turning = turning + pairs(at + (lay%torque + c - 1)*lay%step_c)*turn(c)
        end do
        heat = -dt*(dt/2*drag + turning)
        if (lay%heat > 0) heat = heat + dt*pairs(at + (lay%heat - 1)*lay%step_c)
        energy(i) = energy(i) + real(heat/mass(i), rk)
        book(i) = book(i) + heat
    end subroutine settle_heat
end module brz_motion_items
