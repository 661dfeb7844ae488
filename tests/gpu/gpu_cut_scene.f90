! SPDX-License-Identifier: MIT
!> Bodies in a box of air by cut cells, on the CPU and on the GPU. Cells have sides of 1 m.
module gpu_cut_scene
    use brz_air_driver, only: air_step
    use brz_air_setup, only: make_grid
    use brz_air_state, only: air_ok, air_t, bc_outflow, bc_periodic, bc_wall, cell_gamma
    use brz_air_sums, only: air_time_step
    use brz_coupling_copy, only: fastest_wall, fetch_coupling, fetch_diagnostics, open_gpu_coupling
    use brz_coupling_setup, only: couple
    use brz_coupling_state, only: coupling_t
    use brz_device, only: device_t
    use brz_device_data, only: update_host
    use brz_errors, only: error_t, failed
    use brz_exchange_driver, only: reclassify, set_wall_velocity, spread_load, wake_loaded
    use brz_gas, only: to_conserved
    use brz_gpu_air_state, only: fetch_air, open_gpu_air
    use brz_gpu_air_sums, only: gpu_air_time_step
    use brz_gpu_solid_copy, only: fetch_solid
    use brz_kinds, only: dp, rk
    use brz_scheme, only: hllc, muscl_cells
    use brz_solid_driver, only: solid_step
    use brz_solid_state, only: solid_t
    use brz_solid_to_gpu, only: move_solid_to_gpu
    use gpu_scenes, only: make_solid
    use gpu_tools, only: get_device
    implicit none
    private
    public :: cut_pair_t, begin, fill, join, hand_over, advance, fetch_all

    !> A scene on both machines: on the GPU it is `other`, `twin` and `far`.
    type :: cut_pair_t
        type(air_t) :: air, other
        type(solid_t) :: solid, twin
        type(coupling_t) :: coupling, far
        type(device_t) :: device
        type(error_t) :: err
        integer :: status(2) = air_ok
        real(dp) :: cfl = 0.4_dp
        real(dp) :: dt(2) = 0 !! largest steps of the air [s]
    end type cut_pair_t

contains

    !> A box of still air between walls along y, or a periodic one.
    subroutine begin(cells, s, products, periodic)
        integer, intent(in) :: cells(3)
        type(cut_pair_t), intent(out) :: s
        logical, intent(in), optional :: products !! a second gas
        logical, intent(in), optional :: periodic !! in all directions

        s%air%present = .true.
        s%air%bc = bc_outflow
        s%air%bc(:, 2) = bc_wall
        if (present(periodic)) s%air%bc = bc_periodic
        s%air%scheme%reconstruction = muscl_cells
        s%air%scheme%flux = hllc
        s%air%n_stages = 2
        if (present(products)) then
            s%air%n_var = 6
            s%air%scheme%mixture = .true.
            s%air%scheme%gamma_products = 1.25_rk
        end if
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], 1.0_dp*cells, cells, s%air)
        call fill(s, 1, cells(1), [1.2_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1e5_rk], 0.0_rk)
    end subroutine begin

    !> Set density, velocity and pressure where from <= i <= to, and the share of products.
    subroutine fill(s, from, to, w, share)
        type(cut_pair_t), intent(inout) :: s
        integer, intent(in) :: from, to
        real(rk), intent(in) :: w(5), share
        real(rk) :: q(5)
        integer :: i, j, k

        do k = 1, s%air%n(3)
            do j = 1, s%air%n(2)
                do i = from, to
                    s%air%u(i, j, k, 1) = w(1)
                    if (s%air%n_var == 6) s%air%u(i, j, k, 6) = share*w(1)
                    call to_conserved(cell_gamma(s%air, i, j, k), w, q)
                    s%air%u(i, j, k, 1:5) = q
                end do
            end do
        end do
    end subroutine fill

    !> Put the bodies of a deck in, turned about the middle of the box.
    subroutine join(text, s, angle)
        character(*), intent(in) :: text
        type(cut_pair_t), intent(inout) :: s
        real(dp), intent(in), optional :: angle !! about z [rad]
        real(dp) :: middle(3), x(3)
        integer :: p

        call make_solid(text, s%solid)
        allocate (s%solid%load(3, s%solid%n), source=0.0_rk)
        if (present(angle)) then
            middle = s%air%n/2.0_dp
            do p = 1, s%solid%n
                x = s%solid%x(:, p) - middle
                s%solid%x(1, p) = middle(1) + cos(angle)*x(1) - sin(angle)*x(2)
                s%solid%x(2, p) = middle(2) + sin(angle)*x(1) + cos(angle)*x(2)
            end do
            s%solid%x_ref = s%solid%x
            s%solid%x_built = s%solid%x
        end if
        call couple(s%air, s%solid, 1e5_rk, s%coupling, .true.)
        call hand_over(s)
    end subroutine join

    !> The GPU goes on from the scene of the CPU.
    subroutine hand_over(s)
        type(cut_pair_t), intent(inout) :: s

        call get_device(s%device, s%err)
        s%other = s%air
        s%twin = s%solid
        s%far = s%coupling
        call open_gpu_air(s%device, s%other, .true., s%err)
        call move_solid_to_gpu(s%device, s%twin, .true., s%err)
        call open_gpu_coupling(s%other, s%twin, s%far, s%err)
        if (failed(s%err)) print *, s%err%text
    end subroutine hand_over

    !> A step on both machines.
    subroutine advance(s)
        type(cut_pair_t), intent(inout) :: s
        real(dp) :: fastest

        s%dt(1) = air_time_step(s%air, s%coupling%wall, s%cfl)
        fastest = fastest_wall(s%other, s%far, s%err)
        s%dt(2) = gpu_air_time_step(s%other%device, s%other, s%cfl, s%err, fastest)
        call step_one(s%air, s%solid, s%coupling, s%dt(1), s%status(1), s%err)
        call step_one(s%other, s%twin, s%far, s%dt(1), s%status(2), s%err)
        if (failed(s%err)) print *, s%err%text
    end subroutine advance

    !> A step in the order of a run.
    subroutine step_one(air, solid, coupling, dt, status, err)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: status
        type(error_t), intent(inout) :: err

        call set_wall_velocity(air, solid, coupling, dt, err)
        call air_step(air, coupling%wall, dt, status, err)
        call spread_load(solid, coupling, dt, err)
        call wake_loaded(solid, coupling, err)
        call solid_step(solid, dt, err)
        call reclassify(air, solid, coupling, err)
    end subroutine step_one

    !> The state of the GPU on its host.
    subroutine fetch_all(s)
        type(cut_pair_t), intent(inout) :: s

        call fetch_air(s%other%device, s%other, s%err)
        call fetch_solid(s%twin%device, s%twin, s%err)
        call fetch_coupling(s%far, s%err)
        call fetch_diagnostics(s%far, s%err)
        associate (cells => s%far%wall%cells)
            call update_host(cells%cell(:cells%n), s%err)
            call update_host(cells%aperture(:, :cells%n), s%err)
            call update_host(cells%v(:, :cells%n), s%err)
        end associate
    end subroutine fetch_all
end module gpu_cut_scene
