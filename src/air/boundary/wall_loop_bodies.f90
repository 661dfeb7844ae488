! SPDX-License-Identifier: MIT
!> Maps and lists of the cells that hold solid, of a grid or of a halo of it. Cells go by their
!> number in memory order, ghosts left out. Wall faces, between gas and solid, are listed by solid
!> cell, direction, gas below or above.
module brz_wall_loop_bodies
    use brz_air_boundary, only: image_at
    use brz_air_grid, only: cell_at, grid_t, number_of, place_of
    use brz_boundary_codes, only: bc_inside, bc_periodic
    use brz_kinds, only: int32, int64, int8
    implicit none
    private
    public :: set_wall, image_wall, count_faces, list_faces, images_along

    integer, parameter :: layers = 3 !! of ghosts that stencils reach

contains

    !> Enter a solid cell in the maps, or take it out.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine set_wall(c, grid, is, cell, solid, cell_of)
        integer, intent(in) :: c !! solid cells
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: is !! 1: enter it, 0: take it out
        integer(int32), intent(in) :: cell(*) !! their numbers
        integer(int8), intent(inout) :: solid(*)
        integer, intent(inout) :: cell_of(*)
        integer(int64) :: at

        at = place_at(grid, cell(c))
        solid(at) = int(is, int8)
        cell_of(at) = is*c
    end subroutine set_wall

    !> Place of a cell, from its number.
    !@cuf attributes(host,device) &
    pure function place_at(grid, number) result(at)
        type(grid_t), intent(in) :: grid
        integer(int32), intent(in) :: number
        integer(int64) :: at
        integer :: ijk(3)

        ijk = cell_at(grid%n, number)
        at = place_of(grid, ijk(1), ijk(2), ijk(3))
    end function place_at

    !> Cells that image_wall fills in a direction: ghosts at both ends of all lines, those of ghosts
    !> of other directions too.
    pure integer function images_along(grid, d) result(cells)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction

        cells = 0
        if (grid%n(d) > 1) cells = int(2*layers*grid%apart/extent(grid, d))
    end function images_along

    !> Cells along a direction, ghosts included.
    !@cuf attributes(host,device) &
    pure function extent(grid, d) result(cells)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer :: cells

        cells = int(grid%apart/grid%step(3))
        if (d == 1) cells = grid%step(2)
        if (d == 2) cells = grid%step(3)/grid%step(2)
    end function extent

    !> Fill a ghost of the maps from its image, direction by direction; cells of other processes are
    !> left alone.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine image_wall(t, d, grid, solid, cell_of)
        integer, intent(in) :: t !! as images_along counts
        integer, intent(in) :: d !! direction
        type(grid_t), intent(in) :: grid
        integer(int8), intent(inout) :: solid(*)
        integer, intent(inout) :: cell_of(*)
        integer(int64) :: at, from
        integer :: a, b, p, rest, wide

        a = merge(2, 1, d == 1)
        b = merge(2, 3, d == 3)
        wide = extent(grid, a)
        rest = (t - 1)/(2*layers)
        p = t - 2*layers*rest - layers
        if (p > 0) p = p + grid%n(d)
        if (p + grid%g(d) < 1 .or. p + grid%g(d) > extent(grid, d)) return
        if (grid%bc(merge(1, 2, p < 1), d) == bc_inside) return
        at = 1 + mod(rest, wide)*int(grid%step(a), int64) + rest/wide*int(grid%step(b), int64)
        from = at + (image_at(grid%n(d), grid%bc(1, d), grid%bc(2, d), p) + grid%g(d) - 1) &
            *int(grid%step(d), int64)
        at = at + (p + grid%g(d) - 1)*int(grid%step(d), int64)
        solid(at) = solid(from)
        cell_of(at) = cell_of(from)
    end subroutine image_wall

    !> Gas cell in front of one side of a solid cell, or 0. A periodic box is the only one where the
    !> two are neighbours across the boundary.
    !@cuf attributes(host,device) &
    pure function gas_at(grid, number, row, solid) result(gas)
        type(grid_t), intent(in) :: grid
        integer(int32), intent(in) :: number !! of the solid cell
        integer, intent(in) :: row !! side, as in face_of
        integer(int8), intent(in) :: solid(*)
        integer(int32) :: gas
        integer :: d, ijk(3)

        gas = 0
        d = (row + 1)/2
        if (grid%n(d) == 1) return
        ijk = cell_at(grid%n, number)
        ijk(d) = ijk(d) + merge(-1, 1, mod(row, 2) == 1)
        if (ijk(d) < 1 .or. ijk(d) > grid%n(d)) then
            if (grid%bc(1, d) /= bc_periodic) return
            ijk(d) = image_at(grid%n(d), grid%bc(1, d), grid%bc(2, d), ijk(d))
        end if
        if (solid(place_of(grid, ijk(1), ijk(2), ijk(3))) /= 0) return
        gas = number_of(grid%n, ijk)
    end function gas_at

    !> Wall faces of a solid cell.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine count_faces(c, grid, cell, solid, number)
        integer, intent(in) :: c !! solid cells
        type(grid_t), intent(in) :: grid
        integer(int32), intent(in) :: cell(*) !! their numbers
        integer(int8), intent(in) :: solid(*)
        integer(int32), intent(inout) :: number(*)
        integer :: faces, row

        faces = 0
        do row = 1, 6
            if (gas_at(grid, cell(c), row, solid) > 0) faces = faces + 1
        end do
        number(c) = faces
    end subroutine count_faces

    !> List the wall faces of a solid cell; `start` holds how many are before.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine list_faces(c, grid, cell, solid, start, face_of, gas, rows, owner)
        integer, intent(in) :: c !! solid cells
        type(grid_t), intent(in) :: grid
        integer(int32), intent(in) :: cell(*) !! their numbers
        integer(int8), intent(in) :: solid(*)
        integer(int32), intent(in) :: start(*)
        integer, intent(inout) :: face_of(6, *) !! face on each side, or 0: 1, 2: gas below, above
                                                !! in x; 3, 4 in y; 5, 6 in z
        integer(int32), intent(inout) :: gas(*) !! (faces) number of the gas cell
        integer(int32), intent(inout) :: rows(*) !! (faces) row of face_of
        integer, intent(inout) :: owner(*) !! (faces) place of the solid cell in the list
        integer(int32) :: beside
        integer :: f, row

        f = start(c)
        do row = 1, 6
            face_of(row, c) = 0
            beside = gas_at(grid, cell(c), row, solid)
            if (beside == 0) cycle
            f = f + 1
            face_of(row, c) = f
            gas(f) = beside
            rows(f) = row
            owner(f) = c
        end do
    end subroutine list_faces
end module brz_wall_loop_bodies
