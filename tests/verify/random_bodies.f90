! SPDX-License-Identifier: MIT
!> Random bodies in a box of air: particles that are moved here, not by a solid.
!>
!> Thrown ones are rigid, pushed and turned by their loads; driven ones swing (a gap between two
!> closes and opens) or breathe; broken ones fly apart, each particle pushed by its own load.
module random_bodies
    use brz_air_state, only: air_t
    use brz_kinds, only: dp, rk
    use brz_particles, only: particles_t
    use dice, only: dice_t
    implicit none
    private
    public :: drawn_body_t, draw_bodies, move_bodies

    integer, parameter :: thrown = 1, swinging = 2, breathing = 3, broken = 4

    type :: drawn_body_t
        integer :: kind = thrown
        integer :: first = 1, last = 0 !! particles
        real(dp) :: centre(3) = 0, v(3) = 0, spin(3) = 0
        real(dp) :: rate = 0, frequency = 0 !! of breathing or swinging [1/s]
        real(dp) :: mass = 1, inertia = 1
    end type drawn_body_t

contains

    !> Draw some bodies; `speed` is that of the fastest of their particles, about.
    subroutine draw_bodies(air, rest, sound, random, solid, bodies, speed)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: rest, sound !! density and speed of sound of the gas at rest
        type(dice_t), intent(inout) :: random
        class(particles_t), intent(inout) :: solid
        type(drawn_body_t), allocatable, intent(out) :: bodies(:)
        real(dp), intent(out) :: speed !! [m/s]
        integer :: b, p

        allocate (bodies(random%pick([1, 1, 2, 2, 3, 4])))
        solid%present = .true.
        allocate (solid%x(3, 0), solid%mass(0), solid%volume(0))
        speed = 0
        do b = 1, size(bodies)
            call draw_body(air, rest, sound, random, solid, bodies(b))
            if (bodies(b)%kind /= swinging) &
                speed = max(speed, norm2(bodies(b)%v), abs(bodies(b)%rate)*air%dx(1))
        end do
        allocate (solid%v(3, solid%n), solid%a(3, solid%n), solid%load(3, solid%n), source=0.0_rk)
        allocate (solid%fixed(solid%n), source=0)
        solid%id = [(p, p=1, solid%n)]
        do b = 1, size(bodies)
            call start_body(air, random, solid, bodies(b))
        end do
        call drive(air, bodies, 0.0_dp, solid)
    end subroutine draw_bodies

    !> A block, plate or single particle somewhere, turned, and how it moves.
    subroutine draw_body(air, rest, sound, random, solid, body)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: rest, sound !! density and speed of sound of the gas at rest
        type(dice_t), intent(inout) :: random
        class(particles_t), intent(inout) :: solid
        type(drawn_body_t), intent(out) :: body
        real(dp) :: across, angle, half(3), size(3), spacing, speed
        integer :: d

        size = air%n*air%dx
        spacing = air%dx(1)*(0.3_dp + 0.65_dp*random%draw())
        half = spacing/2
        body%centre = size/2
        do d = 1, 3
            if (air%n(d) == 1) cycle
            body%centre(d) = size(d)*random%draw()
            half(d) = max(half(d), size(d)*0.25_dp*random%draw()**2)
        end do
        if (random%draw() < 0.35_dp) half(1) = 0.5_dp*spacing ! a plate
        if (random%draw() < 0.15_dp) half = 0.5_dp*spacing ! a particle
        angle = 0
        if (air%n(2) > 1) then
            if (random%draw() < 0.6_dp) angle = 3*random%draw()
        end if
        body%first = solid%n + 1
        ! from 50 times the density of the gas on: lighter debris is beyond the coupling
        call add_particles(air, body%centre, half, spacing, angle, &
                           rest*10**(1.7_dp + 2*random%draw()), solid)
        body%last = solid%n
        body%kind = random%pick([thrown, thrown, swinging, breathing, broken])
        speed = sound*5*random%draw()**2
        across = max(maxval(half, mask=air%n > 1), spacing)
        do d = 1, 3
            if (air%n(d) > 1) body%v(d) = speed*(2*random%draw() - 1)
        end do
        if (air%n(2) > 1) body%spin(3) = (2*random%draw() - 1)*speed/across
        if (air%n(3) > 1) body%spin(1) = (2*random%draw() - 1)*speed/across
        body%frequency = (0.05_dp + 0.3_dp*random%draw())*sound/air%dx(1)
        body%rate = (2*random%draw() - 1)*speed/across
    end subroutine draw_body

    !> A lattice of particles turned about z, as far as it lies in the box.
    subroutine add_particles(air, centre, half, spacing, angle, density, solid)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: centre(3), half(3), spacing, angle, density
        class(particles_t), intent(inout) :: solid
        real(dp) :: axis(3, 3), volume, x(3)
        integer :: i, j, k, n(3)

        axis = reshape([cos(angle), sin(angle), 0.0_dp, -sin(angle), cos(angle), 0.0_dp, &
                        0.0_dp, 0.0_dp, 1.0_dp], [3, 3])
        n = merge(max(1, nint(2*half/spacing)), 1, air%n > 1)
        volume = product(merge(spacing, air%dx, air%n > 1))
        do k = 1, n(3)
            do j = 1, n(2)
                do i = 1, n(1)
                    x = centre + matmul(axis, spacing*([i, j, k] - (n + 1)/2.0_dp))
                    if (any(x < 0 .or. x > air%n*air%dx)) cycle
                    solid%x = reshape([solid%x, x], [3, solid%n + 1])
                    solid%mass = [solid%mass, real(density*volume, rk)]
                    solid%volume = [solid%volume, real(volume, rk)]
                    solid%n = solid%n + 1
                end do
            end do
        end do
    end subroutine add_particles

    !> Mass and inertia of a body, and velocities for the case that it is broken.
    subroutine start_body(air, random, solid, body)
        type(air_t), intent(in) :: air
        type(dice_t), intent(inout) :: random
        class(particles_t), intent(inout) :: solid
        type(drawn_body_t), intent(inout) :: body
        integer :: d, p

        if (body%last < body%first) return
        body%mass = sum(real(solid%mass(body%first:body%last), dp))
        body%inertia = body%mass*air%dx(1)**2/6
        if (body%kind == swinging .or. body%kind == breathing) & ! nothing pushes them
            solid%fixed(body%first:body%last) = 1
        do p = body%first, body%last
            body%inertia = body%inertia + solid%mass(p)*sum((solid%x(:, p) - body%centre)**2)
            do d = 1, 3
                if (air%n(d) > 1) solid%v(d, p) = &
                    real(body%v(d) + (2*random%draw() - 1)*abs(body%rate)*air%dx(1), rk)
            end do
        end do
    end subroutine start_body

    !> Velocities of the particles of all bodies but broken ones.
    subroutine drive(air, bodies, t, solid)
        type(air_t), intent(in) :: air
        type(drawn_body_t), intent(in) :: bodies(:)
        real(dp), intent(in) :: t !! [s]
        class(particles_t), intent(inout) :: solid
        real(dp) :: out(3), v(3)
        integer :: b, p

        do b = 1, size(bodies)
            if (bodies(b)%kind == broken) cycle
            do p = bodies(b)%first, bodies(b)%last
                out = solid%x(:, p) - bodies(b)%centre
                v = bodies(b)%v
                select case (bodies(b)%kind)
                case (thrown)
                    v = v + cross(bodies(b)%spin, out)
                case (swinging)
                    v = v*cos(bodies(b)%frequency*t)
                case default
                    v = v + bodies(b)%rate*cos(bodies(b)%frequency*t)*out
                end select
                solid%v(:, p) = real(merge(v, 0.0_dp, air%n > 1), rk)
            end do
        end do
    end subroutine drive

    !> Kick the bodies by their loads, and move them.
    subroutine move_bodies(air, t, dt, bodies, solid)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: t, dt !! [s]
        type(drawn_body_t), intent(inout) :: bodies(:)
        class(particles_t), intent(inout) :: solid
        real(dp) :: force(3), out(3), torque(3), turned(3), v(3)
        integer :: b, p

        do b = 1, size(bodies)
            force = 0
            torque = 0
            do p = bodies(b)%first, bodies(b)%last
                force = force + solid%load(:, p)
                torque = torque + cross(solid%x(:, p) - bodies(b)%centre, &
                                        real(solid%load(:, p), dp))
                if (bodies(b)%kind == broken) solid%v(:, p) = solid%v(:, p) &
                    + real(dt, rk)*solid%load(:, p)/solid%mass(p)
            end do
            if (bodies(b)%kind /= thrown) cycle
            bodies(b)%v = bodies(b)%v + merge(dt*force/bodies(b)%mass, 0.0_dp, air%n > 1)
            bodies(b)%spin = bodies(b)%spin + dt*torque/bodies(b)%inertia
        end do
        call drive(air, bodies, t + dt/2, solid)
        do b = 1, size(bodies)
            v = bodies(b)%v
            if (bodies(b)%kind == swinging) v = v*cos(bodies(b)%frequency*(t + dt/2))
            do p = bodies(b)%first, bodies(b)%last
                out = solid%x(:, p) - bodies(b)%centre
                solid%x(:, p) = solid%x(:, p) + dt*solid%v(:, p)
                if (bodies(b)%kind /= thrown) cycle
                turned = solid%x(:, p) - bodies(b)%centre - dt*v
                solid%x(:, p) = bodies(b)%centre + dt*v &
                                + turned*norm2(out)/max(norm2(turned), tiny(out))
            end do
            bodies(b)%centre = bodies(b)%centre + dt*v
        end do
        solid%dt_last = dt
    end subroutine move_bodies

    pure function cross(a, b) result(c)
        real(dp), intent(in) :: a(3), b(3)
        real(dp) :: c(3)

        c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
    end function cross
end module random_bodies
