! SPDX-License-Identifier: MIT
!> The time step of the solids: staggered leapfrog with two neighbour passes.
!>
!> start_solid once, or resume_solid after a restart; then solid_step again and again.
module brz_solid_step
    use brz_cell_grid, only: reach_of_lists
    use brz_cohesive_steps, only: cohesive_pass
    use brz_errors, only: error_t, exit_numerical, raise
    use brz_kinds, only: dp, int16, int64, int8, rk
    use brz_list_drift, only: drift_bodies, find_stale
    use brz_material, only: strength_left
    use brz_motion_items, only: kick_and_drift
    use brz_ranks, only: agree, several
    use brz_solid_bonds, only: break_bonds, push_rigid_bonds
    use brz_solid_contact, only: contact_pass, find_touch
    use brz_solid_doubles, only: refuse_doubles
    use brz_solid_faults, only: report_bad
    use brz_solid_forces, only: force_pass, update_sizes
    use brz_solid_ghosts, only: refresh_bonds, refresh_motion, refresh_rows
    use brz_solid_gradients, only: gradient_pass
    use brz_solid_arrays, only: group_of
    use brz_solid_leaving, only: remove_left
    use brz_solid_links, only: first_bonds
    use brz_solid_mirror, only: signs
    use brz_solid_neighbours, only: build_neighbours, moved_levels
    use brz_rigid_steps, only: balance_rigid, move_rigid
    use brz_solid_rigid, only: settle_drag, sum_pushes
    use brz_solid_skin, only: find_skin
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: form_bending, form_rigid, intact_share, solid_t, worth_threads
    use brz_solid_tilts, only: find_tilts
    use brz_tension_hold, only: may_be_drawn
    implicit none
    private
    public :: start_solid, resume_solid, solid_time_step, solid_step, velocity_at_step

    integer, parameter :: most_support = huge(1_int16)
    real(dp), parameter :: growth = 1.05_dp !! most that a time step may exceed the last one

contains

    !> Sort the particles, build their lists and find the first accelerations and time step. Where
    !> several processes share them, `find_skin` has been called before.
    subroutine start_solid(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer :: i, k

        if (.not. solid%present) return
        if (.not. several(solid%ranks)) call find_skin(solid)
        call build_neighbours(solid, sort=.true.)
        do k = 1, size(solid%block, 2)
            call update_sizes(solid, solid%bodies(solid%block(1, k)), k)
        end do
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i)
        do k = 1, size(solid%block, 2)
            do i = solid%block(2, k), solid%block(3, k)
                solid%support(i) = int(min(count_intact(solid, solid%block(1, k), i, 0), &
                                           most_support), int16)
            end do
        end do
        call refresh_motion(solid)
        call refuse_doubles(solid, err)
        call meet(solid)
        call find_tilts(solid)
        call gradient_pass(solid, 0.0_dp)
        call refresh_rows(solid)
        call cohesive_pass(solid)
        call contact_pass(solid, 0.0_dp)
        call force_pass(solid, 0.0_dp)
        call balance_bodies(solid, 0.0_dp)
        call report_bad(solid, err)
        call agree_on_step(solid, err)
    end subroutine start_solid

    !> Forces on bodies that do not deform, or are driven, at the step.
    subroutine balance_bodies(solid, dt)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp) :: push(6, size(solid%bodies))

        call push_rigid_bonds(solid, dt)
        call sum_pushes(solid, dt, push)
        call balance_rigid(solid, push, dt)
        call settle_drag(solid, dt)
    end subroutine balance_bodies

    !> How the bodies meet at the start.
    subroutine meet(solid)
        type(solid_t), intent(inout) :: solid

        if (solid%links%bonds) call first_bonds(solid)
        call refresh_bonds(solid)
        if (solid%links%present) call find_touch(solid)
    end subroutine meet

    !> After a restart: what a checkpoint does not hold follows from what it holds.
    subroutine resume_solid(solid)
        type(solid_t), intent(inout) :: solid
        integer :: k

        if (.not. solid%present) return
        call build_neighbours(solid, sort=.false.)
        do k = 1, size(solid%block, 2)
            call update_sizes(solid, solid%bodies(solid%block(1, k)), k)
        end do
        call refresh_motion(solid)
    end subroutine resume_solid

    !> All processes have the same limits of the time step, and an error that one of them has.
    subroutine agree_on_step(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: limit(0:size(solid%bodies))

        if (.not. several(solid%ranks)) return
        limit(0) = solid%dt_limit
        limit(1:) = solid%bodies%dt_limit
        call agree(solid%ranks, err, limit)
        solid%dt_limit = limit(0)
        solid%bodies%dt_limit = limit(1:)
    end subroutine agree_on_step

    !> Largest allowed time step: the CFL limit, and at most 5 % more than the last step [s].
    pure real(dp) function solid_time_step(solid) result(dt)
        type(solid_t), intent(in) :: solid

        dt = solid%dt_limit
        if (solid%dt_last > 0) dt = min(dt, growth*solid%dt_last)
        dt = min(dt, solid%loads%step)
    end function solid_time_step

    !> One time step under the present `load`. The first kick is half a step; its heat is booked
    !> now that the length of the step is known.
    subroutine solid_step(solid, dt, err)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        logical :: stale(size(solid%bodies)), relink

        if (solid%steps == 0) call force_pass(solid, dt/2)
        call kick_bodies(solid, dt)
        call move_rigid(solid, dt)
        solid%time = solid%time + dt
        solid%dt_last = dt
        solid%steps = solid%steps + 1
        call drift_bodies(solid, dt)
        call find_stale(solid, moved_levels(solid), stale, relink)
        if (any(stale) .or. relink) then
            call remove_left(solid)
            call build_neighbours(solid, sort=.true., stale=stale)
            if (any(stale)) solid%rebuilds = solid%rebuilds + 1
            call wake_met(solid)
            call end_support(solid, stale)
        else
            call refresh_motion(solid)
        end if
        call gradient_pass(solid, dt)
        call refresh_rows(solid)
        call break_bonds(solid)
        call refresh_bonds(solid)
        call cohesive_pass(solid)
        call contact_pass(solid, dt)
        call force_pass(solid, dt)
        call balance_bodies(solid, dt)
        call report_bad(solid, err)
        call agree_on_step(solid, err)
    end subroutine solid_step

    !> Velocity by the mean of the last and this time step, then position.
    subroutine kick_bodies(solid, dt)
        type(solid_t), intent(inout), target :: solid
        real(dp), intent(in) :: dt
        real(rk), pointer, contiguous :: load(:, :)
        real(dp) :: work
        integer :: i, k, loaded

        loaded = merge(1, 0, allocated(solid%load))
        load => solid%a ! not read where there is no load
        if (loaded == 1) load => solid%load
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i, work)
        do k = 1, size(solid%block, 2)
            solid%search%sums(1, k) = 0
            associate (body => solid%bodies(solid%block(1, k)))
                if (body%formulation == form_rigid .or. body%asleep) cycle
            end associate
            do i = solid%block(2, k), solid%block(3, k)
                call kick_and_drift(i, 3, 1, 3, real((solid%dt_last + dt)/2, rk), dt, loaded, &
                                    solid%a, load, solid%mass, solid%fixed, solid%x, solid%v, work)
                solid%search%sums(1, k) = solid%search%sums(1, k) + work
            end do
        end do
        do k = 1, size(solid%block, 2)
            associate (ledger => solid%bodies(solid%block(1, k))%ledger)
                ledger%load = ledger%load + solid%search%sums(1, k)
            end associate
        end do
    end subroutine kick_bodies

    !> Velocity of a particle at the step itself [m/s].
    pure function velocity_at_step(solid, i) result(v)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk) :: v(3)

        v = solid%v(:, i) + real(solid%dt_last/2, rk)*solid%a(:, i)
    end function velocity_at_step

    !> Neighbours of a particle within the reach of its list, when that was built, that still carry
    !> load.
    pure integer function count_intact(solid, b, i, fails) result(n)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b, i !! body, particle
        integer, intent(in) :: fails !! how the material of the body fails
        integer(int64) :: k
        integer :: g, j
        real(dp) :: d(3), reach2

        n = 0
        reach2 = reach_of_lists(solid, b)**2
        g = group_of(solid%bodies(b), i)
        do k = solid%first(g), solid%first(g + 1) - 1
            j = solid%list(k)
            d = solid%x_built(:, j) - solid%x_built(:, i)
            if (j == i .or. dot_product(d, d) >= reach2) cycle
            if (strength_left(fails, solid%damage(j)) > intact_share) n = n + 1
        end do
        if (.not. any(solid%mirror)) return
        do k = solid%image_first(g), solid%image_first(g + 1) - 1
            j = solid%image(k)
            d = signs(int(solid%mask(k)))*solid%x_built(:, j) - solid%x_built(:, i)
            if (dot_product(d, d) >= reach2) cycle
            if (strength_left(fails, solid%damage(j)) > intact_share) n = n + 1
        end do
    end function count_intact

    !> True where a particle has a tilted gradient while it has its support.
    pure logical function is_tilted(solid, i) result(yes)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i

        yes = allocated(solid%tilt)
        if (yes) yes = abs(solid%tilt(i)) > 0
    end function is_tilted

    !> End the stiff hourglass force, and the tilt, for good where half of the intact neighbours are
    !> gone.
    subroutine end_support(solid, anew)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: anew(:) !! (bodies) whose lists were built anew
        integer :: fails, i, k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(fails, i)
        do k = 1, size(solid%block, 2)
            associate (body => solid%bodies(solid%block(1, k)))
                if (.not. anew(solid%block(1, k))) cycle
                if (body%formulation /= form_bending .and. .not. body%tension_hold > 0) cycle
                fails = solid%materials(body%material)%fails
                do i = solid%block(2, k), solid%block(3, k)
                    if (solid%cut(i) == 1) cycle
                    if (body%tension_hold > 0) then ! no hold that could end, and no tilt
                        if (.not. (may_be_drawn(solid%stress(:, i)) .or. is_tilted(solid, i))) &
                            cycle
                    end if
                    if (count_intact(solid, solid%block(1, k), i, fails) &
                        < intact_share*solid%support(i)) solid%cut(i) = 1_int8
                end do
            end associate
        end do
    end subroutine end_support
end module brz_solid_step
