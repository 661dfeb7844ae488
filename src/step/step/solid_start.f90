! SPDX-License-Identifier: MIT
!> The solids before their first time step: start_solid once, or resume_solid after a restart; then
!> solid_step (brz_solid_driver) again and again. On the CPU, also of scenes that a GPU goes on
!> with.
module brz_solid_start
    use brz_errors, only: error_t
    use brz_kinds, only: dp
    use brz_ranks, only: several
    use brz_solid_contact, only: find_touch
    use brz_solid_doubles, only: refuse_doubles
    use brz_solid_forces, only: update_sizes
    use brz_solid_gradients, only: gradient_pass
    use brz_solid_ghosts, only: refresh_bonds, refresh_motion
    use brz_solid_links, only: first_bonds
    use brz_solid_motion, only: count_support
    use brz_solid_list_driver, only: build_neighbours
    use brz_contact_surface, only: find_contact_surface
    use brz_bodies, only: bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_state, only: solid_t
    use brz_solid_driver, only: find_forces_of, solid_step
    use brz_solid_tilts, only: find_tilts
    implicit none
    private
    public :: start_solid, resume_solid, solid_time_step, solid_step

    real(dp), parameter :: growth = 1.05_dp !! most that a time step may exceed the last one

contains

    !> Sort the particles, build their lists and find the first accelerations and time step. Where
    !> several processes share them, `find_contact_surface` has been called before.
    subroutine start_solid(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: unsupported

        if (.not. solid%present) return
        if (.not. several(solid%ranks)) call find_contact_surface(solid)
        call build_neighbours(solid, .true., err)
        call size_particles(solid)
        call count_support(solid)
        call refresh_motion(solid, solid%part)
        call refuse_doubles(solid, err)
        if (solid%links%bonds) call first_bonds(solid)
        call refresh_bonds(solid, solid%part)
        if (solid%links%present) call find_touch(solid)
        call find_tilts(solid)
        unsupported = count(solid%unsupported /= 0)
        call gradient_pass(solid, 0.0_dp)
        ! what has lost its support knows it from then on, and forces are those of it
        if (count(solid%unsupported /= 0) > unsupported) call gradient_pass(solid, 0.0_dp)
        call find_forces_of(solid, 0.0_dp, err)
    end subroutine start_solid

    !> After a restart: what a checkpoint does not hold follows from what it holds.
    subroutine resume_solid(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (.not. solid%present) return
        call build_neighbours(solid, .false., err)
        call size_particles(solid)
        call refresh_motion(solid, solid%part)
    end subroutine resume_solid

    !> Volumes and smoothing lengths of all particles.
    subroutine size_particles(solid)
        class(interacting_bodies_t), intent(inout) :: solid
        integer :: k

        do k = 1, size(solid%block, 2)
            call update_sizes(solid, solid%bodies(solid%block(1, k)), k)
        end do
    end subroutine size_particles

    !> Largest allowed time step: the CFL limit, and at most 5 % more than the last step [s].
    pure real(dp) function solid_time_step(solid) result(dt)
        class(bodies_t), intent(in) :: solid

        dt = solid%dt_limit
        if (solid%dt_last > 0) dt = min(dt, growth*solid%dt_last)
        dt = min(dt, solid%loads%step)
    end function solid_time_step
end module brz_solid_start
