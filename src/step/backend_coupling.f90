! SPDX-License-Identifier: MIT
!> The coupling of air and bodies where they are computed. Each operation ends when the GPU has done
!> it, so that the times that a run reports for its parts are their own.
module brz_backend_coupling
    use brz_air_state, only: air_t
    use brz_backend, only: backend_t, particles_of
    use brz_coupling_events, only: reclassify
    use brz_coupling_load, only: spread_load, wake_loaded
    use brz_coupling_state, only: coupling_t
    use brz_coupling_velocity, only: set_wall_velocity
    use brz_device, only: wait_for_device
    use brz_errors, only: error_t, failed
    use brz_gpu_coupling_step, only: gpu_is_loaded, gpu_reclassify, gpu_set_wall_velocity, &
        gpu_spread_load
    use brz_kinds, only: dp
    use brz_ranks, only: agree, several
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: body_t, solid_t
    implicit none
    private
    public :: set_walls, load_bodies, exchange_gas

contains

    !> Before a step of the air: give the walls the velocities of the bodies.
    subroutine set_walls(backend, air, solid, coupling, dt, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! of the coming step [s]
        type(error_t), intent(inout) :: err

        if (backend%coupling_on_gpu) then
            call gpu_set_wall_velocity(backend%coupling, backend%air, particles_of(backend), &
                                       solid, coupling, dt, err)
            call wait_for_device(err)
        else
            call set_wall_velocity(air, solid, coupling, dt)
        end if
    end subroutine set_walls

    !> After it: hand the impulse of the step to the particles, and wake the bodies that feel it.
    subroutine load_bodies(backend, solid, coupling, dt, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        if (backend%coupling_on_gpu) then
            call gpu_spread_load(backend%coupling, particles_of(backend), solid, dt, err)
            call wait_for_device(err)
            backend%solid%fetched = .false.
            if (any(solid%bodies%asleep)) call wake_on_gpu(backend, solid, coupling, dt, err)
            call agree(solid%ranks, err)
        else
            call spread_load(solid, coupling, dt)
            if (any(solid%bodies%asleep)) call wake_loaded(solid, coupling, dt)
        end if
    end subroutine load_bodies

    !> Wake the bodies that feel a load on the GPU, and what they meet.
    subroutine wake_on_gpu(backend, solid, coupling, dt, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout), target :: solid
        type(coupling_t), intent(in), target :: coupling
        real(dp), intent(in) :: dt !! step of the air [s]
        type(error_t), intent(inout) :: err
        logical :: loaded(size(solid%bodies))
        type(body_t), pointer :: bodies(:)

        bodies => solid%bodies
        if (several(solid%ranks)) bodies => coupling%guests%bodies
        call gpu_is_loaded(backend%coupling, backend%air, dt, bodies%first, bodies%last, loaded, &
                           err)
        if (failed(err)) return
        solid%bodies%asleep = solid%bodies%asleep .and. .not. loaded
        call wake_met(solid)
    end subroutine wake_on_gpu

    !> After the steps of the bodies: cells change hands, and gas with them.
    subroutine exchange_gas(backend, air, solid, coupling, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (backend%coupling_on_gpu) then
            call gpu_reclassify(backend%coupling, backend%air, particles_of(backend), solid, &
                                coupling, err)
            call wait_for_device(err)
        else
            call reclassify(air, solid, coupling)
        end if
    end subroutine exchange_gas
end module brz_backend_coupling
