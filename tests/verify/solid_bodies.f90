! SPDX-License-Identifier: MIT
!> Problems of whole bodies: rings that collide, a bar pulled to failure, aluminium through
!> aluminium.
module solid_bodies
    use brz_body_setup, only: set_up_solid
    use brz_errors, only: failed
    use brz_kinds, only: dp, rk
    use brz_bodies, only: bodies_t
    use solid_scenes, only: advance, begin, choose, finish, form_t, metal, solid_scene_t, &
        solid_result_t
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: ring_form_t, rings, torn_t, torn_bar, hole, sound_pieces

    real(dp), parameter :: pi = acos(-1.0_dp)

    type :: ring_form_t
        integer :: pieces = 0
        real(dp) :: rebound = 0 !! velocity of the centre of the ring after over that before
        real(dp) :: momentum = 0 !! change over that of one ring
        real(dp) :: energy = 0 !! error of the total over the energy at the start
        real(dp) :: apart = 0 !! least distance of the rings at the end, in spacings
    end type ring_form_t

    type :: torn_t
        real(dp) :: strain = 0, energy = 0 !! of the middle at failure, over the exact ones
        real(dp) :: failed = 0 !! part of the particles that failed
        integer :: pieces = 0
        integer :: sound = 0 !! pieces of metal that has not failed; all others are rubble
    end type torn_t

contains

    !> Two rubber rings of radii 3 and 4 (Gray, Monaghan & Swift 2001: G/K = 0.22) that meet, each
    !> with `speed` over the bulk sound speed; the halves above their axis, until they have parted.
    subroutine rings(form, speed, across, found, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: speed
        integer, intent(in) :: across !! particles across a ring
        type(ring_form_t), intent(out) :: found
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        type(solid_totals_t) :: t0, t1, left
        integer :: b

        call metal(s%case, 'linear_elastic', [character(24) :: 'density', 'bulk_modulus', &
                                              'shear_modulus'], [1.0_dp, 1.0_dp, 0.22_dp])
        s%case%run%dimension = 2
        s%case%run%symmetry(2) = .true.
        deallocate (s%case%bodies)
        allocate (s%case%bodies(2), s%case%interactions(0))
        do b = 1, 2
            associate (body => s%case%bodies(b))
                body%id = achar(iachar('a') + b - 1)
                body%material_index = 1
                body%shape = 'cylinder'
                body%centre = [real(8*b - 12, dp) + 0.5_dp*(2*b - 3), 0.0_dp, 0.5_dp]
                body%radius = 4
                body%inner_radius = 3
                body%length = 1
                body%spacing = 1.0_dp/across
                body%velocity(1) = -(2*b - 3)*speed
            end associate
        end do
        call choose(s%case, form)
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        call solid_totals(s%solid, 0, t0)
        call solid_totals(s%solid, 1, left)
        call advance(s, 0.5_dp/speed + 160)
        call finish(s, seen)
        call solid_totals(s%solid, 0, t1)
        found%momentum = norm2(t1%momentum(1:1) - t0%momentum(1:1))/abs(left%momentum(1))
        found%rebound = -left%momentum(1)
        call solid_totals(s%solid, 1, left)
        found%rebound = left%momentum(1)/found%rebound
        found%energy = seen%energy
        found%pieces = pieces(s%solid, 1.6_dp)
        found%apart = across*(minval(s%solid%x(1, :), mask=owner(s%solid) == 2) &
                              - maxval(s%solid%x(1, :), mask=owner(s%solid) == 1))
    end subroutine rings

    !> A bar of a metal that hardens linearly, Y = a + b eps_p, and fails at eps_p = 0.3, drawn at
    !> both ends at a strain rate of 3000 1/s; an eighth of it. In uniaxial stress, at failure:
    !> strain 0.3 + Y/E, energy 0.3 a + 0.3^2 b/2 + Y^2/2E per volume. Told of the middle half, when
    !> the first particle fails, over these; it necks at a strain of 0.8 only.
    subroutine torn_bar(form, across, found, seen)
        type(form_t), intent(in) :: form
        integer, intent(in) :: across !! particles per half thickness
        type(torn_t), intent(out) :: found
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        real(dp), parameter :: half = 0.02_dp, rate = 3e3_dp, a = 100e6_dp, b = 500e6_dp, &
                               last = 0.3_dp, shear = 26e9_dp, rho = 2700, sound = 5000
        real(dp) :: young, y, volume
        logical, allocatable :: middle(:)

        call metal(s%case, 'johnson_cook', [character(24) :: 'density', 'shear_modulus', 'a', 'b', &
                   'n', 'c', 'm', 'melt_temperature', 'specific_heat', 'sound_speed', 's1', &
                   'gruneisen_gamma', 'd1'], [rho, shear, a, b, 1.0_dp, 0.0_dp, 1.0_dp, &
                   1000.0_dp, 1e7_dp, sound, 1.4_dp, 0.0_dp, last])
        s%case%run%dimension = 3
        s%case%run%symmetry = .true.
        associate (body => s%case%bodies(1))
            body%spacing = 0.002_dp/across
            body%lo = -[half + 3*body%spacing, 0.002_dp, 0.002_dp]
            body%hi = -body%lo
            body%fix(1) = 'x+'
            body%n_motion = 1
            body%motion_velocity(1, 1) = rate*half
        end associate
        call choose(s%case, form)
        call set_up_solid(s%case, s%solid, s%err)
        s%solid%v(1, :) = real(min(rate*s%solid%x(1, :), rate*half), rk)
        call begin(s)
        do while (maxval(s%solid%damage) < 1 .and. s%time < 0.5_dp/rate .and. .not. failed(s%err))
            call advance(s, s%time + 1e-3_dp/rate)
        end do
        allocate (middle(s%solid%n), source=s%solid%x_ref(1, :) < half/2)
        young = rho*sound**2
        young = 9*young*shear/(3*young + shear)
        y = a + b*last
        found%strain = log(sum(s%solid%x(1, :), middle)/sum(s%solid%x_ref(1, :), middle)) &
                       /(last + y/young)
        volume = sum(real(s%solid%mass, dp), middle)/rho
        found%energy = sum(real(s%solid%mass*s%solid%energy, dp), middle)/volume &
                       /(last*a + last**2*b/2 + y**2/(2*young))
        call advance(s, s%time + 20e-6_dp)
        call finish(s, seen)
        found%pieces = pieces(s%solid, 1.6_dp)
        found%sound = sound_pieces(s%solid)
        found%failed = real(count(s%solid%damage >= 1), dp)/s%solid%n
    end subroutine torn_bar

    !> Aluminium cylinder of 10 mm through an aluminium plate of 2 mm at 3.1 km/s, in plane strain,
    !> the half above its axis: the hole in the plate [m], twice the least height of the particles
    !> that still hang together with its outer end.
    subroutine hole(form, spacing, cutoff, times, holes, seen)
        type(form_t), intent(in) :: form
        real(dp), intent(in) :: spacing !! [m]
        real(dp), intent(in) :: cutoff !! least pressure [Pa]
        real(dp), intent(in) :: times(:) !! [s]
        real(dp), intent(out) :: holes(:)
        type(solid_result_t), intent(out) :: seen
        type(solid_scene_t) :: s
        integer, allocatable :: heap(:)
        integer :: k, outer

        call metal(s%case, 'gruneisen', [character(24) :: 'density', 'sound_speed', 's1', &
                   'gruneisen_gamma', 'shear_modulus', 'yield_stress', 'pressure_cutoff'], &
                   [2785.0_dp, 5328.0_dp, 1.338_dp, 2.0_dp, 27.6e9_dp, 0.3e9_dp, cutoff])
        s%case%run%dimension = 2
        s%case%run%symmetry(2) = .true.
        deallocate (s%case%bodies)
        allocate (s%case%bodies(2), s%case%interactions(0))
        s%case%bodies%id = [character(8) :: 'cylinder', 'plate']
        s%case%bodies%material_index = 1
        s%case%bodies%spacing = spacing
        s%case%bodies(1)%shape = 'cylinder'
        s%case%bodies(1)%centre = [-5e-3_dp - spacing/2, 0.0_dp, 0.5_dp]
        s%case%bodies(1)%radius = 5e-3_dp
        s%case%bodies(1)%length = 1
        s%case%bodies(1)%velocity(1) = 3100
        s%case%bodies(2)%lo = [spacing/2, -0.03_dp, 0.0_dp]
        s%case%bodies(2)%hi = [2e-3_dp + spacing/2, 0.03_dp, 1.0_dp]
        call choose(s%case, form)
        call set_up_solid(s%case, s%solid, s%err)
        call begin(s)
        allocate (heap(s%solid%n))
        holes = 0
        do k = 1, size(times)
            call advance(s, times(k))
            if (failed(s%err)) exit
            outer = maxloc(s%solid%x_ref(2, :), 1, owner(s%solid) == 2)
            call heaps(s%solid, 1.6_dp, heap)
            holes(k) = 2*minval(s%solid%x(2, :), mask=heap == heap(outer)) - spacing
        end do
        call finish(s, seen)
    end subroutine hole

    !> Body of each particle.
    pure function owner(solid) result(body)
        class(bodies_t), intent(in) :: solid
        integer :: body(solid%n), b

        do b = 1, size(solid%bodies)
            body(solid%bodies(b)%first:solid%bodies(b)%last) = b
        end do
    end function owner

    !> Heaps of particles of one body that hang together by distances below `reach` spacings.
    integer function pieces(solid, reach)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(in) :: reach
        integer :: heap(solid%n)

        call heaps(solid, reach, heap)
        pieces = maxval(heap)
    end function pieces

    !> Pieces in which there is metal that is less than half damaged.
    integer function sound_pieces(solid)
        class(bodies_t), intent(in) :: solid
        integer :: heap(solid%n), k

        call heaps(solid, 1.6_dp, heap)
        sound_pieces = count([(any(heap == k .and. solid%damage < 0.5_rk), k=1, maxval(heap))])
    end function sound_pieces

    !> Number of the heap of each particle.
    subroutine heaps(solid, reach, heap)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(in) :: reach
        integer, intent(out) :: heap(:)
        integer :: queue(solid%n), b, i, j, n, head, tail

        n = 0
        heap = 0
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                if (heap(i) > 0) cycle
                n = n + 1
                heap(i) = n
                queue(1) = i
                head = 1
                tail = 1
                do while (head <= tail)
                    do j = solid%bodies(b)%first, solid%bodies(b)%last
                        if (heap(j) > 0) cycle
                        if (norm2(solid%x(:, j) - solid%x(:, queue(head))) &
                            > reach*solid%bodies(b)%spacing) cycle
                        heap(j) = n
                        tail = tail + 1
                        queue(tail) = j
                    end do
                    head = head + 1
                end do
            end do
        end do
    end subroutine heaps
end module solid_bodies
