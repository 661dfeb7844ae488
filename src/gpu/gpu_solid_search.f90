! SPDX-License-Identifier: MIT
!> Neighbour lists on the GPU: the same cells, order and lists as on the CPU.
module brz_gpu_solid_search
    use brz_cell_grid, only: cell_of_groups, choose_cells, reach_of_lists
    use brz_buffers, only: doubles_t
    use brz_device, only: allocate_buffer, arguments_t, buffer_t, clear_buffer, copy_in, copy_out, &
        free_buffer, kernel_t, launch
    use brz_errors, only: error_t, failed
    use brz_gpu_scan, only: running_sum
    use brz_gpu_solid_layout, only: at_hist, grid_gpu_t, n_tag, slice_width
    use brz_gpu_solid_state, only: bytes_of_real, gpu_solid_t, part_of, sum_threads
    use brz_kinds, only: dp, int64
    use brz_solid_state, only: n_pair, solid_t
    implicit none
    private
    public :: build_gpu_lists, order_body

contains

    !> Build the lists. With `sort` the particles are first brought into the order of the cells at
    !> their present positions; without, the lists of the positions `built` are restored.
    subroutine build_gpu_lists(gpu, solid, sort, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        logical, intent(in) :: sort
        type(error_t), intent(inout) :: err
        type(doubles_t) :: place
        integer :: b, cells

        if (sort) then
            call note_positions(gpu, err)
            do b = 1, size(gpu%bodies)
                call order_body(gpu, solid, b, gpu%built, cell_of_groups(solid, b), cells, err)
            end do
            call reorder(gpu, err)
            call note_positions(gpu, err)
        end if
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%rigid) cycle
            place = gpu%built
            if (gpu%bodies(b)%total) place = gpu%reference
            call order_body(gpu, solid, b, place, reach_of_lists(solid, b), cells, err)
            call list_body(gpu, b, place, err)
        end do
    end subroutine build_gpu_lists

    !> Positions that decide on the neighbours: total-Lagrangian bodies that meet no other keep the
    !> unloaded ones.
    subroutine note_positions(gpu, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(doubles_t) :: from
        integer(int64) :: start, n
        integer :: b

        do b = 1, size(gpu%bodies)
            start = 32_int64*(gpu%bodies(b)%first - 1)
            n = gpu%bodies(b)%last - gpu%bodies(b)%first + 1
            from = gpu%place
            if (gpu%bodies(b)%total .and. .not. gpu%linked) from = gpu%reference
            call copy_bytes(gpu, part_of(from, start), part_of(gpu%built, start), 32*n, err)
        end do
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
        type(arguments_t) :: arguments
        real(dp) :: part(sum_threads, 6), box(3, 2)
        integer :: n

        associate (body => gpu%bodies(b))
            n = body%last - body%first + 1
            call arguments%add(body%first)
            call arguments%add(body%last)
            call arguments%add(sum_threads)
            call arguments%add(place)
            call arguments%add(gpu%part)
            call launch(gpu%extent, [sum_threads, 1, 1], arguments, err)
            part = 0
            call copy_out(gpu%part, part, 8_int64*size(part), err)
            if (failed(err)) return
            grid%first = body%first
            grid%last = body%last
        end associate
        grid%reach = reach
        box(:, 1) = minval(part(:, 1:3), 1)
        box(:, 2) = maxval(part(:, 4:6), 1)
        call copy_in(box, gpu%box, 48_int64, err)
        call choose_cells(solid%search, box(:, 1), box(:, 2), n, reach)
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

    !> Bring all arrays of the particles into the order of `order`. Two arrays of positions change
    !> places with the buffer; the others go through `row` and come back.
    subroutine reorder(gpu, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: c, m

        call gather(gpu, gpu%gather_places, gpu%place, gpu%built, 1, err)
        call swap(gpu%place, gpu%built)
        call gather(gpu, gpu%gather_places, gpu%reference, gpu%built, 1, err)
        call swap(gpu%reference, gpu%built)
        call gather(gpu, gpu%gather_motion, gpu%motion, gpu%row, 1, err)
        call copy_bytes(gpu, gpu%row, gpu%motion, 4*bytes_of_real*gpu%n, err)
        do c = 0, gpu%n_state - 1, n_pair
            m = min(n_pair, gpu%n_state - c)
            associate (columns => part_of(gpu%state, c*bytes_of_real*gpu%n))
                call gather(gpu, gpu%gather_columns, columns, gpu%row, m, err)
                call copy_bytes(gpu, gpu%row, columns, m*bytes_of_real*gpu%n, err)
            end associate
        end do
        call gather(gpu, gpu%gather_tags, gpu%tag, gpu%row, n_tag, err)
        call copy_bytes(gpu, gpu%row, gpu%tag, 4_int64*n_tag*gpu%n, err)
    end subroutine reorder

    subroutine gather(gpu, kernel, from, to, columns, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(kernel_t), intent(in) :: kernel
        class(buffer_t), intent(in) :: from, to
        integer, intent(in) :: columns
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(gpu%n)
        call arguments%add(gpu%order)
        call arguments%add(from)
        call arguments%add(to)
        call launch(kernel, [gpu%n, columns, 1], arguments, err)
    end subroutine gather

    pure subroutine swap(a, b)
        type(doubles_t), intent(inout) :: a, b
        type(doubles_t) :: c

        c = a
        a = b
        b = c
    end subroutine swap

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
