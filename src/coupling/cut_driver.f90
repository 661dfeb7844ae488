! SPDX-License-Identifier: MIT
!> Cut cells, an embedded boundary: list, shapes, clusters and loads, the operations in their order.
module brz_cut_driver
    use brz_air_grid, only: rest_t
    use brz_air_state, only: air_t
    use brz_bin_loops, only: for_each_sort_bin
    use brz_cell_loop_bodies, only: cells_of_a_chunk
    use brz_cell_loops, only: for_each_count_kind, for_each_list_kind
    use brz_coupling_device, only: diag_at, diag_work
    use brz_coupling_state, only: coupling_t
    use brz_cut_cells, only: at_corner, cut_cells_t, layers_t
    use brz_cut_cluster_loops, only: for_each_cut_adopt, for_each_cut_follow, &
        for_each_cut_mean_state, for_each_cut_point, for_each_cut_weigh
    use brz_cut_curvature_loops, only: for_each_cut_find_curvature, for_each_cut_find_normal, &
        for_each_cut_find_sag, for_each_cut_smooth_fill
    use brz_cut_motion_loops, only: for_each_cut_find_carrier, for_each_cut_find_push, &
        for_each_cut_sum_load, &
        for_each_cut_sum_push, for_each_cut_sweep, for_each_cut_tame, for_each_cut_wall_velocity
    use brz_cut_list_loops, only: for_each_cut_cell_of, for_each_cut_find_beside, &
        for_each_cut_find_home, for_each_cut_mark, for_each_cut_mark_listed, &
        for_each_cut_mark_unsettled, for_each_cut_set_slot, for_each_cut_start_ring, &
        for_each_cut_unite_marks, for_each_cut_widen, for_each_cut_widen_ring
    use brz_cut_load_loops, only: for_each_cut_bear, for_each_cut_bear_push, for_each_cut_feel, &
        for_each_cut_find_bearing, for_each_cut_load_particle, for_each_cut_record
    use brz_cut_node_loops, only: for_each_cut_fill_corner, for_each_cut_fill_node, &
        for_each_cut_find_ball, &
        for_each_cut_find_distance, for_each_cut_find_largest, for_each_cut_find_thickest, &
        for_each_cut_search_octant, for_each_cut_see_fill, for_each_cut_widen_thickness
    use brz_cut_push_loops, only: for_each_cut_push_corner, for_each_cut_push_node, &
        for_each_cut_push_particle
    use brz_cut_share, only: list_shared, share_marks, share_masters, share_rows
    use brz_cut_shape_loops, only: for_each_cut_close, for_each_cut_open, for_each_cut_shape
    use brz_cut_stress_loops, only: for_each_cut_stress_particle, for_each_cut_sum_lines
    use brz_cut_whereabouts_loops, only: for_each_cut_hash
    use brz_driven_body_driver, only: put_driven_bodies
    use brz_driven_body_motion, only: foresee_driven_bodies, read_driven_bodies
    use brz_driven_body_rules, only: carries_all, carries_none, n_push
    use brz_errors, only: error_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_lists, only: at_least, clear_list, clear_map, count_in_bins, put_in_bins, running_sum, &
        swap
    use brz_near_walls, only: see_cut_cells
    use brz_ranks, only: several
    use brz_record_rules, only: w => words_of_real
    use brz_rows, only: rows_of, rows_t
    use brz_scheme, only: max_var
    use brz_solid_sleep, only: all_asleep
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: find_cut_cells, find_shapes, mix_clusters, press_by_cut_cells, &
        stress_by_cut_cells, feel_loads, &
        move_cut_walls, load_cut_carriers, open_faces, find_clusters, list_members

    integer, parameter :: in_turn = 3 !! pointers that are followed
    integer, parameter :: adoptions = 2 !! times that small clusters join larger ones
    real(rk), parameter :: negligible = 1e-9_rk !! load of a particle, of the reference on a face

contains

    !> List the cells near particles and sort these into them. The list is another where a particle
    !> of any process has left its cell, or places have changed.
    subroutine find_cut_cells(air, solid, p, c, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid !! particles of this process
        class(bodies_t), intent(in) :: p !! those that it sees
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: moved
        logical :: renewed

        associate (cells => c%wall%cells)
            moved = 0
            call for_each_cut_cell_of(c%on_gpu, p%n, cells%nodes, p%wide, p%x, p%fixed, c%cell_of, &
                                      moved, err)
            if (several(c%ranks)) call count_moved(p, c, moved, err)
            renewed = moved > 0 .or. solid%rebuilds /= cells%rebuilds
            cells%rebuilds = solid%rebuilds
            if (renewed) then
                call list_cut_cells(p%n, c, cells, err)
                if (c%on_gpu) call see_cut_cells(air%device, cells, err)
            else if (.not. several(c%ranks)) then
                return
            end if
            ! copies of particles may have got other places
            call at_least(c%on_gpu, cells%home, p%n, err)
            call at_least(c%on_gpu, cells%binned, p%n, err)
            call at_least(c%on_gpu, cells%radius, p%n, err)
            call at_least(c%on_gpu, cells%change, 3, p%n, err)
            call for_each_cut_find_home(c%on_gpu, p%n, c%cell_of, cells%slot, cells%home, err)
            call clear_list(c%on_gpu, cells%n + 2, cells%bin_ends, err)
            call count_in_bins(c%on_gpu, p%n, cells%home, cells%bin_ends, err)
            call running_sum(c%on_gpu, cells%bin_ends(2:), cells%n, err)
            call put_in_bins(c%on_gpu, p%n, cells%home, cells%bin_ends, cells%binned, err)
            call for_each_sort_bin(c%on_gpu, cells%n, p%id, cells%bin_ends, cells%binned, err)
        end associate
    end subroutine find_cut_cells

    !> Has a particle of any process left its cell of the grid? Told by sums of hashes of numbers
    !> and cells: places, and the processes that see a particle, change between two lists.
    subroutine count_moved(p, c, moved, err)
        class(bodies_t), intent(in) :: p !! particles, whose cells are known
        type(coupling_t), intent(inout) :: c
        integer, intent(out) :: moved !! 0: none has
        type(error_t), intent(inout) :: err
        real(dp) :: sums(2)

        call for_each_cut_hash(c%on_gpu, p%n, c%ranks, c%wall%cells%nodes, c%cell_of, p%id, sums, &
                               err)
        moved = merge(1, 0, any(abs(sums - c%wall%cells%whereabouts) > 0))
        c%wall%cells%whereabouts = sums
    end subroutine count_moved

    !> The list of the cells within `near` cells of a particle.
    subroutine list_cut_cells(particles, c, cells, err)
        integer, intent(in) :: particles !! that this process sees
        type(coupling_t), intent(inout) :: c
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err
        integer :: chunks, d, found, n

        if (cells%n > 0) call for_each_cut_set_slot(c%on_gpu, cells%n, cells%nodes, 0, cells%cell, &
                                                    cells%slot, cells%place, err)
        n = product(cells%nodes%n)
        call clear_map(c%on_gpu, n, cells%mark, err)
        call for_each_cut_mark(c%on_gpu, particles, c%cell_of, cells%mark, err)
        do d = 1, 3
            call for_each_cut_widen(c%on_gpu, n, cells%nodes, d, cells%mark, cells%next_mark, err)
            call swap(cells%mark, cells%next_mark)
        end do
        if (cells%resumes) then
            call for_each_cut_mark_listed(c%on_gpu, cells%before%n, cells%before%cell, cells%mark, &
                                          err)
        else if (cells%n > 0) then
            found = 0
            associate (old => cells%before)
                call for_each_cut_mark_unsettled(c%on_gpu, cells%n, cells%nodes, cells%cell, &
                    cells%place, old%volume, old%swept, old%kept, cells%mark, cells%next_mark, &
                    found, err)
            end associate
            if (found > 0) call for_each_cut_unite_marks(c%on_gpu, n, cells%next_mark, &
                                                         cells%mark, err)
        end if
        if (several(c%ranks)) call share_marks(c%wall%share, cells, cells%mark, err)
        chunks = (n - 1)/cells_of_a_chunk + 1
        call at_least(c%on_gpu, c%start, chunks + 1, err)
        call for_each_count_kind(c%on_gpu, chunks, n, 1, cells%mark, c%start, err)
        call running_sum(c%on_gpu, c%start, chunks, err, cells%n)
        call size_list(c%on_gpu, cells, err)
        call for_each_list_kind(c%on_gpu, chunks, n, 1, cells%mark, c%start, cells%cell, err)
        call for_each_cut_set_slot(c%on_gpu, cells%n, cells%nodes, 1, cells%cell, cells%slot, &
                                   cells%place, err)
        call for_each_cut_find_beside(c%on_gpu, cells%n, cells%nodes, cells%cell, cells%slot, &
                                      cells%place, cells%beside, err)
        call list_shared(c%wall%share, cells, err)
    end subroutine list_cut_cells

    !> Room for what is kept per entry.
    subroutine size_list(on_gpu, cells, err)
        logical, intent(in) :: on_gpu
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err
        integer :: n

        n = max(cells%n, 1) ! what has no room has no copy
        call at_least(on_gpu, cells%cell, n, err)
        call at_least(on_gpu, cells%place, n, err)
        call at_least(on_gpu, cells%beside, 6, n, err)
        call at_least(on_gpu, cells%sums, 8*at_corner, n, err)
        call at_least(on_gpu, cells%top, 8, n, err)
        call at_least(on_gpu, cells%fill, n, err)
        call at_least(on_gpu, cells%mass, n, err)
        call at_least(on_gpu, cells%momentum, 3, n, err)
        call at_least(on_gpu, cells%above, 3, n, err)
        call at_least(on_gpu, cells%from_low, 3, n, err)
        call at_least(on_gpu, cells%faces, 6, n, err)
        call at_least(on_gpu, cells%deeper, 6, n, err)
        call at_least(on_gpu, cells%in_line, 6, n, err)
        call at_least(on_gpu, cells%heaviest, n, err)
        call at_least(on_gpu, cells%moment, 3, n, err)
        call at_least(on_gpu, cells%carrier, n, err)
        call at_least(on_gpu, cells%turns, 3, n, err)
        call at_least(on_gpu, cells%kept, max_var + 1, n, err)
        call at_least(on_gpu, cells%pushes, 24, n, err)
        call at_least(on_gpu, cells%smooth, n, err)
        call at_least(on_gpu, cells%next_smooth, n, err)
        call at_least(on_gpu, cells%normal, 3, n, err)
        call at_least(on_gpu, cells%sag, n, err)
        call at_least(on_gpu, cells%curvature, 6, n, err)
        call at_least(on_gpu, cells%octants, 8, n, err)
        call at_least(on_gpu, cells%distance, n, err)
        call at_least(on_gpu, cells%thickest, n, err)
        call at_least(on_gpu, cells%thickness, n, err)
        call at_least(on_gpu, cells%ball, n, err)
        call at_least(on_gpu, cells%force, 3, n, err)
        call at_least(on_gpu, cells%impedance, 3, n, err)
        call at_least(on_gpu, cells%press, 3, n, err)
        call at_least(on_gpu, cells%give, 3, n, err)
        call at_least(on_gpu, cells%bearing, n, err)
        call at_least(on_gpu, cells%gas, n, err)
        call at_least(on_gpu, cells%shut, n, err)
        call at_least(on_gpu, cells%aperture, 6, n, err)
        call at_least(on_gpu, cells%middle, 3, n, err)
        call at_least(on_gpu, cells%area, 3, n, err)
        call at_least(on_gpu, cells%ring, n, err)
        call at_least(on_gpu, cells%next_ring, n, err)
        call at_least(on_gpu, cells%v, 3, n, err)
        call at_least(on_gpu, cells%volume, n, err)
        call at_least(on_gpu, cells%held, n, err)
        call at_least(on_gpu, cells%swept, n, err)
        call at_least(on_gpu, cells%master, n, err)
        call at_least(on_gpu, cells%next_master, n, err)
        call at_least(on_gpu, cells%ends, n + 2, err)
        call at_least(on_gpu, cells%member, n, err)
        call at_least(on_gpu, cells%rate, max_var, n, err)
        call at_least(on_gpu, cells%joined, max_var, n, err)
        call at_least(on_gpu, cells%euler, max_var, n, err)
        call at_least(on_gpu, cells%push, 3, n, err)
        call at_least(on_gpu, cells%impulse, 3, n, err)
        call at_least(on_gpu, cells%bin_ends, n + 2, err)
    end subroutine size_list

    !> Shapes of the listed cells from the particles.
    subroutine find_shapes(p, c, err)
        class(bodies_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout), target :: c
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call for_each_cut_fill_corner(g, 8*l%n, nodes, p%wide, p%stride_w, l%cell, l%bin_ends, &
                l%binned, p%x, p%v, p%mass, p%volume, l%sums, l%top, err)
            call for_each_cut_fill_node(g, l%n, nodes, l%cell, l%slot, l%sums, l%top, l%fill, &
                                        l%mass, l%above, l%heaviest, l%momentum, err)
            call for_each_cut_see_fill(g, p%n, nodes, p%wide, l%home, l%cell, l%slot, p%x, l%fill, &
                                       l%radius, err)
            call for_each_cut_find_thickest(g, l%n, l%bin_ends, l%binned, l%radius, l%thickest, &
                                            err)
            call for_each_cut_widen_thickness(g, l%n, nodes, l%cell, l%slot, l%thickest, &
                                              l%thickness, err)
            call for_each_cut_find_ball(g, p%n, nodes, p%stride_w, l%home, p%volume, l%thickness, &
                                        l%radius, err)
            call for_each_cut_find_largest(g, l%n, l%bin_ends, l%binned, l%radius, l%ball, err)
            call find_sags(g, l, err)
            call for_each_cut_search_octant(g, 8*l%n, nodes, p%wide, l%cell, l%slot, l%bin_ends, &
                l%binned, p%x, l%radius, l%ball, l%fill, l%sag, l%octants, err)
            call for_each_cut_find_distance(g, l%n, l%octants, l%distance, err)
            call share_rows(c%wall%share, [rows_of(g, l%distance, w)], err)
            call for_each_cut_shape(g, l%n, nodes, l%cell, l%place, l%slot, l%distance, l%gas, &
                                    l%middle, l%shut, err)
            call for_each_cut_find_bearing(g, l%n, nodes, l%cell, l%place, l%slot, l%mass, &
                                           l%bearing, err)
        end associate
        call open_faces(c, 1, err)
    end subroutine find_shapes

    !> How far facets lie inside curved walls, from the fill of the nodes.
    subroutine find_sags(on_gpu, l, err)
        logical, intent(in) :: on_gpu
        type(cut_cells_t), intent(inout) :: l
        type(error_t), intent(inout) :: err

        call for_each_cut_smooth_fill(on_gpu, l%n, l%nodes, 1, l%cell, l%slot, l%fill, l%smooth, &
                                      err)
        call for_each_cut_smooth_fill(on_gpu, l%n, l%nodes, 2, l%cell, l%slot, l%smooth, &
                                      l%next_smooth, err)
        call for_each_cut_smooth_fill(on_gpu, l%n, l%nodes, 3, l%cell, l%slot, l%next_smooth, &
                                      l%smooth, err)
        call for_each_cut_find_normal(on_gpu, l%n, l%nodes, l%cell, l%slot, l%smooth, l%normal, err)
        call for_each_cut_find_sag(on_gpu, l%n, l%nodes, l%cell, l%slot, l%normal, l%sag, err)
    end subroutine find_sags

    !> Open shares and wall areas of cells that are shut or not.
    subroutine open_faces(c, seal, err)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: seal !! 1: shut cells without an open face, 0: leave them
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call for_each_cut_open(g, l%n, nodes, l%cell, l%place, l%slot, l%beside, l%distance, &
                                   l%shut, l%aperture, err)
            call for_each_cut_close(g, l%n, seal, nodes, l%place, l%aperture, l%gas, l%shut, &
                l%area, &
                                    c%wall%solid, err)
        end associate
    end subroutine open_faces

    !> Masters of all listed cells, and the members of their clusters.
    subroutine find_clusters(c, err)
        type(coupling_t), intent(inout), target :: c
        type(error_t), intent(inout) :: err
        integer :: m

        associate (g => c%on_gpu, l => c%wall%cells)
            call for_each_cut_weigh(g, l%n, l%gas, l%volume, l%held, err)
            call for_each_cut_point(g, l%n, l%nodes, l%cell, l%beside, l%aperture, &
                                     l%held, l%master, err)
            call follow_pointers(g, l, err)
            do m = 1, adoptions
                call for_each_cut_adopt(g, l%n, l%nodes, l%cell, l%beside, l%aperture, l%held, &
                    l%master, &
                    l%next_master, &
                                        err)
                call swap(l%master, l%next_master)
                call follow_pointers(g, l, err)
            end do
            call share_masters(c%wall%share, l, err)
        end associate
        call list_members(c, err)
    end subroutine find_clusters

    !> Members of all clusters, from their masters.
    subroutine list_members(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells)
            call clear_list(g, l%n + 2, l%ends, err)
            call count_in_bins(g, l%n, l%master, l%ends, err)
            call running_sum(g, l%ends(2:), l%n, err)
            call put_in_bins(g, l%n, l%master, l%ends, l%member, err)
            if (g) call for_each_sort_bin(g, l%n, l%cell, l%ends, l%member, err)
        end associate
    end subroutine list_members

    !> Follow the pointers to their end.
    subroutine follow_pointers(on_gpu, cells, err)
        logical, intent(in) :: on_gpu
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err
        integer :: m

        do m = 1, in_turn
            call for_each_cut_follow(on_gpu, cells%n, cells%master, cells%next_master, err)
            call swap(cells%master, cells%next_master)
        end do
    end subroutine follow_pointers

    !> One state for all cells of a cluster; shut cells hold gas at rest, which nobody reads.
    subroutine mix_clusters(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        type(rest_t) :: rest

        rest%u = air%rest
        rest%momentum = 0
        associate (l => c%wall%cells)
            call for_each_cut_mean_state(c%on_gpu, l%n, l%nodes, rest, l%place, l%master, l%ends, &
                                         l%member, l%volume, air%u, err)
        end associate
    end subroutine mix_clusters

    !> Velocities of the walls: at the step, for how long it may be; with dt in the middle of it,
    !> from what the gas does to rigid bodies, and what they sweep.
    subroutine move_cut_walls(air, solid, p, c, dt, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(in) :: p !! their particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air, 0: not known yet [s]
        type(error_t), intent(inout) :: err

        if (.not. dt > 0) then
            call read_driven_bodies(solid, c%driven)
            c%bodies = size(c%driven)
            call put_driven_bodies(c, err)
            call survey_walls(c%on_gpu, c%wall%cells, err)
        else
            call push_carriers(air, solid, c, dt, err)
            call push_nodes(air, p, c, dt, err)
        end if
        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            if (.not. dt > 0) call for_each_cut_find_carrier(g, l%n, nodes, c%bodies, c%driven, &
                p%wide, l%cell, l%slot, l%area, l%mass, l%heaviest, p%fixed, p%x, l%carrier, &
                l%turns, err)
            call for_each_cut_wall_velocity(g, l%n, nodes, c%bodies, c%driven, l%cell, l%slot, &
                                            l%area, l%middle, l%mass, l%momentum, l%carrier, &
                                            l%turns, l%v, err)
            if (.not. dt > 0) then
                call share_walls(c, .false., err)
                return
            end if
            call for_each_cut_tame(g, l%n, nodes, real(dt, rk), l%place, l%shut, l%master, l%ends, &
                                   l%member, l%volume, l%area, l%v, l%slowed, err)
            call for_each_cut_sweep(g, l%n, nodes, real(dt, rk), l%shut, l%gas, l%volume, l%area, &
                                    l%v, l%swept, err)
        end associate
        call share_walls(c, .true., err)
    end subroutine move_cut_walls

    !> How far the listed cells are from walls, and how these are curved.
    subroutine survey_walls(on_gpu, l, err)
        logical, intent(in) :: on_gpu
        type(cut_cells_t), intent(inout) :: l
        type(error_t), intent(inout) :: err
        integer :: d

        call for_each_cut_start_ring(on_gpu, l%n, l%area, l%ring, err)
        do d = 1, 3
            call for_each_cut_widen_ring(on_gpu, l%n, l%nodes, d, l%cell, l%slot, l%ring, &
                                         l%next_ring, err)
            call swap(l%ring, l%next_ring)
        end do
        call for_each_cut_find_curvature(on_gpu, l%n, l%nodes, l%cell, l%slot, l%ring, l%normal, &
                                         l%curvature, err)
    end subroutine survey_walls

    !> Velocities of the walls in the boxes of others, and what they sweep.
    subroutine share_walls(c, swept, err)
        type(coupling_t), intent(inout), target :: c
        logical, intent(in) :: swept !! they have moved
        type(error_t), intent(inout) :: err
        type(rows_t) :: rows(2)

        associate (g => c%on_gpu, l => c%wall%cells)
            rows = [rows_of(g, l%v, 3*w), rows_of(g, l%swept, w)]
            call share_rows(c%wall%share, rows(:merge(2, 1, swept)), err)
        end associate
    end subroutine share_walls

    !> Bring the nodes whose particles nothing carries to the middle of the coming step.
    subroutine push_nodes(air, p, c, dt, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(error_t), intent(inout) :: err

        if (all(c%driven%carries == carries_all)) return
        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call for_each_cut_find_push(g, l%n, nodes, air%scheme, c%reference_pressure, l%place, &
                                        l%shut, l%area, l%v, l%carrier, air%u, l%press, l%give, err)
            call for_each_cut_bear_push(g, l%n, nodes, l%cell, l%slot, l%ring, l%mass, &
                                        l%bearing, l%press, l%give, l%force, l%impedance, err)
        end associate
        if (several(c%ranks)) then
            associate (before => c%ghosts%v_before, seat => c%part%seat)
                call push_particles(p, c, dt, before, seat, err)
            end associate
        else
            call push_particles(p, c, dt, c%v_before, p%id, err)
        end if
    end subroutine push_nodes

    !> The same by their particles, where the velocity of one a step ago is a column of v_before.
    subroutine push_particles(p, c, dt, v_before, column, err)
        class(bodies_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        real(rk), intent(in) :: v_before(:, :) !! [m/s]
        integer(int32), intent(in) :: column(:) !! of each particle in it
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call for_each_cut_push_particle(g, p%n, nodes, c%bodies, real(dt, rk), &
                real(c%dt_before, rk), c%driven, p%wide, p%stride_d, p%stride_p, l%home, l%cell, &
                l%slot, l%ring, p%x, p%v, p%mass, p%fixed, p%load, v_before, column, l%mass, &
                l%force, l%impedance, l%change, err)
            call for_each_cut_push_corner(g, 8*l%n, nodes, p%wide, l%cell, l%ring, l%bin_ends, &
                                          l%binned, p%x, l%change, l%pushes, err)
            call for_each_cut_push_node(g, l%n, nodes, l%cell, l%slot, l%ring, l%sums, &
                                        l%pushes, l%momentum, err)
        end associate
    end subroutine push_particles

    !> Bring the bodies that carry particles to the middle of the coming step.
    subroutine push_carriers(air, solid, c, dt, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        real(dp), intent(in) :: dt !! of the coming step of the air [s]
        type(error_t), intent(inout) :: err
        real(dp) :: push(n_push, size(c%driven))
        integer :: b

        if (all(c%driven%carries == carries_none)) return
        push = 0
        associate (l => c%wall%cells)
            do b = 1, c%bodies
                if (c%driven(b)%carries /= carries_all) cycle
                call for_each_cut_sum_push(c%on_gpu, l%n, c%ranks, b, l%nodes, air%scheme, &
                    c%reference_pressure, c%driven(b), l%cell, l%place, l%shut, l%area, l%middle, &
                    l%v, l%carrier, l%turns, air%u, push(:, b), err)
            end do
        end associate
        call foresee_driven_bodies(solid, push, dt, c%driven)
        call put_driven_bodies(c, err)
    end subroutine push_carriers

    !> Force and torque of the air on the bodies that carry particles.
    subroutine load_cut_carriers(solid, c, load, err)
        class(bodies_t), intent(in) :: solid !! bodies, and their particles
        type(coupling_t), intent(inout) :: c
        real(dp), intent(out) :: load(6, c%bodies) !! [N], [N m]
        type(error_t), intent(inout) :: err
        integer :: b

        load = 0
        associate (l => c%wall%cells)
            do b = 1, size(solid%bodies)
                if (c%driven(b)%carries == carries_none) cycle
                associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                    call for_each_cut_sum_load(c%on_gpu, last - first + 1, c%ranks, first, &
                        l%nodes, c%driven(b), solid%wide, solid%fixed, l%home, l%cell, l%slot, &
                        solid%x, solid%mass, l%mass, l%force, l%moment, load(:, b), err)
                end associate
            end do
        end associate
    end subroutine load_cut_carriers

    !> Loads of all particles from the impulses on the walls, and the diagnostics.
    subroutine press_by_cut_cells(p, c, dt, err)
        class(bodies_t), intent(inout) :: p !! particles
        type(coupling_t), intent(inout), target :: c
        real(dp), intent(in) :: dt !! step of the air [s]
        type(error_t), intent(inout) :: err
        real(dp) :: work(2), given(3), taken(3)

        work = 0
        given = 0
        taken = 0
        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call share_rows(c%wall%share, [rows_of(g, l%impulse, 3*w)], err)
            call for_each_cut_record(g, l%n, nodes, dt, c%reference_pressure, l%cell, l%area, &
                                     l%v, l%impulse, work, given, taken, &
                                     diag_at(c%device, diag_work), err)
            call for_each_cut_bear(g, l%n, nodes, dt, c%reference_pressure, l%cell, l%slot, &
                l%ring, l%mass, l%bearing, l%area, l%middle, l%impulse, l%force, l%from_low, &
                l%faces, l%moment, err)
            call for_each_cut_load_particle(g, p%n, nodes, p%wide, p%stride_d, p%stride_p, l%home, &
                                            l%cell, l%slot, l%ring, p%x, p%mass, l%mass, l%force, &
                                            p%load, err)
        end associate
        c%diagnostics%work = c%diagnostics%work + work(1)
        c%diagnostics%work_reference = c%diagnostics%work_reference + work(2)
        c%diagnostics%impulse = c%diagnostics%impulse + given
        c%diagnostics%impulse_reference = c%diagnostics%impulse_reference + taken
    end subroutine press_by_cut_cells

    !> Stress that the loads bring to the faces of bodies, after press_by_cut_cells.
    subroutine stress_by_cut_cells(solid, p, c, err)
        class(bodies_t), intent(in) :: solid !! its bodies
        class(bodies_t), intent(inout) :: p !! its particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        type(layers_t) :: layers
        integer :: b

        if (.not. allocated(solid%face_stress) .or. all_asleep(solid)) return
        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call for_each_cut_sum_lines(g, l%n, nodes, l%cell, l%slot, l%ring, l%force, &
                                        l%from_low, l%faces, l%deeper, l%in_line, err)
            do b = 1, size(solid%bodies)
                if (.not. solid%bodies(b)%face_share > 0 .or. solid%bodies(b)%inactive) cycle
                associate (first => p%bodies(b)%first, last => p%bodies(b)%last)
                    layers%apart = solid%bodies(b)%spacing/solid%bodies(b)%stretch
                    call for_each_cut_stress_particle(g, last - first + 1, first, nodes, &
                        solid%bodies(b)%face_share, layers, p%wide, p%stride_d, p%stride_t, &
                        l%home, l%cell, l%slot, l%ring, p%x, l%fill, l%distance, l%mass, l%above, &
                        l%force, l%from_low, l%faces, l%deeper, l%in_line, p%face_stress, err)
                end associate
            end do
        end associate
    end subroutine stress_by_cut_cells

    !> Which bodies that sleep have a load beyond rounding on one of their particles.
    subroutine feel_loads(solid, c, err)
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        real(rk) :: least
        integer :: b

        least = negligible*c%reference_pressure*minval(c%wall%cells%nodes%area, c%box%n > 1)
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%inactive) cycle
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                call for_each_cut_feel(c%on_gpu, last - first + 1, first, solid%stride_d, &
                                       solid%stride_p, least, solid%load, c%felt(b:), err)
            end associate
        end do
    end subroutine feel_loads
end module brz_cut_driver
