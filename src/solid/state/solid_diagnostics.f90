! SPDX-License-Identifier: MIT
!> Accumulated diagnostics of bodies: what goes into their energy accounts on the CPU, all of it.
!>
!> Of bodies that several processes share each process records what its own particles do.
module brz_solid_diagnostics
    use brz_body, only: body_t
    use brz_energy_account, only: energy_account_t, kept_early, kept_energy, kept_heat, kept_rub
    use brz_exact_sum, only: exact_sums
    use brz_formulation_names, only: artificial_none, form_rigid
    use brz_kinds, only: dp
    use brz_motion, only: mean_velocity, motion_t, velocity_of
    use brz_skin_level, only: lost_level
    use brz_ranks, only: several
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_threads, only: worth_threads
    implicit none
    private
    public :: diagnostics_t, open_all_diagnostics, close_all_diagnostics, &
        keep_diagnostics_of_first, begin_kick
    public :: record_work, record_material, record_forces, record_contact, record_drag
    public :: size_work
    public :: record_drive, begin_motion, end_motion, record_rigid_load, add_held_impulse

    type(energy_account_t), parameter :: empty = energy_account_t()
    integer, parameter :: n_account = size(transfer(empty, [0.0_dp])) !! all components are real(dp)

    !> What this process has recorded itself.
    type :: diagnostics_t
        real(dp), allocatable :: own(:, :) !! (6 + energy account, bodies) reaction, drive, energy
                                           !! account
    end type diagnostics_t

contains

    !> Show the diagnostics of all processes together in `solid%bodies`, until they are closed.
    subroutine open_all_diagnostics(solid, diagnostics)
        class(bodies_t), intent(inout) :: solid
        type(diagnostics_t), intent(out) :: diagnostics
        real(dp) :: total((6 + n_account)*size(solid%bodies))
        real(dp) :: terms(6 + n_account, size(solid%bodies))
        integer :: b

        if (.not. several(solid%ranks)) return
        allocate (diagnostics%own(6 + n_account, size(solid%bodies)))
        call look(solid, diagnostics%own)
        terms = diagnostics%own
        do b = 1, size(solid%bodies) ! all processes know the force that drives a rigid body
            if (solid%bodies(b)%formulation == form_rigid .and. solid%ranks%rank > 0) &
                terms(4:6, b) = 0
        end do
        call exact_sums(solid%ranks, reshape(terms, [size(total), 1]), total)
        call write_down(solid, reshape(total, shape(diagnostics%own)))
    end subroutine open_all_diagnostics

    !> Room for what loop bodies record of particles; it is kept from one step to the next.
    subroutine begin_kick(solid)
        class(listed_bodies_t), intent(inout) :: solid

        call size_work(solid)
        if (.not. allocated(solid%moved)) allocate (solid%moved(lost_level, size(solid%bodies)))
        solid%moved = 0
    end subroutine begin_kick

    !> Room for the work on each particle, also on those that have come since the kick; it is none
    !> between two uses.
    subroutine size_work(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: n

        n = 0
        if (allocated(solid%load) .or. solid%links%present) n = size(solid%v, 2)
        if (allocated(solid%work)) then
            if (size(solid%work) < n) deallocate (solid%work)
        end if
        if (.not. allocated(solid%work)) allocate (solid%work(n), source=0.0_dp)
    end subroutine size_work

    !> Record the work of the loads in a kick, block by block: from `kick_and_drift` of
    !> brz_motion_loop_bodies.
    subroutine record_work(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: i, k

        if (.not. allocated(solid%load)) return
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i)
        do k = 1, size(solid%block, 2)
            solid%search%sums(1, k) = 0
            do i = solid%block(2, k), solid%block(3, k)
                solid%search%sums(1, k) = solid%search%sums(1, k) + solid%work(i)
                solid%work(i) = 0
            end do
        end do
        do k = 1, size(solid%block, 2)
            associate (account => solid%bodies(solid%block(1, k))%account)
                account%load = account%load + solid%search%sums(1, k)
            end associate
        end do
    end subroutine record_work

    !> Record the heat of drag on body b, particle by particle.
    subroutine record_drag(solid, b)
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer :: i

        associate (body => solid%bodies(b))
            do i = body%first, body%last
                body%account%contact_heat = body%account%contact_heat + solid%work(i)
                solid%work(i) = 0
            end do
        end associate
    end subroutine record_drag

    !> Record plastic work, work spent in damage and that of loads on faces in the step just made,
    !> block by block: from `advance` of brz_solid_gradients.
    subroutine record_material(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: k

        do k = 1, size(solid%block, 2)
            associate (account => solid%bodies(solid%block(1, k))%account)
                account%plastic = account%plastic + solid%search%sums(1, k)
                account%damage = account%damage + solid%search%sums(2, k)
                account%clamped = account%clamped + solid%search%sums(3, k)
                account%load = account%load + solid%search%sums(4, k)
            end associate
        end do
    end subroutine record_material

    !> Record what forces between the particles of a body have done over dt, the step just made,
    !> block by block: heat of viscosity, energy of the hourglass force, of the artificial stress
    !> and of the tensile control, from `accelerate` of brz_solid_forces.
    subroutine record_forces(solid, dt)
        class(listed_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        integer :: k

        do k = 1, size(solid%bodies)
            associate (account => solid%bodies(k)%account)
                if (solid%bodies(k)%tensile_control > 0 .and. .not. (solid%bodies(k)%inactive &
                                                                  .and. dt > 0)) then
                    account%hourglass = 0 ! what the blocks hold now
                else if (solid%bodies(k)%artificial == artificial_none) then
                    account%hourglass = account%hourglass + account%ahead
                else
                    account%artificial = account%artificial + account%ahead
                end if
                account%ahead = 0
            end associate
        end do
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)), sums => solid%search%sums(:, k))
                body%account%viscous = body%account%viscous + sums(1)
                body%account%early = body%account%early + (sums(1) + sums(7))/2
                body%account%hourglass_heat = body%account%hourglass_heat + sums(7)
                if (body%tensile_control > 0) body%account%hourglass = body%account%hourglass + &
                    sums(8)
                if (body%artificial == artificial_none) then
                    body%account%hourglass = body%account%hourglass + sums(2)
                else
                    body%account%artificial = body%account%artificial + sums(2)
                end if
                body%account%ahead = body%account%ahead + sums(6)
                body%reaction = body%reaction + sums(3:5)
            end associate
        end do
    end subroutine record_forces

    !> Record what contact holds now, and its heat, of friction too: block by block, from
    !> `push_particle` of brz_contact_loop_bodies.
    subroutine record_contact(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: k

        solid%bodies%account%contact = 0
        do k = 1, size(solid%block, 2)
            associate (account => solid%bodies(solid%block(1, k))%account, &
                       sums => solid%search%sums(:, k))
                account%contact = account%contact + sums(kept_energy)
                account%contact_heat = account%contact_heat + sums(kept_heat)
                account%friction = account%friction + sums(kept_rub)
                account%early = account%early + sums(kept_early)
            end associate
        end do
    end subroutine record_contact

    !> Record the work of what drives a body: its kinetic energy, less what the air and the body
    !> itself do. The second half of the latter is recorded with the force, the work of the air on a
    !> rigid body with its step.
    subroutine record_drive(body, time, dt, v)
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: time, dt !! start and length of the step [s]
        real(dp), intent(out) :: v(3) !! mean velocity in it [m/s]
        real(dp) :: work

        call begin_motion(body%motion, time, dt, v, body%account)
        if (body%formulation == form_rigid) return
        work = dt*dot_product(body%rigid%load(1:3), v)
        body%account%load = body%account%load + work
        body%account%drive = body%account%drive - work
    end subroutine record_drive

    !> Work of what moves a body, or a region of it, in a step to come: its kinetic energy, less
    !> half of the step by the force of the body on it at the start.
    pure subroutine begin_motion(motion, time, dt, v, account)
        type(motion_t), intent(in) :: motion
        real(dp), intent(in) :: time, dt !! start and length of the step [s]
        real(dp), intent(out) :: v(3) !! mean velocity in it [m/s]
        type(energy_account_t), intent(inout) :: account
        real(dp) :: before(3), after(3)

        v = mean_velocity(motion, time, dt)
        before = merge(velocity_of(motion, time), 0.0_dp, motion%along)
        after = merge(velocity_of(motion, time + dt), 0.0_dp, motion%along)
        account%drive = account%drive - dt/2*dot_product(motion%force, v) &
            + motion%mass/2*(dot_product(after, after) - dot_product(before, before))
    end subroutine begin_motion

    !> The other half, and the work of the load, which acted all through the step.
    pure subroutine end_motion(motion, time, dt, sums, account, work)
        type(motion_t), intent(inout) :: motion
        real(dp), intent(in) :: time, dt !! end and length of the step [s]
        real(dp), intent(in) :: sums(6) !! of brz_force_loop_bodies: sum_region
        type(energy_account_t), intent(inout) :: account
        real(dp), intent(out) :: work !! of the load [J]
        real(dp) :: v(3)

        v = mean_velocity(motion, time - dt, dt)
        motion%force = sums(1:3) - sums(4:6)
        motion%reaction_force = sums(1:3)
        work = dt*dot_product(sums(4:6), v)
        account%load = account%load + work
        account%drive = account%drive - dt/2*dot_product(motion%force, v) - work
    end subroutine end_motion

    !> Add the mean force of body b on what holds it, as pass 2 has summed it up block by block.
    pure subroutine add_held_impulse(solid, b, dt, force)
        class(listed_bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(inout) :: force(3) !! [N]
        integer :: k

        do k = 1, size(solid%block, 2)
            if (solid%block(1, k) == b) force = force + solid%search%sums(3:5, k)/dt
        end do
    end subroutine add_held_impulse

    !> Record the work of the load of a rigid body in a step, which what drives it does not do.
    subroutine record_rigid_load(body, dt, v, omega)
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: dt !! [s]
        real(dp), intent(in) :: v(3), omega(3) !! twice the mean velocity [m/s] and spin [1/s]
        real(dp) :: work

        associate (load => body%rigid%load)
            work = dt/2*(dot_product(load(1:3), v) + dot_product(load(4:6), omega))
        end associate
        body%account%load = body%account%load + work
        if (body%motion%n > 0) body%account%drive = body%account%drive - work
    end subroutine record_rigid_load

    !> Go back to those of this process alone.
    subroutine close_all_diagnostics(solid, diagnostics)
        class(bodies_t), intent(inout) :: solid
        type(diagnostics_t), intent(in) :: diagnostics

        if (allocated(diagnostics%own)) call write_down(solid, diagnostics%own)
    end subroutine close_all_diagnostics

    !> After a restart, which gives all processes the diagnostics of all: the first one keeps them.
    subroutine keep_diagnostics_of_first(solid)
        class(bodies_t), intent(inout) :: solid
        real(dp) :: nothing(6 + n_account, size(solid%bodies))
        integer :: b

        if (solid%ranks%rank == 0) return
        nothing = 0
        do b = 1, size(solid%bodies)
            if (solid%bodies(b)%formulation == form_rigid) &
                nothing(4:6, b) = solid%bodies(b)%motion%force
        end do
        call write_down(solid, nothing)
    end subroutine keep_diagnostics_of_first

    pure subroutine look(solid, diagnostics)
        class(bodies_t), intent(in) :: solid
        real(dp), intent(out) :: diagnostics(:, :) !! (6 + energy account, bodies)
        integer :: b

        do b = 1, size(solid%bodies)
            diagnostics(1:3, b) = solid%bodies(b)%reaction
            diagnostics(4:6, b) = solid%bodies(b)%motion%force
            diagnostics(7:, b) = transfer(solid%bodies(b)%account, diagnostics(7:, b))
        end do
    end subroutine look

    pure subroutine write_down(solid, diagnostics)
        class(bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: diagnostics(:, :) !! (6 + energy account, bodies)
        integer :: b

        do b = 1, size(solid%bodies)
            solid%bodies(b)%reaction = diagnostics(1:3, b)
            solid%bodies(b)%motion%force = diagnostics(4:6, b)
            solid%bodies(b)%account = transfer(diagnostics(7:, b), empty)
        end do
    end subroutine write_down
end module brz_solid_diagnostics
