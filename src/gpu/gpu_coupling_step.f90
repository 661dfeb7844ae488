! SPDX-License-Identifier: MIT
!> The coupling in a step, on the GPU: the same list of operations as on the CPU, as launches.
!>
!> Nothing but counts comes to the host. `air` and `coupling` of the host say what does not change,
!> and have their counters and dt_before brought up to date.
module brz_gpu_coupling_step
    use brz_buffers, only: from
    use brz_coupling_part, only: introduce
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t
    use brz_gpu_carrier_steps, only: sum_loads
    use brz_gpu_coupling_guests, only: invite_gpu_guests, see_gpu_window, send_gpu_loads_home
    use brz_gpu_coupling_shared, only: share_gpu_debts, share_gpu_impulses
    use brz_gpu_coupling_state, only: gpu_coupling_t, particles_t, seen, seen_t
    use brz_gpu_coupling_steps, only: find_velocities
    use brz_gpu_event_steps, only: move_on
    use brz_gpu_wall_steps, only: keep_velocities, press_bodies
    use brz_kinds, only: dp, int64
    use brz_load_launches, only: load_kernels
    use brz_ranks, only: several, sum_of_all
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: gpu_set_wall_velocity, gpu_spread_load, gpu_is_loaded, gpu_reclassify

contains

    !> Velocities of the walls in the middle of the coming step, as set_wall_velocity has them.
    subroutine gpu_set_wall_velocity(gpu, there, particles, solid, coupling, dt, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(in) :: solid !! its bodies
        type(coupling_t), intent(inout) :: coupling !! dt_before and the carriers are set
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(error_t), intent(inout) :: err
        type(seen_t) :: p

        gpu%dt_before = coupling%dt_before
        if (several(solid%ranks)) then
            call find_velocities(there, coupling%guests, gpu%guests, gpu, dt, gpu%shared%v_before, &
                                 gpu%shared%seat, err)
            coupling%dt_before = dt
            return
        end if
        p = seen(particles)
        call find_velocities(there, solid, p, gpu, dt, gpu%v_before, p%id, err)
        call keep_velocities(p, gpu, err)
        coupling%dt_before = dt
    end subroutine gpu_set_wall_velocity

    !> Loads on the particles from the impulses of the step, and the books of work and impulse, as
    !> spread_load has them.
    subroutine gpu_spread_load(gpu, particles, solid, dt, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(inout) :: solid !! its rigid bodies get their loads
        real(dp), intent(in) :: dt !! step of the air, over which the impulses were added up [s]
        type(error_t), intent(inout) :: err
        real(dp) :: load(6, gpu%bodies)
        type(seen_t) :: p
        integer :: b

        p = seen(particles)
        if (several(solid%ranks)) then
            call share_gpu_impulses(gpu, err)
            call press_bodies(gpu%guests, gpu, dt, err)
            call send_gpu_loads_home(gpu, particles, err)
            call sum_loads(gpu%shared%own, p, gpu, load, err)
        else
            call press_bodies(p, gpu, dt, err)
            if (.not. allocated(solid%bodies)) return
            call sum_loads(solid, p, gpu, load, err)
        end if
        do b = 1, gpu%bodies
            solid%bodies(b)%rigid%load = load(:, b)
        end do
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
        integer(int64) :: all(size(first))

        call reserve_buffer(gpu%felt, 4_int64*size(first), err)
        call clear_buffer(gpu%felt, err)
        do b = 1, size(first)
            call load_kernels%feel_load(last(b) - first(b) + 1, first(b), gpu%box, dt, &
                                        gpu%cell_of, gpu%place_of, gpu%above, &
                                        there%walls%impulse, from(gpu%felt, int(b, int64)), err)
        end do
        marks = 0
        call copy_out(gpu%felt, marks, 4_int64*size(marks), err)
        all = marks
        call sum_of_all(gpu%exact%ranks, all)
        loaded = all /= 0
    end subroutine gpu_is_loaded

    !> Bring walls, ledgers and gas up to date with the particles, as reclassify does.
    subroutine gpu_reclassify(gpu, there, particles, solid, coupling, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(inout) :: there
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(in) :: solid !! its bodies
        type(coupling_t), intent(inout) :: coupling !! its counters are brought up to date
        type(error_t), intent(inout) :: err

        if (several(solid%ranks)) then
            call introduce(solid, coupling%guests)
            call invite_gpu_guests(gpu, particles, coupling%guests, err)
            call see_gpu_window(gpu, there, err)
            call share_gpu_debts(gpu, err)
            call move_on(there, coupling%guests, gpu%guests, gpu, err)
            call see_gpu_window(gpu, there, err)
        else
            call move_on(there, solid, seen(particles), gpu, err)
        end if
        there%fetched = .false.
        ! of any process: the books count cells of this one alone
        if (gpu%n_covered + gpu%n_uncovered > 0) gpu%walls_fetched = .false.
        coupling%outside = gpu%outside
        coupling%n_covered = gpu%n_covered
        coupling%n_uncovered = gpu%n_uncovered
        coupling%n_debts = gpu%n_debts
        coupling%books%covered = gpu%books%covered
        coupling%books%uncovered = gpu%books%uncovered
        coupling%books%kept = gpu%books%kept
    end subroutine gpu_reclassify
end module brz_gpu_coupling_step
