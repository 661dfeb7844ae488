! SPDX-License-Identifier: MIT
!> One time step of the solids on the GPU: the same list of operations as on the CPU, as launches.
module brz_gpu_solid_step
    use brz_buffers, only: doubles_t, reals_t
    use brz_device, only: clear_buffer, copy_out, reserve_buffer, side_by_side
    use brz_errors, only: error_t, failed
    use brz_gpu_cohesive_steps, only: place_nodes
    use brz_gpu_rigid_steps, only: balance_rigid, move_rigid
    use brz_gpu_solid_copy, only: faults_of
    use brz_gpu_solid_ghosts, only: refresh_gpu_motion, refresh_gpu_rows
    use brz_gpu_solid_home, only: lay_gpu_anew
    use brz_gpu_solid_layout, only: book_load, flag_bad, n_flag
    use brz_gpu_solid_links, only: add_bond_moments, build_gpu_links, contact_pass, &
        settle_gpu_links
    use brz_gpu_solid_rigid, only: fill_rigid, settle_drag, sum_pushes
    use brz_gpu_solid_search, only: build_gpu_lists
    use brz_gpu_solid_state, only: book_of, gpu_solid_body_t, gpu_solid_t, moved_flags, &
        threads_of, words_of_real
    use brz_gpu_solid_sums, only: add_held_impulse, fetch_limit
    use brz_host_calls, only: enter_part
    use brz_kinds, only: dp, int64, rk
    use brz_list_drift, only: drift_bodies, find_stale, level_unit
    use brz_move_level, only: move_levels
    use brz_ranks, only: agree, most_of_all, several
    use brz_solid_faults, only: report_bad
    use brz_solid_launches, only: launch_advance_point, launch_solid_forces, &
        launch_solid_moments
    use brz_solid_sleep, only: wake_met
    use brz_solid_state, only: form_bending, intact_share, solid_t
    implicit none
    private
    public :: gpu_solid_step, gradient_pass, force_pass
    public :: sum_moments, find_gradients, update_material, fill_rows, drift ! apart, to be timed

contains

    !> One time step. The first kick is half a step, as in solid_step.
    subroutine gpu_solid_step(gpu, solid, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        real(dp) :: force(3), limit(1), push(6, size(solid%bodies))
        integer :: flags(n_flag), b, load
        logical :: stale(size(solid%bodies)), recut, relink

        ! of bodies that sleep, too
        if (.not. gpu%stepped) call gradient_pass(gpu, solid, 0.0_dp, err)
        gpu%bodies%asleep = solid%bodies%asleep
        gpu%fetched = .false.
        gpu%stepped = .true.
        gpu%summed = .false.
        gpu%cohesive%fetched = .false.
        if (solid%steps == 0) then
            call refresh_gpu_rows(gpu, solid, err)
            call contact_pass(gpu, solid, 0.0_dp, err)
            load = gpu%column%load
            gpu%column%load = 0 ! all of it acts after the half step up to here
            call force_pass(gpu, dt/2, err)
            gpu%column%load = load
            do b = 1, size(gpu%bodies)
                if (solid%bodies(b)%motion%n > 0 .and. .not. gpu%bodies(b)%rigid) &
                    call add_held_impulse(gpu, solid, b, dt, force, err)
            end do
        end if
        call clear_buffer(gpu%flags, err)
        call drift_bodies(solid, dt)
        call drift(gpu, solid, dt, err)
        solid%time = solid%time + dt
        solid%dt_last = dt
        solid%steps = solid%steps + 1
        call find_stale(solid, moved_levels(gpu, solid, err), stale, relink)
        if (any(stale) .or. relink) then
            call enter_part('lists of bodies')
            if (several(solid%ranks)) then
                call lay_gpu_anew(gpu, solid, stale, recut, err)
                if (recut) call gradient_pass(gpu, solid, 0.0_dp, err, of_sleepers=.true.)
            else
                call build_gpu_lists(gpu, solid, .true., stale, err)
                call settle_gpu_links(gpu, solid, .false.)
                call build_gpu_links(gpu, solid, err)
                call place_nodes(gpu, solid, err)
            end if
            if (any(stale)) solid%rebuilds = solid%rebuilds + 1
            call wake_met(solid)
            gpu%bodies%asleep = solid%bodies%asleep
            call end_support(gpu, solid, stale, err)
            call enter_part('bodies', go_on=.true.)
        else
            call refresh_gpu_motion(gpu, err)
        end if
        call gradient_pass(gpu, solid, dt, err)
        call refresh_gpu_rows(gpu, solid, err)
        call contact_pass(gpu, solid, dt, err)
        call force_pass(gpu, dt, err)
        call fetch_limit(gpu, solid%dt_limit, err)
        call sum_pushes(gpu, solid, push, err)
        call balance_rigid(gpu, solid, push, dt, err)
        call settle_drag(gpu, solid, dt, err)
        if (solid%cohesive%present) solid%dt_limit = min(solid%dt_limit, solid%cohesive%dt_limit)
        flags = 0
        call copy_out(gpu%flags, flags, 4_int64*n_flag, err)
        if (.not. failed(err) .and. flags(flag_bad) /= 0) then
            call faults_of(gpu, solid, err)
            call report_bad(solid, err)
        end if
        limit = solid%dt_limit
        call agree(solid%ranks, err, limit)
        solid%dt_limit = limit(1)
    end subroutine gpu_solid_step

    !> How far the particles of each body have moved relative to it since its list was built: the
    !> highest level of brz_list_drift.
    function moved_levels(gpu, solid, err) result(level)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: level(size(gpu%bodies))
        integer :: flags(move_levels, size(gpu%bodies)), b
        integer(int64) :: most(size(gpu%bodies))

        flags = 0
        call copy_out(moved_flags(gpu, 1), flags, 4_int64*size(flags), err)
        do b = 1, size(gpu%bodies)
            level(b) = findloc(flags(:, b), 1, dim=1, back=.true.)
        end do
        most = level
        call most_of_all(solid%ranks, most)
        level = int(most)
    end function moved_levels

    !> Velocity by the mean of the last and this time step, then position.
    subroutine drift(gpu, solid, dt, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: dt
        type(error_t), intent(inout) :: err
        real(dp) :: unit
        integer :: b, n

        call move_rigid(gpu, solid, dt, err)
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%asleep) cycle
            associate (body => solid%bodies(b), there => gpu%bodies(b))
                n = there%last - there%first + 1
                if (there%rigid) then
                    call gpu%motion_kernels%note_particle(n, there%first, 4, level_unit(solid), &
                        body%drift(1), body%drift(2), body%drift(3), gpu%x, gpu%built, &
                        moved_flags(gpu, b), err)
                    cycle
                end if
                if (body%variable) call gpu%motion_kernels%size_particle(n, there%first, &
                    solid%dimension, body%h, body%h_range(1), body%h_range(2), gpu%mu, gpu%x, err)
                unit = merge(sqrt(huge(dt))/(2*move_levels), level_unit(solid), &
                             there%total .and. .not. gpu%linked)
                call gpu%motion_kernels%drift_particle(n, there%first, 4, gpu%n, 1, &
                    real((solid%dt_last + dt)/2, rk), dt, merge(1, 0, gpu%column%load > 0), unit, &
                    body%drift(1), body%drift(2), body%drift(3), gpu%a, gpu%load, gpu%mass, &
                    gpu%fixed, gpu%built, gpu%x, gpu%v, book_of(gpu, book_load), &
                    moved_flags(gpu, b), err)
            end associate
        end do
    end subroutine drift

    !> Pass 1, and the material over the step just made; with dt = 0 no material. Of bodies that are
    !> awake, or of the others.
    subroutine gradient_pass(gpu, solid, dt, err, of_sleepers)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        logical, intent(in), optional :: of_sleepers
        integer :: b

        call pack_places(gpu, err)
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%rigid) cycle
            if (gpu%bodies(b)%asleep .neqv. present(of_sleepers)) cycle
            call side_by_side(merge(b, 0, size(gpu%bodies) > 1))
            call sum_moments(gpu, gpu%bodies(b), err)
        end do
        call side_by_side(0)
        call add_bond_moments(gpu, err)
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%asleep .neqv. present(of_sleepers)) cycle
            if (gpu%bodies(b)%rigid) then
                call side_by_side(0)
                call fill_rigid(gpu, solid, b, err)
                cycle
            end if
            call side_by_side(merge(b, 0, size(gpu%bodies) > 1))
            call find_gradients(gpu, gpu%bodies(b), real(dt, rk), err)
            if (dt > 0) then
                call free_faces(gpu, gpu%bodies(b), real(dt/2, rk), err)
                call update_material(gpu, gpu%bodies(b), real(dt, rk), err)
                call free_faces(gpu, gpu%bodies(b), real(dt/2, rk), err)
            end if
            call fill_rows(gpu, gpu%bodies(b), err)
        end do
        call side_by_side(0)
    end subroutine gradient_pass

    !> Places and reference positions as pairs read them: in real64 they are these themselves.
    subroutine pack_places(gpu, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (words_of_real == 1) then
            call reserve_buffer(gpu%near, 16_int64*gpu%n, err)
            call reserve_buffer(gpu%far, 16_int64*gpu%n, err)
            call gpu%kernels%solid_pack([gpu%n, 1, 1], gpu%n, gpu%place, gpu%reference, gpu%near, &
                gpu%far, err)
        else
            gpu%near%address = gpu%place%address
            gpu%far%address = gpu%reference%address
        end if
    end subroutine pack_places

    subroutine sum_moments(gpu, body, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        type(doubles_t) :: place, other
        type(reals_t) :: near, far

        place = gpu%place
        other = gpu%reference
        near = gpu%near
        far = gpu%far
        if (body%total) then ! pairs are weighed by X_ij, and the sums lead to dx/dX
            place = gpu%reference
            other = gpu%place
            near = gpu%far
            far = gpu%near
        end if
        call launch_solid_moments(body%moments, threads_of(body), gpu%n, body%params, place, &
            other, near, far, gpu%motion, body%slice, gpu%count, body%list, gpu%row, gpu%grad, &
            gpu%state, gpu%tag, gpu%hold, gpu%held, err)
    end subroutine sum_moments

    subroutine find_gradients(gpu, body, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        real(rk), intent(in) :: dt !! step just made, 0: none [s]
        type(error_t), intent(inout) :: err

        call gpu%kernels%solid_gradients(threads_of(body), gpu%n, body%params, gpu%row, gpu%grad, &
            gpu%tag, gpu%hold, gpu%held, gpu%state, dt, err)
    end subroutine find_gradients

    !> A single layer: take out of the energy what the stress does on its faces.
    subroutine free_faces(gpu, body, time, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        real(rk), intent(in) :: time !! [s]
        type(error_t), intent(inout) :: err

        if (body%layer) call gpu%row_kernels%free_face(body%last - body%first + 1, body%first, &
            gpu%n, 4, time, gpu%row, gpu%grad, gpu%stress, gpu%volume, gpu%mass, gpu%energy, err)
    end subroutine free_faces

    subroutine update_material(gpu, body, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        real(rk), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err

        call launch_advance_point(body%update, threads_of(body), gpu%n, dt, body%params, &
            body%material, gpu%grad, gpu%state, gpu%tag, gpu%book, gpu%flags, err)
    end subroutine update_material

    subroutine fill_rows(gpu, body, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(error_t), intent(inout) :: err

        call gpu%kernels%solid_rows(threads_of(body), gpu%n, body%params, body%material, &
            gpu%place, gpu%grad, gpu%state, gpu%tag, gpu%motion, gpu%row, gpu%rate, gpu%axes, &
            gpu%hold, gpu%held, gpu%flags, err)
    end subroutine fill_rows

    !> Pass 2: accelerations; heat and ledgers over dt, the step just made.
    subroutine force_pass(gpu, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        real(dp), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%rigid .or. gpu%bodies(b)%asleep) cycle
            call side_by_side(merge(b, 0, size(gpu%bodies) > 1))
            associate (body => gpu%bodies(b))
                call launch_solid_forces(body%forces, threads_of(body), gpu%n, real(dt, rk), &
                    merge(1, 0, gpu%linked), gpu%column%load, body%params, gpu%place, gpu%near, &
                    gpu%far, gpu%motion, gpu%row, gpu%hold, gpu%held, body%slice, gpu%count, &
                    body%list, gpu%extra, gpu%state, gpu%tag, gpu%book, gpu%flags, err)
            end associate
        end do
        call side_by_side(0)
    end subroutine force_pass

    !> End the stiff hourglass force, and the tilt, for good where half of the intact neighbours are
    !> gone.
    subroutine end_support(gpu, solid, anew, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        logical, intent(in) :: anew(:) !! (bodies) whose lists were built anew
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            if (.not. anew(b)) cycle
            if (solid%bodies(b)%formulation /= form_bending .and. .not. gpu%bodies(b)%drawn) cycle
            associate (body => gpu%bodies(b))
                call gpu%kernels%solid_end_support(threads_of(body), gpu%n, body%params, &
                    intact_share, body%slice, gpu%count, body%list, gpu%reference, gpu%state, &
                    gpu%tag, err)
            end associate
        end do
    end subroutine end_support

end module brz_gpu_solid_step
