! SPDX-License-Identifier: MIT
!> Gas outside open faces that changes with time, on the GPU: see brz_inflow.
module brz_gpu_air_inflow
    use brz_air_grid, only: lines_along, rest_t
    use brz_air_state, only: air_t, bc_outflow
    use brz_ghost_launches, only: ghost_kernels
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t
    use brz_inflow, only: gas_over
    use brz_kinds, only: dp
    implicit none
    private
    public :: gpu_let_in

contains

    !> The gas outside in a step, and that its bricks are reached once it is not that at rest.
    subroutine gpu_let_in(gpu, air, from, dt, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: from, dt !! start of the step, its length [s]
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails
        type(rest_t) :: gas
        integer :: m

        if (.not. allocated(air%inflow)) return
        do m = 1, size(air%inflow)
            associate (inflow => air%inflow(m), grid => gpu%grid)
                if (air%bc(inflow%side, inflow%axis) /= bc_outflow) cycle ! of another process
                gas%u = gas_over(inflow, from, dt)
                gas%momentum = 0
                call ghost_kernels%change_outside(lines_along(grid, inflow%axis), grid, &
                    inflow%axis, inflow%side, gas, gpu%outside, err)
                if (inflow%marked .or. all(abs(gas%u - air%rest) <= 0)) cycle
                call ghost_kernels%mark_end(product(grid%bricks), grid, inflow%axis, inflow%side, &
                                         gpu%bricks%reached, err)
                inflow%marked = .true.
            end associate
        end do
    end subroutine gpu_let_in
end module brz_gpu_air_inflow
