! SPDX-License-Identifier: MIT
!> From the deck to the air at time zero: grid, undisturbed gas, boxes of gas, charges.
module brz_air_setup
    use brz_kinds, only: dp, int8, rk
    use brz_air_grid, only: faces_of_bricks, layers_around
    use brz_air_outside, only: keep_outside
    use brz_air_part, only: box_of, layers_seen, take_part
    use brz_air_state, only: air_t, brick, bc_periodic, bc_symmetry, cell_centre, &
        charge_report_t, n_ghost
    use brz_boundary_names, only: boundary_choices, boundary_names
    use brz_boxes, only: cells_t
    use brz_case, only: case_t, charge_case_t, gas_case_t, label
    use brz_charge_shape, only: filled_part, make_shape, charge_shape_t
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_gas, only: to_conserved
    use brz_gas_box, only: second_gamma
    use brz_gas_file, only: pour_gas_file
    use brz_grid_lines, only: n_blocks
    use brz_inflow, only: make_inflow
    use brz_ranks, only: ranks_t, several
    use brz_running_total, only: begin_total
    use brz_scheme, only: max_var, reach_of
    implicit none
    private
    public :: set_up_air, has_own_gas, make_grid, time_step_ramp, reconstruction_names

    ! in the order of the codes in brz_scheme
    character(*), parameter :: reconstruction_names(4) = [character(16) :: 'first_order', 'muscl', &
        'weno3', 'weno5z']
    character(*), parameter :: flux_names(2) = [character(16) :: 'steger_warming', 'hllc']
    real(dp), parameter :: on_plane = 1e-6_dp
    !! how exactly a plane must halve a charge, in half sides

contains

    !> Allocate the air and fill it with what the deck says.
    subroutine set_up_air(case, air, err, ranks, boxes)
        type(case_t), intent(in) :: case
        type(air_t), intent(out) :: air
        type(error_t), intent(inout) :: err
        type(ranks_t), intent(in), optional :: ranks !! that share it
        type(cells_t), intent(in), optional :: boxes(0:) !! (processes) cells of each
        integer :: d, s, m

        air%present = case%air%present
        if (.not. air%present) return
        call choose_scheme(case, air, err)
        if (failed(err)) return
        air%rho_rest = real(case%air%density, rk)
        air%p_rest = real(case%air%pressure, rk)
        air%fallback = case%air%fallback
        air%activity = case%air%activity
        do d = 1, 3
            do s = 1, 2
                call boundary_code(case%air%bc(s, d), air%bc(s, d), err)
            end do
            if (any(air%bc(:, d) == bc_periodic) .and. .not. all(air%bc(:, d) == bc_periodic)) &
                call raise(err, exit_deck, &
                    label('air', '', case%air%place)// &
                    "bc='periodic' must stand at both ends of a direction")
        end do
        if (failed(err)) return
        if (present(ranks)) air%part%ranks = ranks
        if (present(boxes)) allocate (air%part%boxes(0:ubound(boxes, 1)), source=boxes)
        if (several(air%part%ranks) .and. size(case%bodies) > 0) &
            air%around = layers_seen
        call make_grid(case%air%lo, case%air%hi, case%air%cells, air)
        if (allocated(case%gas)) then
            do m = 1, size(case%gas)
                if (case%gas(m)%file == '') then
                    call fill_box(air, case%gas(m))
                else
                    call pour_gas_file(case%gas(m), air, err)
                end if
            end do
            if (failed(err)) return
        end if
        call keep_outside(air)
        if (allocated(case%inflows)) then
            allocate (air%inflow(size(case%inflows)))
            do m = 1, size(case%inflows)
                call make_inflow(case%inflows(m), air%scheme%gamma, air%rho_rest, air%p_rest, &
                                 air%inflow(m))
            end do
        end if
        if (.not. allocated(case%charges)) return
        allocate (air%charge(size(case%charges)))
        do m = 1, size(case%charges)
            if (case%charges(m)%start /= '3d') cycle ! see start_from_1d, start_from_2d
            call place_charge(air, case%charges(m), has_own_gas(case, m), air%charge(m), err)
        end do
    end subroutine set_up_air

    !> Numerical scheme and gases: charges with a ratio of specific heats of their own need a sixth
    !> conserved variable, and all of them the same ratio.
    subroutine choose_scheme(case, air, err)
        type(case_t), intent(in) :: case
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        real(dp) :: gamma
        integer :: m

        air%scheme%gamma = real(case%air%gamma, rk)
        air%scheme%reconstruction = findloc(reconstruction_names, case%air%reconstruction, dim=1)
        air%scheme%flux = findloc(flux_names, case%air%flux, dim=1)
        if (air%scheme%reconstruction*air%scheme%flux == 0) &
            call raise(err, exit_deck, label('air', '', case%air%place)// &
                "unknown reconstruction '" &
                //trim(case%air%reconstruction)//"' or flux '"//trim(case%air%flux)//"'")
        air%n_stages = merge(2, 3, case%air%integrator == 'ssprk2')
        if (allocated(case%charges)) then
            do m = 1, size(case%charges)
                if (has_own_gas(case, m)) call carry_gas(case%charges(m)%gamma, label('charge', &
                    case%charges(m)%id, case%charges(m)%place), air, err)
            end do
        end if
        if (.not. allocated(case%gas)) return
        do m = 1, size(case%gas)
            gamma = second_gamma(case%gas(m), err)
            if (gamma > 1) call carry_gas(gamma, label('gas', case%gas(m)%id, case%gas(m)%place), &
                                          air, err)
        end do
    end subroutine choose_scheme

    !> Carry products of a ratio of specific heats; there is room for one.
    subroutine carry_gas(gamma, whose, air, err)
        real(dp), intent(in) :: gamma
        character(*), intent(in) :: whose !! begins a message
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (air%scheme%mixture .and. abs(real(gamma, rk) - air%scheme%gamma_products) > 0) &
            call raise(err, exit_deck, whose//'only one gamma besides that of the air can be '// &
                       'carried, and other products have a different one')
        air%scheme%mixture = .true.
        air%scheme%gamma_products = real(gamma, rk)
        air%n_var = 6
    end subroutine carry_gas

    !> True if a charge has a ratio of specific heats other than that of the air.
    pure logical function has_own_gas(case, m)
        type(case_t), intent(in) :: case
        integer, intent(in) :: m !! number of the charge

        has_own_gas = case%charges(m)%gamma > 1 .and. &
                      abs(case%charges(m)%gamma - case%air%gamma) > 0
    end function has_own_gas

    !> Factor on the time step: it grows from a tenth to one over the first steps, because the
    !> speeds that a balloon of hot gas will cause are not there yet.
    pure real(dp) function time_step_ramp(step, ramp_steps)
        integer, intent(in) :: step !! steps done so far
        integer, intent(in) :: ramp_steps !! 0: no ramp

        time_step_ramp = 1
        if (step < ramp_steps) time_step_ramp = 0.1_dp + 0.9_dp*step/ramp_steps
    end function time_step_ramp

    !> Code of a boundary condition.
    subroutine boundary_code(word, code, err)
        character(*), intent(in) :: word
        integer, intent(out) :: code
        type(error_t), intent(inout) :: err

        code = findloc(boundary_names, word, dim=1)
        if (code == 0) call raise(err, exit_deck, "&air: unknown bc '"//trim(word)// &
                                  "'; use one of "//boundary_choices())
    end subroutine boundary_code

    !> Allocate all arrays for a box of cells, with the gas at rest; if several processes share it,
    !> for the part of this one.
    subroutine make_grid(lo, hi, cells, air)
        real(dp), intent(in) :: lo(3), hi(3) !! corners of the box [m]
        integer, intent(in) :: cells(3) !! 1: direction not modelled
        type(air_t), intent(inout) :: air !! its gas, boundaries and processes are set
        integer :: n(3), g(3), c, blocks

        air%present = .true.
        air%g = merge(max(n_ghost, air%around), 0, cells > 1)
        call share_grid(cells, air)
        air%lo = lo
        air%dx = (hi - lo)/cells
        n = air%n
        g = air%g
        allocate (air%u(1 - g(1):n(1) + g(1), 1 - g(2):n(2) + g(2), 1 - g(3):n(3) + g(3), &
            air%n_var))
        call to_conserved(air%scheme%gamma, [air%rho_rest, 0.0_rk, 0.0_rk, 0.0_rk, air%p_rest], &
            air%rest)
        do c = 1, air%n_var
            air%u(:, :, :, c) = air%rest(c)
        end do
        allocate (air%u_start, air%rate, source=air%u)
        air%rate = 0
        blocks = max(n_blocks(n, 1), n_blocks(n, 2), n_blocks(n, 3))
        call begin_diagnostics(air)
        allocate (air%suspect(blocks), source=0)
        allocate (air%bad(1 - g(1):n(1) + g(1), 1 - g(2):n(2) + g(2), 1 - g(3):n(3) + g(3)), &
            source=0_int8)
        allocate (air%edge(sum(product(n)/n, n > 1), air%n_var, 2), source=0.0_rk)
        g = (n + brick - 1)/brick
        allocate (air%reached(g(1), g(2), g(3)), source=0_int8)
        allocate (air%active(g(1), g(2), g(3)), source=1_int8)
        allocate (air%brick_sum(0:air%n_var, product(g)), source=0.0_dp)
        allocate (air%leaving(faces_of_bricks(n, g), air%n_var, 2), source=0.0_dp)
    end subroutine make_grid

    !> Diagnostics of what passes the outer faces of the grid.
    subroutine begin_diagnostics(air)
        type(air_t), intent(inout) :: air
        real(dp) :: mass
        integer :: c

        mass = product(air%dx*air%whole)*air%rho_rest
        do c = 1, 6
            call begin_total(air%left(c), mass, 0.0_dp)
        end do
        do c = 2, 4
            call begin_total(air%left(c), sqrt(mass*product(air%dx*air%whole)*air%p_rest), 0.0_dp)
        end do
        call begin_total(air%left(5), product(air%dx*air%whole)*air%rest(5), 0.0_dp)
    end subroutine begin_diagnostics

    !> Find the box of this process on a grid of so many cells.
    subroutine share_grid(cells, air)
        integer, intent(in) :: cells(3)
        type(air_t), intent(inout) :: air
        type(cells_t) :: box

        air%whole = cells
        air%outer = air%bc
        call take_part(cells, air%bc, merge(n_ghost, 0, cells > 1), air%n_var, &
                       layers_around(cells, air%bc(1, :) == bc_periodic, &
                                     air%n_stages*reach_of(air%scheme)), air%around, air%part)
        call box_of(air%part, cells, air%outer, box, air%bc)
        air%n = box%hi - box%lo + 1
        air%before = box%lo - 1
    end subroutine share_grid

    !> Give the cells whose centre lies in a box of gas its state.
    subroutine fill_box(air, gas)
        type(air_t), intent(inout) :: air
        type(gas_case_t), intent(in) :: gas
        integer :: i, j, k
        real(dp) :: x(3)
        real(rk) :: q(max_var)

        q = 0
        call to_conserved(air%scheme%gamma, real([gas%density, gas%velocity, gas%pressure], rk), q)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    x = cell_centre(air, i, j, k)
                    if (all(x >= gas%lo .and. x <= gas%hi .or. air%n == 1)) &
                        air%u(i, j, k, :) = q(:air%n_var)
                end do
            end do
        end do
    end subroutine fill_box

    !> Put a charge into the air as a balloon of hot gas at rest.
    !>
    !> Cells that its surface cuts are mixed by volume. The density is scaled so that the mass, and
    !> with it the energy, is exact: the whole charge, or what symmetry planes leave of it.
    subroutine place_charge(air, charge, own_gas, report, err)
        type(air_t), intent(inout) :: air
        type(charge_case_t), intent(in) :: charge
        logical, intent(in) :: own_gas !! it is of products, not of air
        type(charge_report_t), intent(out) :: report
        type(error_t), intent(inout) :: err
        type(charge_shape_t) :: shape
        real(dp) :: share, filled, depth
        real(rk) :: hot(3)
        integer :: lo(3), hi(3)

        depth = product(air%dx*air%n, mask=air%n == 1)
        call make_shape(charge, air%n > 1, depth, shape, err)
        if (failed(err)) return
        call share_inside(air, charge, shape, share, err)
        if (failed(err)) return
        lo = 1
        hi = air%whole
        where (air%n > 1)
            lo = max(1, floor((shape%at - shape%half - air%lo)/air%dx))
            hi = min(air%whole, ceiling((shape%at + shape%half - air%lo)/air%dx) + 1)
        end where
        call measure(air, shape, lo, hi, filled)
        if (.not. filled > 0) then
            call raise(err, exit_deck, label('charge', charge%id, charge%place) &
                //"it fills no cell; use smaller cells")
            return
        end if
        report%mass = share*charge%mass
        report%radius = minval(shape%half)
        report%cells = minval(merge(shape%half/air%dx, huge(1.0_dp), air%n > 1))
        report%scale = report%mass/(charge%density*filled)
        hot = real(report%scale*charge%density*[1.0_dp, charge%energy, &
            merge(1.0_dp, 0.0_dp, own_gas)], rk)
        call pour(air, shape, lo, hi, hot)
    end subroutine place_charge

    !> Volume of the cells that a shape fills, on the whole grid: every process finds the same.
    subroutine measure(air, shape, lo, hi, filled)
        type(air_t), intent(in) :: air
        type(charge_shape_t), intent(in) :: shape
        integer, intent(in) :: lo(3), hi(3) !! range of cells of the grid to look at
        real(dp), intent(out) :: filled !! [m3]
        integer :: i, j, k
        real(dp) :: part

        filled = 0
        do k = lo(3), hi(3)
            do j = lo(2), hi(2)
                do i = lo(1), hi(1)
                    part = filled_part(shape, air%lo + ([i, j, k] - 0.5_dp)*air%dx, air%dx)
                    if (part > 0) filled = filled + part*product(air%dx)
                end do
            end do
        end do
    end subroutine measure

    !> Fill a shape with gas of a density and energy (mix, do not replace).
    subroutine pour(air, shape, lo, hi, density)
        type(air_t), intent(inout) :: air
        type(charge_shape_t), intent(in) :: shape
        integer, intent(in) :: lo(3), hi(3) !! range of cells of the grid to look at
        real(rk), intent(in) :: density(3)
        !! mass, energy, mass of products, per volume [kg/m3, J/m3, kg/m3]
        integer :: i, j, k, first(3), last(3)
        real(dp) :: part

        first = max(lo - air%before, 1)
        last = min(hi - air%before, air%n)
        do k = first(3), last(3)
            do j = first(2), last(2)
                do i = first(1), last(1)
                    part = filled_part(shape, cell_centre(air, i, j, k), air%dx)
                    if (.not. part > 0) cycle
                    air%u(i, j, k, :) = real(1 - part, rk)*air%u(i, j, k, :)
                    air%u(i, j, k, 1) = air%u(i, j, k, 1) + real(part, rk)*density(1)
                    air%u(i, j, k, 5) = air%u(i, j, k, 5) + real(part, rk)*density(2)
                    if (air%n_var == 6) air%u(i, j, k, 6) = air%u(i, j, k, 6) &
                        + real(part, rk)*density(3)
                end do
            end do
        end do
    end subroutine pour

    !> Part of a charge that lies in the box: a symmetry plane through its centre leaves a half.
    subroutine share_inside(air, charge, shape, share, err)
        type(air_t), intent(in) :: air
        type(charge_case_t), intent(in) :: charge
        type(charge_shape_t), intent(in) :: shape
        real(dp), intent(out) :: share
        type(error_t), intent(inout) :: err
        real(dp) :: plane, depth
        integer :: d, s

        share = 1
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = 1, 2
                plane = air%lo(d)
                if (s == 2) plane = air%lo(d) + air%whole(d)*air%dx(d)
                depth = shape%at(d) - plane
                if (s == 2) depth = -depth
                if (depth >= shape%half(d)*(1 - on_plane)) cycle
                if (air%outer(s, d) == bc_symmetry .and. abs(depth) <= on_plane*shape%half(d)) then
                    share = share/2
                else
                    call raise(err, exit_deck, label('charge', charge%id, charge%place) &
                        //"it reaches out of the box of &air; move it, " &
                        //"or put a symmetry plane through its centre")
                    return
                end if
            end do
        end do
    end subroutine share_inside
end module brz_air_setup
