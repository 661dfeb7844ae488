! SPDX-License-Identifier: MIT
!> The conservation audit, called the ledger of a run: where mass, momentum and energy are, and what
!> is not accounted for.
!>
!> All values are of what is modelled (a half or a quarter where symmetry planes cut the scene).
module brz_ledger
    use brz_air_state, only: air_t
    use brz_air_totals, only: counts_of_all, outflow_of_all
    use brz_backend, only: backend_t
    use brz_backend_fetch, only: stock_of_air, stock_of_books, stock_of_interfaces
    use brz_cohesive_setup, only: interface_name
    use brz_cohesive_state, only: cohesive_totals
    use brz_coupling_state, only: coupling_books_t, coupling_t
    use brz_coupling_totals, only: books_of_all
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, int64, rk
    use brz_solid_books, only: books_t, close_all_books, open_all_books
    use brz_solid_state, only: solid_t
    use brz_solid_sums, only: n_sum, solid_totals_t, totals_of_sums
    use brz_total_steps, only: sums_of_bodies
    implicit none
    private
    public :: balance_t, ledger_start_t, take_stock, is_balanced, energy_columns, ledger_row
    public :: body_names, body_row, judge

    integer, parameter :: n_energy = 56, n_body = 14, n_interface = 3

    !> Columns of energy.csv.
    character(20), parameter :: energy_columns(n_energy) = [character(20) :: &
                                'time[s]', 'air_kinetic[J]', 'air_internal[J]', 'air_outflow[J]', &
                                'air_stored[J]', 'solid_kinetic[J]', 'solid_internal[J]', &
                                'hourglass[J]', 'artificial[J]', 'viscous[J]', &
                                'hourglass_heat[J]', 'plastic[J]', 'damage[J]', &
                                'air_work[J]', 'load_work[J]', 'coupling[J]', 'total[J]', &
                                'error[-]', 'air_mass[kg]', 'air_outflow[kg]', 'impulse_x[N s]', &
                                'impulse_y[N s]', 'impulse_z[N s]', 'mass_error[-]', &
                                'momentum_error[-]', 'fallback_faces[-]', &
                                'products[kg]', 'products_out[kg]', &
                                'contact[J]', 'contact_heat[J]', 'friction[J]', 'drive_work[J]', &
                                'outside[kg]', 'removed[kg]', 'removed[J]', &
                                'limited_cells[-]', &
                                'air_stored[kg]', 'air_stored_x[N s]', 'air_stored_y[N s]', &
                                'air_stored_z[N s]', 'air_momentum_x[N s]', &
                                'air_momentum_y[N s]', 'air_momentum_z[N s]', &
                                'air_outflow_x[N s]', 'air_outflow_y[N s]', &
                                'air_outflow_z[N s]', 'momentum_scale[N s]', &
                                'reference_work[J]', 'energy_scale[J]', 'coupling_error[-]', &
                                'bond[J]', 'bond_heat[J]', 'ambient_x[N s]', &
                                'ambient_y[N s]', 'ambient_z[N s]', 'coupling_scale[J]']

    !> Columns of bodies.csv, for every body.
    character(20), parameter :: body_columns(n_body) = [character(20) :: &
                                'mass[kg]', 'x[m]', 'y[m]', 'z[m]', 'velocity_x[m/s]', &
                                'velocity_y[m/s]', 'velocity_z[m/s]', 'kinetic[J]', &
                                'internal[J]', 'damage_mean[-]', 'load_work[J]', &
                                'reaction_x[N s]', 'reaction_y[N s]', 'reaction_z[N s]']

    !> Columns of bodies.csv, for every cohesive interface.
    character(20), parameter :: interface_columns(n_interface) = [character(20) :: &
                                'broken[m2]', 'bond[J]', 'bond_heat[J]']

    !> Totals at one time.
    type :: balance_t
        real(dp) :: time = 0 !! [s]
        real(dp) :: gas(5) = 0 !! mass, momentum x, y, z, energy of the gas
        real(dp) :: gas_kinetic = 0 !! part of the gas energy [J]
        real(dp) :: kept(5) = 0 !! the same in ledgers and debts
        real(dp) :: outflow(5) = 0 !! what left through the outer faces so far
        real(dp) :: solid_kinetic = 0, solid_internal = 0, hourglass = 0, artificial = 0 !! [J]
        !> parts of solid_internal so far [J]
        real(dp) :: viscous = 0, hourglass_heat = 0, plastic = 0, damage = 0
        real(dp) :: contact(3) = 0 !! held by contact; heat of contact and friction so far [J]
        real(dp) :: bond(2) = 0 !! held by cohesive interfaces; spent in them so far [J]
        real(dp) :: air_work = 0 !! energy that the air gave to moving walls so far [J]
        real(dp) :: load_work = 0 !! work of the load on the particles so far [J]
        real(dp) :: outside = 0 !! mass of particles that have left the region [kg]
        real(dp) :: removed(2) = 0 !! mass and energy of what has been taken out [kg, J]
        real(dp) :: drive = 0 !! work of prescribed motion so far [J]
        real(dp) :: impulse(3) = 0 !! of the overpressure on walls so far [N s]
        real(dp) :: ambient(3) = 0 !! of the reference pressure on the same faces [N s]
        real(dp) :: available = 0 !! energy of the air above that of its rest [J]
        real(dp) :: reference_work = 0 !! part of air_work that the reference pressure did [J]
        real(dp) :: total = 0 !! energy of everything [J]
        real(dp) :: products = 0 !! mass of products of explosives in gas, ledgers and debts [kg]
        real(dp) :: products_out = 0 !! what of it left through the outer faces so far [kg]
        real(dp) :: fallback_faces = 0 !! faces that fell back to first order so far
        real(dp) :: held_cells = 0 !! cells of gas that were held so far
        !> that errors are measured against
        real(dp) :: energy_scale = 0, momentum_scale = 0, coupling_scale = 0
        real(dp) :: energy_error = 0, mass_error = 0, momentum_error = 0 !! relative
        real(dp) :: coupling_error = 0 !! what coupling loses over what it could hand over
        real(dp), allocatable :: bodies(:, :) !! (n_body, bodies) see body_columns
    end type balance_t

    !> What the errors are measured against.
    type :: ledger_start_t
        logical :: known = .false.
        real(dp) :: total = 0 !! energy at t = 0 [J]
        real(dp) :: mass = 0 !! of the air at t = 0 [kg]
        real(dp) :: momentum(3) = 0 !! of the air at t = 0 [N s]
        real(dp) :: energy = 0 !! the largest of the terms of the energy so far [J]
        real(dp) :: work = 0 !! the largest work of the load so far [J]
        real(dp) :: supply = 0 !! the largest term at t = 0, or work of a drive or load since [J]
        real(dp) :: available = 0 !! the largest energy of the air above that of its rest so far [J]
    end type ledger_start_t

contains

    !> Take stock of the scene. The first call sets what errors are measured against, and each one
    !> brings the largest terms up to date.
    subroutine take_stock(time, backend, air, solid, coupling, start, ledger, err)
        real(dp), intent(in) :: time !! [s]
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(solid_t), intent(inout) :: solid !! its ledgers are brought up to date
        type(coupling_t), intent(inout) :: coupling !! its sums are brought up to date
        type(ledger_start_t), intent(inout) :: start
        type(balance_t), intent(out) :: ledger
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails
        type(coupling_books_t) :: taken
        real(dp) :: all(5), mass
        integer(int64) :: faces, cells

        ledger%time = time
        mass = 0
        if (air%present) then
            call stock_of_air(backend, air, coupling, ledger%gas, ledger%kept, &
                              ledger%gas_kinetic, ledger%products, err)
            call outflow_of_all(air, ledger%outflow, ledger%products_out)
            call counts_of_all(air, faces, cells)
            ledger%fallback_faces = real(faces, dp)
            ledger%held_cells = real(cells, dp)
            ledger%available = available_energy(air, ledger)
        end if
        if (solid%present) call stock_of_solid(backend, solid, ledger, mass, err)
        if (coupling%present) call books_of_all(solid%ranks, coupling, taken)
        ledger%air_work = taken%work
        ledger%reference_work = taken%work_reference
        if (allocated(solid%loads%of)) ledger%reference_work = -ledger%load_work ! from outside
        ledger%impulse = taken%impulse
        ledger%ambient = taken%impulse_reference
        ledger%outflow(2:4) = ledger%outflow(2:4) + taken%images
        all = ledger%gas + ledger%kept + ledger%outflow
        all(2:4) = all(2:4) + ledger%impulse + ledger%ambient
        ledger%total = all(5) + ledger%solid_kinetic + ledger%solid_internal + ledger%hourglass &
                       + ledger%artificial + ledger%contact(1) + sum(ledger%bond) &
                       + ledger%reference_work - ledger%drive
        ledger%momentum_scale = momentum_scale(air, ledger)
        if (.not. start%known) start = ledger_start_t(.true., ledger%total, all(1), all(2:4), &
                                                      supply=largest_term(ledger))
        call judge(all, rounding_energy(solid, mass), start, ledger)
    end subroutine take_stock

    !> The bodies and what is between them, by the books of all processes.
    subroutine stock_of_solid(backend, solid, ledger, mass, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(balance_t), intent(inout) :: ledger
        real(dp), intent(out) :: mass !! of all bodies [kg]
        type(error_t), intent(inout) :: err
        type(solid_totals_t) :: sums, t
        type(books_t) :: books
        real(dp) :: of_bodies(n_sum, size(solid%bodies)), area(2)
        integer :: b

        call stock_of_books(backend, solid, err)
        call open_all_books(solid, books)
        call sums_of_bodies(solid, of_bodies, err)
        call totals_of_sums(solid, 0, of_bodies, sums)
        mass = sums%mass
        ledger%solid_kinetic = sums%kinetic
        ledger%solid_internal = sums%internal
        ledger%outside = sums%outside
        ledger%removed = sums%removed
        ledger%hourglass = sums%hourglass
        ledger%artificial = sums%artificial
        ledger%hourglass_heat = sum(solid%bodies%ledger%hourglass_heat)
        ledger%viscous = sum(solid%bodies%ledger%viscous)
        ledger%plastic = sum(solid%bodies%ledger%plastic)
        ledger%damage = sum(solid%bodies%ledger%damage)
        ledger%contact = [sums%contact, sum(solid%bodies%ledger%contact_heat), &
                          sum(solid%bodies%ledger%friction)]
        ledger%drive = sum(solid%bodies%ledger%drive)
        ledger%load_work = sum(solid%bodies%ledger%load)
        allocate (ledger%bodies(n_body, size(solid%bodies)))
        do b = 1, size(solid%bodies)
            if (failed(err)) exit
            call totals_of_sums(solid, b, of_bodies, t)
            ledger%bodies(:, b) = [t%mass, t%centre, t%momentum/t%mass, t%kinetic, t%internal, &
                                   t%damage, solid%bodies(b)%ledger%load, solid%bodies(b)%reaction]
        end do
        call close_all_books(solid, books)
        call stock_of_interfaces(backend, solid, err)
        call cohesive_totals(solid%cohesive, 0, ledger%bond(1), ledger%bond(2), area(1), area(2))
    end subroutine stock_of_solid

    !> Energy that the air could hand to bodies: that of its motion, and what its mass holds beyond
    !> air at rest [J].
    pure real(dp) function available_energy(air, ledger)
        type(air_t), intent(in) :: air
        type(balance_t), intent(in) :: ledger
        real(dp) :: rest

        rest = real(air%p_rest, dp)/((air%scheme%gamma - 1)*real(air%rho_rest, dp)) ! [J/kg]
        available_energy = max(ledger%gas_kinetic, ledger%gas(5) - rest*ledger%gas(1))
    end function available_energy

    !> A momentum to measure errors against: that of sound through the whole mass of the air.
    pure real(dp) function momentum_scale(air, ledger)
        type(air_t), intent(in) :: air
        type(balance_t), intent(in) :: ledger

        momentum_scale = (ledger%gas(1) + ledger%outflow(1)) &
                         *sqrt(real(air%scheme%gamma*air%p_rest/air%rho_rest, dp))
    end function momentum_scale

    !> The largest of the places and exchanges of energy [J].
    pure real(dp) function largest_term(ledger)
        type(balance_t), intent(in) :: ledger

        largest_term = maxval(abs([ledger%gas_kinetic, ledger%gas(5) - ledger%gas_kinetic, &
            ledger%kept(5), ledger%outflow(5), ledger%solid_kinetic, ledger%solid_internal, &
            ledger%hourglass, ledger%artificial, ledger%contact(1), ledger%bond, &
            ledger%air_work, ledger%load_work, ledger%drive]))
    end function largest_term

    !> Energy of bodies at rest by rounding: their velocities are some roundings of sound [J].
    pure real(dp) function rounding_energy(solid, mass)
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: mass !! of all bodies [kg]

        rounding_energy = 0
        if (solid%present) rounding_energy = &
            mass*(100*epsilon(1.0_rk)*maxval(real(solid%materials%c_wave, dp)))**2
        if (.not. solid%cohesive%present) return
        associate (glue => solid%cohesive) ! the weights of 20 places amplify their rounding
            rounding_energy = rounding_energy + sum(glue%area*glue%law(glue%of)%stiffness)/2 &
                              *(1e4_dp*epsilon(1.0_dp)*glue%farthest)**2
        end associate
    end function rounding_energy

    !> Relative errors, and the largest terms up to now.
    !>
    !> That of the energy counts as 0 where there is only rounding, and where a drive or a load has
    !> just begun: ten times as much as at the last call has been put in. What grows without that
    !> is an error.
    pure subroutine judge(all, rounding, start, ledger)
        real(dp), intent(in) :: all(5) !! mass, momentum, energy of the air and what it gave away
        real(dp), intent(in) :: rounding !! energy of it [J]
        type(ledger_start_t), intent(inout) :: start
        type(balance_t), intent(inout) :: ledger
        real(dp), parameter :: growth = 10
        real(dp), parameter :: noise = 100*epsilon(1.0_rk) ! of the energy of air at rest
        real(dp) :: supply

        start%energy = max(start%energy, largest_term(ledger))
        start%work = max(start%work, abs(ledger%load_work))
        supply = max(start%supply, start%work, abs(ledger%drive))
        ledger%energy_scale = start%energy
        if (start%energy > rounding .and. supply <= growth*start%supply) &
            ledger%energy_error = (ledger%total - start%total)/start%energy
        if (.not. abs(ledger%total) <= huge(start%total)) & ! that is no number either
            ledger%energy_error = ledger%total - ledger%total
        start%supply = supply
        start%available = max(start%available, ledger%available)
        ledger%coupling_scale = max(start%work, start%available)
        if (ledger%coupling_scale > max(rounding, noise*start%energy)) &
            ledger%coupling_error = lost_in_coupling(ledger)/ledger%coupling_scale
        if (start%mass > 0) ledger%mass_error = (all(1) - start%mass)/start%mass
        if (ledger%momentum_scale > 0) ledger%momentum_error = &
            maxval(abs(all(2:4) - start%momentum))/ledger%momentum_scale
    end subroutine judge

    !> Energy that the air lost to walls and the bodies did not gain [J].
    pure real(dp) function lost_in_coupling(ledger)
        type(balance_t), intent(in) :: ledger

        lost_in_coupling = ledger%air_work - ledger%reference_work - ledger%load_work
    end function lost_in_coupling

    !> True while no mass and no momentum of the air is missing, but for rounding.
    !>
    !> Gas, ledgers, debts, outflow and what the walls took must add up to what was there at the
    !> start, whatever happens in the scene; rounding of a million steps stays far below the bound.
    pure logical function is_balanced(ledger)
        type(balance_t), intent(in) :: ledger
        real(dp), parameter :: rounding = sqrt(real(epsilon(1.0_rk), dp))

        is_balanced = abs(ledger%mass_error) <= rounding .and. ledger%momentum_error <= rounding
    end function is_balanced

    !> The row that belongs to the `energy_columns`.
    pure function ledger_row(ledger) result(row)
        type(balance_t), intent(in) :: ledger
        real(dp) :: row(n_energy)

        row(1:4) = [ledger%time, ledger%gas_kinetic, ledger%gas(5) - ledger%gas_kinetic, &
                    ledger%outflow(5)]
        row(5:13) = [ledger%kept(5), ledger%solid_kinetic, ledger%solid_internal, &
                     ledger%hourglass, ledger%artificial, ledger%viscous, ledger%hourglass_heat, &
                     ledger%plastic, ledger%damage]
        row(14:18) = [ledger%air_work, ledger%load_work, lost_in_coupling(ledger), &
                      ledger%total, ledger%energy_error]
        row(19:28) = [ledger%gas(1) + ledger%kept(1), ledger%outflow(1), ledger%impulse, &
                      ledger%mass_error, ledger%momentum_error, ledger%fallback_faces, &
                      ledger%products, ledger%products_out]
        row(29:36) = [ledger%contact, ledger%drive, ledger%outside, ledger%removed, &
                      ledger%held_cells]
        row(37:50) = [ledger%kept(1:4), ledger%gas(2:4), ledger%outflow(2:4), &
                      ledger%momentum_scale, ledger%reference_work, ledger%energy_scale, &
                      ledger%coupling_error]
        row(51:56) = [ledger%bond, ledger%ambient, ledger%coupling_scale]
    end function ledger_row

    !> Columns of bodies.csv.
    subroutine body_names(solid, names)
        type(solid_t), intent(in) :: solid
        character(64), allocatable, intent(out) :: names(:)
        integer :: b, i

        allocate (names(1 + n_body*size(solid%bodies) + n_interface*interfaces_of(solid)))
        names(1) = 'time[s]'
        do b = 1, size(solid%bodies)
            do i = 1, n_body
                names(1 + n_body*(b - 1) + i) = trim(solid%bodies(b)%id)//':'//body_columns(i)
            end do
        end do
        do b = 1, interfaces_of(solid)
            do i = 1, n_interface
                names(1 + n_body*size(solid%bodies) + n_interface*(b - 1) + i) = &
                    interface_name(solid, b)//':'//interface_columns(i)
            end do
        end do
    end subroutine body_names

    pure integer function interfaces_of(solid) result(n)
        type(solid_t), intent(in) :: solid

        n = 0
        if (solid%cohesive%present) n = size(solid%cohesive%law)
    end function interfaces_of

    !> The row that belongs to the columns of bodies.csv.
    pure subroutine body_row(ledger, solid, row)
        type(balance_t), intent(in) :: ledger !! of the present state
        type(solid_t), intent(in) :: solid
        real(dp), intent(out) :: row(:) !! (1 + n_body bodies + n_interface interfaces)
        real(dp) :: sums(4)
        integer :: first, k

        first = 1 + size(ledger%bodies)
        row(1) = ledger%time
        row(2:first) = reshape(ledger%bodies, [size(ledger%bodies)])
        do k = 1, interfaces_of(solid)
            call cohesive_totals(solid%cohesive, k, sums(1), sums(2), sums(3), sums(4))
            row(first + 1:first + n_interface) = [sums(3), sums(1), sums(2)]
            first = first + n_interface
        end do
    end subroutine body_row
end module brz_ledger
