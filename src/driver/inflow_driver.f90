! SPDX-License-Identifier: MIT
!> Gas outside open faces that changes with time, see brz_inflow.
module brz_inflow_driver
    use brz_air_grid, only: lines_along, rest_t
    use brz_air_outside, only: keep_outside, set_grid
    use brz_air_state, only: air_t, bc_outflow
    use brz_errors, only: error_t
    use brz_ghost_loops, only: for_each_change_outside, for_each_mark_end
    use brz_inflow, only: gas_over
    use brz_kinds, only: dp
    implicit none
    private
    public :: let_in

contains

    !> The gas outside in a step, and that its bricks are reached once it is not that at rest.
    subroutine let_in(air, from, dt, err)
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: from, dt !! start of the step, its length [s]
        type(error_t), intent(inout) :: err
        type(rest_t) :: gas
        integer :: m

        if (.not. allocated(air%inflow)) return
        if (.not. air%on_gpu) then
            call keep_outside(air)
            call set_grid(air)
        end if
        gas%momentum = 0
        do m = 1, size(air%inflow)
            associate (inflow => air%inflow(m))
                if (air%bc(inflow%side, inflow%axis) /= bc_outflow) cycle ! of another process
                gas%u = gas_over(inflow, from, dt)
                call for_each_change_outside(air%on_gpu, lines_along(air%grid, inflow%axis), &
                    air%grid, inflow%axis, inflow%side, gas, air%outside, err)
                if (inflow%marked .or. all(abs(gas%u - air%rest) <= 0)) cycle
                call for_each_mark_end(air%on_gpu, product(air%grid%bricks), air%grid, &
                    inflow%axis, inflow%side, air%reached, err)
                inflow%marked = .true.
            end associate
        end do
    end subroutine let_in
end module brz_inflow_driver
