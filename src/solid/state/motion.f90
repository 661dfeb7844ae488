! SPDX-License-Identifier: MIT
!> Prescribed motion: a velocity that is given at some times, straight lines between them.
module brz_motion
    use brz_kinds, only: dp
    implicit none
    private
    public :: motion_t, velocity_of, mean_velocity

    type :: motion_t
        integer :: n = 0 !! points of the history; 0: nothing is prescribed
        real(dp), allocatable :: time(:) !! (n) [s]
        real(dp), allocatable :: v(:, :) !! (3, n) [m/s]
        character(32) :: id = '' !! of a &motion
        logical :: along(3) = .true. !! axes along which it is prescribed
        real(dp) :: mass = 0 !! of the particles that are driven [kg]
        real(dp) :: force(3) = 0 !! of the body on them at the step [N]
        real(dp) :: reaction_force(3) = 0 !! of a region: the same with its load [N]
    end type motion_t

contains

    !> Velocity at a time; constant before the first point and after the last.
    pure function velocity_of(motion, time) result(v)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: time !! [s]
        real(dp) :: v(3)
        integer :: k

        k = count(motion%time(:motion%n) <= time)
        if (k == 0) then
            v = motion%v(:, 1)
        else if (k == motion%n) then
            v = motion%v(:, k)
        else
            v = motion%v(:, k) + (motion%v(:, k + 1) - motion%v(:, k)) &
                *((time - motion%time(k))/(motion%time(k + 1) - motion%time(k)))
        end if
    end function velocity_of

    !> Mean over a time step: exactly the displacement over dt.
    pure function mean_velocity(motion, time, dt) result(v)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: time, dt !! start and length of the step [s]
        real(dp) :: v(3)
        real(dp) :: a, b
        integer :: k

        v = 0
        a = time
        do k = 1, motion%n + 1
            b = time + dt
            if (k <= motion%n) b = min(b, max(a, motion%time(k)))
            if (b <= a) cycle
            v = v + (b - a)/dt*velocity_of(motion, (a + b)/2)
            a = b
        end do
    end function mean_velocity
end module brz_motion
