! SPDX-License-Identifier: MIT
!> Neighbour lists on the GPU: the same cells, order and lists as on the CPU.
module brz_gpu_solid_search
    use brz_cell_grid, only: cell_of_groups, choose_cells, reach_of_lists
    use brz_buffers, only: doubles_t, from
    use brz_common_launches, only: common_kernels
    use brz_device, only: buffer_t, clear_buffer, copy_in, copy_out, copy_within, reserve_buffer
    use brz_drift_launches, only: drift_kernels
    use brz_errors, only: error_t, failed
    use brz_drift_items, only: drift_of
    use brz_gpu_solid_layout, only: grid_gpu_t, n_tag, slice_width
    use brz_gpu_solid_state, only: column_of, gpu_solid_body_t, gpu_solid_t, sum_threads, &
        threads_of
    use brz_kinds, only: dp, int64, rk
    use brz_list_drift, only: begin_list
    use brz_ranks, only: least_of_all, sum_of_all
    use brz_solid_launches, only: solid_kernels
    use brz_solid_state, only: n_pair, solid_t
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: build_list, order_body, note_box, note_places, sort_body

contains

    !> The list of body b, of its particles and ghosts as they lie.
    subroutine build_list(gpu, solid, b, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        type(doubles_t) :: place

        if (gpu%bodies(b)%rigid) return
        place = gpu%built
        if (gpu%bodies(b)%total) place = gpu%reference
        call order_body(gpu, solid, b, place, reach_of_lists(solid, b), err)
        call list_body(gpu, b, place, err)
    end subroutine build_list

    !> Bring the particles of body b, which has no ghosts, into the order of the cells at their
    !> positions `built`, which are those of now.
    subroutine sort_body(gpu, solid, b, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        integer :: cells

        call fill_cells(gpu, solid, b, gpu%built, cell_of_groups(solid, b), cells, err)
        call common_kernels%sort_cells([cells, 1, 1], cells, gpu%bodies(b)%first, 0, gpu%start, &
                                       gpu%id, gpu%order, err)
        if (failed(err)) return
        call reorder(gpu, gpu%bodies(b), err)
        call note_positions(gpu, gpu%bodies(b), err)
    end subroutine sort_body

    !> The list of body b is about to be built for the places of now.
    subroutine note_places(gpu, solid, b, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        real(dp) :: folded(tally_threads/256, 4), lattice, total(4)
        integer(int64) :: numbers(4)

        call note_positions(gpu, gpu%bodies(b), err)
        call clear_buffer(gpu%sums_of_forces, err)
        lattice = solid%materials(solid%bodies(b)%material)%density &
            *solid%bodies(b)%spacing**solid%dimension*solid%depth
        associate (body => gpu%bodies(b))
            call drift_kernels%sum_drift(body%last - body%first + 1, body%first, 4, gpu%n, &
                real(solid%dt_last/2, rk), 1/lattice, gpu%mass, gpu%motion, &
                gpu%a, gpu%sums_of_forces, err)
        end associate
        call gpu%common%fold(gpu%sums_of_forces, tally_threads, folded, err)
        total = sum(folded, 1)
        numbers = nint(total, int64) ! they are whole
        call sum_of_all(solid%ranks, numbers)
        call begin_list(solid, b, drift_of(real(numbers, dp)))
    end subroutine note_places

    !> Positions that decide on the neighbours: total-Lagrangian bodies that meet no other keep the
    !> unloaded ones.
    subroutine note_positions(gpu, body, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        type(doubles_t) :: places

        places = gpu%place
        if (body%total .and. .not. gpu%linked) places = gpu%reference
        call copy_within(from(places, 4*body%first - 3_int64), &
                         from(gpu%built, 4*body%first - 3_int64), &
                         32_int64*(body%last - body%first + 1), err)
    end subroutine note_positions

    !> Lay cells over body b for given places and put its particles and ghosts into them, in
    !> `order`; those of a cell in the order of their numbers.
    subroutine order_body(gpu, solid, b, place, reach, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(in) :: reach !! side of a cell [m]
        type(error_t), intent(inout) :: err
        integer :: cells

        call fill_cells(gpu, solid, b, place, reach, cells, err)
        if (failed(err)) return
        call common_kernels%sort_cells([cells, 1, 1], cells, gpu%bodies(b)%first, 1, gpu%start, &
                                       gpu%id, gpu%order, err)
    end subroutine order_body

    !> The same but for the order within a cell.
    subroutine fill_cells(gpu, solid, b, place, reach, cells, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(in) :: reach !! side of a cell [m]
        integer, intent(out) :: cells !! along the curve
        type(error_t), intent(inout) :: err
        integer :: threads(3)

        cells = 1
        call lay_cells(gpu, solid, b, place, reach, err)
        if (failed(err)) return
        cells = ubound(solid%search%start, 1)
        call clear_buffer(gpu%start, err, 4_int64*(cells + 1))
        associate (body => gpu%bodies(b))
            threads = [body%rim - body%first + 1, 1, 1]
            call solid_kernels%count_cells(threads, gpu%grid, gpu%code, place, gpu%cell, &
                                           gpu%start, err)
            call gpu%common%running_sum(gpu%start, cells, err)
            ! here a cell stands one place further behind its end than a bin does
            call common_kernels%bin_fill(threads, threads(1), body%first - 1, &
                from(gpu%cell, int(body%first, int64)), from(gpu%start, 0_int64), &
                from(gpu%order, int(body%first, int64)), err)
        end associate
    end subroutine fill_cells

    !> Choose the cells for body b, those of all processes, and hand them to the GPU.
    subroutine lay_cells(gpu, solid, b, place, reach, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(in) :: reach !! [m]
        type(error_t), intent(inout) :: err
        type(grid_gpu_t) :: grid
        real(dp) :: box(3, 2)

        call find_box(gpu, solid, b, place, box, err)
        if (failed(err)) return
        grid%first = gpu%bodies(b)%first
        grid%last = gpu%bodies(b)%rim
        grid%reach = reach
        call copy_in(box, gpu%box, 48_int64, err)
        associate (number => solid%bodies(b)%number)
            call choose_cells(solid%search, box(:, 1), box(:, 2), number(2) - number(1) + 1, reach)
        end associate
        grid%cells = solid%search%cells
        grid%stride = size(solid%search%code, 1)
        grid%mirror = merge(1, 0, solid%mirror)
        grid%lo = solid%search%lo
        grid%size = solid%search%size
        call copy_in(grid, gpu%grid, int(storage_size(grid)/8, int64), err)
        call reserve_buffer(gpu%code, 12_int64*grid%stride, err)
        call copy_in(solid%search%code, gpu%code, 4_int64*3*grid%stride, err)
    end subroutine lay_cells

    !> Corners of body b at its positions `built`.
    subroutine note_box(gpu, solid, b, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        call find_box(gpu, solid, b, gpu%built, gpu%bodies(b)%box, err)
    end subroutine note_box

    !> Corners of body b, of all processes, for given places.
    subroutine find_box(gpu, solid, b, place, box, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(out) :: box(3, 2) !! [m]
        type(error_t), intent(inout) :: err
        real(dp) :: part(sum_threads, 6), least(6)

        call solid_kernels%solid_extent([sum_threads, 1, 1], gpu%bodies(b)%first, &
                                      gpu%bodies(b)%last, sum_threads, place, gpu%part, err)
        part = 0
        call copy_out(gpu%part, part, 8_int64*size(part), err)
        least = [minval(part(:, 1:3), 1), -maxval(part(:, 4:6), 1)]
        call least_of_all(solid%ranks, least)
        box = reshape([least(:3), -least(4:)], [3, 2])
    end subroutine find_box

    !> Bring all arrays of the particles of a body into the order of `order`, by way of `row`.
    subroutine reorder(gpu, body, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        type(error_t), intent(inout) :: err
        integer, parameter :: words = storage_size(1.0_rk)/32 !! of 4 B
        integer :: c

        call gather(gpu, body, gpu%place, 8, 1, err)
        call gather(gpu, body, gpu%reference, 8, 1, err)
        call gather(gpu, body, gpu%motion, 4*words, 1, err)
        do c = 1, gpu%n_state, n_pair
            call gather(gpu, body, column_of(gpu, c), words, min(n_pair, gpu%n_state - c + 1), err)
        end do
        call gather(gpu, body, gpu%tag, 1, n_tag, err)
    end subroutine reorder

    !> To `row` in the new order, and back.
    subroutine gather(gpu, body, values, words, columns, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(gpu_solid_body_t), intent(in) :: body
        class(buffer_t), intent(in) :: values
        integer, intent(in) :: words, columns !! words of 4 B in a row
        type(error_t), intent(inout) :: err
        integer :: threads(3)
        integer(int64) :: stride

        threads = [body%last - body%first + 1, columns, 1]
        stride = int(words, int64)*gpu%n
        call solid_kernels%gather_words(threads, body%first, body%last, words, stride, 0, &
                                      gpu%order, values, gpu%row, err)
        call solid_kernels%gather_words(threads, body%first, body%last, words, stride, 1, &
                                      gpu%order, gpu%row, values, err)
    end subroutine gather

    !> The lists of body b, whose particles are in the cells.
    subroutine list_body(gpu, b, place, err)
        type(gpu_solid_t), intent(inout) :: gpu
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        type(error_t), intent(inout) :: err
        integer :: longest

        associate (body => gpu%bodies(b))
            call search(gpu, b, place, 0, err)
            call solid_kernels%slice_widths([body%slices, 1, 1], body%slices, body%first, &
                                          body%last, gpu%count, body%slice, err)
            call gpu%common%running_sum(body%slice, body%slices, err, longest)
            call reserve_buffer(body%list, 4_int64*slice_width*(longest + 1_int64), err)
            call search(gpu, b, place, 1, err)
        end associate
    end subroutine list_body

    !> Look for the neighbours of body b: keep 0 counts them, 1 lists them.
    subroutine search(gpu, b, place, keep, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: b, keep
        type(doubles_t), intent(in) :: place
        type(error_t), intent(inout) :: err

        associate (body => gpu%bodies(b))
            call solid_kernels%solid_search(threads_of(body), keep, body%last, gpu%grid, gpu%code, &
                                          gpu%start, gpu%order, place, body%slice, gpu%count, &
                                          body%list, err)
        end associate
    end subroutine search
end module brz_gpu_solid_search
