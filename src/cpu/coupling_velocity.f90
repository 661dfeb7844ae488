! SPDX-License-Identifier: MIT
!> Velocities of the walls for the next step of the air, from the particles in the solid cells.
module brz_coupling_velocity
    use brz_air_state, only: air_t
    use brz_coupling_bins, only: move_walls
    use brz_carrier_steps, only: move_carriers
    use brz_coupling_state, only: coupling_t
    use brz_kinds, only: dp, int32, rk
    use brz_ranks, only: several
    use brz_solid_state, only: solid_t
    use brz_wall_steps, only: feel_gas, keep_velocities, push_walls, weigh_columns
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
            call find_velocities(air, guests, coupling, dt, guests%v_before, coupling%part%seat)
            call move_alloc(guests, coupling%guests)
        else
            call find_velocities(air, solid, coupling, dt, coupling%v_before, solid%id)
            call keep_velocities(solid, coupling)
        end if
        coupling%dt_before = dt
    end subroutine set_wall_velocity

    !> The same for the particles in the box.
    subroutine find_velocities(air, solid, coupling, dt, v_before, column)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        real(rk), intent(in) :: v_before(:, :) !! velocity a step ago [m/s]
        integer(int32), intent(in) :: column(:) !! of each particle in it

        call move_walls(solid, coupling)
        call weigh_columns(solid, coupling)
        call feel_gas(air, coupling)
        call move_carriers(solid, solid, coupling, dt)
        call push_walls(solid, coupling, dt, v_before, column)
    end subroutine find_velocities
end module brz_coupling_velocity
