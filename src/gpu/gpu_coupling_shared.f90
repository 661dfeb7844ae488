! SPDX-License-Identifier: MIT
!> What several processes tell each other about the walls on their GPUs, as brz_coupling_shared has
!> it: the impulses of wall faces, and debts.
module brz_gpu_coupling_shared
    use brz_boxes, only: cells_t => box_t, common, widened
    use brz_buffers, only: from, integers_t
    use brz_coupling_box, only: box_t
    use brz_device, only: clear_buffer, copy_in
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real
    use brz_gpu_coupling_state, only: gpu_coupling_t
    use brz_gpu_debt_steps, only: enter_debts, keep_own, size_debts
    use brz_gpu_lists, only: at_least
    use brz_gpu_marks, only: asks_of, count_marks, list_marks, place_pieces, reserve_marks
    use brz_gpu_parcels, only: gpu_places_t, put_places, rows_of, rows_t
    use brz_guest_launches, only: guest_kernels
    use brz_kinds, only: int64, int8
    use brz_mail, only: tell_all
    use brz_solid_part, only: find_firsts
    implicit none
    private
    public :: list_gpu_faces, share_impulses, share_debts

    integer, parameter :: w = int(bytes_of_real/4) !! words of a real number

contains

    !> List the faces whose gas is in the box of one process and whose columns may reach into that
    !> of another, in the order of the grid.
    subroutine list_gpu_faces(gpu, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(cells_t) :: near(0:ubound(gpu%part%boxes, 1)) !! boxes and what loads them
        integer :: r
        integer(int64) :: number(1, size(near))

        call mark_blocks(gpu, err)
        do r = 0, ubound(near, 1)
            near(r) = widened(gpu%part%boxes(r), spread(gpu%box%layers + 2, 1, 3))
        end do
        associate (part => gpu%part, me => gpu%crowd%ranks%rank, n => gpu%wall%n_faces)
            call list_cells(gpu, n, gpu%gas, common(part%boxes(me), near), number, &
                            part%faces_out, err)
            call list_cells(gpu, n, gpu%gas, common(part%boxes, near(me)), number, part%faces_in, &
                            err)
        end associate
    end subroutine list_gpu_faces

    !> Mark where gas is fetched: around the solid cells that both processes see.
    subroutine mark_blocks(gpu, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err

        associate (part => gpu%part, near => gpu%part%window%near)
            if (near%address == 0) return
            call clear_buffer(near, err)
            call copy_in([1_int8], near, 1_int64, err) ! always_near
            if (gpu%wall%n_cells > 0) call guest_kernels%mark_around(gpu%wall%n_cells, &
                size(part%windows), part%asks_at, gpu%box, gpu%cell, near, err)
        end associate
    end subroutine mark_blocks

    !> List what of n cells lies in boxes for all processes but this one.
    subroutine list_cells(gpu, n, cell, boxes, number, list, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer, intent(in) :: n
        type(integers_t), intent(in) :: cell !! (n) numbers of cells in the window
        type(cells_t), intent(in) :: boxes(0:) !! (processes) cells of the grid
        integer(int64), intent(out) :: number(:, :) !! (1, processes)
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err
        type(cells_t) :: asked(0:ubound(boxes, 1))

        associate (part => gpu%part, marks => gpu%part%marks)
            asked = boxes
            asked(gpu%crowd%ranks%rank) = cells_t()
            call put_places(asks_of(asked), part%marks%asks, err)
            call reserve_marks(n, size(boxes), marks, err)
            call guest_kernels%mark_cells(n, n, size(boxes), part%marks%asks, gpu%box, cell, &
                                         marks%mark, err)
            call count_marks(n, [1], gpu%common, marks, number, err)
            call list_marks(n, number, marks, list, err)
        end associate
    end subroutine list_cells

    !> Give every process the impulses of the faces whose columns may reach into its box.
    subroutine share_impulses(gpu, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64), dimension(1, size(gpu%part%boxes)) :: out
        integer(int64) :: all(1, size(out), size(out))

        associate (part => gpu%part, impulse => rows_of(gpu%wall%impulse, w))
            out(1, :) = part%faces_out%first(1:) - part%faces_out%first(:size(out) - 1)
            call tell_all(gpu%crowd%ranks, out, all)
            call part%parcels%aim(all(1, :, :), part%faces_out, err)
            call part%parcels%send(part%faces_out, part%faces_in, [impulse], [impulse], err)
        end associate
    end subroutine share_impulses

    !> Renew the debts of other processes that this one sees.
    subroutine share_debts(gpu, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64) :: out(1, size(gpu%part%boxes)), all(1, size(out), size(out))
        integer :: n

        associate (part => gpu%part, ranks => gpu%crowd%ranks)
            call keep_own(gpu, err)
            n = gpu%n_debts
            out = 0
            call find_firsts(out, part%debts_out%first)
            if (n > 0) call list_cells(gpu, n, gpu%debt_cell, part%windows, out, part%debts_out, &
                                       err)
            call tell_all(ranks, out, all)
            if (sum(all) > 0) call swap_debts(gpu, n, all(1, :, :), err)
            if (gpu%n_debts > 0) call enter_debts(gpu, err)
        end associate
    end subroutine share_debts

    !> Send the listed ones of n debts, and put those of others behind them.
    subroutine swap_debts(gpu, n, all, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer, intent(in) :: n
        integer(int64), intent(in) :: all(:, :) !! (to processes, from processes)
        type(error_t), intent(inout) :: err
        integer(int64) :: in(1, size(all, 1))
        type(box_t) :: grid
        type(rows_t) :: rows(2)
        integer :: more, next(1)

        grid = gpu%box
        grid%before = 0
        grid%n = grid%whole
        associate (part => gpu%part)
            call part%parcels%aim(all, part%debts_out, err)
            in(1, :) = all(gpu%crowd%ranks%rank + 1, :)
            more = int(sum(in))
            call size_debts(gpu, n + more, err)
            call at_least(gpu%next_cell, n + more, err)
            call at_least(gpu%next_debt, gpu%n_var, n + more, err) ! the two have the same room
            if (n > 0) call guest_kernels%renumber(n, gpu%box, grid, gpu%debt_cell, gpu%next_cell, &
                                                  err)
            next = n
            call place_pieces(in, next, part%marks%pieces, part%debts_in, err)
            rows = [rows_of(gpu%next_cell, 1), rows_of(gpu%debt, gpu%n_var*w)]
            call part%parcels%send(part%debts_out, part%debts_in, rows, rows, err)
            if (more > 0) call guest_kernels%renumber(more, grid, gpu%box, &
                from(gpu%next_cell, n + 1_int64), from(gpu%debt_cell, n + 1_int64), err)
            gpu%n_debts = n + more
        end associate
    end subroutine swap_debts
end module brz_gpu_coupling_shared
