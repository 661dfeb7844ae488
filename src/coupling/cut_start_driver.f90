! SPDX-License-Identifier: MIT
!> Cut cells at the start, from a checkpoint, and on their way to a GPU, which begins as from a
!> checkpoint.
module brz_cut_start_driver
    use brz_air_grid, only: nodes_along
    use brz_air_state, only: air_t, bc_symmetry, bc_wall
    use brz_bodies, only: bodies_t
    use brz_coupling_state, only: coupling_t
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_cluster_loops, only: for_each_cut_empty_shut, for_each_cut_shut_pocket
    use brz_cut_driver, only: find_clusters, find_cut_cells, find_shapes, list_members, &
        move_cut_walls, open_faces
    use brz_cut_share, only: found_by_any, share_rows
    use brz_device_data, only: enter_data
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_lists, only: clear_map, clear_reals, swap
    use brz_ranks, only: reduce_errors
    use brz_record_rules, only: w => words_of_real
    use brz_rows, only: rows_of
    implicit none
    private
    public :: set_up_cut_cells, begin_cut_cells, enter_cut_cells

contains

    !> The grid of nodes, and maps without an entry.
    subroutine set_up_cut_cells(air, c)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        integer :: n

        associate (cells => c%wall%cells)
            cells%present = .true.
            cells%nodes%whole = c%box%whole
            cells%nodes%before = c%box%before
            cells%nodes%own = c%box%own
            cells%nodes%mirrors = air%outer == bc_symmetry .and. spread(air%n > 1, 1, 2)
            cells%nodes%closed = air%outer == bc_wall .and. spread(air%n > 1, 1, 2)
            cells%nodes%cells = c%box%n
            cells%nodes%wraps = c%wraps
            cells%nodes%n = nodes_along(c%box%n, c%wraps)
            cells%nodes%dimensions = count(air%n > 1)
            cells%nodes%lo = air%lo
            cells%nodes%dx = air%dx
            cells%nodes%inverse_dx = 1/air%dx
            cells%nodes%area = real(product(air%dx)/air%dx, rk)
            cells%nodes%volume = real(product(air%dx), rk)
            cells%nodes%grid = c%box%grid
            cells%n = 0
            n = product(cells%nodes%n)
            allocate (cells%slot(n), source=0_int32)
            allocate (cells%mark(n), cells%next_mark(n), source=0_int8)
        end associate
    end subroutine set_up_cut_cells

    !> Shapes of the cut cells as the particles say, and gas as they leave room for it or, from a
    !> checkpoint, as `before` has it.
    subroutine begin_cut_cells(air, solid, bodies, p, c, err)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid !! particles of this process
        class(bodies_t), intent(in) :: bodies !! bodies of those that it sees
        class(bodies_t), intent(in) :: p !! these particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call clear_map(c%on_gpu, size(c%wall%solid), c%wall%solid, err)
        associate (held => c%wall%cells%before)
            if (c%on_gpu .and. c%wall%cells%resumes) then
                call enter_data(held%cell, err)
                call enter_data(held%volume, err)
                call enter_data(held%kept, err)
                call enter_data(held%shut, err)
                call enter_data(held%master, err)
            end if
        end associate
        c%wall%cells%rebuilds = -1
        call find_cut_cells(air, solid, p, c, err)
        call find_shapes(p, c, err)
        call reduce_errors(c%ranks, err) ! of others the list would be another
        if (failed(err)) return
        if (c%wall%cells%resumes) then
            call resume_volumes(c, err)
        else
            call start_volumes(c, err)
        end if
        call reduce_errors(c%ranks, err) ! all go on to messages, or none
        if (failed(err)) return
        call move_cut_walls(air, bodies, p, c, 0.0_dp, err)
    end subroutine begin_cut_cells

    !> Volume of the gas at the start, on the host: what geometry leaves room for, none in pockets.
    subroutine start_volumes(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: pockets, pass
        integer, parameter :: most = 20 !! shutting a pocket may leave another

        associate (g => c%on_gpu, l => c%wall%cells)
            do pass = 1, most
                l%volume(:l%n) = l%gas(:l%n)
                call find_clusters(c, err)
                pockets = 0
                call for_each_cut_shut_pocket(g, l%n, l%place, l%master, l%ends, l%member, &
                                              l%volume, l%gas, l%shut, pockets, err)
                if (.not. found_by_any(c%ranks, pockets)) exit
                call share_gas(c, err)
                call open_faces(c, 0, err)
            end do
            l%v(:, :l%n) = 0
            l%carrier(:l%n) = 0
            l%kept(:, :l%n) = 0
            l%swept(:l%n) = 0
            l%impulse(:, :l%n) = 0
        end associate
    end subroutine start_volumes

    !> What room the gas has in the boxes of others, none in pockets.
    subroutine share_gas(c, err)
        type(coupling_t), intent(inout), target :: c
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells)
            call share_rows(c%wall%share, [rows_of(g, l%gas, w), rows_of(g, l%shut, 1)], err)
        end associate
    end subroutine share_gas

    !> Volumes and clusters as a checkpoint has them.
    subroutine resume_volumes(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells, held => c%wall%cells%before, &
                   n => c%wall%cells%n)
            l%resumes = .false.
            if (held%n /= n) then ! the list has those of the checkpoint, and no others
                call raise(err, exit_deck, 'the checkpoint has other cut cells than its particles')
                return
            end if
            call swap(l%volume, held%volume)
            call swap(l%kept, held%kept)
            call swap(l%shut, held%shut)
            call swap(l%master, held%master)
            call for_each_cut_empty_shut(g, n, l%shut, l%gas, err)
            call clear_reals(g, n, l%swept, err)
            call clear_reals(g, 3*n, l%impulse, err)
        end associate
        call open_faces(c, 0, err)
        call list_members(c, err)
    end subroutine resume_volumes

    !> Keep what a checkpoint has of the list, and give the maps copies on the GPU; begin_cut_cells
    !> does the rest there.
    subroutine enter_cut_cells(cells, err)
        type(cut_cells_t), intent(inout) :: cells !! of the host
        type(error_t), intent(inout) :: err

        associate (held => cells%before, n => cells%n)
            held%n = n
            held%cell = cells%cell(:n)
            held%volume = cells%volume(:n)
            held%kept = cells%kept(:, :n)
            held%shut = cells%shut(:n)
            held%master = cells%master(:n)
        end associate
        cells%resumes = .true.
        cells%n = 0
        cells%slot = 0
        call enter_data(cells%slot, err)
        call enter_data(cells%mark, err)
        call enter_data(cells%next_mark, err)
    end subroutine enter_cut_cells
end module brz_cut_start_driver
