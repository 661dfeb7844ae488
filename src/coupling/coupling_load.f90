! SPDX-License-Identifier: MIT
!> Loads on the particles from the impulses that the air has given to the walls.
module brz_coupling_load
    use brz_carrier_steps, only: sum_loads
    use brz_coupling_guests, only: send_loads_home
    use brz_coupling_shared, only: share_impulses
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp, int64
    use brz_load_loops, only: each_feel_load
    use brz_ranks, only: several, sum_of_all
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: body_t, solid_t
    use brz_wall_steps, only: press_bodies
    implicit none
    private
    public :: spread_load, load_carriers, wake_loaded

contains

    !> Turn the impulses of the wall faces, reference pressure taken off, into forces on particles.
    !>
    !> The forces of a face add up to its impulse over dt. The columns are those of
    !> set_wall_velocity, before the step of the air.
    subroutine spread_load(solid, coupling, dt)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        type(solid_t), allocatable :: guests

        if (several(solid%ranks)) then
            call share_impulses(coupling, solid%ranks)
            call move_alloc(coupling%guests, guests)
            call press_bodies(guests, coupling, dt)
            call send_loads_home(guests, solid, coupling)
            call move_alloc(guests, coupling%guests)
            solid%v_before(:, :solid%n) = solid%v(:, :solid%n) ! the guests have kept theirs
        else
            call press_bodies(solid, coupling, dt)
        end if
        call load_carriers(solid, coupling)
    end subroutine spread_load

    !> Force and torque of the air on the bodies that carry particles.
    subroutine load_carriers(solid, coupling)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp) :: load(6, coupling%bodies)
        integer :: b

        if (.not. allocated(solid%bodies)) return
        call sum_loads(solid, solid, coupling, load)
        do b = 1, coupling%bodies
            solid%bodies(b)%rigid%load = load(:, b)
        end do
    end subroutine load_carriers

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    subroutine wake_loaded(solid, coupling, dt)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        type(body_t) :: body
        integer :: b, felt
        integer(int64) :: all_felt(size(solid%bodies))

        all_felt = 0
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%asleep) cycle
            body = solid%bodies(b)
            if (several(solid%ranks)) body = coupling%guests%bodies(b)
            felt = 0
            call each_feel_load(body%last - body%first + 1, body%first, coupling%box, dt, &
                                coupling%cell_of, coupling%place_of, coupling%above, &
                                coupling%wall%impulse, felt)
            all_felt(b) = felt
        end do
        call sum_of_all(solid%ranks, all_felt)
        solid%bodies%asleep = solid%bodies%asleep .and. all_felt == 0
        call wake_met(solid)
    end subroutine wake_loaded
end module brz_coupling_load
