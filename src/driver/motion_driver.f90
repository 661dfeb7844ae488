! SPDX-License-Identifier: MIT
!> How particles move in a step: kick and drift, and how far they have gone since their lists were
!> built.
module brz_motion_driver
    use brz_air_force, only: load_of
    use brz_body, only: body_t
    use brz_device, only: clear_buffer
    use brz_device_data, only: update_host
    use brz_formulation_names, only: form_rigid, form_total
    use brz_gpu_solid_motion, only: drift_tiles, size_particles
    use brz_kinds, only: dp, int64, rk
    use brz_list_drift, only: level_unit
    use brz_motion_loops, only: each_drift_particle, for_each_note_particle
    use brz_skin_level, only: skin_levels
    use brz_solid_diagnostics, only: begin_kick, record_work
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_state, only: solid_t
    use brz_errors, only: error_t
    implicit none
    private
    public :: kick_bodies, find_levels

contains

    !> Velocity by the mean of the last and this time step, then position, and how far the particles
    !> have gone; of rigid bodies, which have moved already, that alone.
    subroutine kick_bodies(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer :: b

        if (solid%on_gpu) then
            call clear_buffer(solid%device%flags, err)
            call size_particles(solid%device, solid, err)
            call drift_tiles(solid%device, solid, dt, unit_of(solid, solid%bodies), err)
        else
            call begin_kick(solid)
        end if
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (body%inactive) cycle
                associate (n => body%last - body%first + 1, unit => unit_of(solid, body), &
                           loaded => merge(1, 0, allocated(solid%load)))
                    if (body%formulation == form_rigid) then
                        call for_each_note_particle(solid%on_gpu, n, b, body%first, solid%wide, &
                            unit, body%drift(1), body%drift(2), body%drift(3), solid%fixed, &
                            solid%x, solid%x_built, solid%moved, err)
                    else if (.not. solid%on_gpu) then
                        call each_drift_particle(n, b, body%first, solid%wide, solid%stride_d, &
                            solid%stride_p, real((solid%dt_last + dt)/2, rk), dt, loaded, unit, &
                            body%drift(1), body%drift(2), body%drift(3), solid%a, load_of(solid), &
                            solid%mass, solid%fixed, solid%x_built, solid%x, solid%v, solid%work, &
                            solid%moved)
                    end if
                end associate
            end associate
        end do
        if (.not. solid%on_gpu) call record_work(solid)
    end subroutine kick_bodies

    !> Unit of the levels of motion of a body [m]: huge where it keeps its list, for one that is
    !> total-Lagrangian and meets no other.
    elemental real(dp) function unit_of(solid, body) result(unit)
        class(listed_bodies_t), intent(in) :: solid
        class(body_t), intent(in) :: body

        unit = level_unit(solid)
        if (body%formulation == form_total .and. .not. solid%links%present) &
            unit = sqrt(huge(unit))/(2*skin_levels)
    end function unit_of

    !> How far the particles of each body have moved relative to it since its list was built: the
    !> highest level of brz_list_drift, of this process, at the last kick.
    subroutine find_levels(solid, level, err)
        class(listed_bodies_t), intent(inout) :: solid
        integer(int64), intent(out) :: level(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: b

        if (solid%on_gpu) then
            solid%moved = 0
            call update_host(solid%moved, err)
        end if
        do b = 1, size(solid%bodies)
            level(b) = findloc(solid%moved(:, b), 1, dim=1, back=.true.)
        end do
    end subroutine find_levels
end module brz_motion_driver
