! SPDX-License-Identifier: MIT
!> Loads on the particles from the impulses that the air has given to the walls.
module brz_coupling_load
    use brz_coupling_carriers, only: load_carriers
    use brz_column_loops, only: each_book_face, each_load_particle, each_press_face
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    use brz_load_loops, only: each_feel_load
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: solid_t
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
        real(dp) :: work(2), given(3), taken(3)

        work = 0
        given = 0
        taken = 0
        associate (wall => coupling%wall, box => coupling%box)
            call each_press_face(wall%n_faces, box, dt, coupling%rows, wall%impulse, coupling%force)
            call each_book_face(wall%n_faces, box, dt, coupling%rows, wall%face_cell, &
                                wall%impulse, wall%v, work, given, taken)
            call each_load_particle(solid%n, box, size(solid%x, 1), 1, size(solid%load, 1), &
                                    coupling%place_of, coupling%above, coupling%gas, &
                                    coupling%surface, coupling%weight, coupling%force, solid%x, &
                                    solid%mass, solid%load)
        end associate
        call load_carriers(solid, coupling)
        coupling%work = coupling%work + work(1)
        coupling%work_reference = coupling%work_reference + work(2)
        coupling%impulse = coupling%impulse + given
        coupling%impulse_reference = coupling%impulse_reference + taken
    end subroutine spread_load

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    subroutine wake_loaded(solid, coupling, dt)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        integer :: b, felt

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (.not. body%asleep) cycle
                felt = 0
                call each_feel_load(body%last - body%first + 1, body%first, coupling%box, dt, &
                                    coupling%place_of, coupling%above, coupling%wall%impulse, felt)
                body%asleep = felt == 0
            end associate
        end do
        call wake_met(solid)
    end subroutine wake_loaded
end module brz_coupling_load
