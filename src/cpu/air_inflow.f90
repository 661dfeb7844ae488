! SPDX-License-Identifier: MIT
!> Gas outside open faces that changes with time, see brz_inflow.
module brz_air_inflow
    use brz_air_grid, only: grid_of, grid_t, lines_along, rest_t
    use brz_air_outside, only: keep_outside
    use brz_air_state, only: air_t, bc_outflow, bc_periodic
    use brz_ghost_loops, only: each_change_outside, each_mark_end
    use brz_inflow, only: fastest_over, gas_over
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: let_in, limit_of_inflow

contains

    !> The gas outside in a step, and that its bricks are reached once it is not that at rest.
    subroutine let_in(air, from, dt)
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: from, dt !! start of the step, its length [s]
        type(grid_t) :: grid
        type(rest_t) :: gas
        integer :: m

        if (.not. allocated(air%inflow)) return
        call keep_outside(air)
        grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        do m = 1, size(air%inflow)
            associate (inflow => air%inflow(m))
                if (air%bc(inflow%side, inflow%axis) /= bc_outflow) cycle ! of another process
                gas%u = gas_over(inflow, from, dt)
                call each_change_outside(lines_along(grid, inflow%axis), grid, inflow%axis, &
                                         inflow%side, gas, air%outside)
                if (inflow%marked .or. all(abs(gas%u - air%rest) <= 0)) cycle
                call each_mark_end(product(grid%bricks), grid, inflow%axis, inflow%side, &
                                   air%reached)
                inflow%marked = .true.
            end associate
        end do
    end subroutine let_in

    !> Largest stable time step of what comes in within that step [s].
    pure real(dp) function limit_of_inflow(air, cfl, from, dt) result(limit)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: cfl !! Courant number [-]
        real(dp), intent(in) :: from, dt !! start of the step, limit of the gas inside [s]
        integer :: m

        limit = dt
        if (.not. allocated(air%inflow)) return
        do m = 1, size(air%inflow)
            limit = min(limit, cfl/fastest_over(air%inflow(m), &
                merge(air%dx, huge(1.0_dp), air%whole > 1), from, dt))
        end do
    end function limit_of_inflow
end module brz_air_inflow
