! SPDX-License-Identifier: MIT
!> Clamped plates of metal under a pressure, from the scene clamped_plate.
module clamped_plates
    use brz_errors, only: failed
    use brz_kinds, only: dp
    use brz_particle_marks, only: is_fixed
    use brz_time_step, only: advance
    use scene_tools, only: deck_scene_t, open_scene
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: clamped_t, clamped_plate

    real(dp), parameter :: late = 400e-6_dp !! from when on it swings about what stays [s]

    type :: clamped_t
        real(dp) :: peak = 0 !! of the middle against the clamp [m]
        real(dp) :: peak_time = 0 !! [s]
        real(dp) :: back = 0 !! when it is first back [s]
        real(dp) :: stays = 0 !! mean from 400 us on [m]
        real(dp) :: energy = 0 !! error of the total over the work
    end type clamped_t

contains

    subroutine clamped_plate(changes, found)
        character(*), intent(in) :: changes !! of the deck
        type(clamped_t), intent(out) :: found
        type(deck_scene_t) :: scene
        real(dp) :: w(3), t(3), time

        call open_scene('clamped_plate', changes, scene)
        w = 0
        t = 0
        time = 0
        associate (sim => scene%sim)
            do while (sim%clock%time < sim%case%run%t_end)
                call advance(sim, scene%err)
                if (failed(scene%err)) error stop scene%err%text
                w = [w(2:3), deflection(scene)]
                t = [t(2:3), sim%clock%time]
                if (w(2) > max(w(1), w(3), found%peak)) call top(t, w, found%peak_time, found%peak)
                if (w(3) <= 0 .and. w(2) > 0 .and. found%back <= 0) &
                    found%back = t(2) + (t(3) - t(2))*w(2)/(w(2) - w(3))
                if (t(3) <= late) cycle
                found%stays = found%stays + w(3)*(t(3) - t(2))
                time = time + t(3) - t(2)
            end do
            if (time > 0) found%stays = found%stays/time
            found%energy = energy_error(scene)
        end associate
    end subroutine clamped_plate

    !> Of the middle, the particles nearest to the origin, against the clamp [m].
    real(dp) function deflection(scene)
        type(deck_scene_t), intent(in) :: scene
        real(dp) :: away(scene%sim%solid%n)
        logical :: middle(scene%sim%solid%n)
        integer :: held

        associate (solid => scene%sim%solid)
            away = sum(solid%x_ref**2, dim=1)
            middle = away < 1.000001_dp*minval(away)
            held = findloc(solid%fixed, is_fixed, dim=1)
            deflection = (solid%x(3, held) - solid%x_ref(3, held)) &
                         - sum(solid%x(3, :) - solid%x_ref(3, :), middle)/count(middle)
        end associate
    end function deflection

    !> Top of the parabola through three points.
    pure subroutine top(t, w, time, height)
        real(dp), intent(in) :: t(3), w(3)
        real(dp), intent(out) :: time, height
        real(dp) :: a, b

        a = ((w(3) - w(2))/(t(3) - t(2)) - (w(2) - w(1))/(t(2) - t(1)))/(t(3) - t(1))
        b = (w(3) - w(2))/(t(3) - t(2)) - a*(t(3) - t(2))
        time = t(2) - b/(2*a)
        height = w(2) - b**2/(4*a)
    end subroutine top

    real(dp) function energy_error(scene) result(error)
        type(deck_scene_t), intent(in) :: scene
        type(solid_totals_t) :: s

        call solid_totals(scene%sim%solid, 0, s)
        associate (work => sum(scene%sim%solid%bodies%account%drive))
            error = (s%kinetic + s%internal + s%hourglass - work)/work
        end associate
    end function energy_error
end module clamped_plates
