! SPDX-License-Identifier: MIT
!> Speed of the coupling on the GPU: time of each operation of a step.
!>
!> usage: BRISANCE_PTX=bin/brisance.ptx bench_gpu_coupling [cells of the plate [particles a side]]
!>
!> A plate of seven layers of cells in a box of air, 27 particles a cell: 220 cells a side give
!> nine million particles and a hundred thousand wall faces in 18 million cells. First it stands
!> still, then it dishes, so that some cells change hands in every step.
program bench_gpu_coupling
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_air_setup, only: make_grid
    use brz_air_state, only: air_t, set_scale
    use brz_bench_floors, only: argument
    use brz_carrier_motion, only: read_carriers
    use brz_cell_shells, only: make_shells
    use brz_coupling_setup, only: make_box
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, copy_in, device_t
    use brz_gpu_exchange_steps, only: gpu_reclassify => reclassify, &
        gpu_set_wall_velocity => set_wall_velocity, gpu_spread_load => spread_load
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: bytes_of_real, open_gpu_air
    use brz_gpu_coupling_copy, only: gpu_fastest_wall, open_gpu_coupling
    use brz_gpu_coupling_state, only: gpu_coupling_t, seen_t
    use brz_gpu_event_steps, only: fill_bins, look_at_particles
    use brz_gpu_lists, only: at_least
    use brz_kinds, only: dp, int64, rk
    use brz_solid_state, only: solid_t
    use gpu_tools, only: get_device, start_timer, stop_timer
    implicit none

    integer, parameter :: layers = 7
    type(device_t) :: device
    type(error_t) :: err
    type(air_t) :: air
    type(coupling_t) :: coupling
    type(solid_t) :: solid
    type(gpu_coupling_t) :: gpu
    type(seen_t) :: particles
    real(dp), allocatable :: place(:, :)
    integer :: along, side

    along = argument(1, 220)
    side = argument(2, 3)
    call get_device(device, err)
    call set_up()
    write (output_unit, '(4(i0, a))') particles%n, ' particles, ', gpu%wall%n_cells, &
        ' solid cells, ', gpu%wall%n_faces, ' wall faces, ', product(air%n), ' cells of air'
    call time_step('at rest', 0.0_dp)
    call time_step('dishing, 0.02 cells a step', 0.02_dp)
    call time_step('dishing, 0.1 cells a step', 0.1_dp)
    if (failed(err)) then
        print '(a)', err%text
        error stop 5
    end if

contains

    !> The plate lies across z in the middle of a box that is wider by a third.
    subroutine set_up()
        real(rk), allocatable :: ones(:)
        integer :: i, j, k, n(3), p

        n = [4*along/3, 4*along/3, along]
        air%present = .true.
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], 1.0_dp*n, n, air)
        air%u(:, :, :, 1) = 1.2_rk
        air%u(:, :, :, 2:4) = 0
        air%u(:, :, :, 5) = 2.5e5_rk
        call set_scale(air)
        coupling%n_var = air%n_var
        coupling%reference_pressure = 1e5_rk
        call make_box(air, coupling)
        call make_shells(air%n, coupling%shells)
        coupling%level = 1/27.0_rk
        particles%n = along*along*layers*side**3
        solid%n = particles%n
        call read_carriers(solid, coupling%carrier)
        allocate (place(4, particles%n))
        p = 0
        do k = 1, layers*side
            do j = 1, along*side
                do i = 1, along*side
                    p = p + 1
                    place(:, p) = [along/6 + (i - 0.5_dp)/side, along/6 + (j - 0.5_dp)/side, &
                                   along/2 + (k - 0.5_dp)/side, 0.0_dp]
                end do
            end do
        end do
        call open_gpu_air(device, air, .true., err)
        particles%step_d = particles%n
        call at_least(particles%x, 4, particles%n, err)
        call at_least(particles%v, 4, particles%n, err)
        call at_least(particles%mass, particles%n, err)
        call at_least(particles%load, 3, particles%n, err)
        call at_least(particles%id, particles%n, err)
        call at_least(particles%fixed, particles%n, err)
        call copy_in(place, particles%x, 32_int64*particles%n, err)
        ones = spread(1.0_rk, 1, particles%n)
        call copy_in(ones, particles%mass, bytes_of_real*particles%n, err)
        call copy_in([(p, p=1, particles%n)], particles%id, 4_int64*particles%n, err)
        allocate (coupling%v_before(3, particles%n), source=0.0_rk)
        call open_gpu_coupling(air, solid, coupling, particles, air%device, gpu, err)
    end subroutine set_up

    !> Ten steps, in which the middle of the plate goes down so much.
    subroutine time_step(what, by)
        character(*), intent(in) :: what
        real(dp), intent(in) :: by !! cells
        real(dp) :: ms(6), speed
        integer :: m, moved, p
        integer(int64) :: changed
        integer, parameter :: steps = 10

        ms = 0
        changed = 0
        do m = 1, steps
            do p = 1, particles%n
                place(3, p) = place(3, p) &
                    - by*max(0.0_dp, 1 - 4*sum((place(1:2, p)/along - 2/3.0_dp)**2))
            end do
            call copy_in(place, particles%x, 32_int64*particles%n, err)
            call clear_buffer(air%device%walls%impulse, err)
            call start_timer(err)
            call gpu_set_wall_velocity(air%device, solid, particles, gpu, 1e-6_dp, err)
            ms(1) = ms(1) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call gpu_spread_load(solid, particles, gpu, 1e-6_dp, err)
            ms(2) = ms(2) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call gpu_reclassify(air%device, solid, particles, gpu, err)
            ms(3) = ms(3) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            speed = gpu_fastest_wall(gpu, air%device, err)
            ms(4) = ms(4) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call look_at_particles(particles, gpu, moved, err)
            ms(5) = ms(5) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call fill_bins(particles, gpu, err)
            ms(6) = ms(6) + 1e3_dp*stop_timer(err)/steps
        end do
        changed = gpu%books%covered + gpu%books%uncovered
        write (output_unit, '(a, a, i0, a, i0, a)') what, ': ', changed, ' changes so far, ', &
            gpu%n_debts, ' debts; ms each step'
        write (output_unit, '(6(a, f8.3))') '  wall velocity', ms(1), ', load', ms(2), &
            ', reclassify', ms(3), ', fastest wall', ms(4), '; of these: find cells', ms(5), &
            ', bins', ms(6)
    end subroutine time_step
end program bench_gpu_coupling
