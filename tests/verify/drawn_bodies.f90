! SPDX-License-Identifier: MIT
!> Bodies that are drawn: bars, a ring that flies apart, a notched strip. What parts may part only
!> where the material has failed.
module drawn_bodies
    use brz_body_setup, only: set_up_solid
    use brz_kinds, only: dp, rk
    use brz_particles, only: particles_t
    use brz_solid_state, only: solid_t
    use solid_bodies, only: sound_pieces
    use brz_errors, only: failed
    use brz_time_step, only: advance_scene => advance
    use scene_tools, only: deck_scene_t, open_scene
    use solid_scenes, only: advance, begin, choose, elastic, finish, form_t, solid_scene_t, &
        solid_result_t, total
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: elastic_bar, rebar_t, rebar, ring_t, ring, strip, crack

    real(dp), parameter :: young = 200e9_dp, yield = 500e6_dp, tangent = 1.5e9_dp
    real(dp), parameter :: cowper_d = 40.4_dp, cowper_p = 5 !! of the preset rebar

    type :: rebar_t
        real(dp) :: stress = 0 !! of its middle over that of its law
        real(dp) :: force = 0 !! at its end, from the work there, over that of its law
        real(dp) :: energy = 0 !! error of the total over the work
        real(dp) :: hourglass = 0 !! energy that the tensile control has, over the work
        logical :: ended = .false. !! the program stopped with an error
    end type rebar_t

    type :: ring_t
        integer :: pieces = 0 !! heaps of metal that has not failed
        real(dp) :: through = 0 !! failed particles for each of them over the layers of the ring
        real(dp) :: energy = 0 !! error of the total over the kinetic energy at the start
        real(dp) :: angular = 0 !! change of the angular momentum over mass, radius and speed
        logical :: ended = .false. !! the program stopped with an error
    end type ring_t

contains

    !> An elastic bar in plane strain, E = 10 GPa, drawn to 1.8 % in 1 ms; half of it. Found: mean
    !> stress of its middle over the exact one, E/(1 - nu^2) times the strain.
    subroutine elastic_bar(form, spacing, found, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: spacing !! [m]
        real(dp), intent(out) :: found
        type(solid_result_t), intent(out) :: seen
        real(dp), parameter :: half = 0.05_dp, last = 0.018_dp, time = 1e-3_dp
        type(solid_scene_t) :: s
        logical, allocatable :: middle(:)
        real(dp) :: strain

        call elastic(s%case, 2400.0_dp, 10e9_dp, 0.3_dp)
        s%case%run%symmetry(1) = .true.
        associate (body => s%case%bodies(1))
            body%lo = [-half - 3*spacing, -0.01_dp, 0.0_dp]
            body%hi = [half + 3*spacing, 0.01_dp, 1.0_dp]
            body%spacing = spacing
            body%fix(1) = 'x+'
            body%n_motion = 1
            body%motion_velocity(1, 1) = last*half/time
        end associate
        call choose(s%case, form)
        call set_up_solid(s%case, s%solid, s%err)
        s%solid%v(1, :) = real(min(s%solid%x(1, :)/half, 1.0_dp)*last*half/time, rk)
        call begin(s)
        call advance(s, time)
        call finish(s, seen)
        allocate (middle(s%solid%n))
        call look(s%solid, half/2, middle, strain)
        found = sum(s%solid%stress(1, :), middle)/count(middle)/(10e9_dp/(1 - 0.3_dp**2)*strain)
        seen%energy = error_of_work(s%solid, s%energy)
    end subroutine elastic_bar

    !> Which particles lie within `far` of the plane x = 0 in the unloaded body, and their mean
    !> stretch less 1.
    subroutine look(solid, far, middle, strain)
        class(particles_t), intent(in) :: solid
        real(dp), intent(in) :: far !! [m]
        logical, intent(out) :: middle(:)
        real(dp), intent(out) :: strain

        middle = abs(solid%x_ref(1, :)) < far
        strain = sum(solid%x(1, :)*solid%x_ref(1, :), middle)/sum(solid%x_ref(1, :)**2, middle) - 1
    end subroutine look

    !> Error of the energy of a body that is driven, over the work on it.
    real(dp) function error_of_work(solid, start) result(error)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: start !! energy at the start [J]

        associate (work => sum(solid%bodies%account%drive))
            error = (total(solid) - start - work)/work
        end associate
    end function error_of_work

    !> A bar of reinforcing steel, drawn at a constant velocity of its end; the law is
    !> (Y + H eps_p)(1 + (rate/D)^(1/p)) in uniaxial stress.
    subroutine rebar(across, rate, last, changes, found)
        integer, intent(in) :: across !! particles
        real(dp), intent(in) :: rate !! of strain [1/s]
        real(dp), intent(in) :: last !! strain
        character(*), intent(in) :: changes !! of the deck
        type(rebar_t), intent(out) :: found
        real(dp), parameter :: half = 0.048_dp
        type(deck_scene_t) :: scene
        logical, allocatable :: middle(:)
        character(200) :: words
        real(dp) :: strain, start, d, from(2)

        d = 0.012_dp/across
        from = -1
        write (words, '(2(a, es10.4), a, es10.4, a)') 'body.spacing=', d, ' body.box=0,', &
            half + 3*d, ',-0.006,0.006,-0.006,0.006 body.motion_velocity=', rate*half, ',0,0 '
        call open_scene('rebar', trim(words)//' '//changes, scene)
        associate (sim => scene%sim, solid => scene%sim%solid)
            solid%v(1, :) = real(min(solid%x(1, :)/half, 1.0_dp)*rate*half, rk)
            start = total(solid)
            do while (sim%clock%time*rate < last)
                call advance_scene(sim, scene%err)
                if (failed(scene%err)) exit
                if (from(1) < 0 .and. sim%clock%time*rate > last/2) &
                    from = [sim%clock%time, sum(solid%bodies%account%drive)]
            end do
            found%ended = failed(scene%err)
            allocate (middle(solid%n))
            call look(solid, half/2, middle, strain)
            found%stress = sum(solid%stress(1, :), middle)/count(middle) &
                           /law(log(1 + strain), rate/(1 + strain))
            found%force = (sum(solid%bodies%account%drive) - from(2)) &
                          /((sim%clock%time - from(1))*rate*half*0.012_dp**2) &
                          /nominal(0.75_dp*last, rate)
            found%energy = error_of_work(solid, start)
            found%hourglass = sum(solid%bodies%account%hourglass)/sum(solid%bodies%account%drive)
        end associate
    end subroutine rebar

    !> True stress of reinforcing steel in uniaxial tension [Pa].
    pure real(dp) function law(strain, rate) result(s)
        real(dp), intent(in) :: strain, rate !! true ones
        integer :: pass

        s = yield
        do pass = 1, 50
            s = (yield + tangent*young/(young - tangent)*(strain - s/young)) &
                *(1 + (rate/cowper_d)**(1/cowper_p))
        end do
    end function law

    !> The same as force over the area of the undrawn bar, whose volume stays but for Poisson's
    !> ratio of 0.3 in what is elastic.
    pure real(dp) function nominal(strain, rate)
        real(dp), intent(in) :: strain, rate !! of the undrawn bar

        associate (s => law(log(1 + strain), rate/(1 + strain)))
            nominal = s/(1 + strain)*exp(0.4_dp*s/young)
        end associate
    end function nominal

    !> A ring of steel that flies apart at 600 m/s.
    subroutine ring(changes, layers, found)
        character(*), intent(in) :: changes !! of the deck
        integer, intent(in) :: layers
        type(ring_t), intent(out) :: found
        real(dp), parameter :: speed = 600
        type(deck_scene_t) :: scene
        real(dp) :: start
        integer :: i

        call open_scene('ring', changes, scene)
        associate (sim => scene%sim, solid => scene%sim%solid)
            do i = 1, solid%n
                solid%v(1:2, i) = real(speed*solid%x(1:2, i)/norm2(solid%x(1:2, i)), rk)
            end do
            start = total(solid)
            do while (sim%clock%time < sim%case%run%t_end)
                call advance_scene(sim, scene%err)
                if (failed(scene%err)) exit
            end do
            found%ended = failed(scene%err)
            found%pieces = sound_pieces(solid)
            found%through = real(count(solid%damage >= 1), dp)/max(found%pieces, 1)/layers
            found%energy = total(solid)/start - 1
            found%angular = 0
            do i = 1, solid%n
                found%angular = found%angular + solid%mass(i)*(solid%x(1, i)*solid%v(2, i) &
                                                               - solid%x(2, i)*solid%v(1, i))
            end do
            found%angular = found%angular/(sum(solid%mass)*0.1_dp*speed)
        end associate
    end subroutine ring

    !> A notched strip of concrete, drawn at a rate of 5 1/s until it has parted: its largest mean
    !> stress [Pa], and the work that its crack took [J/m], that of an error without end.
    subroutine strip(changes, peak, work)
        character(*), intent(in) :: changes !! of the deck
        real(dp), intent(out) :: peak, work
        real(dp), parameter :: half = 0.06_dp, notch = 0.02_dp
        type(deck_scene_t) :: scene
        type(solid_totals_t) :: t
        real(dp) :: start
        logical, allocatable :: far(:)
        integer :: i

        call open_scene('strip', changes, scene)
        associate (sim => scene%sim, solid => scene%sim%solid)
            do i = 1, solid%n
                solid%v(1, i) = real(min(solid%x(1, i)/half, 1.0_dp)*0.3_dp, rk)
                if (solid%x(1, i) < 2e-3_dp .and. solid%x(2, i) > 0.04_dp - notch) &
                    solid%damage(i) = 1
            end do
            call solid_totals(solid, 0, t)
            start = t%kinetic
            peak = 0
            do while (sim%clock%time < sim%case%run%t_end)
                call advance_scene(sim, scene%err)
                if (failed(scene%err)) exit
                far = solid%x_ref(1, :) > half/3 .and. solid%x_ref(1, :) < 2*half/3
                peak = max(peak, sum(real(solid%stress(1, :), dp), far)/count(far))
            end do
            call solid_totals(solid, 0, t)
            work = sum(solid%bodies%account%drive) + start - t%kinetic
            if (failed(scene%err)) work = huge(work)
        end associate
    end subroutine strip

    !> Work per area that a crack in concrete takes, over its fracture energy; and whether it ended.
    subroutine crack(changes, work, ended)
        character(*), intent(in) :: changes !! of the deck
        real(dp), intent(out) :: work
        logical, intent(out) :: ended !! with an error
        real(dp), parameter :: ligament = 0.012_dp, energy = 146.5_dp !! [m], [J/m2]
        type(deck_scene_t) :: scene

        call open_scene('notched_strip', changes, scene)
        associate (sim => scene%sim)
            do while (sim%clock%time < sim%case%run%t_end)
                call advance_scene(sim, scene%err)
                if (failed(scene%err)) exit
            end do
            work = 2*sim%solid%bodies(1)%account%drive/ligament/energy
            ended = failed(scene%err)
        end associate
    end subroutine crack
end module drawn_bodies
