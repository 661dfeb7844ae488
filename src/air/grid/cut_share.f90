! SPDX-License-Identifier: MIT
!> Cut cells of several processes. Each lists the cells of its halo, in the order of the grid. What
!> follows from particles alone it computes for the whole list; what is integrated, or depends on
!> cells beyond the halo, comes from the process in whose box the cell is: only listed entries
!> travel.
module brz_cut_share
    use brz_air_grid, only: nodes_along
    use brz_boxes, only: asks_of, cells_t, common
    use brz_buffers, only: bytes_t
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_share_loops, only: for_each_cut_mark_shared, for_each_cut_pick_state, &
        for_each_cut_pick_way, for_each_cut_put_state, for_each_cut_put_way
    use brz_errors, only: error_t
    use brz_fetch, only: fetch, fetch_t, plan_fetch
    use brz_gpu_fetch, only: gpu_fetch_t
    use brz_kinds, only: int32, int64, int8, rk
    use brz_lists, only: at_least, put_list
    use brz_message_buffers, only: courier_t
    use brz_message_exchange, only: tell_all
    use brz_places, only: find_firsts, marks_t, message_buffers_t
    use brz_present_table, only: on_device
    use brz_ranks, only: most_of_all, ranks_t, several
    use brz_record_rules, only: w => words_of_real
    use brz_rows, only: rows_of, rows_t
    use brz_scheme, only: max_var
    use brz_send_lists, only: count_marks, list_marks, reserve_marks
    implicit none
    private
    public :: cut_share_t, plan_share, open_share_of_gpus, share_marks, list_shared, share_rows, &
        pick_states, put_states, states_in, share_states, share_masters, found_by_any

    integer, parameter :: most_words = (2*max_var + 3)*w + 1 !! of an entry in a message

    type :: cut_share_t
        type(ranks_t) :: ranks
        type(fetch_t) :: plan !! nodes of the halo from their owners
        type(gpu_fetch_t) :: plan_of_gpus !! likewise between GPUs
        type(cells_t), allocatable :: goes(:), comes(:)
        !! (0:processes-1) nodes of this process that others see; those of others that it sees
        type(courier_t) :: messages
        type(message_buffers_t) :: out, in !! their entries
        type(marks_t) :: marks
        real(rk), allocatable :: states(:, :) !! (max_var, entries) of the air, on their way
        integer(int32), allocatable :: way(:, :) !! (3, entries) to masters, likewise
    end type cut_share_t

contains

    !> Find out with whom this process has to speak. The nodes at the high ends of the grid belong
    !> with the cells beside them.
    subroutine plan_share(ranks, boxes, halos, n, wraps, share)
        type(ranks_t), intent(in) :: ranks
        type(cells_t), intent(in) :: boxes(0:), halos(0:) !! (processes) cells of each, and its halo
        integer, intent(in) :: n(3) !! cells of the grid
        logical, intent(in) :: wraps(3) !! periodic directions, which are not cut
        type(cut_share_t), intent(inout) :: share
        type(cells_t) :: owners(0:ranks%n - 1), wanted(0:ranks%n - 1)
        integer :: r

        share%ranks = ranks
        share%messages%ranks = ranks
        if (.not. several(ranks)) return
        do r = 0, ranks%n - 1
            owners(r) = with_nodes(boxes(r))
            wanted(r) = with_nodes(halos(r))
        end do
        call plan_fetch(ranks, owners, wanted, nodes_along(n, wraps), spread(.false., 1, 3), 1, &
                        share%plan)
        allocate (share%goes(0:ranks%n - 1), share%comes(0:ranks%n - 1))
        do r = 0, ranks%n - 1
            if (r == ranks%rank) cycle
            share%goes(r) = common(owners(ranks%rank), wanted(r))
            share%comes(r) = common(owners(r), wanted(ranks%rank))
        end do

    contains

        !> Cells, and the nodes at the high ends of the grid.
        pure type(cells_t) function with_nodes(cells) result(nodes)
            type(cells_t), intent(in) :: cells

            nodes = cells
            where (nodes%hi == n) nodes%hi = nodes_along(n, wraps)
        end function with_nodes
    end subroutine plan_share

    !> From now on GPUs speak with each other; nothing is listed yet.
    subroutine open_share_of_gpus(share, cells, err)
        type(cut_share_t), intent(inout) :: share !! planned
        type(cut_cells_t), intent(in) :: cells
        type(error_t), intent(inout) :: err
        type(message_buffers_t) :: nothing
        type(marks_t) :: no_marks

        share%out = nothing
        share%in = nothing
        share%marks = no_marks
        share%messages%on_gpu = .true.
        associate (nodes => cells%nodes)
            call share%plan_of_gpus%open(share%ranks, share%plan, &
                cells_t(nodes%before + 1, nodes%before + nodes%n), 0, err)
        end associate
        allocate (nothing%place(0), nothing%first(0:share%ranks%n))
        nothing%first = 1
        call share%messages%device%open(share%ranks, nothing, nothing, most_words, err)
    end subroutine open_share_of_gpus

    !> Marks of the nodes in the halo as their owners have them.
    subroutine share_marks(share, cells, mark, err)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(in) :: cells
        integer(int8), intent(inout) :: mark(cells%nodes%n(1), cells%nodes%n(2), cells%nodes%n(3))
        type(error_t), intent(inout) :: err

        if (share%messages%on_gpu) then
            call share%plan_of_gpus%bytes_of_others(bytes_t(address=on_device(mark)), err)
        else
            associate (nodes => cells%nodes)
                call fetch(share%ranks, share%plan, nodes%before + 1, nodes%before + nodes%n, mark)
            end associate
        end if
    end subroutine share_marks

    !> The list is new: which entries go to whom, and come from whom, both in the order of the grid.
    subroutine list_shared(share, cells, err)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(in) :: cells
        type(error_t), intent(inout) :: err
        integer(int64), dimension(1, share%ranks%n) :: goes, comes
        integer(int64) :: all(1, share%ranks%n, share%ranks%n)

        if (.not. several(share%ranks)) return
        call list_in_boxes(share, cells, share%goes, share%out, goes, err)
        call list_in_boxes(share, cells, share%comes, share%in, comes, err)
        call at_least(share%messages%on_gpu, share%states, max_var, max(cells%n, 1), err)
        call at_least(share%messages%on_gpu, share%way, 3, max(cells%n, 1), err)
        if (.not. share%messages%on_gpu) return
        call tell_all(share%ranks, goes, all)
        ! whose GPU has failed sends nothing, and nobody waits for it
        comes = all(:, share%ranks%rank + 1, :)
        call find_firsts(comes, share%in%first)
        call share%messages%aim(all(1, :, :), share%out, err)
    end subroutine list_shared

    !> List the entries in a box for each process.
    subroutine list_in_boxes(share, cells, boxes, list, number, err)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(in) :: cells
        type(cells_t), intent(in) :: boxes(:) !! (processes) nodes of the grid
        type(message_buffers_t), intent(inout) :: list
        integer(int64), intent(out) :: number(:, :) !! (1, processes) of entries
        type(error_t), intent(inout) :: err

        associate (g => share%messages%on_gpu, marks => share%marks, n => max(cells%n, 1))
            if (cells%n > 0) then
                call put_list(g, asks_of(boxes), marks%asks, err)
                call reserve_marks(g, n, size(boxes), marks, err)
                call for_each_cut_mark_shared(g, n, n, size(boxes), marks%asks, cells%nodes, &
                                              cells%cell, marks%mark, err)
                call count_marks(g, n, [1], marks, number, err)
            else
                number = 0
            end if
            call list_marks(g, n, number, marks, list, err)
        end associate
    end subroutine list_in_boxes

    !> Entries of others get the rows of some arrays, by entries, that their owners have.
    subroutine share_rows(share, arrays, err)
        type(cut_share_t), intent(inout) :: share
        type(rows_t), intent(in) :: arrays(:)
        type(error_t), intent(inout) :: err

        if (several(share%ranks)) call share%messages%send(share%out, share%in, arrays, arrays, err)
    end subroutine share_rows

    !> States of the air in the cells of entries that others want, for a message: see states_in.
    subroutine pick_states(share, cells, u, err)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(in) :: cells
        real(rk), intent(in) :: u(*)
        type(error_t), intent(inout) :: err

        call for_each_cut_pick_state(share%messages%on_gpu, entries_of(share, share%out), &
            cells%nodes, share%out%place, cells%place, u, share%states, err)
    end subroutine pick_states

    !> Put those that have come among the others.
    subroutine put_states(share, cells, u, err)
        type(cut_share_t), intent(in) :: share
        type(cut_cells_t), intent(in) :: cells
        real(rk), intent(inout) :: u(*)
        type(error_t), intent(inout) :: err

        call for_each_cut_put_state(share%messages%on_gpu, entries_of(share, share%in), &
            cells%nodes, share%in%place, cells%place, share%states, u, err)
    end subroutine put_states

    !> The states as messages see them.
    type(rows_t) function states_in(share) result(rows)
        type(cut_share_t), intent(in), target :: share

        rows = rows_of(share%messages%on_gpu, share%states, max_var*w)
    end function states_in

    !> The air in the cells of others, as these have it.
    subroutine share_states(share, cells, u, err)
        type(cut_share_t), intent(inout), target :: share
        type(cut_cells_t), intent(in) :: cells
        real(rk), intent(inout) :: u(*)
        type(error_t), intent(inout) :: err

        if (.not. several(share%ranks)) return
        call pick_states(share, cells, u, err)
        call share_rows(share, [states_in(share)], err)
        call put_states(share, cells, u, err)
    end subroutine share_states

    !> Masters of the entries of others as these have found them; a master beyond the halo counts as
    !> none. They travel as the way there, in cells.
    subroutine share_masters(share, cells, err)
        type(cut_share_t), intent(inout), target :: share
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err

        if (.not. several(share%ranks)) return
        associate (g => share%messages%on_gpu)
            call for_each_cut_pick_way(g, entries_of(share, share%out), cells%nodes, &
                share%out%place, cells%cell, cells%master, share%way, err)
            call share_rows(share, [rows_of(g, share%way, 3)], err)
            call for_each_cut_put_way(g, entries_of(share, share%in), cells%nodes, &
                share%in%place, cells%cell, cells%slot, share%way, cells%master, err)
        end associate
    end subroutine share_masters

    !> Entries of all messages of a list.
    pure integer function entries_of(share, list) result(n)
        type(cut_share_t), intent(in) :: share
        type(message_buffers_t), intent(in) :: list

        n = list%first(share%ranks%n) - 1
    end function entries_of

    !> True in all processes where a count is not zero in one of them.
    logical function found_by_any(ranks, number)
        type(ranks_t), intent(in) :: ranks
        integer, intent(in) :: number
        integer(int64) :: most(1)

        most = number
        call most_of_all(ranks, most)
        found_by_any = most(1) > 0
    end function found_by_any
end module brz_cut_share
