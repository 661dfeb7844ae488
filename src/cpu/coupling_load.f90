! SPDX-License-Identifier: MIT
!> Loads on the particles from the impulses that the air has given to the walls.
module brz_coupling_load
    use brz_coupling_carriers, only: load_carriers
    use brz_column_loops, only: each_book_face, each_load_particle, each_press_face
    use brz_coupling_box, only: is_own
    use brz_coupling_guests, only: send_loads_home
    use brz_coupling_shared, only: share_impulses
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp, int64
    use brz_load_items, only: feel_load
    use brz_load_loops, only: each_feel_load
    use brz_ranks, only: several, sum_of_all
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: body_t, solid_t
    implicit none
    private
    public :: spread_load, wake_loaded

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
            call press_particles(guests, coupling, dt)
            call send_loads_home(guests, solid, coupling)
            call move_alloc(guests, coupling%guests)
            solid%v_before(:, :solid%n) = solid%v(:, :solid%n) ! the guests have kept theirs
        else
            call press_particles(solid, coupling, dt)
        end if
        call load_carriers(solid, coupling)
    end subroutine spread_load

    !> Loads of the particles, and the books of the walls.
    subroutine press_particles(solid, coupling, dt)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! step of the air [s]
        real(dp) :: work(2), given(3), taken(3)

        work = 0
        given = 0
        taken = 0
        associate (wall => coupling%wall, box => coupling%box)
            call each_press_face(wall%n_faces, box, dt, coupling%rows, wall%impulse, coupling%force)
            call each_book_face(wall%n_faces, box, dt, coupling%gas, coupling%rows, &
                                wall%face_cell, wall%impulse, wall%v, work, given, taken)
            call each_load_particle(solid%n, box, size(solid%x, 1), 1, size(solid%load, 1), &
                                    coupling%place_of, coupling%above, coupling%gas, &
                                    coupling%surface, coupling%weight, coupling%force, solid%x, &
                                    solid%mass, solid%load)
        end associate
        coupling%work = coupling%work + work(1)
        coupling%work_reference = coupling%work_reference + work(2)
        coupling%impulse = coupling%impulse + given
        coupling%impulse_reference = coupling%impulse_reference + taken
    end subroutine press_particles

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    subroutine wake_loaded(solid, coupling, dt)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        integer :: b, felt
        integer(int64) :: all_felt(size(solid%bodies))

        all_felt = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (.not. body%asleep) cycle
                felt = 0
                if (several(solid%ranks)) then
                    call feel_loads(coupling%guests%bodies(b), coupling, dt, felt)
                else
                    call each_feel_load(body%last - body%first + 1, body%first, coupling%box, dt, &
                                        coupling%place_of, coupling%above, coupling%wall%impulse, &
                                        felt)
                end if
                all_felt(b) = felt
            end associate
        end do
        call sum_of_all(solid%ranks, all_felt)
        solid%bodies%asleep = solid%bodies%asleep .and. all_felt == 0
        call wake_met(solid)
    end subroutine wake_loaded

    !> Count the guests in cells of this process that feel a load.
    subroutine feel_loads(body, coupling, dt, felt)
        type(body_t), intent(in) :: body
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step of the air [s]
        integer, intent(inout) :: felt
        integer :: p

        do p = body%first, body%last
            if (.not. is_own(coupling%box, coupling%cell_of(p))) cycle
            call feel_load(p - body%first + 1, body%first, coupling%box, dt, coupling%place_of, &
                           coupling%above, coupling%wall%impulse, felt)
        end do
    end subroutine feel_loads
end module brz_coupling_load
