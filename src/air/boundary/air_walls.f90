! SPDX-License-Identifier: MIT
!> The immersed boundary as the air sees it: lists of the solid cells and of the wall faces, see
!> brz_wall_loop_bodies, and for the sweeps of the faces that a solid cell cuts out of the plain
!> scheme. All lists grow only, and their order is that of the grid.
module brz_air_walls
    use brz_air_boundary, only: image_at
    use brz_air_grid, only: cell_at, grid_of, grid_t
    use brz_air_state, only: air_t, bc_inside, bc_periodic, cut_t, n_ghost, wall_t
    use brz_grid_lines, only: block_of, n_blocks
    use brz_errors, only: error_t
    use brz_kinds, only: int32, int8, rk
    use brz_lists, only: at_least, running_sum
    use brz_scheme, only: reach_of
    use brz_wall_loop_bodies, only: images_along
    use brz_wall_loops, only: each_count_faces, each_image_wall, each_list_faces, each_set_wall
    implicit none
    private
    public :: set_up_walls, build_walls, list_cuts, image_of

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
    !> The wall velocities `v` must be filled afterwards: the list of cells has changed.
    subroutine build_walls(air, wall)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer(int32), allocatable :: cell(:), gas(:), rows(:), start(:)
        type(grid_t) :: grid
        type(error_t) :: none !! nothing fails on the host
        integer :: c, d, n

        grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        grid%n = wall%hi - wall%lo + 1
        grid%g = air%g + wall%lo - 1
        associate (lo => wall%lo, hi => wall%hi)
            cell = pack([(c, c=1, product(grid%n))], &
                        [wall%solid(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)) /= 0])
        end associate
        n = size(cell)
        wall%n_cells = n
        wall%index = 0
        call each_set_wall(n, grid, 1, cell, wall%solid, wall%index)
        do d = 1, 3
            call each_image_wall(images_along(grid, d), d, grid, wall%solid, wall%index)
        end do
        allocate (start(n + 1))
        call each_count_faces(n, grid, cell, wall%solid, start)
        call running_sum(.false., start, n, none, wall%n_faces)
        call at_least(.false., wall%v, 3, n, none)
        wall%v = 0
        call at_least(.false., wall%face_of, 6, n, none)
        call at_least(.false., wall%face_cell, wall%n_faces, none)
        call at_least(.false., wall%push, wall%n_faces, none)
        call at_least(.false., wall%impulse, wall%n_faces, none)
        allocate (gas(wall%n_faces), rows(wall%n_faces))
        call each_list_faces(n, grid, cell, wall%solid, start, wall%face_of, gas, rows, &
                             wall%face_cell)
        call list_cuts(air, cell, gas, rows, wall)
    end subroutine build_walls

    !> Lists for the sweeps, from those of cells and faces by number. On several processes these
    !> hold the cells around the box too, as far as lo..hi; what the sweeps meet does not.
    subroutine list_cuts(air, cell, gas, rows, wall)
        type(air_t), intent(in) :: air
        integer(int32), intent(in) :: cell(:) !! numbers of the solid cells among lo..hi
        integer(int32), intent(in) :: gas(:), rows(:) !! gas cell of each wall face, row of face_of
        type(wall_t), intent(inout) :: wall
        type(error_t) :: none !! nothing fails on the host
        integer :: c, d, f

        wall%push = 0
        wall%impulse = 0
        call at_least(.false., wall%cell, 3, wall%n_cells, none)
        call at_least(.false., wall%face, 5, wall%n_faces, none)
        associate (n => wall%hi - wall%lo + 1)
            do c = 1, wall%n_cells
                wall%cell(:, c) = cell_at(n, cell(c)) + wall%lo - 1
            end do
            do f = 1, wall%n_faces
                wall%face(:, f) = [cell_at(n, gas(f)) + wall%lo - 1, (rows(f) + 1)/2, &
                                   2*mod(rows(f), 2) - 1]
            end do
        end associate
        do d = 1, 3
            wall%cut(d)%has_solid = 0
            if (air%n(d) > 1) call list_cuts_along(air, wall, d)
        end do
    end subroutine list_cuts

    !> Cell whose state the ghost cell at position p of direction d takes.
    pure integer function image_of(air, d, p)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: p !! index of a cell along it, ghosts included

        image_of = image_at(air%n(d), air%bc(1, d), air%bc(2, d), p)
    end function image_of

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

    !> Positions of the ghosts of a line of n cells.
    pure function ghosts_of(n) result(p)
        integer, intent(in) :: n
        integer :: p(2*n_ghost), m

        p = [(m, m=1 - n_ghost, 0), (n + m, m=1, n_ghost)]
    end function ghosts_of

    !> List the faces of direction d whose stencils hold both gas and solid, sorted by block.
    subroutine list_cuts_along(air, wall, d)
        type(air_t), intent(in) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: d !! direction
        integer :: c, i, b, n, pass, m, p(2*n_ghost + 1)

        n = air%n(d)
        do pass = 1, 2
            if (pass == 1) wall%cut(d)%first = 0
            do c = 1, wall%n_cells
                if (.not. is_on_line(air, d, wall%cell(:, c))) cycle
                wall%cut(d)%has_solid(block_of(air%n, d, wall%cell(:, c))) = 1
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
    end subroutine list_cuts_along

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
end module brz_air_walls
