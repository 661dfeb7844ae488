! SPDX-License-Identifier: MIT
!> How particles move, one at a time: kick and drift, how far they have gone since their lists were
!> built, and what momentum and energy they have at the step.
module brz_motion_loop_bodies
    use brz_kernel, only: smoothing_length
    use brz_kinds, only: dp, int32, rk
    use brz_skin_level, only: level_of, lost_level
    use brz_pair_layout, only: n_pair, pair_spin, pair_volume
    use brz_particle_marks, only: is_gone, is_fixed
    use brz_rigid_pose, only: pose_t, spin_at
    use brz_support, only: driven_by, is_kept
    implicit none
    private
    public :: drift_particle, fill_rigid_row, kick_and_drift, note_particle, size_particle
    public :: sum_state, n_sum

    integer, parameter :: n_sum = 16 !! sums of sum_state

contains

    !> Velocity of particle i by the mean of the last and this time step, then position. What is
    !> held or driven does not move by itself.
    !@cuf attributes(host,device) &
    pure subroutine kick_and_drift(i, wide, stride_d, stride_p, mean, dt, loaded, accel, load, &
                                   mass, fixed, x, v, work)
        integer, intent(in) :: i
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in forces
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
        if (fixed(i) == is_fixed .or. fixed(i) == is_gone) return
        total = 0
        do d = 1, 3
            if (fixed(i) >= driven_by(1) .and. is_kept(fixed(i), d)) cycle
            at = 1 + (i - 1)*stride_p + (d - 1)*stride_d
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
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine drift_particle(p, body, first, wide, stride_d, stride_p, mean, dt, loaded, &
                                   unit, dx, dy, dz, accel, load, mass, fixed, built, x, v, work, &
                                   moved)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in forces
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
        call kick_and_drift(i, wide, stride_d, stride_p, mean, dt, loaded, accel, load, mass, &
                            fixed, x, v, share)
        if (loaded == 1) work(i) = work(i) + share
        call note_particle(p, body, first, wide, unit, dx, dy, dz, fixed, x, built, moved)
    end subroutine drift_particle

    !> Mark how far a particle has moved, relative to its body, from where the lists were built; all
    !> that are as far write the same.
    !@loop_body
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
    !@loop_body
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

    !> What contact gathers of a particle of a rigid body.
    !@loop_body
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

    !> Mass, first moments, momentum, angular momentum, energies, damage of a particle at the step,
    !> and of what is outside of the region or has been taken out: see totals_of_sums.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine sum_state(p, first, wide, stride_d, stride_p, half, region, x, v, mass, accel, &
                              energy, damage, fixed, total)
        integer, intent(in) :: p !! particles of the body
        integer, intent(in) :: first !! the first of them
        integer, intent(in) :: wide !! rows of x and v
        integer, intent(in) :: stride_d, stride_p !! distances of directions and particles in accel
        real(rk), intent(in) :: half !! half the last step [s]
        real(dp), intent(in) :: region(3, 2) !! corners [m]
        real(dp), intent(in) :: x(wide, *)
        real(rk), intent(in) :: v(wide, *)
        real(rk), intent(in) :: mass(*)
        real(rk), intent(in) :: accel(*), energy(*), damage(*) !! [m/s2], [J/kg], [-]
        integer(int32), intent(in) :: fixed(*)
        real(dp), intent(inout) :: total(16) !@exact
        real(dp) :: at(3), kinetic, m, u(3)
        integer :: d, i
        logical :: outside

        i = first - 1 + p
        m = mass(i)
        outside = .false.
        do d = 1, 3
            at(d) = x(d, i)
            u(d) = v(d, i) + half*accel(1 + (i - 1)*stride_p + (d - 1)*stride_d)
            if (at(d) < region(d, 1) .or. at(d) > region(d, 2)) outside = .true.
            total(1 + d) = total(1 + d) + m*at(d)
            total(4 + d) = total(4 + d) + m*u(d)
        end do
        kinetic = (u(1)*u(1) + u(2)*u(2) + u(3)*u(3))/2
        total(1) = total(1) + m
        total(8) = total(8) + m*(at(2)*u(3) - at(3)*u(2))
        total(9) = total(9) + m*(at(3)*u(1) - at(1)*u(3))
        total(10) = total(10) + m*(at(1)*u(2) - at(2)*u(1))
        total(11) = total(11) + m*kinetic
        total(12) = total(12) + m*energy(i)
        total(13) = total(13) + m*damage(i)
        if (outside) total(14) = total(14) + m
        if (fixed(i) /= is_gone) return
        total(15) = total(15) + m
        total(16) = total(16) + m*(kinetic + energy(i))
    end subroutine sum_state
end module brz_motion_loop_bodies
