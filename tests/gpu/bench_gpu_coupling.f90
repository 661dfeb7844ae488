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
    use brz_air_walls, only: set_up_walls
    use brz_driven_body_motion, only: read_driven_bodies
    use brz_cell_shells, only: make_shells
    use brz_coupling_copy, only: fastest_wall, open_gpu_coupling
    use brz_coupling_setup, only: make_box
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, device_t
    use brz_device_data, only: update_device
    use brz_errors, only: error_t, failed
    use brz_reclassification_driver, only: fill_bins, look_at_particles
    use brz_exchange_driver, only: reclassify, set_wall_velocity, spread_load
    use brz_gpu_air_state, only: open_gpu_air
    use brz_kinds, only: dp, int64, rk
    use brz_lists, only: at_least
    use brz_solid_state, only: solid_t
    use gpu_tools, only: get_device, start_timer, stop_timer
    implicit none

    integer, parameter :: layers = 7
    type(device_t) :: device
    type(error_t) :: err
    type(air_t) :: air
    type(coupling_t) :: coupling
    type(solid_t) :: solid
    integer :: along, side

    along = argument(1, 220)
    side = argument(2, 3)
    call get_device(device, err)
    call set_up()
    write (output_unit, '(4(i0, a))') solid%n, ' particles, ', coupling%wall%n_cells, &
        ' solid cells, ', coupling%wall%n_faces, ' wall faces, ', product(air%n), ' cells of air'
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
        integer :: i, j, k, n(3), p

        n = [4*along/3, 4*along/3, along]
        air%present = .true.
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], 1.0_dp*n, n, air)
        air%u(:, :, :, 1) = 1.2_rk
        air%u(:, :, :, 2:4) = 0
        air%u(:, :, :, 5) = 2.5e5_rk
        call set_scale(air)
        call open_gpu_air(device, air, .true., err)
        solid%n = along*along*layers*side**3
        call lay_particles()
        p = 0
        do k = 1, layers*side
            do j = 1, along*side
                do i = 1, along*side
                    p = p + 1
                    solid%x(:, p) = [along/6 + (i - 0.5_dp)/side, along/6 + (j - 0.5_dp)/side, &
                                     along/2 + (k - 0.5_dp)/side, 0.0_dp]
                end do
            end do
        end do
        solid%mass = 1
        solid%id(:solid%n) = [(p, p=1, solid%n)]
        call update_device(solid%x, err)
        call update_device(solid%mass, err)
        call update_device(solid%id, err)
        coupling%n_var = air%n_var
        coupling%reference_pressure = 1e5_rk
        call make_box(air, coupling)
        call make_shells(air%n, coupling%shells)
        coupling%level = 1/27.0_rk
        call set_up_walls(air, coupling%wall)
        call read_driven_bodies(solid, coupling%driven)
        allocate (coupling%mark(n(1), n(2), n(3)), coupling%slot(n(1), n(2), n(3)))
        allocate (coupling%cell_of(solid%n), coupling%place_of(solid%n), coupling%binned(solid%n))
        allocate (coupling%v_before(3, solid%n), source=0.0_rk)
        coupling%mark = 0
        coupling%cell_of = 0
        coupling%place_of = 0
        coupling%binned = 0
        call open_gpu_coupling(air, solid, coupling, err)
    end subroutine set_up

    !> Arrays of the particles as solids on a GPU have them.
    subroutine lay_particles()
        solid%on_gpu = .true.
        solid%wide = 4
        solid%stride_d = solid%n
        solid%stride_p = 1
        solid%stride_t = 1
        call at_least(.true., solid%x, 4, solid%n, err)
        call at_least(.true., solid%v, 4, solid%n, err)
        call at_least(.true., solid%mass, solid%n, err)
        call at_least(.true., solid%load, 3, solid%n, err)
        call at_least(.true., solid%id, solid%n, err)
        call at_least(.true., solid%fixed, solid%n, err)
        solid%x = 0
        solid%id = 0
    end subroutine lay_particles

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
            do p = 1, solid%n
                solid%x(3, p) = solid%x(3, p) &
                    - by*max(0.0_dp, 1 - 4*sum((solid%x(1:2, p)/along - 2/3.0_dp)**2))
            end do
            call update_device(solid%x, err)
            call clear_buffer(air%device%walls%impulse, err)
            call start_timer(err)
            call set_wall_velocity(air, solid, coupling, 1e-6_dp, err)
            ms(1) = ms(1) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call spread_load(solid, coupling, 1e-6_dp, err)
            ms(2) = ms(2) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call reclassify(air, solid, coupling, err)
            ms(3) = ms(3) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            speed = fastest_wall(air, coupling, err)
            ms(4) = ms(4) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call look_at_particles(solid, coupling, moved, err)
            ms(5) = ms(5) + 1e3_dp*stop_timer(err)/steps
            call start_timer(err)
            call fill_bins(solid, coupling, err)
            ms(6) = ms(6) + 1e3_dp*stop_timer(err)/steps
        end do
        changed = coupling%diagnostics%covered + coupling%diagnostics%cleared
        write (output_unit, '(a, a, i0, a, i0, a)') what, ': ', changed, ' changes so far, ', &
            coupling%n_deferred, ' debts; ms each step'
        write (output_unit, '(6(a, f8.3))') '  wall velocity', ms(1), ', load', ms(2), &
            ', reclassify', ms(3), ', fastest wall', ms(4), '; of these: find cells', ms(5), &
            ', bins', ms(6)
    end subroutine time_step
end program bench_gpu_coupling
