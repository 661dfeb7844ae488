! SPDX-License-Identifier: MIT
!> One time step of the air on the GPU: the same list of operations as on the CPU, as launches.
module brz_gpu_air_step
    use brz_air_grid, only: faces_of_a_thread, lines_along, stage_t
    use brz_air_lost, only: find_lost, first_lost
    use brz_air_launches, only: air_kernels, launch_faces, launch_march, launch_redo
    use brz_air_stage, only: stage_of
    use brz_air_state, only: air_ok, air_t, air_unphysical
    use brz_buffers, only: from, reals_t
    use brz_device, only: clear_buffer, copy_out, kernel_t
    use brz_ghost_launches, only: ghost_kernels
    use brz_fallback_launches, only: fallback_kernels
    use brz_face_launches, only: face_kernels
    use brz_errors, only: error_t, failed
    use brz_fallback_items, only: to_hold, to_lose, to_redo
    use brz_gpu_air_activity, only: find_awake_bricks
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_kinds, only: dp, int64, int8, rk
    use brz_positivity, only: hold_step, most_holds
    use brz_ranks, only: agree
    use brz_runge_kutta, only: repair_passes
    use brz_scheme, only: first_order
    implicit none
    private
    public :: gpu_air_step

    !> The state that a stage starts from, that of the start of the step, and the next one.
    type :: states_t
        type(reals_t) :: u, start, new
    end type states_t

contains

    !> Advance the air by dt. `status` is air_ok, or air_unphysical: air%bad_cell tells where.
    !>
    !> Each stage reads one state and writes another, so that a cell can be computed again.
    subroutine gpu_air_step(gpu, air, dt, status, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        real(dp), intent(in) :: dt !! time step [s]
        integer, intent(out) :: status
        type(error_t), intent(inout) :: err !! exit_device where the GPU fails
        type(states_t) :: states
        type(stage_t) :: stage
        integer :: m
        logical :: lost

        status = air_ok
        gpu%fetched = .false.
        if (gpu%walls%n_faces > 0) call clear_buffer(gpu%walls%impulse, err)
        call find_awake_bricks(gpu, air, err)
        states = states_t(gpu%u, gpu%u, gpu%spare(1))
        do m = 1, air%n_stages
            stage = stage_of(air, dt, m)
            call gpu%halo%reals_of_others(gpu%grid%apart, states%u, err)
            call ghost_kernels%fill_end(2*gpu%grid%lines, gpu%grid, air%scheme, gpu%outside, &
                                     gpu%walls%solid, states%u, err)
            call sweep(gpu, air, stage, states, err)
            if (gpu%grid%walls == 1) call redo(gpu, air, states, stage, 0, to_redo, err)
            call repair(gpu, air, states, stage, lost, err)
            if (lost) status = air_unphysical
            if (failed(err) .or. lost) return
            call air_kernels%air_outflow([gpu%grid%lines, air%n_var, 2], gpu%grid, stage, &
                                         gpu%edge, gpu%outflow, err)
            if (gpu%walls%n_faces > 0) &
                call face_kernels%add_push(gpu%walls%n_faces, gpu%walls%push, &
                                                gpu%walls%impulse, err)
            states%u = states%new
            states%new = gpu%spare(1 + mod(m, 2))
        end do
        m = merge(1, 2, states%u%address == gpu%spare(1)%address)
        gpu%spare(m) = gpu%u
        gpu%u = states%u
    end subroutine gpu_air_step

    !> Has a kernel found a bad cell since the last call, in any process? An error of one is then
    !> that of all.
    logical function found_bad(gpu, air, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        integer, target :: found(1)
        real(dp) :: none(1)

        found = 0
        call copy_out(gpu%found, found, 4_int64, err)
        none = merge(1, 0, found(1) == 0)
        call agree(air%part%ranks, err, none)
        found_bad = none(1) < 1 .and. .not. failed(err)
        if (found_bad) call clear_buffer(gpu%found, err)
    end function found_bad

    !> Rates of all directions; the last one completes the next state and marks its bad cells.
    subroutine sweep(gpu, air, stage, states, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(stage_t), intent(in) :: stage
        type(states_t), intent(in) :: states
        type(error_t), intent(inout) :: err
        type(kernel_t) :: kernel
        integer :: d, threads(3)

        if (air%n(1) > 1) then
            threads = [(air%n(1)/faces_of_a_thread + 1)*air%n(2), air%n(3), 1]
            call launch_faces(gpu%faces, threads, gpu%grid, air%scheme, states%u, &
                              gpu%bricks%awake, gpu%flux, gpu%edge, err)
        end if
        if (gpu%grid%last == 1) call air_kernels%air_update_line(air%n, gpu%grid, stage, states%u, &
            states%start, states%new, gpu%flux, gpu%walls%near, gpu%bad, gpu%found, err)
        do d = 2, 3
            if (air%n(d) == 1) cycle
            threads = [lines_along(gpu%grid, d), (air%n(d) - 1)/gpu%grid%segment(d) + 1, 1]
            kernel = gpu%march
            if (d == gpu%grid%last) kernel = gpu%last
            call launch_march(kernel, threads, d, gpu%grid, air%scheme, stage, states%u, &
                              states%start, states%new, gpu%flux, gpu%walls%near, &
                              gpu%bricks%awake, gpu%bad, gpu%found, gpu%edge, err)
        end do
    end subroutine sweep

    !> Give the faces of bad cells the flux of first order. `lost` if that does not help.
    subroutine repair(gpu, air, states, stage, lost, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        type(states_t), intent(in) :: states
        type(stage_t), intent(in) :: stage
        logical, intent(out) :: lost
        type(error_t), intent(inout) :: err
        integer :: pass

        lost = .false.
        if (.not. found_bad(gpu, air, err)) return
        pass = 0
        if (air%fallback .and. air%scheme%reconstruction /= first_order) then
            do pass = 1, repair_passes
                call gpu%beside%bytes_of_others(gpu%bad, err)
                call redo(gpu, air, states, stage, pass, to_redo, err)
                if (.not. found_bad(gpu, air, err)) exit
            end do
            pass = min(pass, repair_passes)
            call add_count(gpu, air, pass, air%fallback_faces, err)
        end if
        if (air%fallback) call hold_cells(gpu, air, states, stage, pass, err)
        call redo(gpu, air, states, stage, pass, to_lose, err)
        lost = found_bad(gpu, air, err)
        if (lost) call find_lost_cell(gpu, air, states%new, lost, err)
        call clear_buffer(gpu%bad, err)
    end subroutine repair

    !> Close the faces of the cells that no flux of first order saves.
    subroutine hold_cells(gpu, air, states, stage, pass, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        type(states_t), intent(in) :: states
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: pass !! marks up to this one count
        type(error_t), intent(inout) :: err
        integer :: m
        logical :: bad

        do m = 1, most_holds
            call redo(gpu, air, states, stage, pass, to_hold, err)
            if (.not. found_bad(gpu, air, err)) exit
            call gpu%beside%bytes_of_others(gpu%bad, err)
            pass = pass + hold_step
            call redo(gpu, air, states, stage, pass, to_redo, err)
            bad = found_bad(gpu, air, err) ! whether cells must be held is asked again
        end do
        if (pass >= hold_step) call add_count(gpu, air, pass, air%held_cells, err)
    end subroutine hold_cells

    !> Compute marked cells and their neighbours again, in pass 0 those near walls.
    subroutine redo(gpu, air, states, stage, pass, task, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(states_t), intent(in) :: states
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(error_t), intent(inout) :: err

        associate (walls => gpu%walls)
            call launch_redo(gpu%redo, air%n, pass, task, gpu%grid, air%scheme, stage, states%u, &
                             states%start, states%new, gpu%bad, gpu%found, gpu%edge, walls%near, &
                             walls%solid, walls%index, walls%v, walls%face_of, walls%push, err)
        end associate
    end subroutine redo

    !> Count the faces that took the first-order flux, or, in a pass that holds, the cells held.
    subroutine add_count(gpu, air, pass, total, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        integer, intent(in) :: pass !! marks up to this one count
        integer(int64), intent(inout) :: total !! the number is added
        type(error_t), intent(inout) :: err
        integer :: number(1)

        call clear_buffer(gpu%found, err)
        call fallback_kernels%count_marked(product(air%n), pass, gpu%grid, gpu%bad, gpu%found, err)
        number = 0
        call copy_out(gpu%found, number, 4_int64, err)
        call clear_buffer(gpu%found, err)
        total = total + number(1)
    end subroutine add_count

    !> Where the first lost cell of all is, and what it would have become.
    subroutine find_lost_cell(gpu, air, new, lost, err)
        type(gpu_air_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        type(reals_t), intent(in) :: new !! holds the Euler step of lost cells
        logical, intent(out) :: lost
        type(error_t), intent(inout) :: err
        integer(int8), allocatable :: marks(:)
        real(rk) :: value(1)
        integer(int64) :: first
        integer :: c

        allocate (marks(gpu%grid%apart), source=0_int8)
        call copy_out(gpu%bad, marks, gpu%grid%apart, err)
        call find_lost(air, gpu%grid, marks, first)
        do c = 1, 5
            value = 0
            if (first > 0) &
                call copy_out(from(new, first + (c - 1)*gpu%grid%apart), value, bytes_of_real, err)
            air%bad_state(c) = value(1)
        end do
        lost = first_lost(air, first > 0)
    end subroutine find_lost_cell
end module brz_gpu_air_step
