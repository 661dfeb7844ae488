! SPDX-License-Identifier: MIT
!> The coupling of air and bodies where they are computed. Each operation ends when the GPU has done
!> it, so that the times that a run reports for its parts are their own.
module brz_backend_coupling
    use brz_air_state, only: air_t
    use brz_backend, only: backend_t, particles_of
    use brz_coupling_state, only: coupling_t
    use brz_device, only: wait_for_device
    use brz_errors, only: error_t, failed
    use brz_exchange_steps, only: reclassify, set_wall_velocity, spread_load, wake_loaded
    use brz_gpu_exchange_steps, only: gpu_reclassify => reclassify, &
        gpu_set_wall_velocity => set_wall_velocity, gpu_spread_load => spread_load, &
        gpu_wake_loaded => wake_loaded
    use brz_gpu_coupling_state, only: seen_t
    use brz_kinds, only: dp
    use brz_ranks, only: agree
    use brz_solid_state, only: solid_t
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
            call gpu_set_wall_velocity(air%device, solid, particles_of(backend%solid), &
                                       backend%coupling, dt, err)
            coupling%coupling_known_t = backend%coupling%coupling_known_t
            call wait_for_device(err)
        else
            call set_wall_velocity(air, solid, solid, coupling, dt)
        end if
    end subroutine set_walls

    !> After it: hand the impulse of the step to the particles, and wake the bodies that feel it.
    subroutine load_bodies(backend, solid, coupling, dt, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(seen_t) :: p

        if (backend%coupling_on_gpu) then
            p = particles_of(backend%solid)
            call gpu_spread_load(solid, p, backend%coupling, dt, err)
            call wait_for_device(err)
            backend%solid%fetched = .false.
            if (any(solid%bodies%asleep)) &
                call gpu_wake_loaded(solid, p, backend%coupling, dt, err)
            call agree(solid%ranks, err)
        else
            call spread_load(solid, solid, coupling, dt)
            if (any(solid%bodies%asleep)) call wake_loaded(solid, solid, coupling, dt)
        end if
    end subroutine load_bodies

    !> After the steps of the bodies: cells change hands, and gas with them.
    subroutine exchange_gas(backend, air, solid, coupling, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err
        type(seen_t) :: p

        if (failed(err)) return
        if (backend%coupling_on_gpu) then
            p = particles_of(backend%solid)
            call gpu_reclassify(air%device, solid, p, backend%coupling, err)
            coupling%coupling_known_t = backend%coupling%coupling_known_t
            call wait_for_device(err)
        else
            call reclassify(air, solid, solid, coupling)
        end if
    end subroutine exchange_gas
end module brz_backend_coupling
