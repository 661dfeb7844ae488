! SPDX-License-Identifier: MIT
!> Lists of the solid cells, of the faces between gas and solid, and of the faces that a solid cell
!> cuts out of the plain scheme. All lists grow only, and their order is that of the grid.
module brz_air_walls
    use brz_kinds, only: int8, rk
    use brz_air_boundary, only: image_at
    use brz_air_state, only: air_t, bc_inside, bc_periodic, cut_t, n_ghost, wall_t
    use brz_grid_lines, only: block_of, n_blocks
    use brz_scheme, only: reach_of
    implicit none
    private
    public :: set_up_walls, build_walls, image_of

contains

    !> Allocate the maps of a wall: no cell holds solid yet.
    subroutine set_up_walls(air, wall)
        type(air_t), intent(in) :: air
        type(wall_t), intent(out) :: wall
        integer :: d, n(3), g(3)

        n = air%n
        g = air%g
        allocate (wall%solid(1 - g(1):n(1) + g(1), 1 - g(2):n(2) + g(2), 1 - g(3):n(3) + g(3)), &
            source=0_int8)
        allocate (wall%index(1 - g(1):n(1) + g(1), 1 - g(2):n(2) + g(2), 1 - g(3):n(3) + g(3)), &
            source=0)
        allocate (wall%cell(3, 0), wall%v(3, 0), wall%face_of(6, 0), wall%face(5, 0), &
            wall%face_cell(0), wall%push(0), wall%impulse(0))
        do d = 1, 3
            allocate (wall%cut(d)%face(4, 0), wall%cut(d)%side(0), wall%cut(d)%push(0))
            allocate (wall%cut(d)%speed(0))
            allocate (wall%cut(d)%first(n_blocks(n, d) + 1), source=1)
            allocate (wall%cut(d)%has_solid(n_blocks(n, d)), source=0_int8)
        end do
        wall%lo = 1
        wall%hi = n
        wall%present = .true.
    end subroutine set_up_walls

    !> Derive all lists from `wall%solid` of the cells lo..hi; its ghosts are filled here.
    !>
    !> On several processes lists of cells and wall faces hold those around the box too; lists of
    !> what the sweeps of this process meet do not.
    !>
    !> The wall velocities `v` must be filled afterwards: the list of cells has changed.
    subroutine build_walls(air, wall)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer :: d

        call clear_maps(air, wall)
        call list_cells(air, wall)
        do d = 1, 3
            if (air%n(d) > 1) call fill_ghost_maps(air, wall, d)
        end do
        call list_faces(air, wall)
        do d = 1, 3
            if (air%n(d) > 1) call list_cuts(air, wall, d)
        end do
    end subroutine build_walls

    !> Cell whose state the ghost cell at position p of direction d takes.
    pure integer function image_of(air, d, p)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: p !! index of a cell along it, ghosts included

        image_of = image_at(air%n(d), air%bc(1, d), air%bc(2, d), p)
    end function image_of

    !> Wipe what the last lists have left in the maps.
    subroutine clear_maps(air, wall)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer :: c, d, cell(3)

        do c = 1, wall%n_cells
            cell = wall%cell(:, c)
            wall%index(cell(1), cell(2), cell(3)) = 0
            do d = 1, 3
                if (is_on_line(air, d, cell)) wall%cut(d)%has_solid(block_of(air%n, d, cell)) = 0
            end do
        end do
    end subroutine clear_maps

    !> List the solid cells in the order of the grid.
    subroutine list_cells(air, wall)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer :: i, j, k, d

        wall%n_cells = 0
        do k = wall%lo(3), wall%hi(3)
            do j = wall%lo(2), wall%hi(2)
                if (all(wall%solid(wall%lo(1):wall%hi(1), j, k) == 0)) cycle
                do i = wall%lo(1), wall%hi(1)
                    if (wall%solid(i, j, k) == 0) cycle
                    wall%n_cells = wall%n_cells + 1
                    call grow_integer(wall%cell, wall%n_cells)
                    wall%cell(:, wall%n_cells) = [i, j, k]
                    wall%index(i, j, k) = wall%n_cells
                    do d = 1, 3
                        if (is_on_line(air, d, [i, j, k])) &
                            wall%cut(d)%has_solid(block_of(air%n, d, [i, j, k])) = 1
                    end do
                end do
            end do
        end do
        if (size(wall%v, 2) < wall%n_cells) then
            deallocate (wall%v, wall%face_of)
            allocate (wall%v(3, size(wall%cell, 2)), source=0.0_rk)
            allocate (wall%face_of(6, size(wall%cell, 2)))
        end if
    end subroutine list_cells

    !> True for a cell on a line of the box along direction d, or so near that a stencil reaches it.
    pure logical function is_on_line(air, d, cell)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: cell(3)
        integer :: e

        is_on_line = cell(d) > -n_ghost .and. cell(d) <= air%n(d) + n_ghost
        do e = 1, 3
            if (e /= d) is_on_line = is_on_line .and. cell(e) >= 1 .and. cell(e) <= air%n(e)
        end do
    end function is_on_line

    !> Fill the ghosts of one direction from their images, but for cells of other processes.
    subroutine fill_ghost_maps(air, wall, d)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: d !! direction
        integer :: m, from, p(2*n_ghost)

        p = ghosts_of(air%n(d))
        do m = 1, size(p)
            if (air%bc(merge(1, 2, p(m) < 1), d) == bc_inside) cycle
            from = image_of(air, d, p(m))
            select case (d)
            case (1)
                wall%solid(p(m), :, :) = wall%solid(from, :, :)
                wall%index(p(m), :, :) = wall%index(from, :, :)
            case (2)
                wall%solid(:, p(m), :) = wall%solid(:, from, :)
                wall%index(:, p(m), :) = wall%index(:, from, :)
            case default
                wall%solid(:, :, p(m)) = wall%solid(:, :, from)
                wall%index(:, :, p(m)) = wall%index(:, :, from)
            end select
        end do
    end subroutine fill_ghost_maps

    !> Positions of the ghosts of a line of n cells.
    pure function ghosts_of(n) result(p)
        integer, intent(in) :: n
        integer :: p(2*n_ghost), m

        p = [(m, m=1 - n_ghost, 0), (n + m, m=1, n_ghost)]
    end function ghosts_of

    !> List the faces between a gas cell and a solid cell or its image, both among lo..hi.
    !>
    !> Order: by solid cell, direction, gas below or above. A periodic box is the only one where the
    !> two are neighbours across the boundary.
    subroutine list_faces(air, wall)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer :: c, d, s, gas(3)

        wall%n_faces = 0
        do c = 1, wall%n_cells
            wall%face_of(:, c) = 0
            do d = 1, 3
                if (air%n(d) == 1) cycle
                do s = -1, 1, 2
                    gas = wall%cell(:, c)
                    gas(d) = gas(d) + s
                    if (gas(d) < wall%lo(d) .or. gas(d) > wall%hi(d)) then
                        if (air%bc(1, d) /= bc_periodic) cycle
                        gas(d) = image_of(air, d, gas(d))
                    end if
                    if (wall%solid(gas(1), gas(2), gas(3)) == 1) cycle
                    wall%n_faces = wall%n_faces + 1
                    call grow_integer(wall%face, wall%n_faces)
                    call grow_list(wall%face_cell, wall%n_faces)
                    wall%face(:, wall%n_faces) = [gas, d, -s]
                    wall%face_cell(wall%n_faces) = c
                    wall%face_of(2*d - (1 - s)/2, c) = wall%n_faces
                end do
            end do
        end do
        if (size(wall%impulse) < wall%n_faces) then
            deallocate (wall%push, wall%impulse)
            allocate (wall%push(size(wall%face, 2)), wall%impulse(size(wall%face, 2)))
        end if
        wall%push = 0
        wall%impulse = 0
    end subroutine list_faces

    !> List the faces of direction d whose stencils hold both gas and solid, sorted by block.
    subroutine list_cuts(air, wall, d)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: d !! direction
        integer :: c, i, b, n, pass, m, p(2*n_ghost + 1)

        n = air%n(d)
        do pass = 1, 2
            if (pass == 1) wall%cut(d)%first = 0
            do c = 1, wall%n_cells
                if (.not. is_on_line(air, d, wall%cell(:, c))) cycle
                i = wall%cell(d, c)
                p(1) = i
                m = 1
                if (i <= n_ghost .or. i > n - n_ghost) call list_images(air, d, i, m, p)
                call cuts_of(air, wall, d, c, p(1:m), pass == 2)
            end do
            if (pass == 1) call make_room(wall%cut(d))
        end do
        ! placing has moved each start to that of the next block: move them back
        do b = size(wall%cut(d)%first), 2, -1
            wall%cut(d)%first(b) = wall%cut(d)%first(b - 1)
        end do
        wall%cut(d)%first(1) = 1
        call label_walls(air, wall, d)
    end subroutine list_cuts

    !> Add the ghost positions that show cell i of direction d.
    subroutine list_images(air, d, i, m, p)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: i !! index along it
        integer, intent(inout) :: m !! positions so far
        integer, intent(inout) :: p(2*n_ghost + 1)
        integer :: g, ghost(2*n_ghost)

        ghost = ghosts_of(air%n(d))
        do g = 1, size(ghost)
            if (air%bc(merge(1, 2, ghost(g) < 1), d) == bc_inside) cycle
            if (image_of(air, d, ghost(g)) /= i) cycle
            m = m + 1
            p(m) = ghost(g)
        end do
    end subroutine list_images

    !> Count or place the cut faces whose lowest solid cell is at one of the positions p.
    subroutine cuts_of(air, wall, d, c, p, place)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: c !! solid cell
        integer, intent(in) :: p(:) !! its position and those of its images
        logical, intent(in) :: place !! false: count
        integer :: m, f, q, b, gas, reach, cell(3)
        logical :: lowest

        cell = wall%cell(:, c)
        b = block_of(air%n, d, cell)
        reach = reach_of(air%scheme)
        do m = 1, size(p)
            do f = max(p(m) - reach, 0), min(p(m) + reach - 1, air%n(d))
                lowest = .true.
                gas = 0
                do q = f + 1 - reach, f + reach
                    cell(d) = q
                    if (wall%solid(cell(1), cell(2), cell(3)) == 0) then
                        gas = gas + 1
                    else if (q < p(m)) then
                        lowest = .false.
                    end if
                end do
                if (gas == 0 .or. .not. lowest) cycle
                if (place) then
                    cell(d) = f
                    wall%cut(d)%face(1:3, wall%cut(d)%first(b)) = cell
                    wall%cut(d)%first(b) = wall%cut(d)%first(b) + 1
                else
                    wall%cut(d)%first(b + 1) = wall%cut(d)%first(b + 1) + 1
                end if
            end do
        end do
    end subroutine cuts_of

    !> Turn the counts of a cut list into starts and make the list long enough.
    subroutine make_room(cut)
        type(cut_t), intent(inout) :: cut
        integer :: b

        cut%first(1) = 1
        do b = 2, size(cut%first)
            cut%first(b) = cut%first(b - 1) + cut%first(b)
        end do
        cut%n = cut%first(size(cut%first)) - 1
        if (size(cut%side) >= cut%n) return
        deallocate (cut%face, cut%side, cut%push, cut%speed)
        allocate (cut%face(4, cut%n + cut%n/4), cut%side(cut%n + cut%n/4))
        allocate (cut%push(cut%n + cut%n/4), cut%speed(cut%n + cut%n/4))
    end subroutine make_room

    !> Say which cut faces lie between gas and solid, on which side, and where their impulse goes.
    subroutine label_walls(air, wall, d)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: d !! direction
        integer :: f, low(3), high(3), gas(3), e

        do e = 1, wall%cut(d)%n
            low = wall%cut(d)%face(1:3, e)
            high = low
            high(d) = high(d) + 1
            wall%cut(d)%side(e) = wall%solid(high(1), high(2), high(3)) &
                - wall%solid(low(1), low(2), low(3))
            wall%cut(d)%face(4, e) = 0
        end do
        do f = 1, wall%n_faces
            if (wall%face(4, f) /= d) cycle
            gas = wall%face(1:3, f)
            if (wall%face(5, f) < 0) gas(d) = gas(d) - 1
            if (.not. is_on_line(air, d, gas) .or. gas(d) < 0 .or. gas(d) > air%n(d)) cycle
            e = cut_at(wall%cut(d), block_of(air%n, d, gas), gas)
            wall%cut(d)%face(4, e) = f
        end do
    end subroutine label_walls

    !> Place of a face in its block of the cut list.
    pure integer function cut_at(cut, b, low)
        type(cut_t), intent(in) :: cut
        integer, intent(in) :: b !! block
        integer, intent(in) :: low(3) !! cell below the face

        do cut_at = cut%first(b), cut%first(b + 1) - 1
            if (cut%face(1, cut_at) == low(1) .and. cut%face(2, cut_at) == low(2) &
                .and. cut%face(3, cut_at) == low(3)) return
        end do
    end function cut_at

    !> Make a table with at least n columns, keeping its content.
    subroutine grow_integer(table, n)
        integer, allocatable, intent(inout) :: table(:, :)
        integer, intent(in) :: n
        integer, allocatable :: longer(:, :)

        if (size(table, 2) >= n) return
        allocate (longer(size(table, 1), n + n/2 + 64))
        longer(:, 1:size(table, 2)) = table
        call move_alloc(longer, table)
    end subroutine grow_integer

    !> Make a list at least n long, keeping its content.
    subroutine grow_list(list, n)
        integer, allocatable, intent(inout) :: list(:)
        integer, intent(in) :: n
        integer, allocatable :: longer(:)

        if (size(list) >= n) return
        allocate (longer(n + n/2 + 64))
        longer(1:size(list)) = list
        call move_alloc(longer, list)
    end subroutine grow_list
end module brz_air_walls
