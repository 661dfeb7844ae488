! SPDX-License-Identifier: MIT
!> The particles that a gauge in a body follows, and where they lie.
module brz_gauge_places
    use brz_kinds, only: dp
    use brz_ranks, only: bits_of_all, least_of_all, several
    use brz_bodies, only: bodies_t
    use brz_wide_lattice, only: unloaded_place
    implicit none
    private
    public :: choose_particle, strain_between

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
