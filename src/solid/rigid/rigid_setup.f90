! SPDX-License-Identifier: MIT
!> Mass, inertia and first motion of rigid bodies; prescribed motion of fixed particles.
module brz_rigid_setup
    use brz_algebra, only: inverse3
    use brz_body, only: body_t
    use brz_case, only: body_case_t, label
    use brz_contact, only: spring_share
    use brz_errors, only: error_t, exit_deck, raise
    use brz_formulation_names, only: form_rigid
    use brz_interaction, only: law_none
    use brz_kinds, only: dp, rk
    use brz_motion, only: velocity_of
    use brz_particle_marks, only: is_fixed
    use brz_rigid, only: cross
    use brz_particles, only: particles_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: set_up_rigid

contains

    !> Complete a body whose particles have their places, masses and velocities.
    subroutine set_up_rigid(input, on_plane, solid, body, err)
        type(body_case_t), intent(in) :: input
        logical, intent(in) :: on_plane(3) !! planes of symmetry that cut the body
        class(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        integer :: i

        body%motion%n = input%n_motion
        if (body%motion%n > 0) then
            body%motion%time = input%motion_time(:input%n_motion)
            body%motion%v = input%motion_velocity(:, :input%n_motion)
        end if
        if (body%formulation == form_rigid) call make_rigid(input, on_plane, solid, body, err)
        if (body%motion%n == 0) return
        do i = body%first, body%last
            if (body%formulation /= form_rigid .and. solid%fixed(i) /= is_fixed) cycle
            body%motion%mass = body%motion%mass + solid%mass(i)
            if (body%formulation /= form_rigid) &
                solid%v(:, i) = real(velocity_of(body%motion, 0.0_dp), rk)
        end do
    end subroutine set_up_rigid

    subroutine make_rigid(input, on_plane, solid, body, err)
        type(body_case_t), intent(in) :: input
        logical, intent(in) :: on_plane(3)
        class(listed_bodies_t), intent(inout) :: solid
        type(body_t), intent(inout) :: body
        type(error_t), intent(inout) :: err
        real(dp) :: inertia(3, 3), v(3)
        integer :: i, held

        held = count(solid%fixed(body%first:body%last) == 1)
        if (held > 0 .and. held <= body%last - body%first) call raise(err, exit_deck, &
            label('body', input%id, input%place)//"a rigid body is fixed as a whole (fix='all')"// &
            ' or not at all')
        call freedom(solid, on_plane, held > 0, body)
        associate (b => body%rigid)
            call sum_mass(solid, body, on_plane, inertia)
            call invert_free(inertia, b%turns, b%compliance)
            if (solid%links%present .and. input%n_motion == 0) call bear_contact(solid, body)
            v = input%velocity*b%moves
            if (input%about_point) v = v + cross(input%spin, b%x - input%spin_centre)*b%moves
            if (body%motion%n > 0) v = velocity_of(body%motion, 0.0_dp)
            b%p = b%mass*v
            b%omega = input%spin*b%turns
            b%spin = b%omega
            b%l = matmul(inertia, b%omega)*b%turns
            do i = body%first, body%last
                solid%v(:, i) = real(v + cross(b%omega, solid%x(:, i) - b%x), rk)
            end do
        end associate
    end subroutine make_rigid

    !> Time step that contact with other bodies bears: all of the surface of the body, at most that
    !> of a box around it, presses and rubs on the part of the body that gives way most. It does
    !> not change in time: a leapfrog keeps the energy of a spring while its step does.
    subroutine bear_contact(solid, body)
        class(listed_bodies_t), intent(in) :: solid
        type(body_t), intent(inout) :: body
        real(dp) :: area, give, stiffness, drag, d(3), side(3), rate
        integer :: a, c, i

        give = 0
        associate (r => body%rigid, x => solid%x(:, body%first:body%last))
            do i = body%first, body%last
                d = solid%x(:, i) - r%x
                give = max(give, dot_product(d, d)*(r%compliance(1, 1) + r%compliance(2, 2) &
                                                    + r%compliance(3, 3)) &
                                 - dot_product(d, matmul(r%compliance, d)))
            end do
            give = give + maxval(r%moves)/r%mass
            side = maxval(x, dim=2) - minval(x, dim=2) + body%spacing
            side(solid%dimension + 1:) = 1
            area = 0
            do c = 1, solid%dimension
                area = area + 2*product(side)/side(c)*solid%depth
            end do
        end associate
        a = findloc(solid%bodies%first, body%first, 1)
        do c = 1, size(solid%bodies)
            associate (m => solid%links%table(a, c))
                if (m%law == law_none) cycle
                stiffness = m%core/(m%spacing**solid%dimension*solid%depth)*area
                drag = m%impedance*area
                if (m%friction > 0) drag = max(m%impedance, m%stick)*area
                rate = max(sqrt(give*stiffness), give*drag*spring_share, tiny(rate))
                body%rigid%steps(2) = min(body%rigid%steps(2), spring_share/rate)
            end associate
        end do
    end subroutine bear_contact

    !> Components of velocity and spin that the body may have: a body on a plane of symmetry
    !> moves in it and turns about its normal.
    subroutine freedom(solid, on_plane, held, body)
        class(particles_t), intent(in) :: solid
        logical, intent(in) :: on_plane(3), held
        type(body_t), intent(inout) :: body
        integer :: a

        associate (b => body%rigid)
            do a = 1, 3
                if (on_plane(a) .or. a > solid%dimension) b%moves(a) = 0
                if (on_plane(a)) b%turns = b%turns*merge(1, 0, [1, 2, 3] == a)
            end do
            if (solid%dimension < 3) b%turns(1:2) = 0
            if (solid%dimension == 1 .or. held) b%turns = 0
            if (held) b%moves = 0
        end associate
    end subroutine freedom

    !> Mass, centre, and inertia about it: that of the particles as points and of their cells.
    subroutine sum_mass(solid, body, on_plane, inertia)
        class(particles_t), intent(in) :: solid
        type(body_t), intent(inout) :: body
        logical, intent(in) :: on_plane(3)
        real(dp), intent(out) :: inertia(3, 3)
        real(dp) :: d(3), m
        integer :: a, i

        associate (b => body%rigid)
            b%mass = sum(real(solid%mass(body%first:body%last), dp))
            do a = 1, 3
                b%x(a) = sum(solid%mass(body%first:body%last)*solid%x(a, body%first:body%last)) &
                         /b%mass
            end do
            where (on_plane) b%x = 0
            b%centre_ref = b%x
            b%cell_inertia = b%mass*body%spacing**2/6
            inertia = 0
            do i = body%first, body%last
                d = solid%x(:, i) - b%x
                b%reach = max(b%reach, norm2(d) + body%spacing)
                m = solid%mass(i)
                do a = 1, 3
                    inertia(:, a) = inertia(:, a) - m*d*d(a)
                    inertia(a, a) = inertia(a, a) + m*dot_product(d, d)
                end do
            end do
            do a = 1, 3
                inertia(a, a) = inertia(a, a) + b%cell_inertia
            end do
        end associate
    end subroutine sum_mass

    !> Inverse of the inertia among the axes about which the body may turn, 0 elsewhere.
    subroutine invert_free(inertia, turns, compliance)
        real(dp), intent(in) :: inertia(3, 3), turns(3)
        real(dp), intent(out) :: compliance(3, 3)
        real(dp) :: scale
        real(rk) :: a(3, 3), b(3, 3)
        integer :: i
        logical :: ok

        scale = maxval(abs(inertia))
        do i = 1, 3
            a(:, i) = real(inertia(:, i)/scale*turns*turns(i), rk)
            if (.not. turns(i) > 0) a(i, i) = 1
        end do
        call inverse3(a, b, ok)
        do i = 1, 3
            compliance(:, i) = b(:, i)/scale*turns*turns(i)
        end do
    end subroutine invert_free
end module brz_rigid_setup
