! SPDX-License-Identifier: MIT
!> The problems of the stability map and of the speed-accuracy chart.
module solid_problems
    use brz_body_setup, only: set_up_solid
    use brz_case, only: case_t
    use brz_errors, only: failed
    use brz_kinds, only: dp, rk
    use solid_scenes, only: advance, begin, choose, elastic, finish, form_t, metal, noise, &
                            solid_scene_t, solid_result_t
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: spin, cantilever, patch, zigzag, pulled_bar, planar_impact, plate, taylor_bar

    real(dp), parameter :: pi = acos(-1.0_dp)

contains

    !> A soft square that spins freely: what it lost of its angular momentum.
    subroutine spin(form, rate, turns, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: rate, turns
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        type(solid_totals_t) :: t0, t1

        call elastic(s%case, 1100.0_dp, 17e6_dp, 0.45_dp)
        call choose(s%case, form)
        s%case%bodies(1)%lo = -0.5_dp
        s%case%bodies(1)%hi = 0.5_dp
        s%case%bodies(1)%spacing = 0.05_dp
        s%case%bodies(1)%spin(3) = rate
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        call solid_totals(s%solid, 0, t0)
        call advance(s, turns*2*pi/rate)
        call solid_totals(s%solid, 0, t1)
        call finish(s, seen)
        seen%value = abs(1 - t1%angular(3)/t0%angular(3))
    end subroutine spin

    !> Cantilever in its first mode: error of its period against the converged 0.256 s.
    subroutine cantilever(form, across, seen)
        type(form_t), intent(in) :: form
        integer, intent(in) :: across !! particles across
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        real(dp) :: d, y, y_old, zero
        integer :: i, tip, n

        call elastic(s%case, 1000.0_dp, 2e6_dp, 0.3975_dp)
        call choose(s%case, form)
        d = 0.02_dp/across
        s%case%bodies(1)%spacing = d
        s%case%bodies(1)%lo = [-5*d, -0.01_dp, 0.0_dp]
        s%case%bodies(1)%hi = [0.2_dp, 0.01_dp, 1.0_dp]
        s%case%bodies(1)%fix(1) = 'x-'
        s%case%bodies(1)%fix_layers = 5
        if (form%wide > 1) then
            s%case%bodies(1)%lo(1) = -held_in(0.2_dp, form%wide*d)
            s%case%bodies(1)%fix_layers = 3
        end if
        call set_up_solid(s%case, s%solid, s%err)
        do i = 1, s%solid%n
            if (s%solid%fixed(i) == 0) s%solid%v(2, i) = real(0.05_dp*sqrt(2e6_dp/0.615_dp/1000) &
                *mode(1.875_dp*s%solid%x(1, i)/0.2_dp)/mode(1.875_dp), rk)
        end do
        call begin(s)
        tip = maxval(s%solid%id, mask=abs(s%solid%x(2, :)) < 0.6_dp*d)
        y_old = 0
        n = 0
        zero = 0
        do while (s%time < 0.4_dp .and. n < 2 .and. .not. failed(s%err))
            call advance(s, s%time + 1e-4_dp)
            i = findloc(s%solid%id, tip, 1)
            y = s%solid%x(2, i) - s%solid%x_ref(2, i)/s%solid%bodies(1)%stretch(2)
            if (y*y_old < 0) n = n + 1
            zero = s%time
            if (y*y_old < 0) zero = s%time - 1e-4_dp*y/(y - y_old)
            y_old = y
        end do
        call finish(s, seen)
        seen%value = zero/0.256_dp - 1
    end subroutine cantilever

    !> Shape of the first mode of a clamped beam, up to a factor, at k x.
    pure real(dp) function mode(q)
        real(dp), intent(in) :: q
        real(dp), parameter :: e = 1.875_dp

        mode = (cos(e) + cosh(e))*(cosh(q) - cos(q)) + (sin(e) - sinh(e))*(sinh(q) - sin(q))
    end function mode

    !> A square held all around, stretched and disturbed: what is left of the disturbance after a
    !> time of 400 spacings over sound speed, and at most in between.
    subroutine patch(form, stretch, seen, most)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: stretch
        type(solid_result_t), intent(out) :: seen
        real(dp), intent(out), optional :: most !! kinetic energy over that at the start
        type(solid_scene_t) :: s
        type(solid_totals_t) :: t0, t1
        real(rk) :: e, k, g, r(3)
        integer :: i

        if (present(most)) most = 0
        call elastic(s%case, 1.0_dp, 1.0_dp, 0.3_dp)
        call choose(s%case, form)
        s%case%bodies(1)%lo = [-10.0_dp, -10.0_dp, 0.0_dp]
        s%case%bodies(1)%hi = [10.0_dp, 10.0_dp, 1.0_dp]
        s%case%bodies(1)%spacing = 1
        s%case%bodies(1)%fix(1:4) = [character(32) :: 'x-', 'x+', 'y-', 'y+']
        call set_up_solid(s%case, s%solid, s%err)
        e = log(real(stretch, rk))
        k = s%solid%materials(1)%bulk
        g = s%solid%materials(1)%shear
        s%solid%x(1:2, :) = stretch*s%solid%x(1:2, :)
        s%solid%mu = real(stretch, rk)**(-2) - 1
        do i = 1, s%solid%n
            s%solid%stress(1:2, i) = -k*s%solid%mu(i) + 2*g*e/3
            s%solid%stress(3, i) = -k*s%solid%mu(i) - 4*g*e/3
            s%solid%energy(i) = k*s%solid%mu(i)**2/2 + 2*g*e**2/3
            r = noise(i)
            if (s%solid%fixed(i) == 0) s%solid%v(1:2, i) = 1e-4_rk*r(1:2)
        end do
        call begin(s)
        call solid_totals(s%solid, 0, t0)
        do i = 1, 400
            call advance(s, i/real(s%solid%materials(1)%c_wave, dp))
            call solid_totals(s%solid, 0, t1)
            if (present(most)) most = max(most, t1%kinetic/t0%kinetic)
        end do
        call finish(s, seen)
        seen%value = t1%kinetic/t0%kinetic
    end subroutine patch

    !> A velocity that changes sign from particle to particle has no gradient: what is left of it
    !> after a time of 20 spacings over sound speed.
    subroutine zigzag(form, seen)
        type(form_t), intent(in) :: form
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        type(solid_totals_t) :: t0, t1
        integer :: i

        call elastic(s%case, 1.0_dp, 1.0_dp, 0.3_dp)
        call choose(s%case, form)
        s%case%bodies(1)%hi = [30.0_dp, 30.0_dp, 1.0_dp]
        s%case%bodies(1)%spacing = 1
        s%case%bodies(1)%alpha = 0
        call set_up_solid(s%case, s%solid, s%err)
        do i = 1, s%solid%n
            s%solid%v(1, i) = 1e-3_rk*(-1)**(int(s%solid%x(1, i)) + int(s%solid%x(2, i)))
        end do
        call begin(s)
        call solid_totals(s%solid, 0, t0)
        call advance(s, 20/real(s%solid%materials(1)%c_wave, dp))
        call solid_totals(s%solid, 0, t1)
        call finish(s, seen)
        seen%value = t1%kinetic/t0%kinetic
    end subroutine zigzag

    !> A free elastic bar that stretches and comes back: longest distance of neighbours over the
    !> mean one, at its largest.
    subroutine pulled_bar(form, strain, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: strain !! about the largest in the middle
        type(solid_result_t), intent(out) :: seen
        type(solid_result_t) :: last
        type(solid_scene_t) :: s
        real(dp) :: worst, t_end
        integer :: i

        call elastic(s%case, 1.0_dp, 1.0_dp, 0.3_dp)
        call choose(s%case, form)
        s%case%bodies(1)%lo = [-30.0_dp, -3.0_dp, 0.0_dp]
        s%case%bodies(1)%hi = [30.0_dp, 3.0_dp, 1.0_dp]
        s%case%bodies(1)%spacing = 1
        call set_up_solid(s%case, s%solid, s%err)
        do i = 1, s%solid%n
            s%solid%v(1, i) = real(strain*sin(pi*s%solid%x(1, i)/60), rk)
        end do
        call begin(s)
        t_end = 60
        worst = 0
        do i = 1, 12
            call advance(s, i*t_end/12)
            call finish(s, last)
            if (last%longest > worst) seen = last
            worst = max(worst, last%longest)
        end do
        seen%ended = last%ended
        seen%energy = last%energy
        seen%seconds = last%seconds
        seen%value = worst
    end subroutine pulled_bar

    !> Aluminium at 1 km/s against its mirror image: error of the pressure behind the shock.
    subroutine planar_impact(form, spacing, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: spacing !! [m]
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        real(dp), parameter :: us = 5328 + 1.338_dp*1000, up = 1000
        real(dp) :: front, p, most
        integer :: i, n

        call metal(s%case, 'gruneisen', [character(24) :: 'density', 'sound_speed', 's1', &
                   'gruneisen_gamma', 'shear_modulus', 'yield_stress'], &
                   [2785.0_dp, 5328.0_dp, 1.338_dp, 2.0_dp, 27.6e9_dp, 0.29e9_dp])
        call choose(s%case, form)
        s%case%run%dimension = 1
        s%case%run%symmetry(1) = .true.
        s%case%bodies(1)%hi = [0.03_dp, 1.0_dp, 1.0_dp]
        s%case%bodies(1)%spacing = spacing
        s%case%bodies(1)%velocity(1) = -up
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        call advance(s, 0.7_dp*0.03_dp/us)
        call finish(s, seen)
        front = (us - up)*s%time
        p = 0
        n = 0
        do i = 1, s%solid%n
            if (s%solid%x(1, i) < 0.2_dp*front .or. s%solid%x(1, i) > 0.6_dp*front) cycle
            p = p - sum(s%solid%stress(1:3, i))/3
            n = n + 1
        end do
        p = p/max(n, 1)
        most = maxval(-sum(s%solid%stress(1:3, :), 1)/3)/(2785*us*up)
        seen%value = p/(2785*us*up) - 1
        if (most > 1.1_dp) seen%value = most - 1
    end subroutine planar_impact

    !> Clamped square plate as a quarter: twice the time of its first half swing over the exact
    !> period, less 1. The swing is that of the deflection weighted with the velocity at the start,
    !> in which higher modes count with the square of their share. Without plies isotropic, side 20
    !> thicknesses, against Mindlin's theory; else 3, 5 or 7 plies of carbon fibre at 0, 90, 0, ...
    !> degrees, side 10, against elasticity in space (studies/plate_reference.py, extrapolated).
    !> Glued, each ply is a body of its own.
    subroutine plate(form, layers, seen, plies, glued)
        type(form_t), intent(in) :: form
        integer, intent(in) :: layers
        type(solid_result_t), intent(out) :: seen
        integer, intent(in), optional :: plies
        logical, intent(in), optional :: glued
        type(solid_scene_t) :: s
        real(dp) :: w, w_old, exact, step, side, a, stretch(3)
        integer :: i, n
        real(dp), parameter :: omega(0:7) = [10.586_dp, 0.0_dp, 0.0_dp, 4.084_dp, 0.0_dp, &
                                             4.338_dp, 0.0_dp, 4.433_dp]

        n = 0
        if (present(plies)) n = plies
        a = merge(10, 20, n > 0)
        call elastic(s%case, 1.0_dp, 1.0_dp, 0.3_dp)
        if (n > 0) then
            call metal(s%case, 'orthotropic_ply', [character(24) :: 'density', 'e1', 'e2', 'e3', &
                       'nu12', 'nu13', 'nu23', 'g12', 'g13', 'g23'], [1.0_dp, 1.0_dp, &
                       8.2_dp/150, 8.2_dp/150, 0.34_dp, 0.34_dp, 0.53_dp, 4.34_dp/150, &
                       4.34_dp/150, 2.7_dp/150])
            s%case%bodies(1)%n_plies = n
            s%case%bodies(1)%ply_angle(2:n:2) = 90
        end if
        call choose(s%case, form)
        s%case%run%dimension = 3
        s%case%run%symmetry(1:2) = .true.
        s%case%bodies(1)%spacing = 1.0_dp/layers
        side = a/2 + 3.0_dp/layers
        s%case%bodies(1)%aspect(2) = form%wide
        if (form%wide > 1) side = a/2 + held_in(a/2, form%wide/layers)
        s%case%bodies(1)%lo = [-side, -side, -0.5_dp]
        s%case%bodies(1)%hi = -s%case%bodies(1)%lo
        s%case%bodies(1)%fix(1) = 'sides'
        if (present(glued)) call part_plies(s%case, n)
        call set_up_solid(s%case, s%solid, s%err)
        do i = 1, s%solid%n
            if (s%solid%fixed(i) == 0) &
                s%solid%v(3, i) = real(1e-3_dp*clamped(s%solid%x(:, i)/a), rk)
        end do
        call begin(s)
        stretch = s%solid%bodies(1)%stretch
        exact = 2*pi*a**2/omega(n)
        step = exact/200
        w = 0
        do while (s%time < 0.8_dp*exact .and. w >= 0 .and. .not. failed(s%err))
            w_old = w
            call advance(s, s%time + step)
            w = 0
            do i = 1, s%solid%n
                if (s%solid%fixed(i) == 0) w = w + clamped(s%solid%x_ref(:, i)/stretch/a) &
                                               *(s%solid%x(3, i) - s%solid%x_ref(3, i)/stretch(3))
            end do
        end do
        call finish(s, seen)
        seen%value = 2*(s%time - step*w/(w - w_old))/exact - 1
    end subroutine plate

    !> Depth of three held layers of wide particles behind an edge at which an elastic clamp then
    !> acts, 0.28 widths within them, for a free length in whole layers.
    pure real(dp) function held_in(free, width) result(depth)
        real(dp), intent(in) :: free, width !! [m]

        depth = 2.22_dp*free/(nint(free/width + 2.22_dp) - 2.22_dp)
    end function held_in

    !> A laminate as bodies of one ply each, glued by what never breaks.
    subroutine part_plies(case, n)
        type(case_t), intent(inout) :: case
        integer, intent(in) :: n
        integer :: p

        associate (whole => case%bodies(1))
            case%bodies = [(whole, p=1, n)]
        end associate
        do p = 1, n
            associate (body => case%bodies(p))
                body%lo(3) = -0.5_dp + real(p - 1, dp)/n
                body%hi(3) = -0.5_dp + real(p, dp)/n
                body%n_plies = 1
                body%ply_angle(1) = merge(90, 0, mod(p, 2) == 0)
                body%id = achar(iachar('a') + p)
            end associate
        end do
        allocate (case%interactions(1))
        associate (cohesive => case%interactions(1))
            cohesive%law = 'cohesive'
            cohesive%tensile_strength = 1e3_dp
            cohesive%shear_strength = 1e3_dp
            cohesive%gi = 1e9_dp
            cohesive%gii = 1e9_dp
        end associate
    end subroutine part_plies

    !> About the shape of the first mode of a clamped plate, at x over the side.
    pure real(dp) function clamped(x)
        real(dp), intent(in) :: x(3)

        clamped = cos(pi*x(1))**2*cos(pi*x(2))**2
    end function clamped

    !> Bar of 42CrMo4 against a wall at 287 m/s: the larger of the errors of its length (26.52 mm)
    !> and of the diameter of its foot (11.15 mm), after 80 us.
    subroutine taylor_bar(form, across, seen)
        type(form_t), intent(in) :: form
        integer, intent(in) :: across !! particles per radius
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        real(dp) :: length, foot, d

        call metal(s%case, 'johnson_cook', [character(24) :: 'density', 'shear_modulus', 'a', 'b', &
                   'n', 'c', 'm', 'melt_temperature', 'specific_heat', 'sound_speed', 's1', &
                   'gruneisen_gamma'], &
                   [7830.0_dp, 79.23e9_dp, 806e6_dp, 614e6_dp, 0.168_dp, 0.0089_dp, 1.1_dp, &
                    1813.0_dp, 460.0_dp, 4682.0_dp, 0.0_dp, 0.0_dp])
        call choose(s%case, form)
        d = 3.2e-3_dp/across
        s%case%run%dimension = 3
        s%case%run%symmetry = .true.
        s%case%bodies(1)%shape = 'cylinder'
        s%case%bodies(1)%centre(3) = 16.2e-3_dp
        s%case%bodies(1)%radius = 3.2e-3_dp
        s%case%bodies(1)%length = 32.4e-3_dp
        s%case%bodies(1)%spacing = d
        s%case%bodies(1)%velocity(3) = -287
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        call advance(s, 80e-6_dp)
        call finish(s, seen)
        length = maxval(s%solid%x(3, :)) + d/2
        foot = 2*sqrt(maxval(s%solid%x(1, :)**2 + s%solid%x(2, :)**2)) + d
        seen%value = length/26.52e-3_dp - 1
        if (abs(foot/11.15e-3_dp - 1) > abs(seen%value)) seen%value = foot/11.15e-3_dp - 1
    end subroutine taylor_bar
end module solid_problems
