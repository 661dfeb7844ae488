! SPDX-License-Identifier: MIT
!> Neighbour lists on the GPU: the same cells, order and lists as on the CPU.
module brz_gpu_solid_search
    use brz_cell_grid, only: cell_of_groups, choose_cells, reach_of_lists
    use brz_buffers, only: doubles_t
    use brz_device, only: allocate_buffer, arguments_t, buffer_t, clear_buffer, copy_in, copy_out, &
        free_buffer, kernel_t, launch
    use brz_errors, only: error_t, failed
    use brz_gpu_scan, only: running_sum
    use brz_gpu_solid_layout, only: grid_gpu_t, n_book, n_tag, n_total, slice_width
    use brz_gpu_solid_state, only: bytes_of_real, gpu_solid_body_t, gpu_solid_t, part_of, &
        sum_threads
    use brz_gpu_solid_sums, only: sums_of_body
    use brz_kinds, only: dp, int64
    use brz_list_drift, only: begin_list
    use brz_solid_state, only: n_pair, solid_t
    implicit none
    private
    public :: build_gpu_lists, order_body

contains

    !> Build the lists of the stale bodies. With `sort` their particles are first brought into the
    !> order of the cells at their present positions; without, the lists of the positions `built`
    !> are restored.
    subroutine build_gpu_lists(gpu, solid, sort, stale, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        logical, intent(in) :: sort
        logical, intent(in) :: stale(:) !! (bodies)
        type(error_t), intent(inout) :: err
        type(doubles_t) :: place
        integer :: b, cells

        do b = 1, size(gpu%bodies)
            if (.not. stale(b)) cycle
            if (sort) call sort_body(gpu, solid, b, err)
            call find_box(gpu, b, gpu%built, gpu%bodies(b)%box, err)
            if (gpu%bodies(b)%rigid) cycle
            place = gpu%built
            if (gpu%bodies(b)%total) place = gpu%reference
            call order_body(gpu, solid, b, place, reach_of_lists(solid, b), cells, err)
            call list_body(gpu, b, place, err)
        end do
    end subroutine build_gpu_lists

    !> Bring the particles of body b into the order of the cells at their present positions.
    subroutine sort_body(gpu, solid, b, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        real(dp) :: sums(n_total + n_book)
        integer :: cells

        call sums_of_body(gpu, b, solid%dt_last, sums, err)
        call note_positions(gpu, gpu%bodies(b), err)
        call order_body(gpu, solid, b, gpu%built, cell_of_groups(solid, b), cells, err)
        if (failed(err)) return
        call reorder(gpu, gpu%bodies(b), err)
        call note_positions(gpu, gpu%bodies(b), err)
        call begin_list(solid, b, sums(5:7)/max(sums(1), tiny(sums)))
    end subroutine sort_body

    !> Positions that decide on the neighbours: total-Lagrangian bodies that meet no other keep the
    !> unloaded ones.
    subroutine note_positions(gpu, body, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        type(doubles_t) :: from
        integer(int64) :: start

        start = 32_int64*(body%first - 1)
        from = gpu%place
        if (body%total .and. .not. gpu%linked) from = gpu%reference
        call copy_bytes(gpu, part_of(from, start), part_of(gpu%built, start), &
                        32_int64*(body%last - body%first + 1), err)
    end subroutine note_positions

    !> Copy on the GPU; a multiple of 4 B.
    subroutine copy_bytes(gpu, from, to, bytes, err)
        type(gpu_solid_t), intent(in) :: gpu
        class(buffer_t), intent(in) :: from, to
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(bytes/4)
        call arguments%add(from)
        call arguments%add(to)
        call launch(gpu%copy, [int(bytes/4), 1, 1], arguments, err)
    end subroutine copy_bytes

    !> Lay cells over body b for given places and put its particles into them, in `order`.
    subroutine order_body(gpu, solid, b, place, reach, cells, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        class(buffer_t), intent(in) :: place
        real(dp), intent(in) :: reach !! side of a cell [m]
        integer, intent(out) :: cells !! along the curve
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: n

        cells = 1
        call lay_cells(gpu, solid, b, place, reach, err)
        if (failed(err)) return
        cells = ubound(solid%search%start, 1)
        n = gpu%bodies(b)%last - gpu%bodies(b)%first + 1
        call clear_buffer(part_to(gpu%start, 4_int64*(cells + 1)), err)
        call arguments%add(gpu%grid)
        call arguments%add(gpu%code)
        call arguments%add(place)
        call arguments%add(gpu%cell)
        call arguments%add(gpu%start)
        call launch(gpu%count_cells, [n, 1, 1], arguments, err)
        call running_sum(gpu%scan, gpu%start, cells, err)
        arguments%n = 0
        call arguments%add(gpu%grid)
        call arguments%add(gpu%cell)
        call arguments%add(gpu%start)
        call arguments%add(gpu%order)
        call launch(gpu%fill_cells, [n, 1, 1], arguments, err)
        arguments%n = 0
        call arguments%add(cells)
        call arguments%add(gpu%bodies(b)%first)
        call arguments%add(gpu%start)
        call arguments%add(gpu%order)
        call launch(gpu%sort_cells, [cells, 1, 1], arguments, err)
    end subroutine order_body

    !> The first bytes of a buffer.
    pure function part_to(buffer, bytes) result(part)
        class(buffer_t), intent(in) :: buffer
        integer(int64), intent(in) :: bytes
        type(buffer_t) :: part

        part = buffer
        part%bytes = bytes
    end function part_to

    !> Choose the cells for body b, and hand them to the GPU.
    subroutine lay_cells(gpu, solid, b, place, reach, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        class(buffer_t), intent(in) :: place
        real(dp), intent(in) :: reach !! [m]
        type(error_t), intent(inout) :: err
        type(grid_gpu_t) :: grid
        real(dp) :: box(3, 2)

        call find_box(gpu, b, place, box, err)
        if (failed(err)) return
        grid%first = gpu%bodies(b)%first
        grid%last = gpu%bodies(b)%last
        grid%reach = reach
        call copy_in(box, gpu%box, 48_int64, err)
        call choose_cells(solid%search, box(:, 1), box(:, 2), grid%last - grid%first + 1, reach)
        grid%cells = solid%search%cells
        grid%stride = size(solid%search%code, 1)
        grid%mirror = merge(1, 0, solid%mirror)
        grid%lo = solid%search%lo
        grid%size = solid%search%size
        call copy_in(grid, gpu%grid, int(storage_size(grid)/8, int64), err)
        if (3*grid%stride > gpu%code_room) then
            call free_buffer(gpu%code)
            gpu%code_room = 3*grid%stride
            call allocate_buffer(gpu%code, 4_int64*gpu%code_room, err)
        end if
        call copy_in(solid%search%code, gpu%code, 4_int64*3*grid%stride, err)
    end subroutine lay_cells

    !> Corners of body b for given places.
    subroutine find_box(gpu, b, place, box, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: b
        class(buffer_t), intent(in) :: place
        real(dp), intent(out) :: box(3, 2) !! [m]
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        real(dp) :: part(sum_threads, 6)

        call arguments%add(gpu%bodies(b)%first)
        call arguments%add(gpu%bodies(b)%last)
        call arguments%add(sum_threads)
        call arguments%add(place)
        call arguments%add(gpu%part)
        call launch(gpu%extent, [sum_threads, 1, 1], arguments, err)
        part = 0
        call copy_out(gpu%part, part, 8_int64*size(part), err)
        box(:, 1) = minval(part(:, 1:3), 1)
        box(:, 2) = maxval(part(:, 4:6), 1)
    end subroutine find_box

    !> Bring all arrays of the particles of a body into the order of `order`, by way of `row`.
    subroutine reorder(gpu, body, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        integer :: c

        call gather(gpu, body, gpu%gather_places, gpu%place, 1, err)
        call gather(gpu, body, gpu%gather_places, gpu%reference, 1, err)
        call gather(gpu, body, gpu%gather_motion, gpu%motion, 1, err)
        do c = 0, gpu%n_state - 1, n_pair
            call gather(gpu, body, gpu%gather_columns, &
                        part_of(gpu%state, c*bytes_of_real*gpu%n), min(n_pair, gpu%n_state - c), &
                        err)
        end do
        call gather(gpu, body, gpu%gather_tags, gpu%tag, n_tag, err)
    end subroutine reorder

    !> To `row` in the new order, and back.
    subroutine gather(gpu, body, kernel, values, columns, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(kernel_t), intent(in) :: kernel
        class(buffer_t), intent(in) :: values
        integer, intent(in) :: columns
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: back

        do back = 0, 1
            arguments%n = 0
            call arguments%add(gpu%n)
            call arguments%add(body%first)
            call arguments%add(body%last)
            call arguments%add(back)
            call arguments%add(gpu%order)
            if (back == 0) call arguments%add_all(values, gpu%row)
            if (back == 1) call arguments%add_all(gpu%row, values)
            call launch(kernel, [body%last - body%first + 1, columns, 1], arguments, err)
        end do
    end subroutine gather

    !> The lists of body b, whose particles are in the cells.
    subroutine list_body(gpu, b, place, err)
        type(gpu_solid_t), intent(inout) :: gpu
        integer, intent(in) :: b
        class(buffer_t), intent(in) :: place
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer(int64) :: entries
        integer :: longest

        associate (body => gpu%bodies(b))
            call search(gpu, b, place, 0, err)
            call arguments%add(body%slices)
            call arguments%add(body%first)
            call arguments%add(body%last)
            call arguments%add(gpu%count)
            call arguments%add(body%slice)
            call launch(gpu%widths, [body%slices, 1, 1], arguments, err)
            call running_sum(gpu%scan, body%slice, body%slices, err, longest)
            entries = int(longest, int64)*slice_width
            if (entries > body%room .or. body%room == 0) then
                call free_buffer(body%list)
                body%room = entries + entries/8 + slice_width
                call allocate_buffer(body%list, 4*body%room, err)
            end if
            call search(gpu, b, place, 1, err)
        end associate
    end subroutine list_body

    !> Look for the neighbours of body b: keep 0 counts them, 1 lists them.
    subroutine search(gpu, b, place, keep, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: b, keep
        class(buffer_t), intent(in) :: place
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        associate (body => gpu%bodies(b))
            call arguments%add(keep)
            call arguments%add(gpu%grid)
            call arguments%add(gpu%code)
            call arguments%add(gpu%start)
            call arguments%add(gpu%order)
            call arguments%add(place)
            call arguments%add(body%slice)
            call arguments%add(gpu%count)
            call arguments%add(body%list)
            call launch(gpu%search, [body%last - body%first + 1, 1, 1], arguments, err)
        end associate
    end subroutine search
end module brz_gpu_solid_search
