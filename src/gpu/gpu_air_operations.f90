! SPDX-License-Identifier: MIT
!> What a step of the air is made of on the GPU, as launches; brz_air_driver puts it in order.
!>
!> Each stage reads one state and writes another, so that a cell can be computed again.
module brz_gpu_air_operations
    use brz_air_device, only: air_device_t
    use brz_air_grid, only: faces_of_a_thread, lines_along, stage_t
    use brz_air_launches, only: air_kernels, launch_faces, launch_march, launch_redo
    use brz_air_lost, only: find_lost
    use brz_air_state, only: air_t
    use brz_buffers, only: from
    use brz_device, only: clear_buffer, copy_out, kernel_t
    use brz_errors, only: error_t, failed
    use brz_fallback_loop_bodies, only: to_redo
    use brz_gpu_air_state, only: bytes_of_real
    use brz_kinds, only: dp, int64, int8, rk
    use brz_ranks, only: reduce_errors
    implicit none
    private
    public :: get_ready, sweep_all, find_bad, redo, find_lost_cell
    public :: offer_ghosts, take_ghosts

contains

    !> What the step starts from.
    subroutine get_ready(gpu)
        type(air_device_t), intent(inout) :: gpu

        gpu%fetched = .false.
        gpu%start = gpu%u
    end subroutine get_ready

    !> Rates of all directions; the last one completes the next state and marks its bad cells. Cells
    !> at walls at the ends of lines are computed again, cut ones afterwards.
    subroutine sweep_all(gpu, air, stage, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(stage_t), intent(in) :: stage
        type(error_t), intent(inout) :: err
        type(kernel_t) :: kernel
        integer :: d, threads(3)

        if (air%n(1) > 1) then
            threads = [(air%n(1)/faces_of_a_thread + 1)*air%n(2), air%n(3), 1]
            call launch_faces(gpu%faces, threads, gpu%grid, air%scheme, gpu%u, &
                              gpu%bricks%active, gpu%flux, gpu%edge, err)
        end if
        if (gpu%grid%last == 1) call air_kernels%air_update_line(air%n, gpu%grid, stage, gpu%u, &
            gpu%start, gpu%new, gpu%flux, gpu%walls%near, gpu%bad, gpu%found, err)
        do d = 2, 3
            if (air%n(d) == 1) cycle
            threads = [lines_along(gpu%grid, d), (air%n(d) - 1)/gpu%grid%segment(d) + 1, 1]
            kernel = gpu%march
            if (d == gpu%grid%last) kernel = gpu%last
            call launch_march(kernel, threads, d, gpu%grid, air%scheme, stage, gpu%u, gpu%start, &
                              gpu%new, gpu%flux, gpu%walls%near, gpu%bricks%active, gpu%bad, &
                              gpu%found, gpu%edge, err)
        end do
        if (gpu%n_near > 0) call redo_cells(gpu, air, stage, gpu%n_near, 0, to_redo, err)
    end subroutine sweep_all

    !> Others get ghosts of the next state, before all of them reduce their errors, with it: see
    !> take_ghosts.
    subroutine offer_ghosts(gpu, err)
        type(air_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        call gpu%halo%offer_reals(gpu%grid%apart, gpu%new, err)
        gpu%offered = .true.
    end subroutine offer_ghosts

    !> Ghosts of the boxes of others.
    subroutine take_ghosts(gpu, err)
        type(air_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        if (gpu%offered) then
            call gpu%halo%take_reals(gpu%grid%apart, gpu%u, .true., err)
        else
            call gpu%halo%reals_of_others(gpu%grid%apart, gpu%u, err)
        end if
        gpu%offered = .false.
    end subroutine take_ghosts

    !> Compute marked cells and their neighbours again.
    subroutine redo(gpu, air, stage, pass, task, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(error_t), intent(inout) :: err

        call redo_cells(gpu, air, stage, 0, pass, task, err)
    end subroutine redo

    !> Compute the listed cells again, those at walls, or without a list marked ones.
    subroutine redo_cells(gpu, air, stage, listed, pass, task, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: listed !! how many, or 0
        integer, intent(in) :: pass, task !! see redo
        type(error_t), intent(inout) :: err
        integer :: threads(3)

        threads = [merge(listed, product(air%n), listed > 0), 1, 1]
        call launch_redo(gpu%redo, threads, listed, gpu%near_at, pass, task, gpu%grid, air%scheme, &
                         stage, gpu%walls%near, gpu%u, gpu%start, gpu%new, gpu%bad, gpu%found, &
                         gpu%edge, err)
    end subroutine redo_cells

    !> Has a kernel found a bad cell since the last call, in any process? An error of one is then
    !> that of all.
    subroutine find_bad(gpu, air, found, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        logical, intent(out) :: found
        type(error_t), intent(inout) :: err
        integer :: number
        real(dp) :: none(1)

        call take_found(gpu, number, err)
        none = merge(1, 0, number == 0)
        call reduce_errors(air%part%ranks, err, none)
        found = none(1) < 1 .and. .not. failed(err)
    end subroutine find_bad

    !> What kernels have found since the last call.
    subroutine take_found(gpu, number, err)
        type(air_device_t), intent(in) :: gpu
        integer, intent(out) :: number
        type(error_t), intent(inout) :: err
        integer :: found(1)

        found = 0
        call copy_out(gpu%found, found, 4_int64, err)
        number = found(1)
        if (number > 0) call clear_buffer(gpu%found, err)
    end subroutine take_found

    !> Where the first lost cell of this process is, and what it would have become: the next state
    !> holds the Euler step of lost cells.
    subroutine find_lost_cell(gpu, air, here, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(inout) :: air
        logical, intent(out) :: here !! there is one
        type(error_t), intent(inout) :: err
        integer(int8), allocatable :: marks(:)
        real(rk) :: value(1)
        integer(int64) :: at
        integer :: c

        allocate (marks(gpu%grid%apart), source=0_int8)
        call copy_out(gpu%bad, marks, gpu%grid%apart, err)
        call find_lost(air, gpu%grid, marks, at)
        here = at > 0
        do c = 1, 5
            value = 0
            if (here) call copy_out(from(gpu%new, at + (c - 1)*gpu%grid%apart), value, &
                                    bytes_of_real, err)
            air%bad_state(c) = value(1)
        end do
    end subroutine find_lost_cell
end module brz_gpu_air_operations
