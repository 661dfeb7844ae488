! SPDX-License-Identifier: MIT
!> Velocities of the walls for the next step of the air, from the particles in the solid cells.
module brz_coupling_velocity
    use brz_air_state, only: air_t
    use brz_column_loops, only: each_feel_gas
    use brz_coupling_bins, only: move_walls
    use brz_coupling_carriers, only: move_carriers
    use brz_coupling_columns, only: weigh_columns
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp, int32, rk
    use brz_ranks, only: several
    use brz_solid_state, only: solid_t
    use brz_velocity_loops, only: each_keep_velocity, each_push_wall
    implicit none
    private
    public :: set_wall_velocity

contains

    !> Velocities of the walls in the middle of the coming step.
    subroutine set_wall_velocity(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(solid_t), allocatable :: guests

        if (several(solid%ranks)) then
            call move_alloc(coupling%guests, guests)
            call push_walls(air, guests, coupling, dt, guests%v_before, coupling%part%seat)
            call move_alloc(guests, coupling%guests)
        else
            call push_walls(air, solid, coupling, dt, coupling%v_before, solid%id)
            call each_keep_velocity(solid%n, size(solid%v, 1), solid%v, solid%id, &
                                    coupling%v_before)
        end if
        coupling%dt_before = dt
    end subroutine set_wall_velocity

    !> The same for the particles in the box.
    subroutine push_walls(air, solid, coupling, dt, v_before, column)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        real(rk), intent(in) :: v_before(:, :) !! velocity a step ago [m/s]
        integer(int32), intent(in) :: column(:) !! of each particle in it

        call move_walls(solid, coupling)
        call weigh_columns(solid, coupling)
        associate (wall => coupling%wall, box => coupling%box)
            call each_feel_gas(wall%n_faces, box, air%scheme, coupling%gas, coupling%rows, &
                               wall%face_cell, air%u, wall%v, coupling%force, coupling%impedance)
            call move_carriers(solid, coupling, dt)
            call each_push_wall(wall%n_cells, box, size(solid%x, 1), 1, size(solid%load, 1), &
                                size(coupling%carrier), real(dt, rk), &
                                real(coupling%dt_before, rk), coupling%carrier, coupling%gas, &
                                wall%face_cell, coupling%face_of, coupling%above, coupling%ends, &
                                coupling%binned, solid%x, solid%v, solid%mass, solid%load, &
                                v_before, column, solid%fixed, coupling%surface, &
                                coupling%weight, coupling%force, coupling%impedance, wall%v)
        end associate
    end subroutine push_walls
end module brz_coupling_velocity
