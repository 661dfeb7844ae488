! SPDX-License-Identifier: MIT
!> Cell reclassification: newly covered and freshly cleared cells. The solid moved, the gas must be
!> accounted for. The operations of every step, in their order; scripts/steps.py writes the same for
!> the GPU.
!>
!> Everything is a gather over cells in their own order, so the result depends neither on the order
!> of the particles nor on the number of threads; only debts, which are few, are booked one by one.
module brz_event_steps
    use brz_air_state, only: air_t
    use brz_air_walls, only: list_cuts !@cpu
    use brz_bin_loops, only: each_find_home, each_sort_bin
    use brz_cell_items, only: cells_of_a_chunk
    use brz_cell_loops, only: each_compare_row, each_count_kind, each_find_cell, each_list_kind, &
        each_mark_cell
    use brz_column_loops, only: each_find_above
    use brz_coupling_box, only: is_left, is_solid
    use brz_coupling_state, only: coupling_t
    use brz_coupling_steps, only: settle_ledgers
    use brz_debt_steps, only: donate, fill_uncovered, settle_covered
    use brz_lists, only: at_least, clear_list, clear_map, count_in_bins, put_in_bins, &
        running_sum, swap
    use brz_ranks, only: several
    use brz_scheme, only: max_var
    use brz_shared_steps, only: list_shared_faces
    use brz_solid_state, only: solid_t
    use brz_wall_items, only: images_along
    use brz_wall_loops, only: each_count_faces, each_image_wall, each_list_faces, &
        each_set_wall
    implicit none
    private
    public :: put_up_walls, move_on, look_at_particles, fill_bins

contains

    !> Walls and bins as the particles say.
    subroutine put_up_walls(air, p, c)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        integer :: moved, own(2)

        call look_at_particles(p, c, moved)
        call find_changes(p, c, own)
        call build_walls(air, c)
        c%n_covered = 0
        c%n_uncovered = 0
        call fill_bins(p, c)
    end subroutine put_up_walls

    !> Bring walls, ledgers and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, ledgers and debts together do not change.
    subroutine move_on(air, solid, p, c)
        type(air_t), intent(inout) :: air
        class(solid_t), intent(in) :: solid !! its bodies
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer :: moved, own(2)

        call look_at_particles(p, c, moved)
        ! where they were sorted anew, so are the particles of a cell
        if (moved > 0 .or. solid%rebuilds /= c%rebuilds) then
            call find_changes(p, c, own)
            c%books%covered = c%books%covered + own(1)
            c%books%uncovered = c%books%uncovered + own(2)
            if (c%n_covered + c%n_uncovered > 0) call change_hands(air, c)
            call fill_bins(p, c)
        end if
        c%rebuilds = solid%rebuilds
        call settle_ledgers(air, solid, p, c)
    end subroutine move_on

    !> Find the air cell of each particle, and how many have changed theirs.
    subroutine look_at_particles(p, c, moved)
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer, intent(out) :: moved

        !@gpu call clear_buffer(c%counts)
        moved = 0
        c%outside = 0
        call each_find_cell(p%n, c%box, p%wide, p%x, p%fixed, c%cell_of, moved, &
                            c%outside) !@gpu count_moved
    end subroutine look_at_particles

    !> Compare the map of the cells that hold particles with the walls.
    subroutine find_changes(p, c, own)
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer, intent(out) :: own(2) !! cells of this process newly covered, uncovered

        call clear_map(c%box%cells, c%mark)
        call each_mark_cell(p%n, c%cell_of, c%mark)
        c%n_covered = 0
        c%n_uncovered = 0
        own = 0
        call each_compare_row(c%box%n(2)*c%box%n(3), c%box, c%wall%solid, c%mark, c%n_covered, &
                              c%n_uncovered, own(1), own(2)) !@gpu count_covered
    end subroutine find_changes

    !> The map has changed: fill what the solid left, put the new walls up, pass the rest on.
    subroutine change_hands(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c

        call list_kind_of(c, int(is_left), c%n_uncovered)
        call swap(c%uncovered, c%listed)
        call fill_uncovered(air, c)
        call build_walls(air, c)
        call settle_covered(air, c)
        call donate(air, c)
    end subroutine change_hands

    !> List the n cells of a kind in their order.
    subroutine list_kind_of(c, kind, n)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: kind !! in `mark`
        integer, intent(in) :: n
        integer :: chunks

        call at_least(c%listed, n)
        if (n == 0) return
        chunks = (c%box%cells - 1)/cells_of_a_chunk + 1
        call at_least(c%start, chunks + 1)
        call each_count_kind(chunks, c%box%cells, kind, c%mark, c%start)
        call running_sum(c%start, chunks)
        call each_list_kind(chunks, c%box%cells, kind, c%mark, c%start, c%listed)
    end subroutine list_kind_of

    !> Put the walls up where the map says. Velocities are not set.
    subroutine build_walls(air, c)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        integer :: d, n

        call at_least(c%cell, 0)
        call each_set_wall(c%wall%n_cells, c%box%grid, 0, c%cell, c%wall%solid, c%wall%index)
        n = c%wall%n_cells + c%n_covered - c%n_uncovered
        call list_kind_of(c, int(is_solid), n)
        call swap(c%cell, c%listed)
        c%wall%n_cells = n
        call each_set_wall(n, c%box%grid, 1, c%cell, c%wall%solid, c%wall%index)
        do d = 1, 3
            call each_image_wall(images_along(c%box%grid, d), d, c%box%grid, c%wall%solid, &
                                 c%wall%index)
        end do
        call at_least(c%start, n + 1)
        call each_count_faces(n, c%box%grid, c%cell, c%wall%solid, c%start)
        call running_sum(c%start, n, c%wall%n_faces)
        call size_walls(c)
        call each_list_faces(n, c%box%grid, c%cell, c%wall%solid, c%start, c%wall%face_of, &
                             c%gas, c%rows, c%wall%face_cell)
        call each_find_above(n, c%box, c%cell, c%wall%solid, c%wall%index, c%wall%face_of, c%above)
        call list_cuts(air, c%cell, c%gas, c%rows, c%wall) !@cpu
        !@gpu air%walls = c%wall
        !@gpu call mark_near_walls(air)
        if (several(c%ranks)) call list_shared_faces(c)
    end subroutine build_walls

    !> Room for what is kept per solid cell and per wall face.
    subroutine size_walls(c)
        type(coupling_t), intent(inout) :: c
        integer :: n

        n = c%wall%n_cells
        call at_least(c%above, 6, n)
        call at_least(c%excess, n)
        call at_least(c%ledger, max_var, n)
        call at_least(c%wall%v, 3, n)
        call at_least(c%wall%face_of, 6, n)
        n = c%wall%n_faces
        call at_least(c%gas, n)
        call at_least(c%rows, n)
        call at_least(c%wall%face_cell, n)
        call at_least(c%wall%push, n)
        call at_least(c%wall%impulse, n)
        call at_least(c%surface, n)
        call at_least(c%weight, n)
        call at_least(c%force, n)
        call at_least(c%impedance, n)
    end subroutine size_walls

    !> Sort the particles by solid cell.
    subroutine fill_bins(p, c)
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer :: n

        n = c%wall%n_cells
        call at_least(c%ends, n + 2)
        call each_find_home(p%n, c%box, c%cell_of, c%wall%index, c%place_of)
        call clear_list(n + 2, c%ends)
        call count_in_bins(p%n, c%place_of, c%ends)
        call running_sum(c%ends(2:), n)
        call put_in_bins(p%n, c%place_of, c%ends, c%binned)
        call each_sort_bin(n, p%id, c%ends, c%binned)
    end subroutine fill_bins
end module brz_event_steps
