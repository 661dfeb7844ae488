! SPDX-License-Identifier: MIT
!> Random scenes of strong shocks and bodies that move, meet, turn and break: the number of a scene
!> alone decides what it is.
module random_scenes
    use brz_air_outside, only: keep_outside
    use brz_air_setup, only: make_grid, time_step_ramp
    use brz_air_state, only: air_ok, air_t, bc_outflow, bc_periodic, bc_symmetry, bc_wall
    use shared_steps, only: air_step, reclassify, set_wall_velocity, spread_load
    use brz_air_sums, only: air_time_step
    use brz_air_totals, only: air_totals
    use brz_coupling_setup, only: couple
    use brz_coupling_state, only: coupling_t
    use brz_gas, only: to_conserved
    use brz_kinds, only: dp, rk
    use brz_scheme, only: first_order, hllc, muscl_cells, steger_warming, weno3_cells, weno5z_cells
    use brz_interacting_bodies, only: interacting_bodies_t
    use dice, only: dice_t
    use gas_tools, only: least_gas
    use random_bodies, only: drawn_body_t, draw_bodies, move_bodies
    implicit none
    private
    public :: random_scene_t, run_random_scene

    real(dp), parameter :: gamma = 1.4_dp, rho0 = 1.2_dp, p0 = 1e5_dp
    real(dp), parameter :: c0 = sqrt(gamma*p0/rho0)
    real(dp), parameter :: shortest = 1e-6_dp !! time step, over that of sound through a cell

    type :: random_scene_t
        type(air_t) :: air
        type(interacting_bodies_t) :: solid
        type(coupling_t) :: coupling
        type(drawn_body_t), allocatable :: bodies(:)
        character(200) :: what = '' !! it is
        character(100) :: fault = '' !! '' while there is none
        integer :: steps = 0
        real(dp) :: cfl = 0.5_dp, t = 0, dt = 0
        real(dp) :: speed = c0 !! a scale of velocities [m/s]
        real(dp) :: start(4) = 0 !! mass and momentum at the start
        real(dp) :: diagnostics(2) = 0 !! errors of mass and momentum, the worst
        real(dp) :: least(2) = huge(1.0_dp) !! density and warmth, see least_gas
        real(dp) :: least_dt = huge(1.0_dp) !! time step over that of sound through a cell
    end type random_scene_t

contains

    !> Draw a scene and run it for some steps, or to its first fault.
    subroutine run_random_scene(number, steps, s)
        integer, intent(in) :: number, steps
        type(random_scene_t), intent(out) :: s

        call draw_scene(number, s)
        do while (s%steps < steps .and. s%fault == '')
            call step_scene(s)
        end do
    end subroutine run_random_scene

    subroutine draw_scene(number, s)
        integer, intent(in) :: number
        type(random_scene_t), intent(inout) :: s
        type(dice_t) :: random
        real(dp) :: speed

        call random%seed(number)
        call draw_box(random, s)
        where (s%air%bc == bc_periodic .and. spread(s%air%n < 8, 1, 2)) s%air%bc = bc_wall
        call draw_gas(random, s)
        call keep_outside(s%air)
        call draw_bodies(s%air, rho0, c0, random, s%solid, s%bodies, speed)
        s%speed = max(s%speed, 2*speed)
        call couple(s%air, s%solid, real(p0, rk), s%coupling)
        call total(s, s%start)
        write (s%what, '(a, i0, a, 3(1x, i0), a, 6i2, a, 3(1x, i0), a, f5.2, a, 4i2)') 'scene ', &
            number, ': cells', s%air%n, ' ends', s%air%bc, ' scheme', s%air%scheme%reconstruction, &
            s%air%scheme%flux, s%air%n_stages, ' cfl', s%cfl, ' bodies', s%bodies%kind
        write (s%what, '(2a, i0, a, f0.2)') trim(s%what), ' particles ', s%solid%n, ' speed/c ', &
            s%speed/c0
    end subroutine draw_scene

    !> Cells, boundaries and scheme.
    subroutine draw_box(random, s)
        type(dice_t), intent(inout) :: random
        type(random_scene_t), intent(inout) :: s
        integer :: cells(3), d, dims, least

        associate (air => s%air)
            air%present = .true.
            air%rho_rest = real(rho0, rk)
            air%p_rest = real(p0, rk)
            call draw_scheme(random, air)
            s%cfl = 0.5_dp
            if (random%draw() < 0.3_dp) s%cfl = 0.2_dp + 0.6_dp*random%draw()
            dims = random%pick([1, 2, 2, 2, 3])
            cells = 1
            least = merge(40, merge(14, 6, dims == 2), dims == 1)
            do d = 1, dims
                cells(d) = least + int(1.3_dp*least*random%draw())
                air%bc(:, d) = [random%pick([bc_outflow, bc_wall, bc_symmetry, bc_outflow]), &
                                random%pick([bc_outflow, bc_wall, bc_outflow])]
                if (random%draw() < 0.15_dp) air%bc(:, d) = bc_periodic
            end do
            call make_grid([0.0_dp, 0.0_dp, 0.0_dp], cells*0.01_dp, cells, air)
        end associate
    end subroutine draw_box

    !> The default scheme or another, one gas or two.
    subroutine draw_scheme(random, air)
        type(dice_t), intent(inout) :: random
        type(air_t), intent(inout) :: air

        air%scheme%reconstruction = &
            random%pick([muscl_cells, muscl_cells, muscl_cells, muscl_cells, muscl_cells, &
                         weno3_cells, weno5z_cells, first_order])
        air%scheme%flux = merge(steger_warming, hllc, air%scheme%reconstruction == weno3_cells)
        air%n_stages = merge(3, 2, air%scheme%reconstruction >= weno3_cells)
        if (random%draw() > 1/3.0_dp) return
        air%n_var = 6
        air%scheme%mixture = .true.
        air%scheme%gamma_products = 1.25_rk
    end subroutine draw_scheme

    !> Gas at rest, a shock that runs into it from the left, and a hot or a thin block.
    subroutine draw_gas(random, s)
        type(dice_t), intent(inout) :: random
        type(random_scene_t), intent(inout) :: s
        real(dp) :: ratio, w(5)
        integer :: d, hi(3), lo(3), n(3)

        n = s%air%n
        call fill(s%air, [1, 1, 1], n, [rho0, 0.0_dp, 0.0_dp, 0.0_dp, p0], 0.0_dp)
        ratio = 10**(3*random%draw())
        s%speed = c0*(1 + sqrt(ratio))
        hi = n
        hi(1) = max(2, int(n(1)*(0.15_dp + 0.3_dp*random%draw())))
        if (random%draw() < 0.8_dp) call fill(s%air, [1, 1, 1], hi, behind_shock(ratio), 0.0_dp)
        if (random%draw() > 0.4_dp) return
        do d = 1, 3
            lo(d) = 1 + int((n(d) - 1)*random%draw())
            hi(d) = min(n(d), lo(d) + 1 + int(0.3_dp*n(d)*random%draw()))
        end do
        w = 0
        w(1) = rho0*10**(3*random%draw() - 1.5_dp)
        w(5) = p0*10**(5*random%draw() - 2)
        call fill(s%air, lo, hi, w, 1.0_dp)
    end subroutine draw_gas

    !> Set a block of cells.
    subroutine fill(air, lo, hi, w, products)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: lo(3), hi(3)
        real(dp), intent(in) :: w(5) !! density, velocity, pressure
        real(dp), intent(in) :: products !! their mass fraction
        real(rk) :: u(6)
        integer :: c

        call to_conserved(merge(air%scheme%gamma_products, air%scheme%gamma, &
                                products > 0 .and. air%n_var == 6), real(w, rk), u)
        u(6) = u(1)*real(products, rk)
        do c = 1, air%n_var
            air%u(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3), c) = u(c)
        end do
    end subroutine fill

    !> Density, velocity and pressure behind a shock that runs to the right into the gas at rest.
    pure function behind_shock(ratio) result(w)
        real(dp), intent(in) :: ratio !! of the pressures
        real(dp) :: w(5)
        real(dp) :: m

        m = sqrt((ratio - 1)*(gamma + 1)/(2*gamma) + 1)
        w = 0
        w(1) = rho0*(gamma + 1)*m**2/((gamma - 1)*m**2 + 2)
        w(2) = 2*c0/(gamma + 1)*(m - 1/m)
        w(5) = ratio*p0
    end function behind_shock

    !> One step of air and bodies, as brz_time_step has it, and what is wrong after it.
    subroutine step_scene(s)
        type(random_scene_t), intent(inout) :: s
        integer :: status

        s%dt = air_time_step(s%air, s%coupling%wall, s%cfl)*time_step_ramp(s%steps, 10)
        s%least_dt = min(s%least_dt, s%dt*c0/s%air%dx(1))
        if (.not. s%least_dt > shortest) s%fault = 'the time step collapses'
        call set_wall_velocity(s%air, s%solid, s%coupling, s%dt)
        call air_step(s%air, s%coupling%wall, s%dt, status)
        if (status /= air_ok) s%fault = 'the air is lost'
        if (s%fault /= '') return
        call spread_load(s%solid, s%coupling, s%dt)
        call move_bodies(s%air, s%t, s%dt, s%bodies, s%solid)
        call reclassify(s%air, s%solid, s%coupling)
        s%t = s%t + s%dt
        s%steps = s%steps + 1
        call judge(s)
    end subroutine step_scene

    !> Look at gas and balance.
    subroutine judge(s)
        type(random_scene_t), intent(inout) :: s
        real(dp) :: density, momentum, now(4), warmth

        call least_gas(s%air, s%coupling%wall, density, warmth)
        s%least = min(s%least, [density, warmth])
        call total(s, now)
        momentum = (s%start(1) + abs(s%air%outflow(1)))*s%speed
        s%diagnostics = max(s%diagnostics, [abs(now(1) - s%start(1))/s%start(1), &
                                maxval(abs(now(2:4) - s%start(2:4)))/momentum])
        if (.not. all(s%diagnostics < merge(1e-11_dp, 1e-4_dp, rk == dp))) &
            s%fault = 'the books do not balance'
        if (.not. all(s%least > 0)) s%fault = 'gas without density or internal energy'
    end subroutine judge

    !> Mass and momentum of gas, of what waits, what has left the box and what the walls took.
    subroutine total(s, sum)
        type(random_scene_t), intent(inout) :: s !! the totals use its work space
        real(dp), intent(out) :: sum(4)
        real(dp) :: gas(5)

        call air_totals(s%air, s%coupling%wall, gas)
        sum = gas(1:4) + s%air%outflow(1:4)
        sum(2:4) = sum(2:4) + s%coupling%diagnostics%impulse + &
                   s%coupling%diagnostics%impulse_reference
    end subroutine total
end module random_scenes
