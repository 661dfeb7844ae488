! SPDX-License-Identifier: MIT
!> Walls and bins on the GPU: which cells hold particles, the lists of cells and faces, the
!> particles of each cell.
module brz_gpu_coupling_walls
    use brz_air_state, only: air_t
    use brz_buffers, only: from, integers_t
    use brz_cell_items, only: cells_of_a_chunk
    use brz_device, only: clear_buffer, copy_out
    use brz_coupling_box, only: is_solid
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t, mark_near_walls
    use brz_gpu_coupling_layout, only: count_covered, count_moved, n_count
    use brz_gpu_coupling_state, only: gpu_coupling_t, seen_t, size_cells, size_faces
    use brz_kinds, only: int64, int8
    implicit none
    private
    public :: look_at_particles, list_cells_of_kind, build_gpu_walls, fill_gpu_bins

contains

    !> Find the cell of each particle, and compare the map of these cells with the walls.
    subroutine look_at_particles(gpu, there, p, counts, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(seen_t), intent(in) :: p
        integer, intent(out) :: counts(n_count) !! see brz_gpu_coupling_layout
        type(error_t), intent(inout) :: err

        call clear_buffer(gpu%counts, err)
        call clear_buffer(gpu%mark, err)
        call gpu%cell_kernels%find_cell(p%n, gpu%box, 4, p%x, p%fixed, gpu%cell_of, &
                                 from(gpu%counts, int(count_moved, int64)), err)
        call gpu%cell_kernels%mark_cell(p%n, gpu%cell_of, gpu%mark, err)
        call gpu%cell_kernels%compare_cell(gpu%box%cells, gpu%box, there%walls%solid, gpu%mark, &
                                    from(gpu%counts, int(count_covered, int64)), err)
        counts = 0
        call copy_out(gpu%counts, counts, 4_int64*n_count, err)
    end subroutine look_at_particles

    !> List the cells of a kind, of which there are as many as `list` has room for; or count them.
    subroutine list_cells_of_kind(gpu, kind_of, err, list, total)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int8), intent(in) :: kind_of !! in `mark`
        type(error_t), intent(inout) :: err
        type(integers_t), intent(in), optional :: list
        integer, intent(out), optional :: total
        integer :: chunks

        chunks = (gpu%box%cells - 1)/cells_of_a_chunk + 1
        call gpu%cell_kernels%count_kind(chunks, gpu%box%cells, int(kind_of), gpu%mark, gpu%top, &
                                         err)
        call gpu%common%running_sum(gpu%top, chunks, err, total)
        if (present(list)) call gpu%cell_kernels%list_kind( &
            chunks, gpu%box%cells, int(kind_of), gpu%mark, gpu%top, list, err)
    end subroutine list_cells_of_kind

    !> Put the walls up where `mark` says; there are n solid cells. Velocities are not set.
    subroutine build_gpu_walls(gpu, there, air, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(inout) :: there
        type(air_t), intent(in) :: air
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        integer :: faces

        call size_cells(gpu, there, n, err)
        call list_cells_of_kind(gpu, is_solid, err, list=gpu%cell)
        associate (k => gpu%kernels, walls => there%walls)
            call clear_buffer(walls%solid, err)
            call clear_buffer(walls%index, err)
            call k%wall_index([n, 1, 1], n, gpu%box, gpu%cell, walls%solid, walls%index, &
                              err)
            call k%wall_images(air%n + 2*air%g, gpu%box, walls%solid, walls%index, err)
            call mark_near_walls(there, air, err)
            call k%wall_count([n, 1, 1], n, gpu%box, gpu%cell, walls%solid, gpu%start, err)
            call gpu%common%running_sum(gpu%start, n, err, faces)
            call size_faces(gpu, there, faces, err)
            call k%wall_list([n, 1, 1], n, gpu%box, gpu%cell, walls%solid, gpu%start, &
                             walls%face_of, gpu%gas, gpu%rows, walls%face_cell, err)
            call gpu%column_kernels%find_above(n, gpu%box, gpu%cell, walls%solid, walls%index, &
                                               walls%face_of, gpu%above, err)
            gpu%wall = walls
        end associate
    end subroutine build_gpu_walls

    !> Sort the particles by solid cell.
    subroutine fill_gpu_bins(gpu, there, p, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(seen_t), intent(in) :: p
        type(error_t), intent(inout) :: err
        type(integers_t) :: ends

        call clear_buffer(gpu%ends, err)
        call gpu%bin_kernels%find_home(p%n, gpu%box, gpu%cell_of, there%walls%index, &
                                       gpu%place_of, err)
        call gpu%kernels%bin_count([p%n, 1, 1], p%n, gpu%place_of, gpu%ends, err)
        ends = from(gpu%ends, 2_int64)
        call gpu%common%running_sum(ends, gpu%wall%n_cells, err)
        call gpu%kernels%bin_fill([p%n, 1, 1], p%n, gpu%place_of, gpu%ends, gpu%binned, err)
        call gpu%bin_kernels%sort_bin(gpu%wall%n_cells, p%id, gpu%ends, gpu%binned, err)
    end subroutine fill_gpu_bins
end module brz_gpu_coupling_walls
