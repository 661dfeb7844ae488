! SPDX-License-Identifier: MIT
!> Bars that strike a rigid wall (Taylor's test), by particles.
!>
!> A quarter of the bar; the wall is the plane of symmetry z = 0: no friction, and the bar stays on
!> it. The surface is told from the outer ring of particles: each layer has its mean r/R, times R0.
module taylor_bars
    use brz_body_setup, only: set_up_solid
    use brz_kinds, only: dp
    use solid_scenes, only: advance, begin, choose, finish, form_t, metal, solid_scene_t, &
        solid_result_t
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: bar_t, remains_t, copper, steel, particle_bar, measure

    !> A bar and the constants of Johnson and Cook for its metal, in SI units.
    type :: bar_t
        character(20) :: name = ''
        real(dp) :: radius, length, speed, time
        real(dp) :: density, shear, a, b, n, c, m, melt, heat !! of the deviator
        real(dp) :: sound, s1, gamma, first !! of the equation of state
    end type bar_t

    !> What is left of it.
    type :: remains_t
        real(dp) :: length = 0, foot = 0, bulge = 0 !! L/L0, D/D0, W(0.2 L0)/D0
        real(dp) :: viscous = 0, kinetic = 0, error = 0 !! energies over that of the start
        real(dp) :: hottest = 0, strain = 0 !! [K], largest plastic strain
        real(dp) :: seconds = 0
        real(dp), allocatable :: profile(:, :) !! (2, :) radius and height of the surface [m]
    end type remains_t

    !> OFHC copper: constants of Johnson & Cook 1983, equation of state of Steinberg; the bar of
    !> their experiment, 190 m/s.
    type(bar_t), parameter :: copper = bar_t('copper 190 m/s', 3.81e-3_dp, 25.4e-3_dp, 190.0_dp, &
        80e-6_dp, 8960.0_dp, 46e9_dp, 90e6_dp, 292e6_dp, 0.31_dp, 0.025_dp, 1.09_dp, 1356.0_dp, &
        383.0_dp, 3940.0_dp, 1.489_dp, 2.02_dp, 0.47_dp)
    !> 42CrMo4: the bar that DynELA and Abaqus have computed.
    type(bar_t), parameter :: steel = bar_t('42CrMo4 287 m/s', 3.2e-3_dp, 32.4e-3_dp, 287.0_dp, &
        80e-6_dp, 7830.0_dp, 79.23e9_dp, 806e6_dp, 614e6_dp, 0.168_dp, 0.0089_dp, 1.1_dp, &
        1813.0_dp, 460.0_dp, 4682.0_dp, 0.0_dp, 0.0_dp, 0.0_dp)

contains

    !> The same bar by Zerilli & Armstrong's law for copper where `za` holds c0, c2, c3, c4.
    subroutine particle_bar(bar, form, across, shape, seen, za)
        type(bar_t), intent(in) :: bar
        type(form_t), intent(in) :: form
        integer, intent(in) :: across !! particles per radius
        type(remains_t), intent(out) :: shape
        type(solid_result_t), intent(out) :: seen
        real(dp), intent(in), optional :: za(4)
        type(solid_scene_t) :: s
        type(solid_totals_t) :: t

        if (present(za)) then
            call metal(s%case, 'zerilli_armstrong', [character(24) :: 'density', &
                       'shear_modulus', 'c0', 'c2', 'c3', 'c4', 'melt_temperature', &
                       'specific_heat', 'sound_speed', 's1', 'gruneisen_gamma', 'gruneisen_a'], &
                       [bar%density, bar%shear, za, bar%melt, bar%heat, bar%sound, bar%s1, &
                        bar%gamma, bar%first])
        else
            call metal(s%case, 'johnson_cook', [character(24) :: 'density', 'shear_modulus', &
                       'a', 'b', 'n', 'c', 'm', 'melt_temperature', 'specific_heat', &
                       'sound_speed', 's1', 'gruneisen_gamma', 'gruneisen_a'], &
                       [bar%density, bar%shear, bar%a, bar%b, bar%n, bar%c, bar%m, bar%melt, &
                        bar%heat, bar%sound, bar%s1, bar%gamma, bar%first])
        end if
        call choose(s%case, form)
        s%case%run%dimension = 3
        s%case%run%symmetry = .true.
        associate (b => s%case%bodies(1))
            b%shape = 'cylinder'
            b%centre(3) = bar%length/2
            b%radius = bar%radius
            b%length = bar%length
            b%spacing = bar%radius/across
            b%velocity(3) = -bar%speed
        end associate
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        call solid_totals(s%solid, 0, t)
        shape%kinetic = t%kinetic
        call advance(s, bar%time)
        call finish(s, seen)
        call solid_totals(s%solid, 0, t)
        shape%viscous = sum(s%solid%bodies%account%viscous &
                            + s%solid%bodies%account%hourglass_heat)/shape%kinetic
        shape%kinetic = t%kinetic/shape%kinetic
        shape%error = seen%energy
        shape%seconds = seen%seconds
        shape%strain = maxval(s%solid%hist(1, :))
        shape%hottest = maxval(s%solid%hist(2, :))
        call outer_surface(s, bar, across, shape%profile)
        call measure(bar, shape)
        shape%length = (maxval(s%solid%x(3, :)) + bar%radius/across/2)/bar%length
    end subroutine particle_bar

    !> Layer by layer, R0 times the mean r/R of the particles within a spacing of the surface.
    subroutine outer_surface(s, bar, across, profile)
        type(solid_scene_t), intent(in) :: s
        type(bar_t), intent(in) :: bar
        integer, intent(in) :: across
        real(dp), allocatable, intent(out) :: profile(:, :)
        real(dp) :: d, r
        integer :: i, k, layers
        integer, allocatable :: ring(:)

        d = bar%radius/across
        layers = nint(bar%length/d)
        allocate (profile(2, layers), source=0.0_dp)
        allocate (ring(layers), source=0)
        do i = 1, s%solid%n
            r = norm2(s%solid%x_ref(1:2, i))
            if (r < bar%radius - d) cycle
            k = min(1 + int(s%solid%x_ref(3, i)/d), layers)
            ring(k) = ring(k) + 1
            profile(:, k) = profile(:, k) + [norm2(s%solid%x(1:2, i))/r*bar%radius, &
                                             s%solid%x(3, i)]
        end do
        profile(1, :) = profile(1, :)/ring
        profile(2, :) = profile(2, :)/ring
    end subroutine outer_surface

    !> Length, foot and bulge from the profile, from the foot upwards.
    subroutine measure(bar, shape)
        type(bar_t), intent(in) :: bar
        type(remains_t), intent(inout) :: shape
        real(dp) :: z
        integer :: k

        shape%length = maxval(shape%profile(2, :))/bar%length
        shape%foot = maxval(shape%profile(1, :))/bar%radius
        z = 0.2_dp*bar%length
        do k = 2, size(shape%profile, 2)
            associate (low => shape%profile(:, k - 1), high => shape%profile(:, k))
                if (low(2) < z .and. high(2) >= z) shape%bulge = &
                    (low(1) + (high(1) - low(1))*(z - low(2))/(high(2) - low(2)))/bar%radius
            end associate
        end do
    end subroutine measure
end module taylor_bars
