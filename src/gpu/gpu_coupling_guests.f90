! SPDX-License-Identifier: MIT
!> Windows of the air, and guests on their way there, between GPUs: see brz_gpu_guest_steps.
module brz_gpu_coupling_guests
    use brz_air_state, only: air_t
    use brz_boxes, only: cells_t
    use brz_buffers, only: reals_t
    use brz_cell_lists, only: list_cells
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, copy_in, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_fetch, only: fetch_t
    use brz_gpu_coupling_state, only: gpu_coupling_t, seen_t
    use brz_gpu_lists, only: put_list
    use brz_gpu_parcels, only: rows_of, gpu_rows_t
    use brz_guest_items, only: always_near, block_at, blocks_of
    use brz_guest_launches, only: guest_kernels
    use brz_kinds, only: int64, int8
    use brz_places, only: parcels_t
    use brz_record_rules, only: w => words_of_real
    use brz_solid_part, only: solid_part_t
    implicit none
    private
    public :: open_gpu_windows, mark_blocks, find_runs, send_guests

    integer, parameter :: most_runs = 4 !! bodies whose particles are copied one by one
    integer, parameter :: n_known = 7 !! arrays of a guest
    integer, parameter :: n_moving = 4 !! those of them that change in a step

contains

    !> Get ready to speak with the other processes, whose windows the host knows.
    subroutine open_gpu_windows(air, coupling, gpu, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer, parameter :: most = 6 + 10*w + 2 !! words of a guest
        integer :: none(0:air%part%ranks%n)
        type(cells_t) :: held

        none = 1
        held = cells_t(air%before + 1 - air%g, air%before + air%n + air%g)
        associate (part => gpu%part, ranks => air%part%ranks)
            part%boxes = coupling%part%boxes
            part%windows = coupling%part%windows
            part%near = coupling%part%near
            gpu%crowd = coupling%crowd
            allocate (gpu%guests%bodies(size(gpu%crowd%bodies)))
            call part%window%open(ranks, air%part%window, held, air%n_var, err)
            if (.not. any(gpu%box%wraps)) call map_blocks(gpu, air%part%window, held, err)
            call part%parcels%open(ranks, solid_part_t(out=parcels_t([integer ::], none), &
                                   in=parcels_t([integer ::], none)), max(most, 1 + 6*w), err)
        end associate
    end subroutine open_gpu_windows

    !> Of the window what lies around walls is fetched, and three layers around the box for gauges:
    !> say in which block of the map that mark_blocks keeps each cell is.
    subroutine map_blocks(gpu, plan, held, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(fetch_t), intent(in) :: plan
        type(cells_t), intent(in) :: held !! cells of the arrays of the air
        type(error_t), intent(inout) :: err

        associate (window => gpu%part%window, n => gpu%crowd%ranks%n)
            call reserve_buffer(window%near, int(always_near + n*blocks_of(gpu%box), int64), err)
            call clear_buffer(window%near, err)
            call put_list(blocks(list_cells(n, plan%out, held), .true.), window%out_block, err)
            call put_list(blocks(list_cells(n, plan%in, held), .false.), window%in_block, err)
        end associate

    contains

        !> Blocks of listed cells, process by process.
        function blocks(list, goes) result(block)
            type(parcels_t), intent(in) :: list !! in the arrays
            logical, intent(in) :: goes !! to the process
            integer :: at, block(size(list%place)), cell(3), r, t
            type(cells_t) :: box

            associate (n => held%hi - held%lo + 1)
                do r = 0, ubound(list%first, 1) - 1
                    box = gpu%part%boxes(merge(r, gpu%crowd%ranks%rank, goes))
                    do t = list%first(r), list%first(r + 1) - 1
                        at = list%place(t) - 1
                        cell = held%lo + [mod(at, n(1)), mod(at/n(1), n(2)), at/n(1)/n(2)]
                        block(t) = block_at(gpu%box, r + 1, cell - gpu%box%before)
                        if (all(cell >= box%lo - 3 .and. cell <= box%hi + 3)) &
                            block(t) = always_near
                    end do
                end do
            end associate
        end function blocks
    end subroutine map_blocks

    !> Mark where gas is fetched: around the solid cells that both processes see.
    subroutine mark_blocks(gpu, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err

        associate (part => gpu%part, near => gpu%part%window%near)
            if (any(gpu%box%wraps)) return
            call clear_buffer(near, err)
            call copy_in([1_int8], near, 1_int64, err) ! always_near
            if (gpu%wall%n_cells > 0) call guest_kernels%mark_around(gpu%wall%n_cells, &
                size(part%windows), part%windows_at, gpu%box, gpu%cell, near, err)
        end associate
    end subroutine mark_blocks

    !> Where the particles lie that a process has for itself, if these are all of a few bodies.
    subroutine find_runs(p, out, in, gpu, err)
        type(seen_t), intent(in) :: p
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes) that go, and come
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(in) :: err
        integer :: me, n(size(out, 1)), whole(size(out, 1)), from(size(out, 1)), to(size(out, 1))

        if (failed(err)) return
        me = gpu%crowd%ranks%rank + 1
        n = int(out(:, me))
        whole = p%bodies%last - p%bodies%first + 1
        associate (part => gpu%part)
            if (allocated(part%out%run)) deallocate (part%out%run, part%in%run)
            if (count(n > 0) > most_runs .or. any(n > 0 .and. n < whole)) return
            from = p%bodies%first
            to = gpu%guests%bodies%first + int(sum(in(:, :me - 1), 2))
            part%out%run = listed(from)
            part%in%run = listed(to)
        end associate

    contains

        !> Runs of bodies from these places.
        pure function listed(first) result(run)
            integer, intent(in) :: first(:)
            integer, allocatable :: run(:, :)

            run = transpose(reshape([pack(first, n > 0), pack(n, n > 0)], [count(n > 0), 2]))
        end function listed
    end subroutine find_runs

    !> Send what the copies have of their particles.
    subroutine send_guests(p, gpu, all_of_it, err)
        type(seen_t), intent(in) :: p
        type(gpu_coupling_t), intent(inout) :: gpu
        logical, intent(in) :: all_of_it !! else what changes in a step
        type(error_t), intent(inout) :: err
        type(gpu_rows_t) :: from(n_known), to(n_known)
        integer :: n

        n = merge(n_known, n_moving, all_of_it)
        from = rows_of_seen(p, rows_of(p%v_before, w, 3, p%step_d))
        to = rows_of_seen(gpu%guests, rows_of(gpu%guests%v_before, 3*w))
        call gpu%part%parcels%send(gpu%part%out, gpu%part%in, from(:n), to(:n), err)
    end subroutine send_guests

    !> What of a particle its copies have.
    pure function rows_of_seen(p, v_before) result(rows)
        type(seen_t), intent(in) :: p
        type(gpu_rows_t), intent(in) :: v_before
        type(gpu_rows_t) :: rows(n_known)

        rows = [rows_of(p%x, 6, pitch=2*p%wide), rows_of(p%v, 3*w, pitch=p%wide*w), &
                rows_of(p%load, w, 3, p%step_d), rows_of(p%fixed, 1), v_before, &
                rows_of(p%mass, w), rows_of(p%id, 1)]
    end function rows_of_seen
end module brz_gpu_coupling_guests
