! SPDX-License-Identifier: MIT
!> The operations of a step that differ between CPU and GPU, but for the coupling.
module brz_backend_step
    use brz_air_outside, only: limit_of_inflow
    use brz_air_state, only: air_t, wall_t
    use brz_air_sums, only: air_time_step
    use brz_backend, only: backend_t, particles_of
    use brz_between_steps, only: book_between
    use brz_coupling_state, only: coupling_t
    use brz_device, only: measure_memory
    use brz_errors, only: error_t, failed
    use brz_force_steps, only: book_impulse
    use brz_gpu_air_state, only: open_gpu_air
    use brz_gpu_air_sums, only: gpu_air_time_step
    use brz_gpu_coupling_copy, only: gpu_fastest_wall, open_gpu_coupling
    use brz_gpu_between_steps, only: book_gpu_between => book_between
    use brz_gpu_solid_copy, only: open_gpu_solid
    use brz_gpu_force_steps, only: book_gpu_impulse => book_impulse
    use brz_gpu_load_steps, only: gpu_load_faces => load_faces
    use brz_gpu_solid_steps, only: gpu_solid_step => solid_step
    use brz_kinds, only: dp
    use brz_load_steps, only: load_faces
    use brz_solid_state, only: solid_t
    use brz_solid_steps, only: solid_step
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
            call open_gpu_solid(backend%device, solid, coupling%present, backend%solid, err)
        if (.not. backend%coupling_on_gpu) return
        call open_gpu_coupling(air, solid, coupling, particles_of(backend%solid), &
                               air%device, backend%coupling, err)
    end subroutine start_backend

    !> Largest stable time step of the air [s].
    real(dp) function limit_of_air(backend, air, wall, cfl, time, err) result(dt)
        type(backend_t), intent(in) :: backend
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(in) :: cfl !! Courant number [-]
        real(dp), intent(in) :: time !! start of the step [s]
        type(error_t), intent(inout) :: err
        real(dp) :: fastest

        if (backend%on_gpu) then
            fastest = 0
            if (backend%coupling_on_gpu) &
                fastest = gpu_fastest_wall(backend%coupling, air%device, err)
            dt = gpu_air_time_step(air%device, air, cfl, err, fastest)
        else
            dt = air_time_step(air, wall, cfl)
        end if
        dt = limit_of_inflow(air, cfl, time, dt)
    end function limit_of_air

    !> One step of the bodies, and before it the loads of scenes without air.
    subroutine advance_solid(backend, solid, dt, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        if (backend%bodies_on_gpu) then
            call gpu_load_faces(backend%solid, solid, dt, err)
            call book_gpu_impulse(backend%solid, solid, dt, err)
            call gpu_solid_step(backend%solid, solid, dt, err)
            call book_gpu_between(backend%solid, solid, dt, err)
        else
            call load_faces(solid, dt)
            call book_impulse(solid, dt)
            call solid_step(solid, dt, err)
            call book_between(solid, dt)
        end if
    end subroutine advance_solid
end module brz_backend_step
