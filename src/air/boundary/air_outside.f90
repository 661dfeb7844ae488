! SPDX-License-Identifier: MIT
!> The gas beyond the open boundaries, for which they let waves pass, and where cells lie in memory.
module brz_air_outside
    use brz_air_grid, only: first_cell, grid_of, grid_t, lines_along
    use brz_air_state, only: air_t, bc_outflow, bc_periodic
    use brz_inflow, only: fastest_over
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: keep_outside, limit_of_inflow, set_grid

contains

    !> Keep the state of the cells at the open boundaries, once: nothing happens where it is known.
    !>
    !> Called when the air is set up, before charges are placed, and before the first step.
    subroutine keep_outside(air)
        type(air_t), intent(inout) :: air
        type(grid_t) :: grid
        integer :: d, s, line, cell(3)

        if (allocated(air%outside)) return
        grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        allocate (air%outside(grid%lines, air%n_var, 2), source=0.0_rk)
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = 1, 2
                if (air%bc(s, d) /= bc_outflow) cycle
                do line = 1, lines_along(grid, d)
                    call first_cell(grid, d, line, cell)
                    if (s == 2) cell(d) = air%n(d)
                    associate (outside => air%outside(grid%before(d) + line, :, s))
                        outside = air%u(cell(1), cell(2), cell(3), :)
                        if (.not. outside(1) > 0) outside = air%rest(:air%n_var) ! of a body
                    end associate
                end do
            end do
        end do
    end subroutine keep_outside

    !> Where the cells of the air lie in memory, without walls.
    pure subroutine set_grid(air)
        type(air_t), intent(inout) :: air

        air%grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
    end subroutine set_grid

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
end module brz_air_outside
