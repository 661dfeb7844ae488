! SPDX-License-Identifier: MIT
!> Numbers about all of the air on the GPU, of all processes: time step, totals, outflow. Sums of
!> bricks, and of faces of bricks, are added exactly: the same bits on any number of processes.
module brz_gpu_air_sums
    use brz_air_device, only: air_device_t
    use brz_air_state, only: air_t
    use brz_air_totals, only: record_outflow
    use brz_device, only: copy_out
    use brz_air_grid, only: column
    use brz_brick_launches, only: brick_kernels
    use brz_air_launches, only: air_kernels
    use brz_errors, only: error_t, failed
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, int64
    use brz_ranks, only: reduce_errors
    implicit none
    private
    public :: gpu_air_time_step, gpu_air_totals, gpu_outflow

contains

    !> Largest stable time step [s], as air_time_step has it.
    real(dp) function gpu_air_time_step(gpu, air, cfl, err, fastest) result(dt)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: cfl !! Courant number [-]
        type(error_t), intent(inout) :: err
        real(dp), intent(in), optional :: fastest !! of the walls [1/s]
        real(dp) :: least(1)
        integer :: columns

        columns = (air%n(3) - 1)/column + 1
        call air_kernels%air_speed([air%n(1:2), columns], gpu%grid, air%scheme, gpu%u, &
                                   gpu%walls%solid, gpu%bricks%active, gpu%part, err)
        least = cfl/gpu%common%largest(gpu%part, air%n(1)*air%n(2)*columns, err)
        if (present(fastest)) least = min(least, cfl/max(fastest, tiny(dt)))
        call reduce_errors(air%part%ranks, err, least)
        dt = least(1)
    end function gpu_air_time_step

    !> Mass, momentum, energy, mass of products and kinetic energy of the gas [SI].
    subroutine gpu_air_totals(gpu, air, totals, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        real(dp), intent(out) :: totals(0:6) !! 0: kinetic energy
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: part(:, :)

        allocate (part(0:air%n_var, size(air%reached)), source=0.0_dp)
        call brick_kernels%total_brick(size(part), gpu%grid, gpu%u, gpu%walls%solid, &
                                            gpu%part, err)
        call copy_out(gpu%part, part, 8*size(part, kind=int64), err)
        totals = 0
        call exact_sums(air%part%ranks, part, totals(:air%n_var))
        totals = totals*product(air%dx)
    end subroutine gpu_air_totals

    !> What left through the boundary of this process since the start of the run, into air%left and
    !> air%outflow.
    subroutine gpu_outflow(gpu, air, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        call copy_out(gpu%leaving, air%leaving, 8*size(air%leaving, kind=int64), err)
        if (failed(err)) return
        air%left = gpu%left_before
        call record_outflow(air)
    end subroutine gpu_outflow
end module brz_gpu_air_sums
