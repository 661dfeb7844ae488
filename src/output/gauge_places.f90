! SPDX-License-Identifier: MIT
!> The particles that a gauge in a body follows, and where they lie: the nearest one, or those of
!> a box.
module brz_gauge_places
    use brz_kinds, only: dp
    use brz_particle_order, only: find_place
    use brz_ranks, only: bits_of_all, least_of_all, several
    use brz_bodies, only: bodies_t
    use brz_wide_lattice, only: unloaded_place
    implicit none
    private
    public :: choose_particle, choose_particles, find_places, strain_between

contains

    !> The particle of the body that is nearest to a place; the lowest number among equals.
    subroutine choose_particle(solid, body, at, particle, place)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: body
        real(dp), intent(in) :: at(3) !! in the unloaded body [m]
        integer, intent(out) :: particle, place !! its number, where it lies if this process has it
        real(dp) :: distance, least, nearest(1), number(1)
        integer :: i

        least = huge(least)
        particle = 0
        place = 0
        do i = solid%bodies(body)%first, solid%bodies(body)%last
            distance = sum((unloaded_place(solid, body, i) - at)**2)
            if (distance > least .or. (distance >= least .and. solid%id(i) > particle)) cycle
            least = distance
            particle = solid%id(i)
            place = i
        end do
        if (.not. several(solid%ranks)) return
        nearest = least
        call least_of_all(solid%ranks, nearest)
        number = particle
        if (least > nearest(1)) number = huge(1)
        call least_of_all(solid%ranks, number)
        particle = nint(number(1))
    end subroutine choose_particle

    !> The particles whose cells lie in a box about a place in the unloaded body, by their numbers,
    !> and the share of each cell that does. Along an axis the box is a cell wide or wider, so a
    !> small one weighs the particles around the place. Without any width the nearest particle.
    subroutine choose_particles(solid, body, at, width, axes, particle, share)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: body
        real(dp), intent(in) :: at(3), width(3) !! in the unloaded body [m]
        integer, intent(in) :: axes !! that are modelled
        integer, allocatable, intent(out) :: particle(:)
        real(dp), allocatable, intent(out) :: share(:)
        real(dp), allocatable :: inside(:)
        real(dp) :: cell(3)
        integer :: i, k, place

        allocate (particle(1), share(1))
        share = 1
        call choose_particle(solid, body, at, particle(1), place)
        if (.not. any(width > 0)) return
        associate (of => solid%bodies(body))
            cell = of%spacing/of%stretch
            allocate (inside(of%number(1):of%number(2)), source=0.0_dp)
            do i = of%first, of%last
                inside(solid%id(i)) = product(overlap(unloaded_place(solid, body, i) - at), &
                                                      mask=[1, 2, 3] <= axes)
            end do
            if (several(solid%ranks)) call bits_of_all(solid%ranks, inside)
            if (.not. any(inside > 0)) return
            particle = pack([(k, k=of%number(1), of%number(2))], inside > 0)
            share = pack(inside, inside > 0)
        end associate

    contains

        !> Share of a cell that lies in the box, by the distance of their middles along each axis.
        pure function overlap(apart)
            real(dp), intent(in) :: apart(3) !! [m]
            real(dp) :: overlap(3)

            overlap = min(max((max(width, cell) + cell)/2 - abs(apart), 0.0_dp), cell)/cell
        end function overlap
    end subroutine choose_particles

    !> Look particles up again if they have been moved by sorting; place 0: another process has it.
    pure subroutine find_places(solid, body, particle, place)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: body, particle(:)
        integer, intent(inout) :: place(:)
        integer, allocatable :: table(:)
        integer :: i, k

        if (size(particle) <= 2) then
            do k = 1, size(particle)
                call find_place(solid, body, particle(k), place(k))
            end do
            return
        end if
        associate (first => solid%bodies(body)%first, last => solid%bodies(body)%last)
            if (all(place >= first .and. place <= last)) then
                if (all(solid%id(place) == particle)) return
            end if
            allocate (table(minval(particle):maxval(particle)), source=0)
            do i = first, last
                if (solid%id(i) >= lbound(table, 1) .and. solid%id(i) <= ubound(table, 1)) &
                    table(solid%id(i)) = i
            end do
        end associate
        place = table(particle)
    end subroutine find_places

    !> Strain between two particles: change of their distance over that in the unloaded body. Each
    !> is known to one process (place 0: another one's), the strain to all, by the same bits.
    real(dp) function strain_between(solid, body, place) result(strain)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: body, place(2)
        real(dp) :: now(6), unloaded(6) !! one after the other [m]
        integer :: k

        now = 0
        unloaded = 0
        do k = 1, 2
            if (place(k) == 0) cycle
            now(3*k - 2:3*k) = solid%x(:, place(k))
            unloaded(3*k - 2:3*k) = unloaded_place(solid, body, place(k))
        end do
        if (several(solid%ranks)) then
            call bits_of_all(solid%ranks, now)
            call bits_of_all(solid%ranks, unloaded)
        end if
        strain = norm2(now(:3) - now(4:))/norm2(unloaded(:3) - unloaded(4:)) - 1
    end function strain_between
end module brz_gauge_places
