! SPDX-License-Identifier: MIT
!> Loads on the particles from the impulses that the air has given to the walls.
module brz_coupling_load
    use brz_air_state, only: air_t
    use brz_coupling_carriers, only: load_carriers
    use brz_coupling_columns, only: area, face_above, weight_of
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp
    use brz_load_rules, only: gauge_force, is_felt
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: body_t, solid_t, worth_threads
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
        integer :: c, f, p

        !$omp parallel if(solid%n >= worth_threads)
        !$omp do schedule(static)
        do f = 1, coupling%wall%n_faces
            coupling%force(f) = gauge_force(coupling%wall%face(5, f), coupling%wall%impulse(f), &
                coupling%reference_pressure, area(air, coupling%wall%face(4, f)), dt)
        end do
        !$omp do schedule(static)
        do p = 1, solid%n
            if (coupling%cell_of(p) == 0) solid%load(:, p) = 0
        end do
        !$omp do schedule(dynamic, 64)
        do c = 1, coupling%wall%n_cells
            call load_cell(air, solid, coupling, c)
        end do
        !$omp end parallel
        call load_carriers(air, solid, coupling)
        call account(air, coupling, dt)
    end subroutine spread_load

    !> Loads of the particles of one solid cell, from all faces whose columns reach it.
    subroutine load_cell(air, solid, coupling, c)
        type(air_t), intent(in) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        integer :: d, f, i, p, s

        do i = coupling%first(c), coupling%first(c + 1) - 1
            solid%load(:, coupling%binned(i)) = 0
        end do
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = -1, 1, 2
                f = face_above(air, coupling, d, s, c)
                if (f == 0) cycle
                do i = coupling%first(c), coupling%first(c + 1) - 1
                    p = coupling%binned(i)
                    solid%load(d, p) = solid%load(d, p) + coupling%force(f) &
                        *(weight_of(air, solid, coupling, f, p)/coupling%weight(f))
                end do
            end do
        end do
    end subroutine load_cell

    !> Add the step to the sums of work and impulse, as the air sees them.
    subroutine account(air, coupling, dt)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt
        real(dp) :: push, reference, work(2), given(3), taken(3)
        integer :: d, f, s

        work = 0
        given = 0
        taken = 0
        do f = 1, coupling%wall%n_faces
            d = coupling%wall%face(4, f)
            s = coupling%wall%face(5, f)
            push = s*real(coupling%wall%impulse(f), dp)
            reference = s*coupling%reference_pressure*area(air, d)*dt
            work = work + [push, reference]*coupling%wall%v(d, coupling%wall%face_cell(f))
            given(d) = given(d) + (push - reference)
            taken(d) = taken(d) + reference
        end do
        coupling%work = coupling%work + work(1)
        coupling%work_reference = coupling%work_reference + work(2)
        coupling%impulse = coupling%impulse + given
        coupling%impulse_reference = coupling%impulse_reference + taken
    end subroutine account

    !> Wake the bodies with a load beyond rounding on one of their particles, and what they meet.
    subroutine wake_loaded(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        integer :: b

        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%asleep) &
                solid%bodies(b)%asleep = .not. is_loaded(air, coupling, dt, solid%bodies(b))
        end do
        call wake_met(solid)
    end subroutine wake_loaded

    !> True where a particle of the body lies in the column of a wall face that feels more than
    !> rounding above or below the reference pressure.
    pure logical function is_loaded(air, coupling, dt, body)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! [s]
        type(body_t), intent(in) :: body
        integer :: d, f, p, s

        is_loaded = .true.
        do p = body%first, body%last
            if (coupling%place_of(p) == 0) cycle
            do d = 1, 3
                if (air%n(d) == 1) cycle
                do s = -1, 1, 2
                    f = face_above(air, coupling, d, s, coupling%place_of(p))
                    if (f == 0) cycle
                    if (is_felt(coupling%wall%impulse(f), coupling%reference_pressure, &
                                area(air, d), dt)) return
                end do
            end do
        end do
        is_loaded = .false.
    end function is_loaded
end module brz_coupling_load
