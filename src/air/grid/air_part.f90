! SPDX-License-Identifier: MIT
!> The part of the grid that belongs to this process: its box, and what it needs from others.
!>
!> Boxes begin on bricks (see brz_boxes). Ghosts of a box are those of the grid where it touches the
!> boundary, and cells of other boxes elsewhere (bc_inside).
module brz_air_part
    use brz_air_grid, only: brick
    use brz_boundary_codes, only: bc_inside, bc_periodic
    use brz_boxes, only: cells_t, cut_grid, widened
    use brz_cell_lists, only: places_in
    use brz_fetch, only: fetch_t, plan_fetch
    use brz_kinds, only: dp, int64, int8, rk
    use brz_ranks, only: ranks_t, several
    implicit none
    private
    public :: air_part_t, take_part, box_of, layers_seen, halo_of

    integer, parameter :: layers_seen = 10
    !! layers of cells around a box that the coupling of this box depends on, and those that these
    !! depend on in a step: shapes follow from particles some cells away, and clusters reach over
    !! some more

    type :: air_part_t
        type(ranks_t) :: ranks !! the processes that share the grid
        type(cells_t), allocatable :: boxes(:) !! (0:processes-1) cells of each
        type(fetch_t) :: halo !! the cells as near as a stencil reaches
        type(fetch_t) :: beside !! the cells next to the box
        type(fetch_t) :: bricks !! the bricks as near as a step reaches
        type(fetch_t) :: coupling_halo !! the cells as far as the coupling looks, where there are
                                       !! bodies
        integer(int8), allocatable :: reached(:, :, :), active(:, :, :)
        !! the maps of bricks, with those of others that are near
        integer(int64), allocatable :: own(:) !! place of each brick of this process there
        real(rk), allocatable :: seen(:, :, :)
        !! (n_var, 0:7, points) conserved variables around the gauges, see fetch_around
    end type air_part_t

contains

    !> Cut the grid for all processes, where that has not been done, and find out with whom this one
    !> has to speak.
    subroutine take_part(n, bc, layers, n_var, near, around, part)
        integer, intent(in) :: n(3) !! cells of the whole grid
        integer, intent(in) :: bc(2, 3) !! its boundary conditions
        integer, intent(in) :: layers(3) !! of ghosts
        integer, intent(in) :: n_var !! conserved variables
        integer, intent(in) :: near(3) !! bricks that a step reaches
        integer, intent(in) :: around !! layers of cells that the coupling sees, 0: none
        type(air_part_t), intent(inout) :: part !! its processes are set
        type(cells_t) :: bricks(0:part%ranks%n - 1)
        logical :: periodic(3)
        integer :: r, all_bricks(3)

        if (.not. allocated(part%boxes)) then
            allocate (part%boxes(0:part%ranks%n - 1))
            call cut_grid(n, brick, part%boxes)
        end if
        if (.not. several(part%ranks)) return
        periodic = bc(1, :) == bc_periodic
        all_bricks = (n - 1)/brick + 1
        do r = 0, part%ranks%n - 1
            bricks(r)%lo = (part%boxes(r)%lo - 1)/brick + 1
            bricks(r)%hi = (part%boxes(r)%hi - 1)/brick + 1
        end do
        call plan(part%boxes, n, layers, n_var, part%halo)
        call plan(part%boxes, n, min(layers, 1), 1, part%beside)
        call plan(bricks, all_bricks, near, 1, part%bricks)
        if (around > 0) call plan(part%boxes, n, merge(around, 0, n > 1), n_var, part%coupling_halo)
        call make_map(part%bricks%whole, part%reached)
        call make_map(part%bricks%whole, part%active)
        part%own = places_in(part%bricks%whole, bricks(part%ranks%rank))

    contains

        !> Plan to fetch the cells around the boxes of a grid.
        subroutine plan(boxes, grid, wide, numbers, fetch)
            type(cells_t), intent(in) :: boxes(0:)
            integer, intent(in) :: grid(3), wide(3), numbers
            type(fetch_t), intent(out) :: fetch
            type(cells_t) :: wanted(0:size(boxes) - 1)
            integer :: m

            do m = 0, size(boxes) - 1
                wanted(m) = widened(boxes(m), wide)
                where (.not. periodic .or. boxes(m)%hi - boxes(m)%lo + 1 == grid)
                    wanted(m)%lo = max(wanted(m)%lo, 1)
                    wanted(m)%hi = min(wanted(m)%hi, grid)
                end where
            end do
            call plan_fetch(part%ranks, boxes, wanted, grid, periodic, numbers, fetch)
        end subroutine plan
    end subroutine take_part

    !> The cells that the coupling of a process sees: its box and the layers around, not beyond the
    !> grid. A direction that is not cut is whole.
    pure type(cells_t) function halo_of(part, rank, n, around) result(halo)
        type(air_part_t), intent(in) :: part
        integer, intent(in) :: rank !! process
        integer, intent(in) :: n(3) !! cells of the whole grid
        integer, intent(in) :: around

        halo = widened(part%boxes(rank), [around, around, around])
        halo%lo = max(halo%lo, 1)
        halo%hi = min(halo%hi, n)
    end function halo_of

    subroutine make_map(box, map)
        type(cells_t), intent(in) :: box
        integer(int8), allocatable, intent(out) :: map(:, :, :)

        allocate (map(box%lo(1):box%hi(1), box%lo(2):box%hi(2), box%lo(3):box%hi(3)), source=0_int8)
    end subroutine make_map

    !> The box of this process, and its boundary conditions.
    pure subroutine box_of(part, n, bc, box, inner)
        type(air_part_t), intent(in) :: part
        integer, intent(in) :: n(3) !! cells of the whole grid
        integer, intent(in) :: bc(2, 3) !! its boundary conditions
        type(cells_t), intent(out) :: box
        integer, intent(out) :: inner(2, 3)
        integer :: d

        box = cells_t([1, 1, 1], n)
        inner = bc
        if (.not. several(part%ranks)) return
        box = part%boxes(part%ranks%rank)
        do d = 1, 3
            if (box%lo(d) == 1 .and. box%hi(d) == n(d)) cycle
            if (box%lo(d) > 1 .or. bc(1, d) == bc_periodic) inner(1, d) = bc_inside
            if (box%hi(d) < n(d) .or. bc(2, d) == bc_periodic) inner(2, d) = bc_inside
        end do
    end subroutine box_of
end module brz_air_part
