! SPDX-License-Identifier: MIT
!> The operations of a step that differ between CPU and GPU, but for the coupling.
module brz_backend_step
    use brz_air_outside, only: limit_of_inflow
    use brz_air_state, only: air_t
    use brz_air_sums, only: air_time_step
    use brz_backend, only: backend_t
    use brz_body_pair_force_driver, only: record_body_pair_force
    use brz_coupling_copy, only: fastest_wall, open_gpu_coupling
    use brz_coupling_state, only: coupling_t
    use brz_device, only: measure_memory
    use brz_errors, only: error_t, failed
    use brz_force_driver, only: record_impulse
    use brz_gpu_air_state, only: open_gpu_air
    use brz_gpu_air_sums, only: gpu_air_time_step
    use brz_solid_to_gpu, only: move_solid_to_gpu
    use brz_kinds, only: dp
    use brz_load_driver, only: load_faces
    use brz_solid_state, only: solid_t
    use brz_solid_driver, only: solid_step
    implicit none
    private
    public :: start_backend, limit_of_air, advance_solid

contains

    !> Hand the state to the GPU, once it is set up or read from a checkpoint.
    subroutine start_backend(backend, air, coupling, solid, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: coupling
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (backend%on_gpu) &
            call open_gpu_air(backend%device, air, coupling%present, err)
        if (backend%on_gpu .and. backend%bodies_on_gpu) call measure_memory(backend%device, err)
        if (backend%bodies_on_gpu) &
            call move_solid_to_gpu(backend%device, solid, coupling%present, err)
        if (backend%coupling_on_gpu) call open_gpu_coupling(air, solid, coupling, err)
    end subroutine start_backend

    !> Largest stable time step of the air [s].
    real(dp) function limit_of_air(backend, air, coupling, cfl, time, err) result(dt)
        type(backend_t), intent(in) :: backend
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling !! its walls
        real(dp), intent(in) :: cfl !! Courant number [-]
        real(dp), intent(in) :: time !! start of the step [s]
        type(error_t), intent(inout) :: err
        real(dp) :: fastest

        if (backend%on_gpu) then
            fastest = 0
            if (coupling%on_gpu) fastest = fastest_wall(air, coupling, err)
            dt = gpu_air_time_step(air%device, air, cfl, err, fastest)
        else
            dt = air_time_step(air, coupling%wall, cfl)
        end if
        dt = limit_of_inflow(air, cfl, time, dt)
    end function limit_of_air

    !> One step of the bodies, and before it the loads of scenes without air.
    subroutine advance_solid(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        call load_faces(solid, dt, err)
        call record_impulse(solid, dt, err)
        call solid_step(solid, dt, err)
        call record_body_pair_force(solid, dt, err)
    end subroutine advance_solid
end module brz_backend_step
