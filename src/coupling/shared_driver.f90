! SPDX-License-Identifier: MIT
!> What several processes tell each other about the walls: the impulses of wall faces, and deferred
!> sources.
module brz_shared_driver
    use brz_boxes, only: asks_of, cells_t, common, widened
    use brz_coupling_box, only: box_t
    use brz_coupling_state, only: coupling_t
    use brz_coupling_windows, only: mark_blocks
    use brz_deferred_source_driver, only: enter_deferred_sources, keep_own, size_deferred_sources, &
        size_next
    use brz_errors, only: error_t
    use brz_coupling_ghost_loops, only: for_each_mark_cells, for_each_renumber
    use brz_kinds, only: int32, int64
    use brz_lists, only: put_list
    use brz_message_exchange, only: tell_all
    use brz_places, only: find_firsts, marks_t, message_buffers_t
    use brz_record_rules, only: words_of_real
    use brz_rows, only: rows_of, rows_t
    use brz_send_lists, only: count_marks, list_marks, place_pieces, reserve_marks
    implicit none
    private
    public :: put_halos, list_shared_faces, share_impulses, share_deferred_sources

contains

    !> What loop bodies are told of the halos of all processes, of their boxes, and of halos with a
    !> layer around.
    subroutine put_halos(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call put_list(c%on_gpu, asks_of(c%part%halos), c%part%halos_at, err)
        call put_list(c%on_gpu, asks_of(c%part%boxes), c%part%boxes_at, err)
        call put_list(c%on_gpu, asks_of(c%part%near), c%part%near_at, err)
    end subroutine put_halos

    !> List the faces whose gas is in the box of one process and whose columns may reach into that
    !> of another, in the order of the grid: so both list the same.
    subroutine list_shared_faces(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        type(cells_t) :: near(0:c%ranks%n - 1) !! boxes and what loads them
        integer :: r

        if (c%on_gpu) call mark_blocks(c, err)
        do r = 0, ubound(near, 1)
            near(r) = widened(c%part%boxes(r), spread(c%box%layers + 2, 1, 3))
        end do
        associate (part => c%part, me => c%ranks%rank, n => c%wall%n_faces)
            call list_cells(c, n, c%gas, common(part%boxes(me), near), part%marks, part%faces_out, &
                            err)
            call list_cells(c, n, c%gas, common(part%boxes, near(me)), part%marks, part%faces_in, &
                            err)
        end associate
    end subroutine list_shared_faces

    !> List what of n cells lies in boxes for all processes but this one.
    subroutine list_cells(c, n, cell, boxes, marks, list, err)
        type(coupling_t), intent(in) :: c
        integer, intent(in) :: n
        integer(int32), intent(in) :: cell(:) !! (n) numbers of cells in the halo
        type(cells_t), intent(in) :: boxes(0:) !! (processes) cells of the grid
        type(marks_t), intent(inout) :: marks
        type(message_buffers_t), intent(inout) :: list
        type(error_t), intent(inout) :: err
        type(cells_t) :: asked(0:ubound(boxes, 1))
        integer(int64) :: number(1, size(boxes))

        asked = boxes
        asked(c%ranks%rank) = cells_t()
        call put_list(c%on_gpu, asks_of(asked), marks%asks, err)
        call reserve_marks(c%on_gpu, n, size(boxes), marks, err)
        call for_each_mark_cells(c%on_gpu, n, n, size(boxes), marks%asks, c%box, cell, marks%mark, &
                                 err)
        call count_marks(c%on_gpu, n, [1], marks, number, err)
        call list_marks(c%on_gpu, n, number, marks, list, err)
    end subroutine list_cells

    !> Give every process the impulses of the faces whose columns may reach into its box.
    subroutine share_impulses(c, err)
        type(coupling_t), intent(inout), target :: c
        type(error_t), intent(inout) :: err
        type(rows_t) :: impulses(1)

        impulses = [rows_of(c%on_gpu, c%wall%impulse, words_of_real)]
        call c%part%messages%announce(c%part%faces_out, err)
        call c%part%messages%send(c%part%faces_out, c%part%faces_in, impulses, impulses, err)
    end subroutine share_impulses

    !> Renew the deferred sources of other processes that this one sees.
    subroutine share_deferred_sources(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer(int64) :: out(1, c%ranks%n), all(1, c%ranks%n, c%ranks%n)

        call keep_own(c, err)
        associate (part => c%part, n => c%ranks%n)
            out = 0
            call find_firsts(out, part%deferred_out%first)
            if (c%n_deferred > 0) call list_cells(c, c%n_deferred, c%deferred_cell, part%halos, &
                part%marks, part%deferred_out, err)
            out(1, :) = part%deferred_out%first(1:) - part%deferred_out%first(:n - 1)
            call tell_all(c%ranks, out, all)
        end associate
        if (sum(all) > 0) call swap_deferred_sources(c, all(1, :, :), err)
        call enter_deferred_sources(c, err)
    end subroutine share_deferred_sources

    !> Send the listed deferred sources, and put those of others behind those of this process. On
    !> the way their cells have the numbers of the grid.
    subroutine swap_deferred_sources(c, all, err)
        type(coupling_t), intent(inout), target :: c
        integer(int64), intent(in) :: all(:, :) !! (to processes, from processes) deferred sources
        type(error_t), intent(inout) :: err
        integer(int64) :: in(1, size(all, 1))
        type(box_t) :: grid
        type(rows_t) :: rows(2)
        integer :: first, more, next(1)

        grid = c%box
        grid%before = 0
        grid%n = grid%whole
        in(1, :) = all(c%ranks%rank + 1, :)
        more = int(sum(in))
        call size_deferred_sources(c, c%n_deferred + more, err)
        call size_next(c, c%n_deferred + more, err)
        call for_each_renumber(c%on_gpu, c%n_deferred, c%box, grid, c%deferred_cell, c%next_cell, &
            err)
        next = c%n_deferred
        call place_pieces(c%on_gpu, in, next, c%part%marks, c%part%deferred_in, err)
        rows = [rows_of(c%on_gpu, c%next_cell, 1), &
                rows_of(c%on_gpu, c%deferred, c%n_var*words_of_real)]
        call c%part%messages%aim(all, c%part%deferred_out, err)
        call c%part%messages%send(c%part%deferred_out, c%part%deferred_in, rows, rows, err)
        first = c%n_deferred + 1
        if (more > 0) call for_each_renumber(c%on_gpu, more, grid, c%box, c%next_cell(first:), &
            c%deferred_cell(first:), err)
        c%n_deferred = c%n_deferred + more
    end subroutine swap_deferred_sources
end module brz_shared_driver
