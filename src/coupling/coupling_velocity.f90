! SPDX-License-Identifier: MIT
!> Velocities of the walls for the next step of the air, from the particles in the solid cells.
module brz_coupling_velocity
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_coupling_steps, only: find_velocities
    use brz_kinds, only: dp
    use brz_ranks, only: several
    use brz_solid_state, only: solid_t
    use brz_wall_steps, only: keep_velocities
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
            call find_velocities(air, guests, guests, coupling, dt, guests%v_before, &
                                 coupling%part%seat)
            call move_alloc(guests, coupling%guests)
        else
            call find_velocities(air, solid, solid, coupling, dt, coupling%v_before, solid%id)
            call keep_velocities(solid, coupling)
        end if
        coupling%dt_before = dt
    end subroutine set_wall_velocity
end module brz_coupling_velocity
