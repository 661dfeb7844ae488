! SPDX-License-Identifier: MIT
!> Problems of the air whose solution is known, for any scheme and resolution: the error, and what
!> it has cost.
module air_problems
    use brz_kinds, only: dp, int64, rk
    use brz_air_setup, only: make_grid, time_step_ramp
    use brz_air_state, only: air_ok, air_t, bc_outflow, bc_periodic, bc_symmetry, bc_wall, wall_t
    use shared_steps, only: air_step
    use brz_air_sums, only: air_time_step
    use brz_blast1d_profile, only: blast1d_at
    use brz_blast1d_state, only: blast1d_input_t, blast1d_t, start_blast1d
    use brz_blast1d_step, only: advance_blast1d
    use brz_gas, only: to_conserved, to_primitive
    use brz_jwl, only: jwl_t
    use exact_blasts, only: front_radius, sedov_energy, sedov_state
    use exact_riemann, only: riemann
    implicit none
    private
    public :: scheme_name, choose_scheme, air_result_t, n_schemes
    public :: sod, entropy_wave, vortex, sedov, balloon_tube, balloon_box, double_rarefaction, &
        free_air_blast
    public :: set_up_sedov, judge_sedov

    integer, parameter :: n_schemes = 8
    character(*), parameter :: scheme_name(n_schemes) = [character(22) :: &
        'first_order-sw', 'muscl-sw', 'weno3-sw', 'weno5z-sw', 'first_order-hllc', 'muscl-hllc', &
        'weno3-hllc', 'weno5z-hllc']
    real(dp), parameter :: pi = acos(-1.0_dp)

    !> What a run has shown.
    type :: air_result_t
        integer :: status = air_ok
        real(dp) :: error = 0 !! mean, relative where the text of the problem says so
        real(dp) :: radius = 0 !! of the shock, over the exact one, where there is one
        real(dp) :: seconds = 0 !! of one core
        integer(int64) :: cell_steps = 0
        integer(int64) :: fallback_faces = 0
    end type air_result_t

contains

    !> Set one of the schemes: MUSCL and first order with two stages, the others with three.
    subroutine choose_scheme(m, air)
        integer, intent(in) :: m !! 1..n_schemes
        type(air_t), intent(inout) :: air

        air%scheme%reconstruction = modulo(m - 1, 4) + 1
        air%scheme%flux = (m - 1)/4 + 1
        air%n_stages = merge(3, 2, air%scheme%reconstruction > 2)
    end subroutine choose_scheme

    !> A box of gas at rest from the origin.
    subroutine make_box(m, cells, side, bc, rest, air)
        integer, intent(in) :: m !! scheme
        integer, intent(in) :: cells(3)
        real(dp), intent(in) :: side !! along x; cells are cubes [m]
        integer, intent(in) :: bc
        real(dp), intent(in) :: rest(2) !! density, pressure
        type(air_t), intent(inout) :: air

        call choose_scheme(m, air)
        air%rho_rest = real(rest(1), rk)
        air%p_rest = real(rest(2), rk)
        air%bc = bc
        where (spread(cells == 1, 1, 2)) air%bc = bc_wall
        air%activity = .true.
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], side/cells(1)*cells, cells, air)
    end subroutine make_box

    !> Set one cell by density, velocity, pressure.
    subroutine set_cell(air, cell, w)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: cell(3)
        real(dp), intent(in) :: w(5)
        real(rk) :: q(5)

        call to_conserved(air%scheme%gamma, real(w, rk), q)
        air%u(cell(1), cell(2), cell(3), :5) = q
    end subroutine set_cell

    !> Density, velocity, pressure of a cell.
    function state_of(air, cell) result(w)
        type(air_t), intent(in) :: air
        integer, intent(in) :: cell(3)
        real(dp) :: w(5)
        real(rk) :: q(5), s(5)

        q = air%u(cell(1), cell(2), cell(3), :5)
        call to_primitive(air%scheme%gamma, q, s)
        w = s
    end function state_of

    !> Run to a time and count what it costs.
    subroutine run(air, cfl, ramp, t_end, seen)
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: cfl, t_end
        integer, intent(in) :: ramp !! first steps, over which the time step grows
        type(air_result_t), intent(inout) :: seen
        type(wall_t) :: wall
        real(dp) :: t, dt, start, now
        integer :: step

        t = 0
        step = 0
        call cpu_time(start)
        do while (t < t_end*(1 - 1e-12_dp))
            dt = air_time_step(air, wall, cfl)*time_step_ramp(step, ramp)
            if (.not. dt > 1e-7_dp*t_end) seen%status = 2
            if (seen%status /= air_ok) exit
            dt = min(dt, t_end - t)
            call air_step(air, wall, dt, seen%status)
            t = t + dt
            step = step + 1
            seen%cell_steps = seen%cell_steps + product(int(air%n, int64))
        end do
        call cpu_time(now)
        seen%seconds = now - start
        seen%fallback_faces = air%fallback_faces
    end subroutine run

    !> Shock tube of Sod at t = 0.2: mean error of the density.
    subroutine sod(m, n, seen)
        integer, intent(in) :: m, n !! scheme, cells
        type(air_result_t), intent(out) :: seen
        real(dp), parameter :: left(3) = [1.0_dp, 0.0_dp, 1.0_dp]
        real(dp), parameter :: right(3) = [0.125_dp, 0.0_dp, 0.1_dp]

        call tube(m, n, 0.5_dp, 0, .true., reshape([left, right], [3, 2]), 0.2_dp, seen)
    end subroutine sod

    !> Gas of a thousand times the density and `ratio` times the pressure against air; relative
    !> mean error of the density when the shock has gone 0.35 of the tube.
    subroutine balloon_tube(m, n, ratio, cfl, fallback, seen)
        integer, intent(in) :: m, n !! scheme, cells
        real(dp), intent(in) :: ratio, cfl
        logical, intent(in) :: fallback
        type(air_result_t), intent(out) :: seen
        real(dp) :: left(3), right(3), state(3), p, u

        right = [1.2_dp, 0.0_dp, 1e5_dp]
        left = [1200.0_dp, 0.0_dp, ratio*1e5_dp]
        call riemann(left, right, 0.0_dp, state, p, u)
        call tube(m, n, cfl, 20, fallback, reshape([left, right], [3, 2]), 0.35_dp/(1.2_dp*u), seen)
    end subroutine balloon_tube

    !> An octant of a balloon of that gas, n/4 cells in radius, until a plane shock would have left
    !> the box: does the scheme survive it?
    subroutine balloon_box(m, n, ratio, cfl, fallback, seen)
        integer, intent(in) :: m, n !! scheme, cells per side
        real(dp), intent(in) :: ratio, cfl
        logical, intent(in) :: fallback
        type(air_result_t), intent(out) :: seen
        type(air_t) :: air
        real(dp) :: state(3), p, u

        call make_box(m, [n, n, n], 1.0_dp, bc_outflow, [1.2_dp, 1e5_dp], air)
        air%bc(1, :) = bc_symmetry
        air%fallback = fallback
        call paint_corner(air, n/4.0_dp, [1200.0_dp, ratio*1e5_dp])
        call riemann([1200.0_dp, 0.0_dp, ratio*1e5_dp], [1.2_dp, 0.0_dp, 1e5_dp], 0.0_dp, state, &
            p, u)
        call run(air, cfl, 20, 0.75_dp/(1.2_dp*u), seen)
    end subroutine balloon_box

    !> Gas of one state that flows apart at twice its speed of sound: near-vacuum; relative mean
    !> error of the density.
    subroutine double_rarefaction(m, n, seen)
        integer, intent(in) :: m, n !! scheme, cells
        type(air_result_t), intent(out) :: seen
        real(dp) :: c

        c = sqrt(1.4_dp*1e5_dp/1.2_dp)
        call tube(m, n, 0.5_dp, 20, .true., reshape([1.2_dp, -2*c, 1e5_dp, 1.2_dp, 2*c, 1e5_dp], &
            [3, 2]), 0.15_dp/c, seen)
    end subroutine double_rarefaction

    !> A tube of unit length with two gases; mean error of the density over that of right.
    subroutine tube(m, n, cfl, ramp, fallback, gas, t, seen)
        integer, intent(in) :: m, n, ramp
        real(dp), intent(in) :: cfl, t
        real(dp), intent(in) :: gas(3, 2) !! density, velocity, pressure on the left, right
        logical, intent(in) :: fallback
        type(air_result_t), intent(out) :: seen
        type(air_t) :: air
        real(dp) :: exact(3), p, u, total
        integer :: i, side

        call make_box(m, [n, 1, 1], 1.0_dp, bc_outflow, gas([1, 3], 2), air)
        air%fallback = fallback
        do i = 1, n
            side = merge(1, 2, i <= n/2)
            call set_cell(air, [i, 1, 1], [gas(1:2, side), 0.0_dp, 0.0_dp, gas(3, side)])
        end do
        call run(air, cfl, ramp, t, seen)
        total = 0
        do i = 1, n
            call riemann(gas(:, 1), gas(:, 2), ((i - 0.5_dp)/n - 0.5_dp)/t, exact, p, u)
            seen%error = seen%error + abs(air%u(i, 1, 1, 1) - exact(1))
            total = total + exact(1)
        end do
        seen%error = seen%error/merge(total, real(n, dp), ramp > 0)
    end subroutine tube

    !> Wave of density carried once through a periodic box: mean error of the density.
    subroutine entropy_wave(m, n, seen)
        integer, intent(in) :: m, n !! scheme, cells
        type(air_result_t), intent(out) :: seen
        type(air_t) :: air
        integer :: i

        call make_box(m, [n, 1, 1], 1.0_dp, bc_periodic, [1.0_dp, 1.0_dp], air)
        do i = 1, n
            call set_cell(air, [i, 1, 1], [1 + 0.2_dp*sin(2*pi*(i - 0.5_dp)/n), 1.0_dp, 0.0_dp, &
                0.0_dp, 1.0_dp])
        end do
        call run(air, 0.4_dp, 0, 1.0_dp, seen)
        do i = 1, n
            seen%error = seen%error + abs(air%u(i, 1, 1, 1) - 1 &
                - 0.2_dp*sin(2*pi*(i - 0.5_dp)/n))/n
        end do
    end subroutine entropy_wave

    !> Isentropic vortex (Shu 1998, strength 5) carried along the diagonal of a periodic box of side
    !> 10 for the time t, a multiple of the cell side: mean error of the density.
    subroutine vortex(m, n, t, seen)
        integer, intent(in) :: m, n !! scheme, cells per side
        real(dp), intent(in) :: t
        type(air_result_t), intent(out) :: seen
        type(air_t) :: air
        integer :: i, j
        real(dp) :: w(5)

        call make_box(m, [n, n, 1], 10.0_dp, bc_periodic, [1.0_dp, 1.0_dp], air)
        air%bc(:, 3) = bc_wall
        do j = 1, n
            do i = 1, n
                call set_cell(air, [i, j, 1], vortex_at(([i, j] - 0.5_dp)*10/n, 0.0_dp))
            end do
        end do
        call run(air, 0.4_dp, 0, t, seen)
        do j = 1, n
            do i = 1, n
                w = vortex_at(([i, j] - 0.5_dp)*10/n, t)
                seen%error = seen%error + abs(air%u(i, j, 1, 1) - w(1))/n**2
            end do
        end do
    end subroutine vortex

    !> The vortex, whose middle is at (5, 5) at time 0.
    pure function vortex_at(x, t) result(w)
        real(dp), intent(in) :: x(2), t
        real(dp) :: w(5), d(2), e, temperature

        d = modulo(x - t, 10.0_dp) - 5
        e = 5/(2*pi)*exp((1 - sum(d**2))/2)
        temperature = 1 - 0.4_dp/(2*1.4_dp)*e**2
        w = [temperature**2.5_dp, 1 - e*d(2), 1 + e*d(1), 0.0_dp, temperature**3.5_dp]
    end function vortex_at

    !> Point blast in an octant of side 1.2 at t = 1: relative mean error of the density inside the
    !> shock, and the radius of the shock.
    subroutine sedov(m, n, seen)
        integer, intent(in) :: m, n !! scheme, cells per side
        type(air_result_t), intent(out) :: seen
        type(air_t) :: air

        call set_up_sedov(m, n, air)
        call run(air, 0.5_dp, 20, 1.0_dp, seen)
        if (seen%status == air_ok) call judge_sedov(air, seen)
    end subroutine sedov

    !> Energy in a ball of three cells in the corner of an octant of n^3 cells. It is to run until
    !> t = 1 with CFL 0.5 and a ramp of 20 steps.
    subroutine set_up_sedov(m, n, air)
        integer, intent(in) :: m, n !! scheme, cells per side
        type(air_t), intent(inout) :: air
        integer :: inside

        call make_box(m, [n, n, n], 1.2_dp, bc_outflow, [1.0_dp, 1e-5_dp], air)
        air%bc(1, :) = bc_symmetry
        inside = count_near(n, 3.0_dp)
        call paint_corner(air, 3.0_dp, [1.0_dp, 0.4_dp*sedov_energy/(8*inside*(1.2_dp/n)**3)])
    end subroutine set_up_sedov

    !> Error of the density and radius of the shock.
    subroutine judge_sedov(air, seen)
        type(air_t), intent(in) :: air
        type(air_result_t), intent(inout) :: seen
        real(dp), allocatable :: p(:, :, :)
        real(dp) :: dx, w(5), s(3), total, r
        integer :: i, j, k, n

        n = air%n(1)
        dx = 1.2_dp/n
        allocate (p(n, n, n))
        total = 0
        do k = 1, n
            do j = 1, n
                do i = 1, n
                    r = norm2([i, j, k] - 0.5_dp)*dx
                    w = state_of(air, [i, j, k])
                    s = sedov_state(r)
                    seen%error = seen%error + abs(w(1) - s(1))
                    if (r < 1) total = total + s(1)
                    p(i, j, k) = w(5)
                end do
            end do
        end do
        seen%error = seen%error/total
        seen%radius = front_radius(p)*dx
    end subroutine judge_sedov

    !> Cells of an octant within a radius in cells.
    pure integer function count_near(n, radius)
        integer, intent(in) :: n
        real(dp), intent(in) :: radius
        integer :: i, j, k, most

        most = min(n, ceiling(radius))
        count_near = 0
        do k = 1, most
            do j = 1, most
                do i = 1, most
                    if (norm2([i, j, k] - 0.5_dp) < radius) count_near = count_near + 1
                end do
            end do
        end do
    end function count_near

    !> Give the cells within a radius in cells of the corner a density and a pressure.
    subroutine paint_corner(air, radius, gas)
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: radius, gas(2)
        integer :: i, j, k

        do k = 1, min(air%n(3), ceiling(radius))
            do j = 1, min(air%n(2), ceiling(radius))
                do i = 1, min(air%n(1), ceiling(radius))
                    if (norm2([i, j, k] - 0.5_dp) < radius) call set_cell(air, [i, j, k], &
                        [gas(1), 0.0_dp, 0.0_dp, 0.0_dp, gas(2)])
                end do
            end do
        end do
    end subroutine paint_corner

    !> 1 kg of hot gas with the density and energy of TNT in an octant of side 0.8 m, when its shock
    !> is near 0.65 m: mean error of the overpressure over its mean size, against the same in one
    !> dimension with some 700 cells.
    subroutine free_air_blast(m, n, seen)
        integer, intent(in) :: m, n !! scheme, cells per side
        type(air_result_t), intent(out) :: seen
        type(air_t) :: air
        type(blast1d_t) :: blast
        real(dp) :: dx, volume, w(5), s(3), total
        integer :: i, j, k
        real(dp), parameter :: t = 2.5e-4_dp, side = 0.8_dp

        call reference_blast(t, blast)
        dx = side/n
        call make_box(m, [n, n, n], side, bc_outflow, [1.225_dp, 101325.0_dp], air)
        air%bc(1, :) = bc_symmetry
        volume = 8*count_near(n, blast%input%radius/dx)*dx**3 ! of cells, the mass stays exact
        call paint_corner(air, blast%input%radius/dx, [1/volume, 0.4_dp*4.29e6_dp/volume])
        call run(air, 0.5_dp, 20, t, seen)
        if (seen%status /= air_ok) return
        total = 0
        do k = 1, n
            do j = 1, n
                do i = 1, n
                    w = state_of(air, [i, j, k])
                    s = [1.225_dp, 0.0_dp, 101325.0_dp]
                    if (norm2([i, j, k] - 0.5_dp)*dx < blast%r(blast%n)) &
                        call blast1d_at(blast, norm2([i, j, k] - 0.5_dp)*dx, s)
                    seen%error = seen%error + abs(w(5) - s(3))
                    total = total + abs(s(3) - 101325)
                end do
            end do
        end do
        seen%error = seen%error/total
    end subroutine free_air_blast

    !> The same charge along the radius.
    subroutine reference_blast(t, blast)
        real(dp), intent(in) :: t
        type(blast1d_t), intent(out) :: blast
        type(blast1d_input_t) :: input
        logical :: ok

        input%radius = (3/(4*pi*1630))**(1/3.0_dp)
        input%eos = jwl_t(rho0=1630.0_dp, omega=0.4_dp, e0=1630*4.29e6_dp)
        input%n_in = 120
        input%n_air = 600
        call start_blast1d(input, blast)
        ok = .true.
        do while (ok .and. blast%time < t*(1 - 1e-12_dp))
            call advance_blast1d(blast, t - blast%time, ok)
        end do
    end subroutine reference_blast
end module air_problems
