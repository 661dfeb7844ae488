! SPDX-License-Identifier: MIT
!> Forces of the pressures on faces and of pushes on bodies, in scenes without air.
module brz_solid_load
    use brz_carrier_rules, only: add_force
    use brz_face_load, only: facets_t, find_places, impulse_on
    use brz_kinds, only: dp, rk
    use brz_rigid, only: cross
    use brz_solid_state, only: form_rigid, is_gone, solid_t
    implicit none
    private
    public :: load_faces

contains

    !> Set the loads of all particles, and those of rigid bodies, to the mean pressures of the
    !> coming step: their impulses are exact.
    subroutine load_faces(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        integer :: b, i, k

        if (.not. allocated(solid%loads%of)) return
        if (solid%loads%rebuilds /= solid%rebuilds) then ! lists were sorted
            call find_places(solid%loads, solid%id)
            solid%loads%rebuilds = solid%rebuilds
        end if
        solid%load = 0
        do k = 1, size(solid%loads%of)
            if (solid%loads%of(k)%body > 0) then
                call push_body(solid, solid%loads%of(k), dt)
            else
                call load_facets(solid, solid%loads%of(k), dt)
            end if
        end do
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%formulation /= form_rigid) cycle
                body%rigid%load = 0
                do i = body%first, body%last
                    call add_force(solid%x(:, i) - body%rigid%x, solid%load(:, i), &
                                   body%rigid%load)
                end do
            end associate
        end do
    end subroutine load_faces

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
    subroutine load_facets(solid, facets, dt)
        type(solid_t), intent(inout) :: solid
        type(facets_t), intent(in) :: facets
        real(dp), intent(in) :: dt !! [s]
        real(dp) :: span(3, 2), area(3), length, p
        integer :: i, k, t

        do k = 1, facets%n
            if (facets%blast .or. k == 1) p = (impulse_on(facets, k, solid%time + dt) &
                                               - impulse_on(facets, k, solid%time))/dt
            i = solid%loads%place(facets%id(k))
            if (solid%fixed(i) == is_gone) cycle
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

    !> Place of neighbour m of facet k.
    pure function place_beside(solid, facets, i, k, m) result(x)
        type(solid_t), intent(in) :: solid
        type(facets_t), intent(in) :: facets
        integer, intent(in) :: i, k, m !! i: its particle
        real(dp) :: x(3)

        x = solid%x(:, i)
        if (facets%beside(m, k) > 0) x = solid%x(:, solid%loads%place(facets%beside(m, k)))
        if (facets%mirror(m, k) > 0) x(facets%mirror(m, k)) = -x(facets%mirror(m, k))
    end function place_beside
end module brz_solid_load
