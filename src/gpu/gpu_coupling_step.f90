! SPDX-License-Identifier: MIT
!> The coupling in a step, on the GPU: the same list of operations as on the CPU, as launches.
!>
!> Nothing but counts comes to the host. `air` and `coupling` of the host say what does not change,
!> and have their counters and dt_before brought up to date.
module brz_gpu_coupling_step
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_buffers, only: from
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: gpu_air_t
    use brz_gpu_coupling_carriers, only: load_gpu_carriers, move_gpu_carriers, &
        see_gpu_carriers
    use brz_gpu_coupling_debts, only: level_gpu_ledgers, limit_gpu_ledgers, release_gpu_debts
    use brz_gpu_coupling_events, only: change_gpu_hands
    use brz_gpu_coupling_layout, only: count_covered, count_moved, count_outside, &
        count_uncovered, n_count
    use brz_gpu_coupling_state, only: column_of, gpu_coupling_t, particles_t, tags_of
    use brz_gpu_coupling_walls, only: fill_gpu_bins, look_at_particles, move_gpu_walls
    use brz_gpu_solid_layout, only: at_mass, tag_fixed, tag_id
    use brz_kinds, only: dp, int64, rk
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: gpu_set_wall_velocity, gpu_spread_load, gpu_is_loaded, gpu_reclassify

contains

    !> Velocities of the walls in the middle of the coming step, as set_wall_velocity has them.
    subroutine gpu_set_wall_velocity(gpu, there, particles, air, solid, coupling, dt, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(particles_t), intent(in) :: particles
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid !! its bodies
        type(coupling_t), intent(inout) :: coupling !! dt_before and the carriers are set
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(error_t), intent(inout) :: err

        call see_gpu_carriers(gpu, particles, solid, coupling, err)
        call move_gpu_walls(gpu, there, particles, err)
        call gpu%columns%weigh_column(gpu%n_faces, gpu%box, 4, gpu%gas, gpu%rows, gpu%owner, &
                                      gpu%cell, there%walls%solid, there%walls%cell_of, gpu%ends, &
                                      gpu%binned, particles%place, column_of(particles, at_mass), &
                                      gpu%surface, gpu%weight, err)
        call gpu%columns%feel_gas(gpu%n_faces, gpu%box, air%scheme, gpu%gas, gpu%rows, gpu%owner, &
                                  there%u, there%walls%v, gpu%force, gpu%impedance, err)
        call move_gpu_carriers(gpu, particles, solid, coupling, dt, err)
        call gpu%velocities%push_wall( &
            gpu%n_cells, gpu%box, 4, particles%n, 1, gpu%bodies, real(dt, rk), &
            real(coupling%dt_before, rk), gpu%carrier, gpu%gas, gpu%owner, there%walls%face_of, &
            gpu%above, gpu%ends, gpu%binned, particles%place, particles%motion, &
            column_of(particles, at_mass), column_of(particles, particles%load + 1), gpu%before, &
            tags_of(particles, tag_id), tags_of(particles, tag_fixed), gpu%surface, gpu%weight, &
            gpu%force, gpu%impedance, there%walls%v, err)
        call gpu%velocities%keep_velocity(particles%n, 4, particles%motion, &
                                          tags_of(particles, tag_id), gpu%before, err)
        coupling%dt_before = dt
    end subroutine gpu_set_wall_velocity

    !> Loads on the particles from the impulses of the step, and the books of work and impulse, as
    !> spread_load has them.
    subroutine gpu_spread_load(gpu, there, particles, solid, coupling, dt, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(inout) :: solid !! its rigid bodies get their loads
        type(coupling_t), intent(in) :: coupling
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        type(error_t), intent(inout) :: err

        call gpu%columns%press_face(gpu%n_faces, gpu%box, dt, gpu%rows, there%walls%impulse, &
                                    gpu%force, err)
        call gpu%columns%book_face(gpu%n_faces, gpu%box, dt, gpu%gas, gpu%rows, gpu%owner, &
                                   there%walls%impulse, there%walls%v, gpu%book, err)
        call gpu%columns%load_particle(particles%n, gpu%box, 4, particles%n, 1, gpu%home, &
                                       gpu%above, gpu%gas, gpu%surface, gpu%weight, gpu%force, &
                                       particles%place, column_of(particles, at_mass), &
                                       column_of(particles, particles%load + 1), err)
        call load_gpu_carriers(gpu, particles, solid, coupling, err)
    end subroutine gpu_spread_load

    !> Which bodies feel more than rounding, as wake_loaded asks. After gpu_spread_load.
    subroutine gpu_is_loaded(gpu, there, dt, first, last, loaded, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        real(dp), intent(in) :: dt !! step over which the impulses were added up [s]
        integer, intent(in) :: first(:), last(:) !! particles of each body
        logical, intent(out) :: loaded(:)
        type(error_t), intent(inout) :: err
        integer :: b, marks(size(first))

        call reserve_buffer(gpu%felt, 4_int64*size(first), err)
        call clear_buffer(gpu%felt, err)
        do b = 1, size(first)
            call gpu%loads%feel_load(last(b) - first(b) + 1, first(b), gpu%box, dt, gpu%home, &
                                     gpu%above, there%walls%impulse, &
                                     from(gpu%felt, int(b, int64)), err)
        end do
        marks = 0
        call copy_out(gpu%felt, marks, 4_int64*size(marks), err)
        loaded = marks /= 0
    end subroutine gpu_is_loaded

    !> Bring walls, ledgers and gas up to date with the particles, as reclassify does.
    subroutine gpu_reclassify(gpu, there, particles, air, solid, coupling, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(inout) :: there
        type(particles_t), intent(in) :: particles
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid !! its bodies
        type(coupling_t), intent(inout) :: coupling !! its counters are brought up to date
        type(error_t), intent(inout) :: err
        integer :: counts(n_count)

        call look_at_particles(gpu, there, particles, counts, err)
        if (failed(err)) return
        coupling%outside = counts(count_outside)
        if (counts(count_moved) > 0) then
            if (counts(count_covered) + counts(count_uncovered) > 0) &
                call change_gpu_hands(gpu, there, air, coupling, counts, err)
            call fill_gpu_bins(gpu, there, particles, err)
        end if
        call level_gpu_ledgers(gpu, there, air, coupling, err)
        call limit_gpu_ledgers(gpu, there, err)
        call release_gpu_debts(gpu, there, err)
        call see_gpu_carriers(gpu, particles, solid, coupling, err)
        call move_gpu_walls(gpu, there, particles, err)
        there%fetched = .false.
        coupling%n_debts = gpu%n_debts
    end subroutine gpu_reclassify
end module brz_gpu_coupling_step
