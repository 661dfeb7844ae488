! SPDX-License-Identifier: MIT
!> Velocities of the walls for the next step of the air, from the particles in the solid cells.
module brz_coupling_velocity
    use brz_air_state, only: air_t
    use brz_carrier_rules, only: carried_velocity
    use brz_cell_place, only: cell_middle
    use brz_column_loops, only: each_feel_gas
    use brz_coupling_bins, only: carrier_of, move_walls
    use brz_coupling_carriers, only: move_carriers
    use brz_coupling_columns, only: weigh_columns, weight_of
    use brz_coupling_state, only: coupling_t, side_of
    use brz_kinds, only: dp, rk
    use brz_load_rules, only: pushed_velocity
    use brz_solid_state, only: is_held, solid_t, worth_threads
    implicit none
    private
    public :: set_wall_velocity

    !> Sums over the particles of a cell: those that go by themselves, those that a body carries.
    type :: cell_t
        logical :: held = .false. !! something in it is fixed
        real(rk) :: mass = 0 !! of what goes by itself [kg]
        real(rk) :: v(3) = 0 !! its momentum [kg m/s]
        real(rk) :: force(3) = 0, load(3) = 0
        !! mean forces on it over the last step of the air: of all kinds, and of the gas [N]
        real(rk) :: carried = 0 !! mass that bodies carry [kg]
        real(rk) :: momentum(3) = 0 !! of this in the middle of the step [kg m/s]
    end type cell_t

contains

    !> Mean velocity by mass of the particles of each solid cell, in the middle of the step.
    !>
    !> A rigid body goes on as a whole, a driven one as it is told. The rest of the mass of a cell
    !> goes on as it did in the last step of the air, changed by what the gas, spread as a load will
    !> be, now pushes more. So a body that holds against the pressure does not seem to give way, as
    !> it would if the gas alone pushed. Cells with fixed particles stay at the mean.
    subroutine set_wall_velocity(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        integer :: c, p

        call move_walls(air, solid, coupling)
        call weigh_columns(solid, coupling)
        call each_feel_gas(coupling%wall%n_faces, coupling%box, air%scheme, coupling%gas, &
                           coupling%rows, coupling%wall%face_cell, air%u, coupling%wall%v, &
                           coupling%force, coupling%impedance)
        call move_carriers(air, solid, coupling, dt)
        !$omp parallel if(solid%n >= worth_threads)
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

    !> Carry one wall to the middle of the step, in the directions in which it meets gas.
    subroutine push_cell(air, solid, coupling, c, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(rk), intent(in) :: dt
        type(cell_t) :: cell
        real(rk) :: change, impedance, part, v(3)
        integer :: d, f, s

        call look_into(air, solid, coupling, c, cell)
        v = 0
        if (cell%mass > 0) v = cell%v/cell%mass
        do d = 1, 3
            if (cell%held .or. .not. cell%mass > 0 .or. air%n(d) == 1) cycle
            if (all(coupling%face_of(2*d - 1:2*d, c) == 0)) cycle
            impedance = 0
            change = -cell%load(d)
            do s = -1, 1, 2
                f = coupling%above(side_of(d, s), c)
                if (f == 0) cycle
                part = part_of(solid, coupling, f, c)
                change = change + part*coupling%force(f)
                if (coupling%wall%face_cell(f) /= c) cycle
                impedance = impedance + part*coupling%impedance(f)
            end do
            v(d) = pushed_velocity(v(d), cell%force(d), change, impedance, cell%mass, dt)
        end do
        coupling%wall%v(:, c) = (cell%mass*v + cell%momentum)/(cell%mass + cell%carried)
    end subroutine push_cell

    !> Sums over the particles of a cell.
    pure subroutine look_into(air, solid, coupling, c, cell)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        type(cell_t), intent(out) :: cell
        integer :: b, i, p

        do i = coupling%ends(c) + 1, coupling%ends(c + 1)
            p = coupling%binned(i)
            b = carrier_of(solid, coupling, p)
            cell%held = cell%held .or. solid%fixed(p) == is_held
            if (b > 0) then
                cell%carried = cell%carried + solid%mass(p)
                cell%momentum = cell%momentum + solid%mass(p)*carried_velocity( &
                    coupling%carrier(b), cell_middle(solid%x(:, p), air%lo, air%dx))
                cycle
            end if
            cell%mass = cell%mass + solid%mass(p)
            cell%v = cell%v + solid%mass(p)*solid%v(:, p)
            if (.not. coupling%dt_before > 0) cycle
            cell%load = cell%load + solid%load(:, p)
            cell%force = cell%force + solid%mass(p)*(solid%v(:, p) &
                - coupling%v_before(:, solid%id(p)))/real(coupling%dt_before, rk)
        end do
    end subroutine look_into

    !> Part of the load of a face that falls on what no body carries in a cell, 0..1.
    pure real(rk) function part_of(solid, coupling, f, c) result(part)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: f, c !! face, place in the wall list
        integer :: i, p

        part = 0
        do i = coupling%ends(c) + 1, coupling%ends(c + 1)
            p = coupling%binned(i)
            if (carrier_of(solid, coupling, p) > 0) cycle
            part = part + weight_of(solid, coupling, f, p)
        end do
        part = part/coupling%weight(f)
    end function part_of
end module brz_coupling_velocity
