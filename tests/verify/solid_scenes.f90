! SPDX-License-Identifier: MIT
!> Scenes for the stability map and the speed-accuracy chart of the solids.
!>
!> Each runs one body in one formulation and says what was seen, in one number and a few measures
!> of its state.
module solid_scenes
    use brz_body_setup, only: set_up_solid
    use brz_case, only: case_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, rk
    use brz_bodies, only: bodies_t
    use brz_solid_state, only: solid_t
    use brz_solid_start, only: solid_time_step, start_solid
    use brz_solid_driver, only: solid_step
    use shared_steps, only: solid_totals, solid_totals_t
    implicit none
    private
    public :: form_t, solid_result_t, solid_scene_t, forms, elastic, metal, choose, begin, &
        advance, finish, total
    public :: noise

    !> A formulation as a deck would choose it.
    type :: form_t
        character(40) :: label = ''
        character(20) :: formulation = '', artificial = 'auto'
        real(dp) :: alpha = -1, beta = -1
        real(dp) :: zeta = -1 !! stiffness of the stiff hourglass force
        character(8) :: limiter = 'auto' !! of the viscosity
        real(dp) :: hold = -1 !! stiffness of the tensile control over the tension
        real(dp) :: wide = 1 !! width of a particle along the body over that across it
    end type form_t

    !> What was seen.
    type :: solid_result_t
        real(dp) :: value = 0 !! the number of the test
        real(dp) :: energy = 0 !! error of the total over the energy at the start
        real(dp) :: longest = 1, shortest = 1 !! distance of lattice neighbours over the spacing
        real(dp) :: seconds = 0 !! of one core
        real(dp) :: particle_steps = 0
        logical :: ended = .false. !! the program stopped with an error
    end type solid_result_t

    type :: solid_scene_t
        type(case_t) :: case
        type(solid_t) :: solid
        type(error_t) :: err
        real(dp) :: time = 0, dt = 0, start = 0, energy = 0
    end type solid_scene_t

    type(form_t), parameter :: forms(10) = [ &
                               form_t('uncorrected', 'uncorrected'), &
                               form_t('paper', 'paper'), &
                               form_t('uncorrected + gray', 'uncorrected', 'gray'), &
                               form_t('corrected', 'corrected'), &
                               form_t('corrected + gray', 'corrected', 'gray'), &
                               form_t('corrected_hourglass - hold', 'corrected_hourglass', &
                                      hold=0.0_dp), &
                               form_t('corrected_hourglass', 'corrected_hourglass'), &
                               form_t('bending', 'bending'), &
                               form_t('total_lagrangian', 'total_lagrangian'), &
                               form_t('total_lagrangian (aspect 3)', 'total_lagrangian', &
                                      wide=3.0_dp)]

contains

    !> One body of an elastic material in plane strain; its box and spacing are still to be given.
    subroutine elastic(case, density, young, poisson)
        type(case_t), intent(out) :: case
        real(dp), intent(in) :: density, young, poisson

        call metal(case, 'linear_elastic', [character(24) :: 'density', 'youngs_modulus', &
                                            'poisson_ratio'], [density, young, poisson])
        case%run%dimension = 2
    end subroutine elastic

    !> One body of any material.
    subroutine metal(case, model, keys, values)
        type(case_t), intent(out) :: case
        character(*), intent(in) :: model, keys(:)
        real(dp), intent(in) :: values(:)

        allocate (case%materials(1), case%bodies(1))
        case%solid%present = .true.
        associate (m => case%materials(1))
            m%model = model
            m%n = size(keys)
            allocate (m%key(m%n), m%value(m%n), m%word(m%n), m%given(m%n))
            m%key = keys
            m%value = values
            m%word = ''
            m%given = .true.
        end associate
        case%bodies(1)%id = 'body'
        case%bodies(1)%material_index = 1
    end subroutine metal

    !> Settings of a formulation.
    subroutine choose(case, form)
        type(case_t), intent(inout) :: case
        type(form_t), intent(in) :: form
        integer :: b

        do b = 1, size(case%bodies)
            case%bodies(b)%formulation = form%formulation
            case%bodies(b)%artificial_stress = form%artificial
            if (form%alpha >= 0) case%bodies(b)%alpha = form%alpha
            if (form%beta >= 0) case%bodies(b)%beta = form%beta
            if (form%zeta >= 0) case%bodies(b)%zeta = form%zeta
            case%bodies(b)%limiter = form%limiter
            case%bodies(b)%tensile_control = form%hold
            case%bodies(b)%aspect(1) = form%wide
        end do
    end subroutine choose

    !> Start the clock once the initial velocities are set.
    subroutine begin(s)
        type(solid_scene_t), intent(inout) :: s

        call start_solid(s%solid, s%err)
        s%energy = total(s%solid)
        s%time = 0
        call cpu_time(s%start)
    end subroutine begin

    subroutine advance(s, t_end)
        type(solid_scene_t), intent(inout) :: s
        real(dp), intent(in) :: t_end !! [s]

        do while (s%time < t_end .and. .not. failed(s%err))
            s%dt = min(solid_time_step(s%solid), t_end - s%time + 1e-9_dp*t_end)
            call solid_step(s%solid, s%dt, s%err)
            s%time = s%time + s%dt
        end do
    end subroutine advance

    !> What can be said of every scene at its end.
    subroutine finish(s, seen)
        type(solid_scene_t), intent(in) :: s
        type(solid_result_t), intent(inout) :: seen
        real(dp) :: scale, now

        call cpu_time(now)
        seen%seconds = now - s%start
        seen%particle_steps = real(s%solid%n, dp)*real(s%solid%steps, dp)
        seen%ended = failed(s%err)
        scale = max(abs(s%energy), abs(sum(s%solid%bodies%account%load)), tiny(scale))
        seen%energy = (total(s%solid) - sum(s%solid%bodies%account%load) - s%energy)/scale
        call links(s%solid, seen%longest, seen%shortest)
    end subroutine finish

    real(dp) function total(solid)
        type(solid_t), intent(in) :: solid
        type(solid_totals_t) :: t

        call solid_totals(solid, 0, t)
        total = t%kinetic + t%internal + t%hourglass + t%artificial + t%contact
    end function total

    !> Longest and shortest distance, over the spacing, of particles that were lattice neighbours.
    subroutine links(solid, longest, shortest)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(out) :: longest, shortest
        real(dp) :: d, y(3), far
        integer :: b, i, j

        longest = 0
        shortest = huge(shortest)
        do b = 1, size(solid%bodies)
            d = solid%bodies(b)%spacing
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                do j = solid%bodies(b)%first, i - 1
                    if (maxval(abs(solid%x_ref(:, i) - solid%x_ref(:, j))) > 1.1_dp*d) cycle
                    y = solid%x_ref(:, i) - solid%x_ref(:, j)
                    if (norm2(y) > 1.1_dp*d) cycle
                    far = norm2(solid%x(:, i) - solid%x(:, j))/d &
                          *(norm2(y)/norm2(y/solid%bodies(b)%stretch))
                    longest = max(longest, far)
                    shortest = min(shortest, far)
                end do
            end do
        end do
    end subroutine links

    !> The same pseudo-random numbers on every machine, in -1..1.
    pure function noise(i) result(r)
        integer, intent(in) :: i
        real(rk) :: r(3)

        r = real(2*modulo(43758.5453_dp*sin([12.9898_dp, 78.233_dp, 37.719_dp]*i), 1.0_dp) - 1, rk)
    end function noise
end module solid_scenes
