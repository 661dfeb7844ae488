! SPDX-License-Identifier: MIT
!> Random gas and particles on the CPU and on the GPU, for the tests of the coupling.
module gpu_coupled_scene
    use brz_air_setup, only: make_grid
    use brz_air_state, only: air_t, bc_outflow, bc_periodic, bc_symmetry, bc_wall, cell_gamma
    use brz_coupling_copy, only: open_gpu_coupling
    use brz_coupling_setup, only: couple
    use brz_coupling_state, only: coupling_t
    use brz_deferred_source_driver, only: stored_totals
    use brz_device, only: copy_in, device_t
    use brz_device_data, only: update_device
    use brz_errors, only: error_t, failed
    use brz_formulation_names, only: form_rigid
    use brz_gas, only: to_conserved
    use brz_gpu_air_state, only: bytes_of_real, open_gpu_air
    use brz_gpu_air_sums, only: gpu_air_totals
    use brz_kinds, only: dp, int64, int8, rk
    use brz_lists, only: at_least
    use brz_present_table, only: buffer_of
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_solid_state, only: solid_t
    use gpu_tools, only: get_device
    implicit none
    private
    public :: both_t, start, hand_over, noise, stir_gas, put_particles, change_motion, shake, &
              stock, gas_scale

    !> A scene on both machines: on the GPU it is `other`, `twin` and `far`.
    type :: both_t
        type(air_t) :: air, other
        type(solid_t) :: solid, twin
        type(coupling_t) :: coupling, far
        type(device_t) :: device
        type(error_t) :: err
    end type both_t

contains

    !> Random gas and particles on both machines.
    subroutine start(n, count, periodic, s, products, bodies)
        integer, intent(in) :: n(3), count !! cells, particles
        logical, intent(in) :: periodic
        type(both_t), intent(out) :: s
        logical, intent(in), optional :: products !! a second gas
        logical, intent(in), optional :: bodies !! rigid and driven ones

        call make_air(n, periodic, present(products), s%air)
        call make_particles(s%air, count, s%solid)
        if (present(bodies)) call make_bodies(s%solid)
        call couple(s%air, s%solid, 1.5_rk, 1e5_rk, s%coupling)
        call hand_over(s)
    end subroutine start

    !> The GPU goes on from the scene of the CPU.
    subroutine hand_over(s)
        type(both_t), intent(inout) :: s

        call get_device(s%device, s%err)
        s%other = s%air
        s%far = s%coupling
        call open_gpu_air(s%device, s%other, .true., s%err)
        call open_twin(s)
        call put_particles(s)
        call open_gpu_coupling(s%other, s%twin, s%far, s%err)
        if (failed(s%err)) print *, s%err%text
    end subroutine hand_over

    !> The particles as solids on a GPU have them.
    subroutine open_twin(s)
        type(both_t), intent(inout) :: s

        s%twin = s%solid
        s%twin%on_gpu = .true.
        s%twin%wide = 4
        s%twin%stride_d = s%solid%n
        s%twin%stride_p = 1
        s%twin%stride_t = 1
        deallocate (s%twin%x, s%twin%v)
        call at_least(.true., s%twin%x, 4, s%solid%n, s%err)
        call at_least(.true., s%twin%v, 4, s%solid%n, s%err)
        call at_least(.true., s%twin%mass, s%solid%n, s%err)
        call at_least(.true., s%twin%load, 3, s%solid%n, s%err)
        call at_least(.true., s%twin%id, s%solid%n, s%err)
        call at_least(.true., s%twin%fixed, s%solid%n, s%err)
    end subroutine open_twin

    !> Numbers between 0 and 1 that depend on the seed alone.
    pure real(dp) function noise(i, j)
        integer, intent(in) :: i, j

        noise = modulo(sin(12.9898_dp*i + 78.233_dp*j)*43758.5453_dp, 1.0_dp)
    end function noise

    subroutine make_air(n, periodic, products, air)
        integer, intent(in) :: n(3)
        logical, intent(in) :: periodic, products
        type(air_t), intent(out) :: air
        real(dp), parameter :: lo(3) = [-0.3_dp, 0.2_dp, 0.1_dp]

        air%present = .true.
        air%bc(:, 1) = [bc_wall, bc_outflow]
        air%bc(:, 2) = bc_periodic
        air%bc(:, 3) = [bc_symmetry, bc_outflow]
        if (periodic) air%bc = bc_periodic
        if (products) air%n_var = 6
        air%scheme%mixture = products
        air%scheme%gamma_products = 1.25_rk
        call make_grid(lo, lo + [0.01_dp, 0.012_dp, 0.015_dp]*n, n, air)
        call stir_gas(air, 0)
    end subroutine make_air

    !> New gas everywhere; in solid cells energy accounts in and out of their band.
    subroutine stir_gas(air, seed, solid)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: seed
        integer(int8), intent(in), optional :: solid(:, :, :)
        real(rk) :: w(5), q(5), r
        integer :: i, j, k, m

        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    m = i + 31*j + 57*k
                    r = real(noise(m, seed), rk)
                    w(1:4) = [0.5_rk + r, 20*r - 10, 30*r**2 - 10, 5*r]
                    w(5) = 1e5_rk*(0.5_rk + real(noise(m, seed + 100), rk))
                    air%u(i, j, k, 1) = w(1)
                    if (air%n_var == 6) air%u(i, j, k, 6) = w(1)*real(noise(m, seed + 50), rk)
                    call to_conserved(cell_gamma(air, i, j, k), w, q)
                    air%u(i, j, k, 1:5) = q
                    if (.not. present(solid)) cycle
                    if (solid(i, j, k) == 1) air%u(i, j, k, :) = (8*r - 3)*air%u(i, j, k, :)
                end do
            end do
        end do
    end subroutine stir_gas

    !> A half of the particles in a block, the others all over the box and beyond; some are fixed.
    subroutine make_particles(air, n, solid)
        type(air_t), intent(in) :: air
        integer, intent(in) :: n
        class(particles_t), intent(out) :: solid
        integer :: p, d

        solid%present = .true.
        solid%n = n
        allocate (solid%x(3, n), solid%v(3, n), solid%load(3, n), solid%mass(n), solid%volume(n))
        allocate (solid%fixed(n), source=0)
        solid%id = [(n + 1 - p, p=1, n)]
        solid%dt_last = 0.003_dp
        do p = 1, n
            do d = 1, 3
                solid%x(d, p) = noise(p, d)
                if (p <= n/2) solid%x(d, p) = 0.3_dp + 0.35_dp*solid%x(d, p)
                if (p > n - 20) solid%x(d, p) = 3*solid%x(d, p) - 1
                solid%x(d, p) = air%lo(d) + air%n(d)*air%dx(d)*solid%x(d, p)
                solid%v(d, p) = real(60*noise(p, d + 3) - 30, rk)
                solid%load(d, p) = real(50*noise(p, d + 6) - 25, rk)
            end do
            solid%mass(p) = real(product(air%dx)*2*(1 + noise(p, 11)), rk)
            solid%volume(p) = real(product(air%dx)/30, rk)
            if (p > n/4 .and. p < n/3) solid%fixed(p) = 1
        end do
    end subroutine make_particles

    !> Four bodies: rigid, with driven particles, rigid and driven, free.
    subroutine make_bodies(solid)
        class(bodies_t), intent(inout) :: solid
        integer :: b, i

        allocate (solid%bodies(4), solid%block(3, 8))
        do b = 1, 4
            associate (body => solid%bodies(b), r => solid%bodies(b)%rigid)
                body%first = (b - 1)*(solid%n/4) + 1
                body%last = b*(solid%n/4)
                if (b == 4) body%last = solid%n
                do i = 1, 2
                    solid%block(:, 2*b - 2 + i) = [b, body%first + (i - 1)*100, &
                                                   merge(body%first + 99, body%last, i == 1)]
                end do
                if (b == 1 .or. b == 3) body%formulation = form_rigid
                if (b > 1 .and. b < 4) then
                    body%motion%n = 2
                    body%motion%time = [0.0_dp, 1.0_dp]
                    body%motion%v = reshape([0, 0, 0, 300, 200, -100]*1.0_dp, [3, 2])
                end if
                r%mass = 2e-4_dp
                r%x = solid%x(:, body%first)
                r%q = [0.8_dp, 0.0_dp, 0.6_dp, 0.0_dp]
                r%p = r%mass*[10, -20, 5]
                r%compliance = reshape([3, 1, 0, 1, 4, 0, 0, 0, 2], [3, 3])*1e7_dp
                r%l = [2, -1, 3]*1e-6_dp
                r%force = [0.3_dp, 0.1_dp, -0.2_dp]
                r%torque = [0.02_dp, 0.01_dp, -0.03_dp]
                r%load = [1.0_dp, 2.0_dp, -1.0_dp, 0.1_dp, -0.2_dp, 0.3_dp]
                r%omega = [20, -10, 30]
            end associate
        end do
        solid%time = 0.1_dp
    end subroutine make_bodies

    !> Copy the particles to the GPU.
    subroutine put_particles(s)
        type(both_t), intent(inout) :: s
        integer :: n

        n = s%solid%n
        s%twin%x = 0
        s%twin%x(1:3, :n) = s%solid%x
        s%twin%mass(:n) = s%solid%mass
        s%twin%id(:n) = s%solid%id
        s%twin%fixed(:n) = s%solid%fixed
        call update_device(s%twin%x(:, :n), s%err)
        call put_motion(s)
        call update_device(s%twin%mass(:n), s%err)
        call copy_in(transpose(s%solid%load), buffer_of(s%twin%load), 3*bytes_of_real*n, s%err)
        call update_device(s%twin%id(:n), s%err)
        call update_device(s%twin%fixed(:n), s%err)
    end subroutine put_particles

    subroutine put_motion(s)
        type(both_t), intent(inout) :: s

        s%twin%v = 0
        s%twin%v(1:3, :s%solid%n) = s%solid%v
        call update_device(s%twin%v(:, :s%solid%n), s%err)
    end subroutine put_motion

    !> Other velocities of the particles on both machines; loads and old velocities stay.
    subroutine change_motion(s, seed)
        type(both_t), intent(inout) :: s
        integer, intent(in) :: seed
        integer :: p

        do p = 1, s%solid%n
            s%solid%v(:, p) = s%solid%v(:, p) + real(noise(p, seed + 20), rk)
        end do
        call put_motion(s)
    end subroutine change_motion

    subroutine shake(s, step, by)
        type(both_t), intent(inout) :: s
        integer, intent(in) :: step
        real(dp), intent(in) :: by !! cells
        integer :: d, p

        do p = 1, s%solid%n
            do d = 1, 3
                s%solid%x(d, p) = s%solid%x(d, p) &
                    + s%air%dx(d)*by*(noise(p + 7*step, d + 3) - 0.5_dp)
            end do
        end do
    end subroutine shake

    !> Gas, energy accounts and deferred sources on the GPU.
    subroutine stock(s, all, kept, products)
        type(both_t), intent(inout) :: s
        real(dp), intent(out) :: all(5), kept(5), products
        real(dp) :: totals(0:6)

        call gpu_air_totals(s%other%device, s%other, totals, s%err)
        call stored_totals(s%other, s%far, kept, products, s%err)
        all = totals(1:5) + kept
    end subroutine stock

    !> What mass, momentum and energy are to be compared with.
    function gas_scale(air) result(scale)
        type(air_t), intent(in) :: air
        real(dp) :: scale(5)
        integer :: c

        do c = 1, 5
            scale(c) = product(air%dx) &
                *sum(abs(real(air%u(1:air%n(1), 1:air%n(2), 1:air%n(3), c), dp)))
        end do
        scale(2:4) = sqrt(scale(1)*scale(5))
    end function gas_scale
end module gpu_coupled_scene
