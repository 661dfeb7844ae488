! SPDX-License-Identifier: MIT
!> The gas beyond the open boundaries, for which they let waves pass.
module brz_air_outside
    use brz_air_grid, only: first_cell, grid_of, grid_t, lines_along
    use brz_air_state, only: air_t, bc_outflow, bc_periodic
    use brz_kinds, only: rk
    implicit none
    private
    public :: keep_outside

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
                        if (.not. outside(1) > 0) outside = air%rest(:air%n_var) ! a solid cell
                    end associate
                end do
            end do
        end do
    end subroutine keep_outside
end module brz_air_outside
