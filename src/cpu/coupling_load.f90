! SPDX-License-Identifier: MIT
!> Loads on the particles from the impulses that the air has given to the walls.
module brz_coupling_load
    use brz_air_state, only: air_t
    use brz_coupling_carriers, only: load_carriers
    use brz_column_loops, only: each_book_face, each_load_particle, each_press_face
    use brz_column_rules, only: direction_of
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    use brz_load_rules, only: is_felt
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
    subroutine spread_load(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
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
        call load_carriers(air, solid, coupling)
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
        integer :: b

        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%asleep) &
                solid%bodies(b)%asleep = .not. is_loaded(coupling, dt, solid%bodies(b))
        end do
        call wake_met(solid)
    end subroutine wake_loaded

    !> True where a particle of the body lies in the column of a wall face that feels more than
    !> rounding above or below the reference pressure.
    pure logical function is_loaded(coupling, dt, body)
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! [s]
        type(body_t), intent(in) :: body
        integer :: f, p, row

        is_loaded = .true.
        do p = body%first, body%last
            if (coupling%place_of(p) == 0) cycle
            do row = 1, 6
                f = coupling%above(row, coupling%place_of(p))
                if (f == 0) cycle
                if (is_felt(coupling%wall%impulse(f), coupling%reference_pressure, &
                            coupling%box%area(direction_of(row)), dt)) return
            end do
        end do
        is_loaded = .false.
    end function is_loaded
end module brz_coupling_load
