! SPDX-License-Identifier: MIT
!> Velocities of the walls for the next step of the air, from the particles in the solid cells.
module brz_coupling_velocity
    use brz_air_state, only: air_t, cell_gamma
    use brz_coupling_bins, only: move_walls
    use brz_coupling_columns, only: area, face_above, weigh_columns, weight_of
    use brz_coupling_state, only: coupling_t, side_of
    use brz_kinds, only: dp, rk
    use brz_load_rules, only: coasted_velocity, gas_push, pushed_velocity
    use brz_solid_state, only: solid_t, worth_threads
    implicit none
    private
    public :: set_wall_velocity

contains

    !> Mean velocity by mass of the particles of each solid cell, carried to the middle of the step.
    !>
    !> The mass of a cell goes on as it did in the last step of the air, changed by what the gas,
    !> spread as a load will be, now pushes more. So a body that holds against the pressure does not
    !> seem to give way, as it would if the gas alone pushed. Cells with fixed particles stay at the
    !> mean.
    subroutine set_wall_velocity(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        integer :: c, f, p

        call move_walls(solid, coupling)
        call weigh_columns(air, solid, coupling)
        !$omp parallel if(solid%n >= worth_threads)
        !$omp do schedule(static)
        do f = 1, coupling%wall%n_faces
            call feel_gas(air, coupling, f)
        end do
        !$omp do schedule(dynamic, 64)
        do c = 1, coupling%wall%n_cells
            if (.not. any(coupling%face_of(:, c) > 0)) cycle
            call push_cell(air, solid, coupling, c, real(dt, rk))
        end do
        !$omp do schedule(static)
        do p = 1, solid%n
            coupling%v_before(:, solid%id(p)) = solid%v(:, p)
        end do
        !$omp end parallel
        coupling%dt_before = dt
    end subroutine set_wall_velocity

    !> Force of the gas on a face if the wall keeps its velocity, and its fall if the wall yields.
    subroutine feel_gas(air, coupling, f)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: f !! wall face
        real(rk) :: u(5)
        integer :: d, g(3)

        g = coupling%wall%face(1:3, f)
        d = coupling%wall%face(4, f)
        u = air%u(g(1), g(2), g(3), 1:5)
        call gas_push(side_of(d, coupling%wall%face(5, f)), cell_gamma(air, g(1), g(2), g(3)), u, &
                      coupling%wall%v(d, coupling%wall%face_cell(f)), area(air, d), &
                      coupling%reference_pressure, coupling%force(f), coupling%impedance(f))
    end subroutine feel_gas

    !> Carry one wall to the middle of the step, in the directions in which it meets gas.
    subroutine push_cell(air, solid, coupling, c, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk), intent(in) :: dt
        real(rk) :: change, force(3), impedance, load(3), mass, part, v(3)
        integer :: d, f, s
        logical :: held

        call forces_before(solid, coupling, c, force, load, mass, held)
        if (held) return
        do d = 1, 3
            v(d) = coasted_velocity(coupling%wall%v(d, c), force(d), load(d), mass, &
                                    real(solid%dt_last, rk))
            if (air%n(d) == 1) cycle
            if (all(coupling%face_of(2*d - 1:2*d, c) == 0)) cycle
            impedance = 0
            change = -load(d)
            do s = -1, 1, 2
                f = face_above(air, coupling, d, s, c)
                if (f == 0) cycle
                part = part_of(air, solid, coupling, f, c)
                change = change + part*coupling%force(f)
                if (coupling%wall%face_cell(f) /= c) cycle
                impedance = impedance + part*coupling%impedance(f)
            end do
            v(d) = pushed_velocity(v(d), force(d), change, impedance, mass, dt)
        end do
        coupling%wall%v(:, c) = v
    end subroutine push_cell

    !> Mass of a cell, and the mean forces on it over the last step of the air.
    pure subroutine forces_before(solid, coupling, c, force, load, mass, held)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk), intent(out) :: force(3), load(3) !! of all kinds, and of the gas [N]
        real(rk), intent(out) :: mass !! [kg]
        logical, intent(out) :: held !! something in the cell is fixed
        integer :: i, p

        held = .false.
        mass = 0
        force = 0
        load = 0
        do i = coupling%first(c), coupling%first(c + 1) - 1
            p = coupling%binned(i)
            held = held .or. solid%fixed(p) == 1
            mass = mass + solid%mass(p)
            if (.not. coupling%dt_before > 0) cycle
            load = load + solid%load(:, p)
            force = force + solid%mass(p)*(solid%v(:, p) - coupling%v_before(:, solid%id(p))) &
                    /real(coupling%dt_before, rk)
        end do
    end subroutine forces_before

    !> Part of the load of a face that falls on a cell, 0..1.
    pure real(rk) function part_of(air, solid, coupling, f, c) result(part)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: f, c !! face, place in the wall list
        integer :: i

        part = 0
        do i = coupling%first(c), coupling%first(c + 1) - 1
            part = part + weight_of(air, solid, coupling, f, coupling%binned(i))
        end do
        part = part/coupling%weight(f)
    end function part_of
end module brz_coupling_velocity
