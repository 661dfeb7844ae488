! SPDX-License-Identifier: MIT
!> Numbers about all of the air on the GPU: time step, totals, outflow. Folded in a fixed order.
module brz_gpu_air_sums
    use brz_air_state, only: air_t
    use brz_buffers, only: doubles_t, from
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: gpu_air_time_step, gpu_air_totals, gpu_outflow, sum_of

    integer, parameter :: fold_threads = 1024 !! partial results that the host adds up

contains

    !> Largest stable time step [s], as air_time_step has it.
    real(dp) function gpu_air_time_step(gpu, air, cfl, err) result(dt)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: cfl !! Courant number [-]
        type(error_t), intent(inout) :: err

        call gpu%kernels%air_speed([air%n(1:2), 1], gpu%grid, air%scheme, gpu%u, &
                                   gpu%walls%solid, gpu%bricks%awake, gpu%part, err)
        dt = cfl/gpu%common%largest(gpu%part, air%n(1)*air%n(2), err)
    end function gpu_air_time_step

    !> Mass, momentum, energy, mass of products and kinetic energy of the gas [SI].
    subroutine gpu_air_totals(gpu, air, totals, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(dp), intent(out) :: totals(0:6) !! 0: kinetic energy
        type(error_t), intent(inout) :: err
        integer :: c

        totals = 0
        do c = 0, air%n_var
            call gpu%kernels%air_total([air%n(1:2), 1], gpu%grid, c, gpu%u, gpu%walls%solid, &
                                       gpu%part, err)
            call sum_of(gpu, gpu%part, air%n(1)*air%n(2), totals(c), err)
        end do
        totals = totals*product(air%dx)
    end subroutine gpu_air_totals

    !> What left the box since the start of the run, into air%outflow.
    subroutine gpu_outflow(gpu, air, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        real(dp) :: left(6), total
        integer :: c

        left = gpu%outflow_before
        do c = 1, air%n_var
            call sum_of(gpu, from(gpu%outflow, int(gpu%grid%lines, int64)*(c - 1) + 1), &
                        gpu%grid%lines, total, err)
            left(c) = left(c) + total
        end do
        air%outflow = left(1:5)
        air%outflow_products = left(6)
    end subroutine gpu_outflow

    !> Sum of n numbers on the GPU.
    subroutine sum_of(gpu, numbers, n, total, err)
        type(gpu_air_t), intent(in) :: gpu
        type(doubles_t), intent(in) :: numbers
        integer, intent(in) :: n
        real(dp), intent(out) :: total
        type(error_t), intent(inout) :: err
        real(dp) :: folded(fold_threads, 1)

        call gpu%common%fold(numbers, n, folded, err)
        total = sum(folded)
    end subroutine sum_of
end module brz_gpu_air_sums
