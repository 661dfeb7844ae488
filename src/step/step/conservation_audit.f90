! SPDX-License-Identifier: MIT
!> The conservation audit, of a run: where mass, momentum and energy are, and what
!> is not accounted for.
!>
!> All values are of what is modelled (a half or a quarter where symmetry planes cut the scene).
module brz_conservation_audit
    use brz_air_state, only: air_t
    use brz_air_totals, only: air_totals, counts_of_all, leave_out, outflow_of_all
    use brz_backend, only: backend_t
    use brz_cohesive_setup, only: interface_name
    use brz_cohesive_part, only: share_points
    use brz_cohesive_state, only: cohesive_t
    use brz_coupling_copy, only: fetch_diagnostics
    use brz_coupling_state, only: coupling_diagnostics_t, coupling_t
    use brz_coupling_totals, only: diagnostics_of_all
    use brz_errors, only: error_t, failed
    use brz_gpu_air_sums, only: gpu_air_totals, gpu_outflow
    use brz_gpu_cohesive_part, only: fetch_gpu_points
    use brz_gpu_solid_diagnostics, only: fetch_accounts
    use brz_kinds, only: dp, int64, rk
    use brz_motion_loop_bodies, only: n_sum
    use brz_motion_loops, only: for_each_sum_state
    use brz_solid_backend, only: sum_states
    use brz_solid_diagnostics, only: diagnostics_t, close_all_diagnostics, open_all_diagnostics
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_state, only: solid_t
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: balance_t, audit_start_t, audit_scene, is_balanced, energy_columns, audit_row
    public :: body_names, body_row, judge
    public :: cohesive_totals, solid_totals_t, sums_of_bodies, totals_of_sums

    integer, parameter :: n_energy = 51, n_body = 14, n_interface = 3

    !> Columns of energy.csv.
    character(20), parameter :: energy_columns(n_energy) = [character(20) :: &
                                'time[s]', 'air_kinetic[J]', 'air_internal[J]', 'air_outflow[J]', &
                                'solid_kinetic[J]', 'solid_internal[J]', &
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
                                'air_momentum_x[N s]', 'air_momentum_y[N s]', &
                                'air_momentum_z[N s]', &
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

    !> Of what is modelled (a half or a quarter where symmetry planes cut), at the time of the step.
    type :: solid_totals_t
        real(dp) :: mass = 0 !! [kg]
        real(dp) :: centre(3) = 0 !! mass centre [m]
        real(dp) :: momentum(3) = 0 !! [N s]
        real(dp) :: angular(3) = 0 !! angular momentum about the origin [N m s]
        real(dp) :: kinetic = 0, internal = 0 !! [J]
        real(dp) :: hourglass = 0 !! energy held by the stiff hourglass force [J]
        real(dp) :: artificial = 0 !! energy held by the artificial stress [J]
        real(dp) :: contact = 0 !! energy held by the springs of contact [J]
        real(dp) :: outside = 0 !! mass that has left the region [kg]
        real(dp) :: removed(2) = 0 !! mass and energy of what has been taken out [kg, J]
        real(dp) :: damage = 0 !! mean over the mass
    end type solid_totals_t

    !> Totals at one time.
    type :: balance_t
        real(dp) :: time = 0 !! [s]
        real(dp) :: gas(5) = 0 !! mass, momentum x, y, z, energy of the gas
        real(dp) :: gas_kinetic = 0 !! part of the gas energy [J]
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
        real(dp) :: products = 0 !! mass of products of explosives in the gas [kg]
        real(dp) :: products_out = 0 !! what of it left through the outer faces so far [kg]
        real(dp) :: fallback_faces = 0 !! faces that fell back to first order so far
        real(dp) :: limited_cells = 0 !! cells of gas that were held so far
        !> that errors are measured against
        real(dp) :: energy_scale = 0, momentum_scale = 0, coupling_scale = 0
        real(dp) :: energy_error = 0, mass_error = 0, momentum_error = 0 !! relative
        real(dp) :: coupling_error = 0 !! what coupling loses over what it could hand over
        real(dp), allocatable :: bodies(:, :) !! (n_body, bodies) see body_columns
    end type balance_t

    !> What the errors are measured against.
    type :: audit_start_t
        logical :: known = .false.
        real(dp) :: total = 0 !! energy at t = 0 [J]
        real(dp) :: mass = 0 !! of the air at t = 0 [kg]
        real(dp) :: momentum(3) = 0 !! of the air at t = 0 [N s]
        real(dp) :: energy = 0 !! the largest of the terms of the energy so far [J]
        real(dp) :: work = 0 !! the largest work of the load so far [J]
        real(dp) :: supply = 0 !! the largest term at t = 0, or work of a drive or load since [J]
        real(dp) :: available = 0 !! the largest energy of the air above that of its rest so far [J]
    end type audit_start_t

contains

    !> Gather the terms of the audit. The first call sets what errors are measured against, and each
    !> one brings the largest terms up to date.
    subroutine audit_scene(time, backend, air, solid, coupling, start, audit, err)
        real(dp), intent(in) :: time !! [s]
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(solid_t), intent(inout) :: solid !! its accounts are brought up to date
        type(coupling_t), intent(inout) :: coupling !! its sums are brought up to date
        type(audit_start_t), intent(inout) :: start
        type(balance_t), intent(out) :: audit
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails
        type(coupling_diagnostics_t) :: taken
        real(dp) :: all(5), mass
        integer(int64) :: faces, cells

        audit%time = time
        mass = 0
        if (air%present) then
            call gather_air(backend, air, coupling, audit%gas, audit%gas_kinetic, audit%products, &
                            err)
            call outflow_of_all(air, audit%outflow, audit%products_out)
            call counts_of_all(air, faces, cells)
            audit%fallback_faces = real(faces, dp)
            audit%limited_cells = real(cells, dp)
            audit%available = available_energy(air, audit)
        end if
        if (solid%present) call gather_solid(backend, solid, audit, mass, err)
        if (coupling%present) call diagnostics_of_all(solid%ranks, coupling, taken)
        audit%air_work = taken%work
        audit%reference_work = taken%work_reference
        if (allocated(solid%loads%of)) audit%reference_work = -audit%load_work ! from outside
        audit%impulse = taken%impulse
        audit%ambient = taken%impulse_reference
        all = audit%gas + audit%outflow
        all(2:4) = all(2:4) + audit%impulse + audit%ambient
        audit%total = all(5) + audit%solid_kinetic + audit%solid_internal + audit%hourglass &
                       + audit%artificial + audit%contact(1) + sum(audit%bond) &
                       + audit%reference_work - audit%drive
        audit%momentum_scale = momentum_scale(air, audit)
        if (.not. start%known) start = audit_start_t(.true., audit%total, all(1), all(2:4), &
                                                      supply=largest_term(audit))
        call judge(all, rounding_energy(solid, mass), start, audit)
    end subroutine audit_scene

    !> The bodies and what is between them, by the diagnostics of all processes.
    subroutine gather_solid(backend, solid, audit, mass, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(balance_t), intent(inout) :: audit
        real(dp), intent(out) :: mass !! of all bodies [kg]
        type(error_t), intent(inout) :: err
        type(solid_totals_t) :: sums, t
        type(diagnostics_t) :: diagnostics
        real(dp) :: of_bodies(n_sum, size(solid%bodies)), area(2)
        integer :: b

        call gather_diagnostics(backend, solid, err)
        call open_all_diagnostics(solid, diagnostics)
        call sums_of_bodies(solid, of_bodies, err)
        call totals_of_sums(solid, 0, of_bodies, sums)
        mass = sums%mass
        audit%solid_kinetic = sums%kinetic
        audit%solid_internal = sums%internal
        audit%outside = sums%outside
        audit%removed = sums%removed
        audit%hourglass = sums%hourglass
        audit%artificial = sums%artificial
        audit%hourglass_heat = sum(solid%bodies%account%hourglass_heat)
        audit%viscous = sum(solid%bodies%account%viscous)
        audit%plastic = sum(solid%bodies%account%plastic)
        audit%damage = sum(solid%bodies%account%damage)
        audit%contact = [sums%contact, sum(solid%bodies%account%contact_heat), &
                          sum(solid%bodies%account%friction)]
        audit%drive = sum(solid%bodies%account%drive)
        audit%load_work = sum(solid%bodies%account%load)
        allocate (audit%bodies(n_body, size(solid%bodies)))
        do b = 1, size(solid%bodies)
            if (failed(err)) exit
            call totals_of_sums(solid, b, of_bodies, t)
            audit%bodies(:, b) = [t%mass, t%centre, t%momentum/t%mass, t%kinetic, t%internal, &
                                   t%damage, solid%bodies(b)%account%load, solid%bodies(b)%reaction]
        end do
        call close_all_diagnostics(solid, diagnostics)
        call gather_interfaces(backend, solid, err)
        call cohesive_totals(solid%cohesive, 0, audit%bond(1), audit%bond(2), area(1), area(2))
    end subroutine gather_solid

    !> Totals of the air, with what waits in cut cells; what left through its boundaries is brought
    !> up to date in `air`.
    subroutine gather_air(backend, air, coupling, gas, kinetic, products, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(coupling_t), intent(inout) :: coupling !! its work and impulse are brought up to date
        real(dp), intent(out) :: gas(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: kinetic !! energy of the gas [J]
        real(dp), intent(out) :: products !! mass of products of explosives [kg]
        type(error_t), intent(inout) :: err
        real(dp) :: lack(0:6), totals(0:6)

        if (backend%on_gpu) then
            call gpu_air_totals(air%device, air, totals, err)
            call gpu_outflow(air%device, air, err)
            if (coupling%wall%cells%present) then
                lack = 0
                call leave_out(air, coupling%wall%cells, lack, err)
                totals = totals + lack*product(air%dx)
            end if
            if (coupling%on_gpu) call fetch_diagnostics(coupling, err)
            gas = totals(1:5)
            kinetic = totals(0)
            products = totals(6)
        else
            call air_totals(air, coupling%wall, gas, kinetic, products)
        end if
    end subroutine gather_air

    !> Bring the diagnostics of the particles of this process up to date, before those of all are
    !> opened.
    subroutine gather_diagnostics(backend, solid, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (backend%bodies_on_gpu) call fetch_accounts(solid%device, solid, err)
    end subroutine gather_diagnostics

    !> Bring what cohesive interfaces hold and have spent up to date on the host, of all processes.
    subroutine gather_interfaces(backend, solid, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (backend%bodies_on_gpu) &
            call fetch_gpu_points(solid%device, .false., solid%cohesive, err)
        call share_points(solid)
    end subroutine gather_interfaces

    !> Sums over the particles of each body. All processes must call.
    subroutine sums_of_bodies(solid, sums, err)
        type(solid_t), intent(in) :: solid
        real(dp), intent(out) :: sums(n_sum, size(solid%bodies)) !! see sum_state
        type(error_t), intent(inout) :: err
        real(dp) :: one(n_sum)
        integer :: k

        if (solid%on_gpu) then
            call sum_states(solid%device, solid, sums, err)
            return
        end if
        do k = 1, size(solid%bodies)
            associate (there => solid%bodies(k))
                call for_each_sum_state(solid%on_gpu, there%last - there%first + 1, solid%ranks, &
                    there%first, solid%wide, solid%stride_d, solid%stride_p, &
                    real(solid%dt_last/2, rk), solid%region, solid%x, solid%v, solid%mass, &
                    solid%a, solid%energy, solid%damage, solid%fixed, one, err)
            end associate
            sums(:, k) = one
        end do
    end subroutine sums_of_bodies

    !> Totals of body b, or of all bodies with b = 0.
    subroutine totals_of_sums(solid, b, sums, totals)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: sums(n_sum, size(solid%bodies)) !! see sum_state
        type(solid_totals_t), intent(out) :: totals
        real(dp) :: all(n_sum)
        integer :: k

        if (b == 0) all = sum(sums, 2) ! body by body
        if (b > 0) all = sums(:, b)
        totals%mass = all(1)
        totals%centre = all(2:4)/max(all(1), tiny(1.0_dp))
        totals%momentum = all(5:7)
        totals%angular = all(8:10)
        totals%kinetic = all(11)
        totals%internal = all(12)
        totals%outside = all(14)
        totals%removed = all(15:16)
        totals%damage = all(13)/max(all(1), tiny(1.0_dp))
        do k = 1, size(solid%bodies) ! the turning of the particles of rigid bodies
            if (b /= 0 .and. b /= k) cycle
            associate (r => solid%bodies(k)%rigid)
                totals%angular = totals%angular + r%cell_inertia*r%omega
                totals%kinetic = totals%kinetic &
                                 + r%cell_inertia/2*dot_product(r%omega, r%omega)
            end associate
        end do
        if (b == 0) then
            totals%hourglass = sum(solid%bodies%account%hourglass)
            totals%artificial = sum(solid%bodies%account%artificial)
            totals%contact = sum(solid%bodies%account%contact)
            totals%internal = totals%internal - sum(solid%bodies%account%early)
        else
            totals%hourglass = solid%bodies(b)%account%hourglass
            totals%artificial = solid%bodies(b)%account%artificial
            totals%contact = solid%bodies(b)%account%contact
            totals%internal = totals%internal - solid%bodies(b)%account%early
        end if
    end subroutine totals_of_sums

    !> What interface k, or all with k = 0, holds and has spent, and how much of it is broken.
    pure subroutine cohesive_totals(cohesive, k, held, spent, broken, whole)
        type(cohesive_t), intent(in) :: cohesive
        integer, intent(in) :: k
        real(dp), intent(out) :: held, spent !! [J]
        real(dp), intent(out) :: broken, whole !! area with damage 1; all of it [m2]
        integer :: p

        held = 0
        spent = 0
        broken = 0
        whole = 0
        do p = 1, cohesive%n
            if (k /= 0 .and. cohesive%of(p) /= k) cycle
            held = held + cohesive%held(p)
            spent = spent + cohesive%spent(p)
            whole = whole + cohesive%area(p)
            if (cohesive%damage(p) >= 1) broken = broken + cohesive%area(p)
        end do
    end subroutine cohesive_totals

    !> Energy that the air could hand to bodies: that of its motion, and what its mass holds beyond
    !> air at rest [J].
    pure real(dp) function available_energy(air, audit)
        type(air_t), intent(in) :: air
        type(balance_t), intent(in) :: audit
        real(dp) :: rest

        rest = real(air%p_rest, dp)/((air%scheme%gamma - 1)*real(air%rho_rest, dp)) ! [J/kg]
        available_energy = max(audit%gas_kinetic, audit%gas(5) - rest*audit%gas(1))
    end function available_energy

    !> A momentum to measure errors against: that of sound through the whole mass of the air.
    pure real(dp) function momentum_scale(air, audit)
        type(air_t), intent(in) :: air
        type(balance_t), intent(in) :: audit

        momentum_scale = (audit%gas(1) + audit%outflow(1)) &
                         *sqrt(real(air%scheme%gamma*air%p_rest/air%rho_rest, dp))
    end function momentum_scale

    !> The largest of the places and exchanges of energy [J].
    pure real(dp) function largest_term(audit)
        type(balance_t), intent(in) :: audit

        largest_term = maxval(abs([audit%gas_kinetic, audit%gas(5) - audit%gas_kinetic, &
            audit%outflow(5), audit%solid_kinetic, audit%solid_internal, &
            audit%hourglass, audit%artificial, audit%contact(1), audit%bond, &
            audit%air_work, audit%load_work, audit%drive]))
    end function largest_term

    !> Energy of bodies at rest by rounding: their velocities are some roundings of sound [J].
    pure real(dp) function rounding_energy(solid, mass)
        class(interacting_bodies_t), intent(in) :: solid
        real(dp), intent(in) :: mass !! of all bodies [kg]

        rounding_energy = 0
        if (solid%present) rounding_energy = &
            mass*(100*epsilon(1.0_rk)*maxval(real(solid%materials%c_wave, dp)))**2
        if (.not. solid%cohesive%present) return
        associate (cohesive => solid%cohesive) ! the weights of 20 places amplify their rounding
            rounding_energy = rounding_energy + &
                sum(cohesive%area*cohesive%law(cohesive%of)%stiffness)/2 &
                              *(1e4_dp*epsilon(1.0_dp)*cohesive%farthest)**2
        end associate
    end function rounding_energy

    !> Relative errors, and the largest terms up to now.
    !>
    !> That of the energy counts as 0 where there is only rounding, and where a drive or a load has
    !> just begun: ten times as much as at the last call has been put in. What grows without that
    !> is an error.
    pure subroutine judge(all, rounding, start, audit)
        real(dp), intent(in) :: all(5) !! mass, momentum, energy of the air and what it gave away
        real(dp), intent(in) :: rounding !! energy of it [J]
        type(audit_start_t), intent(inout) :: start
        type(balance_t), intent(inout) :: audit
        real(dp), parameter :: growth = 10
        real(dp), parameter :: noise = 100*epsilon(1.0_rk) ! of the energy of air at rest
        real(dp) :: supply

        start%energy = max(start%energy, largest_term(audit))
        start%work = max(start%work, abs(audit%load_work))
        supply = max(start%supply, start%work, abs(audit%drive))
        audit%energy_scale = start%energy
        if (start%energy > rounding .and. supply <= growth*start%supply) &
            audit%energy_error = (audit%total - start%total)/start%energy
        if (.not. abs(audit%total) <= huge(start%total)) & ! that is no number either
            audit%energy_error = audit%total - audit%total
        start%supply = supply
        start%available = max(start%available, audit%available)
        audit%coupling_scale = max(start%work, start%available)
        if (audit%coupling_scale > max(rounding, noise*start%energy)) &
            audit%coupling_error = lost_in_coupling(audit)/audit%coupling_scale
        if (start%mass > 0) audit%mass_error = (all(1) - start%mass)/start%mass
        if (audit%momentum_scale > 0) audit%momentum_error = &
            maxval(abs(all(2:4) - start%momentum))/audit%momentum_scale
    end subroutine judge

    !> Energy that the air lost to walls and the bodies did not gain [J].
    pure real(dp) function lost_in_coupling(audit)
        type(balance_t), intent(in) :: audit

        lost_in_coupling = audit%air_work - audit%reference_work - audit%load_work
    end function lost_in_coupling

    !> True while no mass and no momentum of the air is missing, but for rounding.
    !>
    !> Gas, outflow and what the walls took must add up to what was there at the start, whatever
    !> happens in the scene; rounding of a million steps stays far below the bound.
    pure logical function is_balanced(audit)
        type(balance_t), intent(in) :: audit
        real(dp), parameter :: rounding = sqrt(real(epsilon(1.0_rk), dp))

        is_balanced = abs(audit%mass_error) <= rounding .and. audit%momentum_error <= rounding
    end function is_balanced

    !> The row that belongs to the `energy_columns`.
    pure function audit_row(audit) result(row)
        type(balance_t), intent(in) :: audit
        real(dp) :: row(n_energy)

        row(1:4) = [audit%time, audit%gas_kinetic, audit%gas(5) - audit%gas_kinetic, &
                    audit%outflow(5)]
        row(5:12) = [audit%solid_kinetic, audit%solid_internal, audit%hourglass, &
                     audit%artificial, audit%viscous, audit%hourglass_heat, audit%plastic, &
                     audit%damage]
        row(13:17) = [audit%air_work, audit%load_work, lost_in_coupling(audit), &
                      audit%total, audit%energy_error]
        row(18:27) = [audit%gas(1), audit%outflow(1), audit%impulse, &
                      audit%mass_error, audit%momentum_error, audit%fallback_faces, &
                      audit%products, audit%products_out]
        row(28:35) = [audit%contact, audit%drive, audit%outside, audit%removed, &
                      audit%limited_cells]
        row(36:45) = [audit%gas(2:4), audit%outflow(2:4), &
                      audit%momentum_scale, audit%reference_work, audit%energy_scale, &
                      audit%coupling_error]
        row(46:51) = [audit%bond, audit%ambient, audit%coupling_scale]
    end function audit_row

    !> Columns of bodies.csv.
    subroutine body_names(solid, names)
        class(interacting_bodies_t), intent(in) :: solid
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
        class(interacting_bodies_t), intent(in) :: solid

        n = 0
        if (solid%cohesive%present) n = size(solid%cohesive%law)
    end function interfaces_of

    !> The row that belongs to the columns of bodies.csv.
    pure subroutine body_row(audit, solid, row)
        type(balance_t), intent(in) :: audit !! of the present state
        class(interacting_bodies_t), intent(in) :: solid
        real(dp), intent(out) :: row(:) !! (1 + n_body bodies + n_interface interfaces)
        real(dp) :: sums(4)
        integer :: first, k

        first = 1 + size(audit%bodies)
        row(1) = audit%time
        row(2:first) = reshape(audit%bodies, [size(audit%bodies)])
        do k = 1, interfaces_of(solid)
            call cohesive_totals(solid%cohesive, k, sums(1), sums(2), sums(3), sums(4))
            row(first + 1:first + n_interface) = [sums(3), sums(1), sums(2)]
            first = first + n_interface
        end do
    end subroutine body_row
end module brz_conservation_audit
