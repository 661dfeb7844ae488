! SPDX-License-Identifier: MIT
!> Forces of the pressures on faces and of pushes on bodies, in scenes without air.
module brz_solid_load
    use brz_carrier_rules, only: add_force
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_exact_sum, only: add_terms, close_sums, limbs, open_sums, scale_t, widen
    use brz_face_load, only: facets_t, find_places, impulse_on
    use brz_kinds, only: dp, int64, rk
    use brz_ranks, only: several
    use brz_rigid, only: cross
    use brz_solid_state, only: body_t, form_rigid, is_gone, solid_t
    use brz_text, only: to_text
    implicit none
    private
    public :: load_faces

contains

    !> Set the loads of all particles, and those of rigid bodies, to the mean pressures of the
    !> coming step: their impulses are exact.
    subroutine load_faces(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err !! exit_numerical on several processes alone
        integer :: b, k

        if (.not. allocated(solid%loads%of)) return
        if (solid%loads%rebuilds /= solid%rebuilds) then ! lists were sorted
            if (several(solid%ranks)) solid%loads%place = 0
            call find_places(solid%loads, solid%id(:solid%n))
            call mark_ghosts(solid)
            solid%loads%rebuilds = solid%rebuilds
        end if
        solid%load = 0
        do k = 1, size(solid%loads%of)
            if (solid%loads%of(k)%body > 0) then
                call push_body(solid, solid%loads%of(k), dt)
            else
                call load_facets(solid, solid%loads%of(k), dt, err)
            end if
        end do
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%formulation == form_rigid) &
                call load_rigid(solid, solid%bodies(b), solid%bodies(b)%rigid%load)
        end do
    end subroutine load_faces

    !> Force and torque on a rigid body: exact sums, as they act back.
    subroutine load_rigid(solid, body, load)
        type(solid_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(out) :: load(6) !! [N, N m]
        type(scale_t) :: scales(6)
        real(dp) :: largest(6)
        integer(int64) :: limb(limbs, 6)
        integer :: i

        largest = 0
        do i = body%first, body%last
            call widen(load_on(i), largest)
        end do
        call open_sums(solid%ranks, largest, scales)
        limb = 0
        do i = body%first, body%last
            call add_terms(scales, load_on(i), limb)
        end do
        call close_sums(solid%ranks, scales, limb, load)

    contains

        pure function load_on(i) result(f)
            integer, intent(in) :: i
            real(dp) :: f(6)

            f = 0
            call add_force(solid%x(:, i) - body%rigid%x, solid%load(:, i), f)
        end function load_on
    end subroutine load_rigid

    !> Add the forces of a push on all particles of a body.
    subroutine push_body(solid, facets, dt)
        type(solid_t), intent(inout) :: solid
        type(facets_t), intent(in) :: facets
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: mean
        integer :: i

        mean = (impulse_on(facets, 1, solid%time + dt) - impulse_on(facets, 1, solid%time))/dt
        do i = solid%bodies(facets%body)%first, solid%bodies(facets%body)%last
            if (solid%fixed(i) == is_gone) cycle
            solid%load(:, i) = solid%load(:, i) + real(solid%mass(i)*mean*facets%push, rk)
        end do
    end subroutine push_body

    !> Add the forces on the facets of one load.
    subroutine load_facets(solid, facets, dt, err)
        type(solid_t), intent(inout) :: solid
        type(facets_t), intent(in) :: facets
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: span(3, 2), area(3), length, p
        integer :: i, k, t

        do k = 1, facets%n
            if (facets%blast .or. k == 1) p = (impulse_on(facets, k, solid%time + dt) &
                                               - impulse_on(facets, k, solid%time))/dt
            i = solid%loads%place(facets%id(k))
            if (i <= 0) cycle ! another process loads it
            if (solid%fixed(i) == is_gone) cycle
            if (is_torn_apart(solid, facets, k)) then
                call raise(err, exit_numerical, 'a loaded face is torn further apart than '// &
                           'processes look, at particle '//to_text(facets%id(k))// &
                           ': run this scene as one process')
                cycle
            end if
            do t = 1, 2
                span(:, t) = place_beside(solid, facets, i, k, 2*t - 1) &
                             - place_beside(solid, facets, i, k, 2*t)
                span(:, t) = span(:, t)*facets%width(t, k)
                length = norm2(span(:, t))
                if (length > facets%most(t, k)) span(:, t) = span(:, t)*facets%most(t, k)/length
                if (facets%width(t, k) > 0) cycle
                span(mod(abs(facets%side(k)) + t - 1, 3) + 1, t) = 1 ! a direction not modelled
            end do
            area = cross(span(:, 1), span(:, 2))*sign(1, facets%side(k))
            solid%load(:, i) = solid%load(:, i) - real(p*area, rk)
        end do
    end subroutine load_facets

    !> True where this process does not know a neighbour of facet k.
    pure logical function is_torn_apart(solid, facets, k) result(yes)
        type(solid_t), intent(in) :: solid
        type(facets_t), intent(in) :: facets
        integer, intent(in) :: k
        integer :: m

        yes = .false.
        do m = 1, 4
            if (facets%beside(m, k) > 0) &
                yes = yes .or. solid%loads%place(facets%beside(m, k)) == 0
        end do
    end function is_torn_apart

    !> Places of ghosts are negative.
    pure subroutine mark_ghosts(solid)
        type(solid_t), intent(inout) :: solid
        integer :: b, i

        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%last + 1, solid%bodies(b)%rim
                solid%loads%place(solid%id(i)) = -i
            end do
        end do
    end subroutine mark_ghosts

    !> Place of neighbour m of facet k.
    pure function place_beside(solid, facets, i, k, m) result(x)
        type(solid_t), intent(in) :: solid
        type(facets_t), intent(in) :: facets
        integer, intent(in) :: i, k, m !! i: its particle
        real(dp) :: x(3)

        x = solid%x(:, i)
        if (facets%beside(m, k) > 0) &
            x = solid%x(:, abs(solid%loads%place(facets%beside(m, k))))
        if (facets%mirror(m, k) > 0) x(facets%mirror(m, k)) = -x(facets%mirror(m, k))
    end function place_beside
end module brz_solid_load
