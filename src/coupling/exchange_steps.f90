! SPDX-License-Identifier: MIT
!> What the coupling does in a step, on one process and on several: velocities of the walls, loads
!> of the particles, cells that change hands. scripts/steps.py writes the same for the GPU.
module brz_exchange_steps
    use brz_air_state, only: air_t
    use brz_carrier_steps, only: sum_loads
    use brz_coupling_guests, only: see_window !@cpu
    use brz_coupling_state, only: coupling_t
    use brz_coupling_steps, only: find_velocities
    use brz_event_steps, only: move_on
    use brz_guest_steps, only: invite_guests, send_loads_home
    use brz_kinds, only: dp, int64
    use brz_lists, only: at_least, clear_list, read_first
    use brz_load_loops, only: each_feel_load
    use brz_ranks, only: several, sum_of_all
    use brz_shared_steps, only: share_debts, share_impulses
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: solid_t
    use brz_velocity_loops, only: each_keep_velocity
    use brz_wall_steps, only: keep_velocities, press_bodies, stress_faces
    implicit none
    private
    public :: set_wall_velocity, spread_load, load_carriers, wake_loaded, reclassify

contains

    !> Velocities of the walls in the middle of the coming step, from the particles in the solid
    !> cells. On several processes `crowd` has the bodies of the guests.
    subroutine set_wall_velocity(air, solid, p, c, dt)
        type(air_t), intent(in) :: air
        class(solid_t), intent(in) :: solid !! its bodies
        type(solid_t), intent(in) :: p !! its particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]

        if (several(solid%ranks)) then
            associate (before => c%guests%v_before, seat => c%part%seat)
                call find_velocities(air, c%crowd, c%guests, c, dt, before, seat)
            end associate
        else
            call find_velocities(air, solid, p, c, dt, c%v_before, p%id)
            call keep_velocities(p, c)
        end if
        c%dt_before = dt
    end subroutine set_wall_velocity

    !> Turn the impulses of the wall faces, reference pressure taken off, into forces on particles.
    !>
    !> The forces of a face add up to its impulse over dt. The columns are those of
    !> set_wall_velocity, before the step of the air.
    subroutine spread_load(solid, p, c, dt)
        class(solid_t), intent(inout) :: solid !! its rigid bodies get their loads
        type(solid_t), intent(inout) :: p !! its particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]

        if (several(solid%ranks)) then
            ! the guests keep theirs when they are renewed
            call each_keep_velocity(p%n, p%wide, p%step_d, p%step_p, p%v, c%part%seat, p%v_before)
            call share_impulses(c)
            call press_bodies(c%guests, c, dt)
            call stress_faces(solid, c%guests, c)
            call send_loads_home(solid, p, c)
        else
            call press_bodies(p, c, dt)
            call stress_faces(solid, p, c)
        end if
        call load_carriers(solid, p, c)
    end subroutine spread_load

    !> Force and torque of the air on the bodies that carry particles.
    subroutine load_carriers(solid, p, c)
        class(solid_t), intent(inout) :: solid
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        real(dp) :: load(6, c%bodies)
        integer :: b

        if (.not. allocated(solid%bodies)) return
        call sum_loads(solid, p, c, load)
        do b = 1, c%bodies
            solid%bodies(b)%rigid%load = load(:, b)
        end do
    end subroutine load_carriers

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    !> After spread_load.
    subroutine wake_loaded(solid, p, c, dt)
        class(solid_t), intent(inout) :: solid
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        integer :: felt(size(solid%bodies))
        integer(int64) :: all_felt(size(solid%bodies))

        if (several(solid%ranks)) then
            call feel_loads(solid, c%guests, c, dt, felt)
        else
            call feel_loads(solid, p, c, dt, felt)
        end if
        all_felt = felt
        call sum_of_all(solid%ranks, all_felt) !@host
        solid%bodies%asleep = solid%bodies%asleep .and. all_felt == 0
        call wake_met(solid) !@host
    end subroutine wake_loaded

    !> Which bodies that sleep have a load on one of the particles in cells of this process.
    subroutine feel_loads(solid, p, c, dt, felt)
        class(solid_t), intent(in) :: solid
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: felt(size(solid%bodies)) !! 1: yes
        integer :: b

        call at_least(c%felt, size(felt))
        call clear_list(size(felt), c%felt)
        do b = 1, size(felt)
            if (.not. solid%bodies(b)%asleep) cycle
            associate (first => p%bodies(b)%first, last => p%bodies(b)%last)
                call each_feel_load(last - first + 1, first, c%box, dt, c%cell_of, c%place_of, &
                                    c%above, c%wall%impulse, c%felt(b:))
            end associate
        end do
        call read_first(size(felt), c%felt, felt)
    end subroutine feel_loads

    !> Bring walls, ledgers and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, ledgers and debts together do not change.
    subroutine reclassify(air, solid, p, c)
        type(air_t), intent(inout) :: air
        class(solid_t), intent(in) :: solid !! its bodies
        type(solid_t), intent(inout) :: p !! its particles
        type(coupling_t), intent(inout) :: c

        if (several(solid%ranks)) then
            !@gpu call c%part%window%offer_reals(air%grid%apart, air%u)
            call invite_guests(solid, p, c) ! where all meet
            call see_window(air) !@cpu
            !@gpu call c%part%window%take_reals(air%grid%apart, air%u, .true.)
            call share_debts(c)
            call move_on(air, c%crowd, c%guests, c)
            call see_window(air) !@cpu
            !@gpu call c%part%window%reals_of_others(air%grid%apart, air%u)
        else
            call move_on(air, solid, p, c)
        end if
        !@gpu air%fetched = .false.
        ! of any process: the books count cells of this one alone
        !@gpu if (c%n_covered + c%n_uncovered > 0) c%walls_fetched = .false.
    end subroutine reclassify
end module brz_exchange_steps
