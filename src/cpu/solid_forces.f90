! SPDX-License-Identifier: MIT
!> Pass 2: accelerations by the internal forces, heat of the viscous ones, and their energy account.
module brz_solid_forces
    use brz_body, only: body_t
    use brz_cohesive_state, only: push_of
    use brz_air_force, only: air_force
    use brz_force_layout, only: at_drag, at_friction, at_heat, at_stiff, at_work, n_terms
    use brz_formulation_names, only: artificial_none, form_rigid, form_total
    use brz_hold_layout, only: control_affine, control_energy, control_stiffness, n_control
    use brz_kernel, only: smoothing_length
    use brz_kinds, only: dp, int64, real32, rk
    use brz_pair_layout, only: n_pair, pair_tilt
    use brz_particle_groups, only: lanes
    use brz_particle_marks, only: is_free, is_gone
    use brz_solid_bonds, only: add_bonded_forces
    use brz_solid_arrays, only: group_of
    use brz_solid_diagnostics, only: record_forces
    use brz_solid_lanes, only: centre_t, lane_group_t, images_t, in_turn, most_images, place_body, &
        place_group, place_images
    use brz_pair_rows, only: mirror_row, mirror_tensor
    use brz_solid_mirror, only: mirrored, signs
    use brz_solid_pair_sums, only: add_pairs
    use brz_solid_artificial, only: add_artificial
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_support, only: fixed_share
    use brz_tensile_control, only: kept_work
    use brz_threads, only: worth_threads
    use brz_one_sided_arm, only: mirrored_tilt
    implicit none
    private
    public :: force_pass, update_sizes

    !> What pass 1 left of particles, as their images have it.
    type :: image_rows_t
        real(rk) :: pair(n_pair, most_images) = 0
        real(rk) :: control(n_control, most_images) = 0
        real(real32) :: k_axes(6, most_images) = 0
    end type image_rows_t

contains

    !> Accelerations at the present positions; heat over dt, the step just made.
    subroutine force_pass(solid, dt)
        class(interacting_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        integer :: k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static)
        do k = 1, size(solid%block, 2)
            call force_block(solid, solid%bodies(solid%block(1, k)), dt, k)
        end do
        if (size(solid%h) > 0) then ! not before all pairs have been seen
            !$omp parallel do if(solid%n >= worth_threads) schedule(static)
            do k = 1, size(solid%block, 2)
                call update_lengths(solid, solid%bodies(solid%block(1, k)), k)
            end do
        end if
        call record_forces(solid, dt)
    end subroutine force_pass

    subroutine force_block(solid, body, dt, k)
        type(interacting_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(dp), intent(in) :: dt
        integer, intent(in) :: k !! block
        type(lane_group_t) :: p
        real(rk) :: f(n_terms)
        integer :: i, first

        solid%search%sums(:, k) = 0
        if (body%formulation == form_rigid .or. body%inactive .and. dt > 0) return
        call place_body(solid, body, p)
        do first = solid%block(2, k), solid%block(3, k), lanes
            if (solid%fixed(first) == is_gone) exit ! and so are all that follow
            call place_group(solid, body, first, p)
            call sum_group(solid, body, p)
            do i = first, p%last
                if (solid%fixed(i) == is_gone) cycle
                f = p%sums(i - first + 1, :)
                call add_rest(solid, body, i, p%centre_t, f)
                call accelerate(solid, body, real(dt, rk), i, k, f)
            end do
        end do
        call update_volumes(solid, body, k)
    end subroutine force_block

    !> Sums over the neighbours of a group and over their images, one after the other.
    subroutine sum_group(solid, body, p)
        type(interacting_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(inout) :: p
        type(images_t) :: images
        type(image_rows_t) :: rows
        integer(int64) :: k, last
        integer :: g

        call take_rows(solid, body, p)
        p%sums = 0
        call add_pairs(p, solid%x, solid%v, solid%x_ref, solid%pair, solid%h, solid%list(p%list), &
                       solid%k_axes, solid%control)
        if (.not. any(solid%mirror)) return
        g = group_of(body, p%i)
        do k = solid%image_first(g), solid%image_first(g + 1) - 1, most_images
            last = min(k + most_images, solid%image_first(g + 1)) - 1
            call place_images(solid, k, last, images)
            call mirror_rows(solid, p, k, last, rows)
            p%count = int(last - k) + 1
            call add_pairs(p, images%x, images%v, images%x_ref, rows%pair, images%h, in_turn, &
                           rows%k_axes, rows%control)
        end do
    end subroutine sum_group

    !> What pass 1 left of the members of a group.
    subroutine take_rows(solid, body, p)
        type(interacting_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(inout) :: p
        integer :: i, l

        p%control = body%tensile_control > 0 .and. any(body%normal > 0)
        if (body%in_tension .and. .not. p%control) p%control = some_pair_held(solid, body, p)
        do l = 1, lanes
            i = min(p%i + l - 1, p%last)
            p%row(l, :) = solid%pair(:, i)
            if (p%directional) p%k_axes(l, :) = real(solid%k_axes(:, i), rk)
            if (p%control) p%own(l, :) = solid%control(:, i)
        end do
    end subroutine take_rows

    !> True where the tensile control acts on some pair of a group, the members of which are in its
    !> list.
    pure logical function some_pair_held(solid, body, p) result(yes)
        type(interacting_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        type(lane_group_t), intent(in) :: p
        integer(int64) :: k
        integer :: g

        g = group_of(body, p%i)
        yes = .true.
        do k = solid%first(g), solid%first(g + 1) - 1
            if (solid%control(control_stiffness, solid%list(k)) > 0) return
        end do
        if (any(solid%mirror)) then
            do k = solid%image_first(g), solid%image_first(g + 1) - 1
                if (solid%control(control_stiffness, solid%image(k)) > 0) return
            end do
        end if
        yes = .false.
    end function some_pair_held

    !> What pass 1 left of particles, as the images k..last have it. Where a plane turns the normal
    !> round, a tilt changes sign.
    subroutine mirror_rows(solid, p, k, last, rows)
        type(interacting_bodies_t), intent(in) :: solid
        type(lane_group_t), intent(in) :: p
        integer(int64), intent(in) :: k, last
        type(image_rows_t), intent(inout) :: rows
        real(rk) :: s(3)
        integer(int64) :: e
        integer :: j, n

        do e = k, last
            n = int(e - k) + 1
            j = solid%image(e)
            s = signs(int(solid%mask(e)))
            rows%pair(:, n) = solid%pair(:, j)
            call mirror_row(s, rows%pair(:, n))
            if (p%control) rows%control(:, n) = solid%control(:, j)
            if (p%control) call mirror_tensor(s, rows%control(control_affine + 1, n))
            if (.not. p%curved) &
                rows%pair(pair_tilt, n) = mirrored_tilt(s, p%normal, solid%pair(pair_tilt, j))
            if (p%directional) rows%k_axes(:, n) = real(mirrored(s, solid%k_axes(:, j)), real32)
        end do
    end subroutine mirror_rows

    !> Add what the loops over the lanes leave out: other bodies, artificial stress.
    subroutine add_rest(solid, body, i, p, f)
        type(interacting_bodies_t), intent(in) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: i
        type(centre_t), intent(in) :: p !! kernel
        real(rk), intent(inout) :: f(n_terms)

        if (solid%links%bonds) call add_bonded_forces(solid, i, f)
        if (solid%links%present) then
            associate (push => solid%links%push(:, solid%links%row(i)))
                f(1:3) = f(1:3) + push(1:3)
                f(at_drag + 1:at_drag + 3) = f(at_drag + 1:at_drag + 3) + push(4:6)
            end associate
        end if
        if (solid%cohesive%present) f(1:3) = f(1:3) + real(push_of(solid%cohesive, solid%id(i)), rk)
        if (body%artificial /= artificial_none) call add_artificial(solid, body, i, p, f)
    end subroutine add_rest

    !> Volumes and smoothing lengths of a block as its compression says.
    subroutine update_sizes(solid, body, k)
        class(interacting_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: k !! block

        call update_volumes(solid, body, k)
        call update_lengths(solid, body, k)
    end subroutine update_sizes

    subroutine update_volumes(solid, body, k)
        type(interacting_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: k !! block
        integer :: i

        if (body%formulation == form_total) return
        do i = solid%block(2, k), solid%block(3, k)
            solid%volume(i) = solid%mass(i)/(solid%materials(body%material)%density &
                                             *(1 + solid%mu(i)))
        end do
    end subroutine update_volumes

    subroutine update_lengths(solid, body, k)
        type(interacting_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        integer, intent(in) :: k !! block
        integer :: i

        if (.not. body%variable) return
        do i = solid%block(2, k), solid%block(3, k)
            solid%h(i) = smoothing_length(body%h, body%h_range, solid%dimension, solid%mu(i))
        end do
    end subroutine update_lengths

    !> Use the sums of particle i: acceleration, heat, energy account of its block.
    !>
    !> The work against the tensile control is counted pair by pair, so that a body which flies has
    !> the heat of one at rest.
    !> The heat of the pairs is that of the velocity before the kick. A force works with the mean of
    !> the velocities before and after it, so the drag takes dt/2 of its power on the acceleration
    !> back: then the energy of the drag is closed to rounding.
    subroutine accelerate(solid, body, dt, i, k, f)
        type(interacting_bodies_t), intent(inout) :: solid
        type(body_t), intent(in) :: body
        real(rk), intent(in) :: dt
        integer, intent(in) :: i, k
        real(rk), intent(in) :: f(n_terms)
        real(rk) :: force(3), fixed_part(3), load(3), kick(3), heat, friction, before, after, kept

        load = air_force(solid, i)
        if (solid%steps == 0) load = 0 ! all of it acts after the half step up to here
        force = f(1:3) + f(at_drag + 1:at_drag + 3) + f(at_stiff + 1:at_stiff + 3)
        fixed_part = 0
        if (solid%fixed(i) /= is_free) fixed_part = fixed_share(solid%fixed(i))
        solid%a(:, i) = (1 - fixed_part)*force/solid%mass(i)
        kick = (1 - fixed_part)*dt*(solid%a(:, i) + load/solid%mass(i))
        heat = f(at_heat) - dot_product(f(at_drag + 1:at_drag + 3), kick)/2
        friction = dt*f(at_friction)
        before = -dt/2*dot_product(f(at_stiff + 1:at_stiff + 3), solid%v(:, i))
        after = -dt/2*dot_product(f(at_stiff + 1:at_stiff + 3), solid%v(:, i) + kick)
        associate (sums => solid%search%sums(:, k))
            if (body%tensile_control > 0) then
                associate (control_due => solid%control_due(i), work => dt/2*f(at_work))
                    kept = kept_work(control_due + work, solid%control(control_energy, i))
                    friction = friction + (control_due + work - kept)
                    control_due = kept + work + (after - before)
                    sums(8) = sums(8) + kept
                end associate
            else
                sums(2) = sums(2) + before
                sums(6) = sums(6) + after
            end if
            sums(1) = sums(1) + dt*heat
            sums(7) = sums(7) + friction
            sums(3:5) = sums(3:5) + dt*fixed_part*(force + load)
            if (allocated(solid%reaction_force)) solid%reaction_force(:, i) = &
                fixed_part*(force + load)
        end associate
        solid%energy(i) = solid%energy(i) + (dt*heat + friction)/solid%mass(i)
        if (.not. (dot_product(f, f) <= huge(dt)) .or. solid%mu(i) <= -1) then
            if (solid%search%bad(k) == 0) solid%search%bad(k) = i
        end if
    end subroutine accelerate
end module brz_solid_forces
