! SPDX-License-Identifier: MIT
!> Cell reclassification: newly covered and freshly cleared cells. The solid moved, the gas must be
!> accounted for. The operations of every step, in their order.
!>
!> Everything is a gather over cells in their own order, so the result depends neither on the order
!> of the particles nor on the number of threads; only deferred sources, which are few, are recorded
!> one by one.
module brz_reclassification_driver
    use brz_air_state, only: air_t
    use brz_air_walls, only: list_cuts
    use brz_bin_loops, only: for_each_find_home, for_each_sort_bin
    use brz_cell_loop_bodies, only: cells_of_a_chunk
    use brz_cell_loops, only: for_each_compare_row, for_each_count_kind, for_each_find_cell, &
        for_each_list_kind, for_each_mark_cell
    use brz_column_loops, only: for_each_find_above
    use brz_coupling_box, only: is_left, is_solid
    use brz_coupling_state, only: coupling_t
    use brz_coupling_driver, only: settle_cell_stores
    use brz_deferred_source_driver, only: donate, fill_cleared, settle_covered
    use brz_errors, only: error_t
    use brz_lists, only: at_least, clear_list, clear_map, count_in_bins, put_in_bins, &
        running_sum, swap
    use brz_near_walls, only: mark_near_walls, see_walls
    use brz_ranks, only: several
    use brz_scheme, only: max_var
    use brz_shared_driver, only: list_shared_faces
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_wall_loop_bodies, only: images_along
    use brz_wall_loops, only: for_each_count_faces, for_each_image_wall, for_each_list_faces, &
        for_each_set_wall
    implicit none
    private
    public :: put_up_walls, move_on, look_at_particles, fill_bins

contains

    !> Walls and bins as the particles say.
    subroutine put_up_walls(air, p, c, err)
        type(air_t), intent(inout) :: air
        class(particles_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: moved, own(2)

        call look_at_particles(p, c, moved, err)
        call find_changes(p, c, own, err)
        call build_walls(air, c, err)
        c%n_covered = 0
        c%n_cleared = 0
        call fill_bins(p, c, err)
    end subroutine put_up_walls

    !> Bring walls, cell stores and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, cell stores and deferred sources together do not change.
    subroutine move_on(air, solid, p, c, err)
        type(air_t), intent(inout) :: air
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: moved, own(2)

        call look_at_particles(p, c, moved, err)
        ! where they were sorted anew, so are the particles of a cell
        if (moved > 0 .or. solid%rebuilds /= c%rebuilds) then
            call find_changes(p, c, own, err)
            c%diagnostics%covered = c%diagnostics%covered + own(1)
            c%diagnostics%cleared = c%diagnostics%cleared + own(2)
            if (c%n_covered + c%n_cleared > 0) call change_hands(air, c, err)
            call fill_bins(p, c, err)
        end if
        c%rebuilds = solid%rebuilds
        call settle_cell_stores(air, solid, p, c, err)
    end subroutine move_on

    !> Find the air cell of each particle, and how many have changed theirs.
    subroutine look_at_particles(p, c, moved, err)
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer, intent(out) :: moved
        type(error_t), intent(inout) :: err

        moved = 0
        c%outside = 0
        call for_each_find_cell(c%on_gpu, p%n, c%box, p%wide, p%x, p%fixed, c%cell_of, moved, &
                                c%outside, err)
    end subroutine look_at_particles

    !> Compare the map of the cells that hold particles with the walls.
    subroutine find_changes(p, c, own, err)
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer, intent(out) :: own(2) !! cells of this process newly covered, cleared
        type(error_t), intent(inout) :: err

        call clear_map(c%on_gpu, c%box%cells, c%mark, err)
        call for_each_mark_cell(c%on_gpu, p%n, c%cell_of, c%mark, err)
        c%n_covered = 0
        c%n_cleared = 0
        own = 0
        call for_each_compare_row(c%on_gpu, c%box%n(2)*c%box%n(3), c%box, c%wall%solid, c%mark, &
                                  c%n_covered, c%n_cleared, own(1), own(2), err)
    end subroutine find_changes

    !> The map has changed: fill what the solid left, put the new walls up, pass the rest on.
    subroutine change_hands(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call list_kind_of(c, int(is_left), c%n_cleared, err)
        call swap(c%cleared, c%listed)
        call fill_cleared(air, c, err)
        call build_walls(air, c, err)
        call settle_covered(air, c, err)
        call donate(air, c, err)
    end subroutine change_hands

    !> List the n cells of a kind in their order.
    subroutine list_kind_of(c, kind, n, err)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: kind !! in `mark`
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        integer :: chunks

        call at_least(c%on_gpu, c%listed, n, err)
        if (n == 0) return
        chunks = (c%box%cells - 1)/cells_of_a_chunk + 1
        call at_least(c%on_gpu, c%start, chunks + 1, err)
        call for_each_count_kind(c%on_gpu, chunks, c%box%cells, kind, c%mark, c%start, err)
        call running_sum(c%on_gpu, c%start, chunks, err)
        call for_each_list_kind(c%on_gpu, chunks, c%box%cells, kind, c%mark, c%start, c%listed, err)
    end subroutine list_kind_of

    !> Put the walls up where the map says. Velocities are not set.
    subroutine build_walls(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: d, n

        call at_least(c%on_gpu, c%cell, 0, err)
        call for_each_set_wall(c%on_gpu, c%wall%n_cells, c%box%grid, 0, c%cell, c%wall%solid, &
                               c%wall%index, err)
        n = c%wall%n_cells + c%n_covered - c%n_cleared
        call list_kind_of(c, int(is_solid), n, err)
        call swap(c%cell, c%listed)
        c%wall%n_cells = n
        call for_each_set_wall(c%on_gpu, n, c%box%grid, 1, c%cell, c%wall%solid, c%wall%index, err)
        do d = 1, 3
            call for_each_image_wall(c%on_gpu, images_along(c%box%grid, d), d, c%box%grid, &
                                     c%wall%solid, c%wall%index, err)
        end do
        call at_least(c%on_gpu, c%start, n + 1, err)
        call for_each_count_faces(c%on_gpu, n, c%box%grid, c%cell, c%wall%solid, c%start, err)
        call running_sum(c%on_gpu, c%start, n, err, c%wall%n_faces)
        call size_walls(c, err)
        call for_each_list_faces(c%on_gpu, n, c%box%grid, c%cell, c%wall%solid, c%start, &
                                 c%wall%face_of, c%gas, c%rows, c%wall%face_cell, err)
        call for_each_find_above(c%on_gpu, n, c%box, c%cell, c%wall%solid, c%wall%index, &
                                 c%wall%face_of, c%above, err)
        if (c%on_gpu) then
            call see_walls(air, c%wall)
            call mark_near_walls(air%device, err)
        else
            call list_cuts(air, c%cell, c%gas, c%rows, c%wall)
        end if
        if (several(c%ranks)) call list_shared_faces(c, err)
    end subroutine build_walls

    !> Room for what is kept per solid cell and per wall face.
    subroutine size_walls(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: n

        n = c%wall%n_cells
        call at_least(c%on_gpu, c%above, 6, n, err)
        call at_least(c%on_gpu, c%excess, n, err)
        call at_least(c%on_gpu, c%stored, max_var, n, err)
        call at_least(c%on_gpu, c%wall%v, 3, n, err)
        call at_least(c%on_gpu, c%wall%face_of, 6, n, err)
        n = c%wall%n_faces
        call at_least(c%on_gpu, c%gas, n, err)
        call at_least(c%on_gpu, c%rows, n, err)
        call at_least(c%on_gpu, c%wall%face_cell, n, err)
        call at_least(c%on_gpu, c%wall%push, n, err)
        call at_least(c%on_gpu, c%wall%impulse, n, err)
        call at_least(c%on_gpu, c%surface, n, err)
        call at_least(c%on_gpu, c%weight, n, err)
        call at_least(c%on_gpu, c%force, n, err)
        call at_least(c%on_gpu, c%impedance, n, err)
    end subroutine size_walls

    !> Sort the particles by solid cell.
    subroutine fill_bins(p, c, err)
        class(particles_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: n

        n = c%wall%n_cells
        call at_least(c%on_gpu, c%ends, n + 2, err)
        call for_each_find_home(c%on_gpu, p%n, c%box, c%cell_of, c%wall%index, c%place_of, err)
        call clear_list(c%on_gpu, n + 2, c%ends, err)
        call count_in_bins(c%on_gpu, p%n, c%place_of, c%ends, err)
        call running_sum(c%on_gpu, c%ends(2:), n, err)
        call put_in_bins(c%on_gpu, p%n, c%place_of, c%ends, c%binned, err)
        call for_each_sort_bin(c%on_gpu, n, p%id, c%ends, c%binned, err)
    end subroutine fill_bins
end module brz_reclassification_driver
