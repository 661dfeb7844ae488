! SPDX-License-Identifier: MIT
!> Numbers about all of the air on the GPU: time step, totals, outflow. Folded in a fixed order.
module brz_gpu_air_sums
    use brz_air_state, only: air_t
    use brz_device, only: arguments_t, buffer_t, copy_out, kernel_t, launch
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: add_grid, fold_threads, gpu_air_t
    use brz_kinds, only: dp, int64
    implicit none
    private
    public :: gpu_air_time_step, gpu_air_totals, gpu_outflow, sum_of

contains

    !> Largest stable time step [s], as air_time_step has it.
    real(dp) function gpu_air_time_step(gpu, air, cfl, err) result(dt)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: cfl !! Courant number [-]
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        real(dp), target :: folded(fold_threads)

        call add_grid(gpu, arguments)
        call arguments%add_structure(air%scheme, storage_size(air%scheme)/8)
        call arguments%add(gpu%u)
        call arguments%add(gpu%walls%solid)
        call arguments%add(gpu%bricks%awake)
        call arguments%add(gpu%part)
        call launch(gpu%speed, [air%n(1:2), 1], arguments, err)
        call fold(gpu, gpu%most, gpu%part, air%n(1)*air%n(2), folded, err)
        dt = cfl/maxval(folded)
    end function gpu_air_time_step

    !> Mass, momentum, energy, mass of products and kinetic energy of the gas [SI].
    subroutine gpu_air_totals(gpu, air, totals, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(dp), intent(out) :: totals(0:6) !! 0: kinetic energy
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: c

        totals = 0
        do c = 0, air%n_var
            arguments%n = 0
            call add_grid(gpu, arguments)
            call arguments%add(c)
            call arguments%add(gpu%u)
            call arguments%add(gpu%walls%solid)
            call arguments%add(gpu%part)
            call launch(gpu%total, [air%n(1:2), 1], arguments, err)
            call sum_of(gpu, gpu%part, air%n(1)*air%n(2), totals(c), err)
        end do
        totals = totals*product(air%dx)
    end subroutine gpu_air_totals

    !> What left the box since the start of the run, into air%outflow.
    subroutine gpu_outflow(gpu, air, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(buffer_t) :: lines
        real(dp) :: left(6), total
        integer :: c

        left = gpu%outflow_before
        lines = gpu%outflow
        do c = 1, air%n_var
            call sum_of(gpu, lines, gpu%grid%lines, total, err)
            left(c) = left(c) + total
            lines%address = lines%address + 8_int64*gpu%grid%lines
        end do
        air%outflow = left(1:5)
        air%outflow_products = left(6)
    end subroutine gpu_outflow

    !> Sum of n numbers on the GPU.
    subroutine sum_of(gpu, numbers, n, total, err)
        type(gpu_air_t), intent(in) :: gpu
        type(buffer_t), intent(in) :: numbers
        integer, intent(in) :: n
        real(dp), intent(out) :: total
        type(error_t), intent(inout) :: err
        real(dp), target :: folded(fold_threads)

        call fold(gpu, gpu%sum, numbers, n, folded, err)
        total = sum(folded)
    end subroutine sum_of

    !> Partial results of n numbers, by a kernel of reduce.CUF.
    subroutine fold(gpu, kernel, numbers, n, folded, err)
        type(gpu_air_t), intent(in) :: gpu
        type(kernel_t), intent(in) :: kernel
        type(buffer_t), intent(in) :: numbers
        integer, intent(in) :: n
        real(dp), intent(out), target :: folded(fold_threads)
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        folded = 0
        call arguments%add(int(n, int64))
        call arguments%add(fold_threads)
        call arguments%add(numbers)
        call arguments%add(gpu%folded)
        call launch(kernel, [fold_threads, 1, 1], arguments, err)
        call copy_out(gpu%folded, folded, 8_int64*fold_threads, err)
    end subroutine fold
end module brz_gpu_air_sums
