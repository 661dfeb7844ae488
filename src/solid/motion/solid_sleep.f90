! SPDX-License-Identifier: MIT
!> Inactive bodies, which sleep: unloaded and at rest they are left out of the steps, and nothing
!> else changes by a bit. A body wakes for good when a load reaches it or a body that is active
!> comes within reach. In a scene without air all bodies sleep until the first of its loads begins.
module brz_solid_sleep
    use brz_kinds, only: int64, rk
    use brz_ranks, only: most_of_all
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: put_to_sleep, sleep_until_loaded, wake_met, particles_active, all_asleep

    real(rk), parameter :: rounding = 1e3_rk*epsilon(1.0_rk) !! strain of bodies without stress

contains

    !> Put the bodies to sleep that are at rest, are not driven and meet none that moves.
    subroutine put_to_sleep(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: b
        integer(int64) :: moves(size(solid%bodies)) !! 1: some particle of some process does

        moves = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (any(abs(solid%v(:, body%first:body%last)) > 0)) moves(b) = 1
            end associate
        end do
        do b = 1, size(solid%bodies)
            if (allocated(solid%bodies(b)%regions)) moves(b) = 1
        end do
        call most_of_all(solid%ranks, moves)
        solid%bodies%inactive = solid%bodies%motion%n == 0 .and. moves == 0
        call wake_met(solid)
    end subroutine put_to_sleep

    !> Put all bodies to sleep, or none, in a scene whose loads alone can move them: they are at
    !> rest, nothing drives them, and what pushes them is rounding.
    subroutine sleep_until_loaded(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer(int64) :: pushed(1) !! 1: some particle of some process is
        real(rk) :: least !! acceleration that counts [m/s2]
        integer :: b

        if (.not. (solid%present .and. allocated(solid%loads%of))) return
        call put_to_sleep(solid)
        pushed = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                least = real(rounding*solid%materials(body%material)%c_wave**2/body%spacing, rk)
                if (any(abs(solid%a(:, body%first:body%last)) > least)) pushed = 1
                if (any(abs(body%rigid%force) > 0)) pushed = 1 ! by contact
            end associate
        end do
        call most_of_all(solid%ranks, pushed)
        if (particles_active(solid) > 0 .or. pushed(1) > 0) solid%bodies%inactive = .false.
    end subroutine sleep_until_loaded

    !> Wake the bodies that have links with one that is active, and those that these have links
    !> with.
    subroutine wake_met(solid)
        class(listed_bodies_t), intent(inout) :: solid
        logical :: again
        integer :: b

        if (.not. solid%links%present) return
        again = any(solid%bodies%inactive)
        do while (again)
            again = .false.
            do b = 1, size(solid%bodies)
                if (.not. solid%bodies(b)%inactive) cycle
                solid%bodies(b)%inactive = .not. any(solid%links%met(b, :) &
                                                   .and. .not. solid%bodies%inactive)
                again = again .or. .not. solid%bodies(b)%inactive
            end do
        end do
    end subroutine wake_met

    !> True while no body has moved yet.
    pure logical function all_asleep(solid) result(asleep)
        class(bodies_t), intent(in) :: solid

        asleep = allocated(solid%bodies)
        if (asleep) asleep = all(solid%bodies%inactive)
    end function all_asleep

    !> Particles that take steps, of all processes.
    pure integer(int64) function particles_active(solid) result(n)
        class(bodies_t), intent(in) :: solid
        integer :: b

        n = 0
        if (.not. solid%present) return
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%inactive) &
                n = n + solid%bodies(b)%number(2) - solid%bodies(b)%number(1) + 1
        end do
    end function particles_active
end module brz_solid_sleep
