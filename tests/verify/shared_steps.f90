! SPDX-License-Identifier: MIT
!> Drivers as tests call them: what fails there, apart from the physics, stops the test. (On the CPU
!> nothing does.)
module shared_steps
    use brz_air_state, only: air_t, wall_t
    use brz_air_driver, only: step_of_air => air_step
    use brz_cohesive_driver, only: pass_of_cohesive => cohesive_pass
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, failed
    use brz_exchange_driver, only: load_of_air => spread_load, step_of_cells => reclassify, &
        wake_of_load => wake_loaded, walls_of_step => set_wall_velocity
    use brz_kinds, only: dp
    use brz_load_driver, only: load_all_faces => load_faces
    use brz_solid_list_driver, only: build_all_neighbours => build_neighbours
    use brz_solid_start, only: resume_all => resume_solid
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_state, only: solid_t
    use brz_conservation_audit, only: solid_totals_t, sums_of_bodies, totals_of_sums
    use brz_motion_loop_bodies, only: n_sum
    implicit none
    private
    public :: air_step, cohesive_pass, load_faces, build_neighbours, resume_solid
    public :: solid_totals, solid_totals_t
    public :: set_wall_velocity, spread_load, wake_loaded, reclassify

contains

    subroutine stop_if_failed(err)
        type(error_t), intent(in) :: err

        if (.not. failed(err)) return
        print *, err%text
        error stop 'a driver failed'
    end subroutine stop_if_failed

    !> As brz_air_driver has it.
    subroutine air_step(air, wall, dt, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: status
        type(error_t) :: err

        call step_of_air(air, wall, dt, status, err)
        call stop_if_failed(err)
    end subroutine air_step

    !> As brz_cohesive_driver has it.
    subroutine cohesive_pass(solid)
        type(solid_t), intent(inout) :: solid
        type(error_t) :: err

        call pass_of_cohesive(solid, err)
        call stop_if_failed(err)
    end subroutine cohesive_pass

    !> As brz_load_driver has it.
    subroutine load_faces(solid, dt)
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t) :: err

        call load_all_faces(solid, dt, err)
        call stop_if_failed(err)
    end subroutine load_faces

    !> As brz_solid_list_driver has it.
    subroutine build_neighbours(solid, sort, stale)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: sort
        logical, intent(in), optional :: stale(:) !! (bodies)
        type(error_t) :: err

        call build_all_neighbours(solid, sort, err, stale)
        call stop_if_failed(err)
    end subroutine build_neighbours

    !> As brz_solid_start has it.
    subroutine resume_solid(solid)
        type(solid_t), intent(inout) :: solid
        type(error_t) :: err

        call resume_all(solid, err)
        call stop_if_failed(err)
    end subroutine resume_solid

    !> Totals of body b, or with b = 0 of all bodies. Energy accounts must be up to date. All
    !> processes must call.
    subroutine solid_totals(solid, b, totals)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        type(error_t) :: err
        real(dp) :: sums(n_sum, size(solid%bodies))

        call sums_of_bodies(solid, sums, err)
        call stop_if_failed(err)
        call totals_of_sums(solid, b, sums, totals)
    end subroutine solid_totals

    !> As brz_exchange_driver has it, and those that follow.
    subroutine set_wall_velocity(air, solid, coupling, dt)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        type(error_t) :: err

        call walls_of_step(air, solid, coupling, dt, err)
        call stop_if_failed(err)
    end subroutine set_wall_velocity

    subroutine spread_load(solid, coupling, dt)
        class(bodies_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        type(error_t) :: err

        call load_of_air(solid, coupling, dt, err)
        call stop_if_failed(err)
    end subroutine spread_load

    subroutine wake_loaded(solid, coupling)
        class(listed_bodies_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        type(error_t) :: err

        call wake_of_load(solid, coupling, err)
        call stop_if_failed(err)
    end subroutine wake_loaded

    subroutine reclassify(air, solid, coupling)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(error_t) :: err

        call step_of_cells(air, solid, coupling, err)
        call stop_if_failed(err)
    end subroutine reclassify
end module shared_steps
