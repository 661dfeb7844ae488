! SPDX-License-Identifier: MIT
!> What several processes tell each other about the walls: the impulses of wall faces, and debts.
!> scripts/steps.py writes the same for the GPU.
module brz_shared_steps
    use brz_boxes, only: asks_of, cells_t, common, widened
    use brz_coupling_box, only: box_t
    use brz_coupling_state, only: coupling_t
    use brz_debt_steps, only: enter_debts, keep_own, size_debts, size_next
    !@gpu use brz_gpu_coupling_guests, only: mark_blocks
    use brz_guest_loops, only: each_mark_cells, each_renumber
    use brz_kinds, only: int32, int64
    use brz_lists, only: put_list
    use brz_mail, only: tell_all
    use brz_mark_steps, only: count_marks, list_marks, place_pieces, reserve_marks
    use brz_parcels, only: rows_of, rows_t
    use brz_places, only: find_firsts, marks_t, parcels_t
    use brz_record_rules, only: words_of_real
    implicit none
    private
    public :: put_windows, list_shared_faces, share_impulses, share_debts

contains

    !> What items are told of the windows of all processes, of their boxes, and of windows with a
    !> layer around.
    subroutine put_windows(c)
        type(coupling_t), intent(inout) :: c

        call put_list(asks_of(c%part%windows), c%part%windows_at)
        call put_list(asks_of(c%part%boxes), c%part%boxes_at)
        call put_list(asks_of(c%part%near), c%part%near_at)
    end subroutine put_windows

    !> List the faces whose gas is in the box of one process and whose columns may reach into that
    !> of another, in the order of the grid: so both list the same.
    subroutine list_shared_faces(c)
        type(coupling_t), intent(inout) :: c
        type(cells_t) :: near(0:c%ranks%n - 1) !! boxes and what loads them
        integer :: r

        !@gpu call mark_blocks(c)
        do r = 0, ubound(near, 1)
            near(r) = widened(c%part%boxes(r), spread(c%box%layers + 2, 1, 3))
        end do
        associate (part => c%part, me => c%ranks%rank, n => c%wall%n_faces)
            call list_cells(c, n, c%gas, common(part%boxes(me), near), part%marks, part%faces_out)
            call list_cells(c, n, c%gas, common(part%boxes, near(me)), part%marks, part%faces_in)
        end associate
    end subroutine list_shared_faces

    !> List what of n cells lies in boxes for all processes but this one.
    subroutine list_cells(c, n, cell, boxes, marks, list)
        type(coupling_t), intent(in) :: c
        integer, intent(in) :: n
        integer(int32), intent(in) :: cell(:) !! (n) numbers of cells in the window
        type(cells_t), intent(in) :: boxes(0:) !! (processes) cells of the grid
        type(marks_t), intent(inout) :: marks
        type(parcels_t), intent(inout) :: list
        type(cells_t) :: asked(0:ubound(boxes, 1))
        integer(int64) :: number(1, size(boxes))

        asked = boxes
        asked(c%ranks%rank) = cells_t()
        call put_list(asks_of(asked), marks%asks)
        call reserve_marks(n, size(boxes), marks)
        call each_mark_cells(n, n, size(boxes), marks%asks, c%box, cell, marks%mark)
        call count_marks(n, [1], marks, number)
        call list_marks(n, number, marks, list)
    end subroutine list_cells

    !> Give every process the impulses of the faces whose columns may reach into its box.
    subroutine share_impulses(c)
        type(coupling_t), intent(inout), target :: c
        type(rows_t) :: impulses(1)

        impulses = [rows_of(c%wall%impulse, words_of_real)]
        !@gpu call c%part%parcels%announce(c%part%faces_out)
        call c%part%parcels%send(c%part%faces_out, c%part%faces_in, impulses, impulses)
    end subroutine share_impulses

    !> Renew the debts of other processes that this one sees.
    subroutine share_debts(c)
        type(coupling_t), intent(inout) :: c
        integer(int64) :: out(1, c%ranks%n), all(1, c%ranks%n, c%ranks%n)

        call keep_own(c)
        associate (part => c%part, n => c%ranks%n)
            out = 0
            call find_firsts(out, part%debts_out%first) !@host
            if (c%n_debts > 0) call list_cells(c, c%n_debts, c%debt_cell, part%windows, &
                                               part%marks, part%debts_out)
            out(1, :) = part%debts_out%first(1:) - part%debts_out%first(:n - 1)
            call tell_all(c%ranks, out, all) !@host
        end associate
        if (sum(all) > 0) call swap_debts(c, all(1, :, :))
        call enter_debts(c)
    end subroutine share_debts

    !> Send the listed debts, and put those of others behind those of this process. On the way their
    !> cells have the numbers of the grid.
    subroutine swap_debts(c, all)
        type(coupling_t), intent(inout), target :: c
        integer(int64), intent(in) :: all(:, :) !! (to processes, from processes) debts
        integer(int64) :: in(1, size(all, 1))
        type(box_t) :: grid
        type(rows_t) :: rows(2)
        integer :: first, more, next(1)

        grid = c%box
        grid%before = 0
        grid%n = grid%whole
        in(1, :) = all(c%ranks%rank + 1, :)
        more = int(sum(in))
        call size_debts(c, c%n_debts + more)
        call size_next(c, c%n_debts + more)
        call each_renumber(c%n_debts, c%box, grid, c%debt_cell, c%next_cell)
        next = c%n_debts
        call place_pieces(in, next, c%part%marks, c%part%debts_in)
        rows = [rows_of(c%next_cell, 1), rows_of(c%debt, c%n_var*words_of_real)]
        !@gpu call c%part%parcels%aim(all, c%part%debts_out)
        call c%part%parcels%send(c%part%debts_out, c%part%debts_in, rows, rows)
        first = c%n_debts + 1
        call each_renumber(more, grid, c%box, c%next_cell(first:), c%debt_cell(first:))
        c%n_debts = c%n_debts + more
    end subroutine swap_debts
end module brz_shared_steps
