! SPDX-License-Identifier: MIT
!> Neighbour lists on the GPU: the same cells, order and lists as on the CPU.
module brz_gpu_solid_search
    use brz_cell_grid, only: cell_of_groups, choose_cells, reach_of_lists, take_cells
    use brz_buffers, only: doubles_t, from, integers_t
    use brz_common_launches, only: common_kernels
    use brz_device, only: clear_buffer, copy_in, copy_out, copy_within, reserve_buffer
    use brz_drift_launches, only: drift_kernels
    use brz_errors, only: error_t, failed
    use brz_drift_loop_bodies, only: drift_of
    use brz_formulation_names, only: form_total
    use brz_ghost_wants, only: most_outside
    use brz_lists, only: put_changed => put_changed_table
    use brz_gpu_message_buffers, only: carry_rows
    use brz_rows, only: rows_of => rows_of_copy, rows_t
    use brz_gpu_solid_owner, only: put_region
    use brz_gpu_solid_layout, only: grid_gpu_t
    use brz_gpu_solid_lists, only: lay_lists, move_lists, pick_chosen
    use brz_gpu_solid_state, only: threads_of
    use brz_gpu_solid_tiles, only: adders_of
    use brz_solid_device, only: solid_device_t, news_all, news_part
    use brz_gpu_solid_diagnostics, only: boxes_of_all, find_extents, forget_gone
    use brz_owner_launches, only: owner_kernels
    use brz_kept_cells, only: kept_cells_t
    use brz_kinds, only: dp, int64, rk
    use brz_list_drift, only: level_unit
    use brz_pair_layout, only: n_pair
    use brz_ranks, only: several, sum_of_all
    use brz_solid_launches, only: solid_kernels
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_part, only: solid_part_t
    implicit none
    private
    public :: build_list, choose_lists, mean_velocities, note_positions, renew_places, sort_bodies

    integer, parameter :: spare_entries = 8 !! of each list, where lists are built anew in part

contains

    !> The list of body b, of its particles and ghosts as they lie; in part where only few places
    !> are new, unless these lists no longer have room. Links are looked for in the cells of lists;
    !> bodies whose lists are not those of `built` have cells for links alone.
    subroutine build_list(gpu, solid, b, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        type(doubles_t) :: place
        logical :: fits

        associate (body => gpu%bodies(b), cells => solid%bodies(b)%cells)
            body%news = merge(news_part, news_all, cells%in_part)
            place = gpu%built
            if (body%total) place = gpu%reference
            if (.not. body%rigid) then
                call order_body(gpu, solid, b, place, reach_of_lists(solid, b), err, cells)
                fits = .false.
                if (cells%in_part) call list_part(gpu, b, place, fits, err)
                if (.not. fits) call list_body(gpu, b, place, err)
            end if
            if (gpu%linked .and. (body%rigid .or. body%total)) call order_body(gpu, solid, b, &
                gpu%built, 2*real(solid%bodies(b)%h, dp) + solid%skin, err)
        end associate
    end subroutine build_list

    !> Bring the particles of some bodies, which have no ghosts, into the order of the cells at
    !> their positions `built`; bodies side by side go together.
    subroutine sort_bodies(gpu, solid, which, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: b, first

        do b = 1, size(which)
            if (.not. which(b)) cycle
            call fill_cells(gpu, solid, b, gpu%built, cell_of_groups(solid, b), 0, err)
        end do
        if (failed(err)) return
        first = 0
        do b = 1, size(which)
            if (.not. which(b)) cycle
            if (first == 0) first = gpu%bodies(b)%first
            gpu%bodies(b)%packed = .false.
            if (b < size(which)) then
                if (which(b + 1) .and. gpu%bodies(b + 1)%first == gpu%bodies(b)%last + 1) cycle
            end if
            call reorder(gpu, first, gpu%bodies(b)%last, err)
            first = 0
        end do
    end subroutine sort_bodies

    !> Give new places to the particles of body b that have moved far, mark the cells of the old and
    !> the new ones, and count them; then 1 if any are outside the region of their process, and by
    !> more than they may.
    subroutine renew_places(gpu, solid, part, b, moved, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        type(solid_part_t), intent(in) :: part
        integer, intent(in) :: b
        integer(int64), intent(out) :: moved(3) !! particles of this process
        type(error_t), intent(inout) :: err
        integer :: found(4)

        moved = 0
        call unmark_cells(gpu, solid, b, err)
        if (failed(err)) return
        call renew(gpu%bodies(b)%last + 1, gpu%bodies(b)%rim, 2)
        call renew(gpu%bodies(b)%first, gpu%bodies(b)%last, 1)
        found = 0
        associate (body => gpu%bodies(b), n => size(solid%search%start))
            if (part%keeps) then
                call put_region(gpu, part%region, err)
                call owner_kernels%note_outside(body%last - body%first + 1, body%first, 4, &
                    solid%ranks%rank, most_outside(solid), gpu%region_at, gpu%built, &
                    from(body%marked, n + 3_int64), err)
            end if
            call copy_out(from(body%marked, n + 1_int64), found, 16_int64, err)
        end associate
        moved = found([1, 3, 4])

    contains

        !> Those of the body, or its ghosts, whose places are those of their own process.
        subroutine renew(first, last, counter)
            integer, intent(in) :: first, last, counter

            associate (body => gpu%bodies(b), drift => solid%bodies(b)%drift, s => solid%search)
                if (last >= first) call drift_kernels%renew_place(last - first + 1, first, 4, &
                    level_unit(solid), drift(1), drift(2), drift(3), size(s%code, 1), s%cells(1), &
                    s%cells(2), s%cells(3), s%lo(1), s%lo(2), s%lo(3), s%size, body%code, &
                    gpu%fixed, gpu%x, gpu%built, body%marked, &
                    from(body%marked, size(s%start) + int(counter, int64)), err)
            end associate
        end subroutine renew
    end subroutine renew_places

    !> Lay the cells of the list of body b, none of which is marked. Four counts follow.
    subroutine unmark_cells(gpu, solid, b, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err

        call lay_cells(gpu, solid, b, gpu%built, reach_of_lists(solid, b), err, &
                       solid%bodies(b)%cells)
        if (failed(err)) return
        call reserve_buffer(gpu%bodies(b)%marked, 4_int64*size(solid%search%start) + 16, err)
        call clear_buffer(gpu%bodies(b)%marked, err)
    end subroutine unmark_cells

    !> Choose the particles of body b that are within reach of a marked cell, or of that of a ghost
    !> that is new.
    subroutine choose_lists(gpu, solid, b, news, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        integer, intent(in) :: news !! the last of its ghosts that are new
        type(error_t), intent(inout) :: err

        associate (body => gpu%bodies(b), in_part => solid%bodies(b)%cells%in_part)
            if (body%rigid) return
            if (.not. in_part) call unmark_cells(gpu, solid, b, err) ! ghosts alone are new
            in_part = .true.
            body%spare = spare_entries
            if (news > 0) call solid_kernels%mark_cells([news, 1, 1], body%rim - news + 1, &
                body%rim, body%grid, body%code, gpu%built, body%marked, err)
            call solid_kernels%choose_near(threads_of(body), body%last, body%grid, body%code, &
                                           body%marked, body%below, gpu%built, gpu%chosen, err)
        end associate
    end subroutine choose_lists

    !> Mean velocities of the mass of some bodies at the step.
    subroutine mean_velocities(gpu, solid, which, v, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(in) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        real(dp), intent(out) :: v(:, :) !! (3, bodies), of others 0 [m/s]
        type(error_t), intent(inout) :: err
        real(dp) :: lattice, per_mass(size(which)), total(4, size(which))
        integer(int64) :: numbers(4*size(which))
        type(integers_t) :: tiles
        integer :: b, threads(3)

        do b = 1, size(which)
            associate (body => solid%bodies(b))
                lattice = solid%materials(body%material)%density &
                    *body%spacing**solid%dimension*solid%depth
                per_mass(b) = 1/lattice
            end associate
        end do
        call gpu%common%ask(per_mass, 8_int64*size(which), 8_int64, err)
        call adders_of(gpu, 1, size(which), tiles, threads)
        if (threads(1) > 0) call solid_kernels%solid_mean_drift(threads, gpu%stride_d, tiles, &
            gpu%adders%sets, real(solid%dt_last/2, rk), doubles_t(gpu%common%asked), gpu%mass, &
            gpu%motion, gpu%a, gpu%adders%part, err)
        call gpu%common%fold_sets(gpu%adders%part, gpu%adders%sets, 1, size(which), 4, err)
        call gpu%common%read_sums(1, total, err)
        do b = 1, size(which)
            if (.not. which(b)) total(:, b) = 0
        end do
        numbers = nint(reshape(total, [size(total)]), int64) ! they are whole
        call sum_of_all(solid%ranks, numbers)
        do b = 1, size(which)
            v(:, b) = drift_of(real(numbers(4*b - 3:4*b), dp))
        end do
    end subroutine mean_velocities

    !> Positions that decide on the neighbours: total-Lagrangian bodies that meet no other keep the
    !> unloaded ones.
    subroutine note_positions(gpu, solid, b, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        type(error_t), intent(inout) :: err
        type(doubles_t) :: places

        places = gpu%place
        if (solid%bodies(b)%formulation == form_total .and. .not. gpu%linked) &
            places = gpu%reference
        associate (first => gpu%bodies(b)%first, last => gpu%bodies(b)%last)
            call copy_within(from(places, 4*first - 3_int64), from(gpu%built, 4*first - 3_int64), &
                             32_int64*(last - first + 1), err)
        end associate
    end subroutine note_positions

    !> Lay cells over body b for given places, or those that it has kept, and put its particles and
    !> ghosts into them, in `order`; those of a cell in the order of their numbers.
    subroutine order_body(gpu, solid, b, place, reach, err, kept)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(in) :: reach !! side of a cell [m]
        type(error_t), intent(inout) :: err
        type(kept_cells_t), intent(inout), optional :: kept

        call fill_cells(gpu, solid, b, place, reach, 1, err, kept)
        if (failed(err)) return
        call forget_gone(gpu, solid, b, err)
    end subroutine order_body

    !> The same by other cells; within a cell in the order of their places, or numbers. What has
    !> left the region is put behind all cells, into as many as these, by its numbers.
    subroutine fill_cells(gpu, solid, b, place, reach, by_number, err, kept)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(in) :: reach !! side of a cell [m]
        integer, intent(in) :: by_number !! 0: in the order of places
        type(error_t), intent(inout) :: err
        type(kept_cells_t), intent(inout), optional :: kept
        type(integers_t) :: binned
        integer :: cells, end(1), real_cells, threads(3)
        logical :: laid

        laid = .false. ! by unmark_cells, but that ghosts may have come since
        if (present(kept)) laid = kept%in_part .and. .not. several(solid%ranks)
        if (.not. laid) call lay_cells(gpu, solid, b, place, reach, err, kept)
        if (failed(err)) return
        real_cells = ubound(solid%search%start, 1)
        cells = merge(2, 1, solid%remove)*real_cells
        associate (body => gpu%bodies(b), number => solid%bodies(b)%number)
            binned = from(gpu%picked, int(body%first, int64)) ! which is free here
            call reserve_buffer(body%start, 4_int64*(cells + 2), err)
            call clear_buffer(body%start, err, 4_int64*(cells + 1))
            call reserve_buffer(body%below, 24_int64, err)
            call clear_buffer(body%below, err)
            threads = [body%rim - body%first + 1, 1, 1]
            call solid_kernels%count_cells(threads, real_cells, number(1), number(2), body%grid, &
                body%code, place, gpu%fixed, gpu%id, gpu%cell, body%start, body%below, err)
            call gpu%common%running_sum(body%start, cells, err)
            ! here a cell stands one place further behind its end than a bin does
            call common_kernels%bin_fill(threads, threads(1), body%first - 1, &
                from(gpu%cell, int(body%first, int64)), from(gpu%bodies(b)%start, 0_int64), &
                binned, err)
            call solid_kernels%order_cells(threads, body%grid, by_number, gpu%cell, body%start, &
                gpu%id, place, binned, gpu%order, gpu%sorted, err)
            if (.not. solid%remove) return
            end = 0
            if (body%rim == body%last) then ! else as they were before there were ghosts
                call copy_out(from(body%start, int(real_cells, int64)), end, 4_int64, err)
                body%gone = threads(1) - end(1)
            end if
            call put_changed([body%first, body%last - body%gone], body%ends_there, body%params, err)
        end associate
    end subroutine fill_cells

    !> Choose the cells for body b, those of all processes, or take those that it has kept, and hand
    !> them to the GPU.
    subroutine lay_cells(gpu, solid, b, place, reach, err, kept)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        real(dp), intent(in) :: reach !! [m]
        type(error_t), intent(inout) :: err
        type(kept_cells_t), intent(inout), optional :: kept !! chosen if there are none yet
        type(grid_gpu_t) :: grid
        real(dp) :: box(3, 2, 1)
        logical :: has_cells

        has_cells = .false.
        if (present(kept)) has_cells = all(kept%along > 0)
        if (has_cells) then
            call take_cells(solid%search, kept, reach)
        else
            box(:, :, 1) = gpu%bodies(b)%box
            if (place%address /= gpu%built%address) then
                call find_extents(gpu, b, b, place, err)
                call boxes_of_all(gpu, solid, b, box, err)
            end if
            if (failed(err)) return
            associate (number => solid%bodies(b)%number)
                call choose_cells(solid%search, box(:, 1, 1), box(:, 2, 1), &
                                  number(2) - number(1) + 1, reach)
            end associate
            if (present(kept)) then
                kept%along = solid%search%cells
                kept%lo = solid%search%lo
            end if
        end if
        grid%first = gpu%bodies(b)%first
        grid%last = gpu%bodies(b)%rim
        grid%reach = reach
        grid%cells = solid%search%cells
        grid%stride = size(solid%search%code, 1)
        grid%mirror = merge(1, 0, solid%mirror)
        grid%lo = solid%search%lo
        grid%size = solid%search%size
        associate (body => gpu%bodies(b))
            call put_changed(transfer(grid, [0]), body%grid_there, body%grid, err)
            if (allocated(body%code_there)) then
                if (all(body%code_there == [grid%cells, grid%stride])) return
            end if
            body%code_there = [grid%cells, grid%stride]
            call reserve_buffer(body%code, 12_int64*grid%stride, err)
            call copy_in(solid%search%code, body%code, 12_int64*grid%stride, err)
        end associate
    end subroutine lay_cells

    !> Bring all arrays of the particles first..last into the order of `order`, by way of `row`.
    subroutine reorder(gpu, first, last, err)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: first, last
        type(error_t), intent(inout) :: err
        type(rows_t) :: room, there
        integer :: c, k, n

        n = last - first + 1
        do k = 1, gpu%n_record
            do c = 1, gpu%record(k)%columns, n_pair
                there = gpu%record(k)
                there%columns = min(n_pair, there%columns - c + 1)
                there%of = from(there%of, (c - 1)*there%stride + 1)
                room = rows_of(gpu%row, there%words, there%columns, n)
                call carry_rows(n, there, from(gpu%order, int(first, int64)), room, &
                                gpu%seat, err)
                call carry_rows(n, room, gpu%seat, there, from(gpu%seat, int(first, int64)), err)
            end do
        end do
    end subroutine reorder

    !> The lists of body b, whose particles are in the cells.
    subroutine list_body(gpu, b, place, err)
        type(solid_device_t), intent(inout) :: gpu
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        type(error_t), intent(inout) :: err

        call search(gpu, b, place, 0, .false., err)
        associate (body => gpu%bodies(b))
            call lay_lists(body, gpu%common, gpu%count, body%spare, 8, 0, err)
            call reserve_buffer(body%pairs, body%list%bytes, err)
        end associate
        call search(gpu, b, place, 1, .false., err)
    end subroutine list_body

    !> The chosen lists. Lists that no longer have room go behind all others.
    subroutine list_part(gpu, b, place, fits, err)
        type(solid_device_t), intent(inout) :: gpu
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        logical, intent(out) :: fits !! else there is no room behind them, and no list is right
        type(error_t), intent(inout) :: err
        integer :: filled

        associate (body => gpu%bodies(b))
            fits = body%width%bytes > 0
            if (.not. fits) return
            call search(gpu, b, place, 2, .true., err)
            call clear_buffer(from(gpu%chosen, int(body%first, int64)), err, &
                              4_int64*(body%last - body%first + 1)) ! others have chosen, too
            filled = body%filled
            call move_lists(body, gpu%count, gpu%chosen, fits, err)
            if (fits .and. body%filled > filled) call search(gpu, b, place, 1, .true., err)
        end associate
    end subroutine list_part

    !> Look for the neighbours of body b: keep 0 counts them, 1 lists them, 2 those for which there
    !> is room; of all its particles, or of the chosen ones.
    subroutine search(gpu, b, place, keep, some, err)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: b
        type(doubles_t), intent(in) :: place
        integer, intent(in) :: keep
        logical, intent(in) :: some
        type(error_t), intent(inout) :: err

        if (some) call clear_buffer(gpu%found, err)
        if (some) call pick_chosen(gpu, b, err)
        associate (body => gpu%bodies(b))
            call solid_kernels%solid_search(threads_of(body), keep, merge(1, 0, some), &
                body%last - body%gone, body%grid, body%code, body%start, body%below, &
                gpu%sorted, place, from(gpu%found, int(b, int64)), &
                from(gpu%picked, int(body%first, int64)), &
                body%slice, body%width, gpu%count, body%list, err)
        end associate
    end subroutine search
end module brz_gpu_solid_search
