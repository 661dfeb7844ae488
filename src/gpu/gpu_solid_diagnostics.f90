! SPDX-License-Identifier: MIT
!> Numbers about all particles on the GPU: energy accounts, extents, time step. Folded in a fixed
!> order.
module brz_gpu_solid_diagnostics
    use brz_buffers, only: doubles_t, from, integers_t, reals_t
    use brz_device, only: clear_buffer
    use brz_errors, only: error_t, failed
    use brz_exact_sum, only: exact_sums
    use brz_force_loop_bodies, only: n_forces
    use brz_motion_loop_bodies, only: n_sum
    use brz_formulation_names, only: artificial_none
    use brz_gpu_solid_layout, only: diag_ahead, diag_clamped, diag_contact, &
        diag_contact_early, diag_contact_heat, diag_damage, diag_early, diag_force, &
        diag_friction, diag_stiff, diag_load, diag_plastic, diag_rub, diag_viscous, n_diag
    use brz_gpu_solid_state, only: diag_of
    use brz_gpu_solid_tiles, only: adders_of
    use brz_solid_device, only: solid_device_t
    use brz_kinds, only: dp, int64, rk
    use brz_ranks, only: least_of_all
    use brz_solid_launches, only: solid_kernels
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: add_held_impulse, boxes_of_all, fetch_accounts, fetch_limit, find_extents, &
        forget_gone, note_boxes, sum_forces_of_all, sum_states

contains

    !> Sums of the state of each body, of all processes.
    subroutine sum_states(gpu, solid, sums, err)
        type(solid_device_t), intent(in) :: gpu
        class(particles_t), intent(in) :: solid
        real(dp), intent(out) :: sums(n_sum, size(gpu%bodies)) !! see sum_state
        type(error_t), intent(inout) :: err
        real(dp) :: own(n_sum, size(gpu%bodies)), all(n_sum*size(gpu%bodies))
        type(integers_t) :: tiles
        integer :: threads(3)

        call adders_of(gpu, 1, size(gpu%bodies), tiles, threads)
        if (threads(1) > 0) call solid_kernels%solid_state_of(threads, gpu%stride_d, tiles, &
            gpu%adders%sets, real(solid%dt_last/2, rk), gpu%region, gpu%place, gpu%motion, &
            gpu%state, gpu%tag, gpu%adders%part, err)
        call gpu%common%fold_sets(gpu%adders%part, gpu%adders%sets, 1, size(gpu%bodies), n_sum, err)
        call gpu%common%read_sums(1, own, err)
        call exact_sums(solid%ranks, reshape(own, [size(own), 1]), all)
        sums = reshape(all, shape(sums))
    end subroutine sum_states

    !> Forces on each body, of all processes, with moments about the origin.
    subroutine sum_forces_of_all(gpu, solid, sums, err)
        type(solid_device_t), intent(in) :: gpu
        class(particles_t), intent(in) :: solid
        real(dp), intent(out) :: sums(n_forces, size(gpu%bodies)) !! see sum_forces
        type(error_t), intent(inout) :: err
        real(dp) :: own(n_forces, size(gpu%bodies)), all(n_forces*size(gpu%bodies))
        type(integers_t) :: tiles
        type(reals_t) :: grip, load
        integer :: threads(3)

        load = gpu%a ! not read
        if (gpu%column%load > 0) load = gpu%load
        grip = gpu%a
        if (gpu%column%reaction_force > 0) grip = gpu%reaction_force
        call adders_of(gpu, 1, size(gpu%bodies), tiles, threads)
        if (threads(1) > 0) call solid_kernels%solid_total_forces(threads, gpu%stride_d, tiles, &
            gpu%adders%sets, merge(1, 0, gpu%column%load > 0), &
            merge(1, 0, gpu%column%reaction_force > 0), gpu%place, gpu%mass, gpu%fixed, gpu%a, &
            load, grip, gpu%adders%part, err)
        call gpu%common%fold_sets(gpu%adders%part, gpu%adders%sets, 1, size(gpu%bodies), &
                                  n_forces, err)
        call gpu%common%read_sums(1, own, err)
        call exact_sums(solid%ranks, reshape(own, [size(own), 1]), all)
        sums = reshape(all, shape(sums))
    end subroutine sum_forces_of_all

    !> Sums of the columns of `diag` over the bodies first..last, each.
    subroutine sum_diag(gpu, first, last, sums, err)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: first, last !! bodies
        real(dp), intent(out) :: sums(n_diag, last - first + 1)
        type(error_t), intent(inout) :: err
        type(integers_t) :: tiles
        integer :: threads(3)

        call adders_of(gpu, first, last, tiles, threads)
        threads(2) = n_diag
        if (threads(1) > 0) call solid_kernels%solid_diag_of(threads, gpu%stride_d, tiles, &
            gpu%adders%sets, gpu%diag, gpu%adders%part, err)
        call gpu%common%fold_sets(gpu%adders%part, gpu%adders%sets, first, last, n_diag, err)
        call gpu%common%read_sums(first, sums, err)
    end subroutine sum_diag

    !> Bring the energy accounts and the reactions of all bodies up to date.
    subroutine fetch_accounts(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: diagnostics(n_diag, size(gpu%bodies))
        integer :: b

        if (gpu%summed .or. .not. gpu%stepped) return
        call sum_diag(gpu, 1, size(gpu%bodies), diagnostics, err)
        if (failed(err)) return
        do b = 1, size(gpu%bodies)
            call fill_account(gpu, b, diagnostics(:, b), solid)
        end do
        gpu%summed = .true.
    end subroutine fetch_accounts

    !> Energy account of body b from what it was when the GPU took over and from the sums of `diag`.
    subroutine fill_account(gpu, b, diag, solid)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: b
        real(dp), intent(in) :: diag(n_diag)
        class(bodies_t), intent(inout) :: solid

        associate (account => solid%bodies(b)%account, before => gpu%account(b))
            account%viscous = before%viscous + diag(diag_viscous)
            account%hourglass_heat = before%hourglass_heat + diag(diag_friction)
            account%plastic = before%plastic + diag(diag_plastic)
            account%damage = before%damage + diag(diag_damage)
            account%clamped = before%clamped + diag(diag_clamped)
            if (.not. gpu%bodies(b)%rigid) account%load = before%load + diag(diag_load)
            account%ahead = diag(diag_ahead)
            account%early = 0
            if (.not. solid%bodies(b)%inactive) account%early = diag(diag_early)
            if (gpu%linked .and. .not. solid%bodies(b)%inactive) &
                account%early = account%early + diag(diag_contact_early)
            if (gpu%linked) account%contact = diag(diag_contact)
            account%contact_heat = before%contact_heat + diag(diag_contact_heat)
            account%friction = before%friction + diag(diag_rub)
            if (gpu%bodies(b)%in_tension) then
                account%hourglass = diag(diag_stiff)
            else if (solid%bodies(b)%artificial == artificial_none) then
                account%hourglass = before%hourglass + before%ahead + diag(diag_stiff) - &
                    account%ahead
            else
                account%artificial = before%artificial + before%ahead + diag(diag_stiff) &
                    - account%ahead
            end if
            if (solid%bodies(b)%motion%n == 0 .and. .not. gpu%bodies(b)%rigid) &
                solid%bodies(b)%reaction = &
                gpu%reaction(:, b) + diag(diag_force + 1:diag_force + 3)
        end associate
    end subroutine fill_account

    !> Add the mean force of body b on what holds it in the last pass 2, and record its impulse.
    subroutine add_held_impulse(gpu, solid, b, dt, force, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        real(dp), intent(in) :: dt !! step just made [s]
        real(dp), intent(inout) :: force(3) !! [N]
        type(error_t), intent(inout) :: err
        real(dp) :: diag(n_diag, 1)

        call sum_diag(gpu, b, b, diag, err)
        associate (impulse => diag(diag_force + 1:diag_force + 3, 1))
            solid%bodies(b)%reaction = solid%bodies(b)%reaction + impulse
            force = force + impulse/dt
        end associate
    end subroutine add_held_impulse

    !> Corners of the bodies first..last in this process, for given places, wait in their sets;
    !> without particles the low one is huge and above the high one.
    subroutine find_extents(gpu, first, last, place, err)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: first, last !! bodies
        type(doubles_t), intent(in) :: place
        type(error_t), intent(inout) :: err
        type(integers_t) :: tiles
        integer :: threads(3)

        call adders_of(gpu, first, last, tiles, threads)
        if (threads(1) > 0) call solid_kernels%solid_extent(threads, tiles, gpu%adders%sets, &
            gpu%fixed, place, gpu%adders%part, err)
        call gpu%common%fold_boxes(gpu%adders%part, gpu%adders%sets, first, last, err)
    end subroutine find_extents

    !> Corners of some bodies at their positions `built`: cells and links are chosen by them.
    subroutine note_boxes(gpu, solid, which, err)
        type(solid_device_t), intent(inout) :: gpu
        class(particles_t), intent(in) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        type(error_t), intent(inout) :: err
        real(dp) :: box(3, 2, size(which))
        integer :: b

        if (.not. any(which)) return
        call find_extents(gpu, 1, size(which), gpu%built, err)
        call boxes_of_all(gpu, solid, 1, box, err)
        do b = 1, size(which)
            if (which(b)) gpu%bodies(b)%box = box(:, :, b)
        end do
    end subroutine note_boxes

    !> Corners of the bodies whose extents wait, from a first one on, of all processes.
    subroutine boxes_of_all(gpu, solid, first, box, err)
        type(solid_device_t), intent(in) :: gpu
        class(particles_t), intent(in) :: solid
        integer, intent(in) :: first !! body
        real(dp), intent(out) :: box(:, :, :) !! (3, 2, bodies) [m]
        type(error_t), intent(inout) :: err
        real(dp) :: least(size(box))
        integer :: b

        call gpu%common%read_boxes(first, box, err)
        box(:, 2, :) = -box(:, 2, :)
        least = reshape(box, [size(box)])
        call least_of_all(solid%ranks, least)
        box = reshape(least, shape(box))
        box(:, 2, :) = -box(:, 2, :)
        do b = 1, size(box, 3)
            if (any(box(:, 1, b) > box(:, 2, b))) box(:, :, b) = 0 ! nothing is there
        end do
    end subroutine boxes_of_all

    !> What is gone from body b, its last particles, limits no time step, and the diagnostics of the
    !> last step have nothing of it.
    subroutine forget_gone(gpu, solid, b, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        integer, allocatable :: columns(:)
        integer :: c

        associate (gone => gpu%bodies(b)%gone, &
                   at => gpu%bodies(b)%last - gpu%bodies(b)%gone + 1_int64)
            if (gone == 0) return
            call clear_buffer(from(gpu%rate, at), err, 8_int64*gone)
            columns = [diag_ahead, diag_early]
            if (gpu%bodies(b)%in_tension) columns = [columns, diag_stiff]
            if (solid%bodies(b)%motion%n > 0) columns = [columns, diag_force + [1, 2, 3]]
            do c = 1, size(columns)
                call clear_buffer(from(diag_of(gpu, columns(c)), at), err, 8_int64*gone)
            end do
        end associate
    end subroutine forget_gone

    !> Largest stable time step, as pass 1, contact and interfaces left it [s].
    subroutine fetch_limit(gpu, solid, err)
        type(solid_device_t), intent(in) :: gpu
        class(interacting_bodies_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: rate

        rate = gpu%common%largest(gpu%rate, gpu%n, err)
        solid%dt_limit = 0 ! no step is possible with a rate that is no number
        if (rate < huge(rate)) solid%dt_limit = 1/max(rate, tiny(rate))
        if (solid%cohesive%present) solid%dt_limit = min(solid%dt_limit, solid%cohesive%dt_limit)
    end subroutine fetch_limit
end module brz_gpu_solid_diagnostics
