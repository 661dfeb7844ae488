! SPDX-License-Identifier: MIT
!> Cut cells of several processes. Each lists the cells of its halo, in the order of the grid. What
!> follows from particles alone it computes for the whole list; what is integrated, or depends on
!> cells beyond the halo, comes from the process in whose box the cell is.
module brz_cut_share
    use brz_air_grid, only: cell_at, nodes_along, number_of
    use brz_boxes, only: cells_t
    use brz_cut_cells, only: cut_cells_t
    use brz_fetch, only: fetch, fetch_rows, fetch_t, plan_fetch
    use brz_kinds, only: int32, int64, int8, rk
    use brz_ranks, only: most_of_all, ranks_t, several
    implicit none
    private
    public :: cut_share_t, plan_share, share_marks, list_shared, share_columns, share_numbers, &
        share_masters, states_of, put_states, found_by_any

    type :: cut_share_t
        type(ranks_t) :: ranks
        type(fetch_t) :: plan !! nodes of the halo from their owners
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
        if (.not. several(ranks)) return
        do r = 0, ranks%n - 1
            owners(r) = with_nodes(boxes(r))
            wanted(r) = with_nodes(halos(r))
        end do
        call plan_fetch(ranks, owners, wanted, nodes_along(n, wraps), spread(.false., 1, 3), 1, &
                        share%plan)

    contains

        !> Cells, and the nodes at the high ends of the grid.
        pure type(cells_t) function with_nodes(cells) result(nodes)
            type(cells_t), intent(in) :: cells

            nodes = cells
            where (nodes%hi == n) nodes%hi = nodes_along(n, wraps)
        end function with_nodes
    end subroutine plan_share

    !> Marks of the nodes in the halo as their owners have them.
    subroutine share_marks(share, cells, mark)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(in) :: cells
        integer(int8), intent(inout) :: mark(cells%nodes%n(1), cells%nodes%n(2), cells%nodes%n(3))

        associate (nodes => cells%nodes)
            call fetch(share%ranks, share%plan, nodes%before + 1, nodes%before + nodes%n, mark)
        end associate
    end subroutine share_marks

    !> The list is new: which entries go to whom, and come from whom.
    subroutine list_shared(share, cells)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(in) :: cells
        integer :: m

        if (.not. several(share%ranks)) return
        do m = 1, size(share%plan%out)
            call list_box(cells, share%plan%out(m)%box, share%plan%out(m)%row)
        end do
        do m = 1, size(share%plan%in)
            call list_box(cells, share%plan%in(m)%box, share%plan%in(m)%row)
        end do
    end subroutine list_shared

    !> Entries of the nodes in a box, in the order of the grid.
    pure subroutine list_box(cells, box, entries)
        type(cut_cells_t), intent(in) :: cells
        type(cells_t), intent(in) :: box !! as the grid counts
        integer(int32), allocatable, intent(inout) :: entries(:)
        integer :: i, j, k, n, number, pass

        do pass = 1, 2
            n = 0
            do k = box%lo(3) - cells%nodes%before(3), box%hi(3) - cells%nodes%before(3)
                do j = box%lo(2) - cells%nodes%before(2), box%hi(2) - cells%nodes%before(2)
                    number = cells%nodes%n(1)*(j - 1 + cells%nodes%n(2)*(k - 1))
                    do i = box%lo(1) - cells%nodes%before(1), box%hi(1) - cells%nodes%before(1)
                        if (cells%slot(number + i) == 0) cycle
                        n = n + 1
                        if (pass == 2) entries(n) = cells%slot(number + i)
                    end do
                end do
            end do
            if (pass == 2) exit
            if (allocated(entries)) deallocate (entries)
            allocate (entries(n))
        end do
    end subroutine list_box

    !> Entries of others get the columns that their owners have.
    subroutine share_columns(share, table)
        type(cut_share_t), intent(inout) :: share
        real(rk), intent(inout) :: table(:, :) !! (numbers of an entry, entries)

        call fetch_rows(share%ranks, share%plan, table)
    end subroutine share_columns

    !> The same of one number for each entry.
    subroutine share_numbers(share, n, numbers)
        type(cut_share_t), intent(inout) :: share
        integer, intent(in) :: n !! entries
        real(rk), intent(inout) :: numbers(:)
        real(rk) :: table(1, n)

        if (.not. several(share%ranks)) return
        table(1, :) = numbers(:n)
        call fetch_rows(share%ranks, share%plan, table)
        numbers(:n) = table(1, :)
    end subroutine share_numbers

    !> States of the listed cells, 0 where an entry is a node alone.
    pure function states_of(cells, u) result(states)
        type(cut_cells_t), intent(in) :: cells
        real(rk), intent(in) :: u(cells%nodes%grid%apart, cells%nodes%grid%n_var)
        real(rk) :: states(cells%nodes%grid%n_var, cells%n)
        integer :: s

        do s = 1, cells%n
            states(:, s) = 0
            if (cells%place(s) > 0) states(:, s) = u(cells%place(s), :)
        end do
    end function states_of

    !> Put states of the listed cells among those of the air.
    pure subroutine put_states(cells, states, u)
        type(cut_cells_t), intent(in) :: cells
        real(rk), intent(in) :: states(:, :) !! (n_var, entries)
        real(rk), intent(inout) :: u(cells%nodes%grid%apart, cells%nodes%grid%n_var)
        integer :: s

        do s = 1, cells%n
            if (cells%place(s) > 0) u(cells%place(s), :) = states(:, s)
        end do
    end subroutine put_states

    !> Masters of the entries of others as these have found them; a master beyond the halo counts as
    !> none. They travel as the way there, in cells.
    subroutine share_masters(share, cells)
        type(cut_share_t), intent(inout) :: share
        type(cut_cells_t), intent(inout) :: cells
        real(rk) :: way(3, cells%n)
        integer :: entry, s, there(3)

        if (.not. several(share%ranks)) return
        do s = 1, cells%n
            way(:, s) = cell_at(cells%nodes%n, cells%cell(cells%master(s))) &
                        - cell_at(cells%nodes%n, cells%cell(s))
        end do
        call fetch_rows(share%ranks, share%plan, way)
        do s = 1, cells%n
            there = cell_at(cells%nodes%n, cells%cell(s)) + nint(way(:, s))
            cells%master(s) = s
            if (any(there < 1 .or. there > cells%nodes%n)) cycle
            entry = cells%slot(number_of(cells%nodes%n, there))
            if (entry > 0) cells%master(s) = entry
        end do
    end subroutine share_masters

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
