! SPDX-License-Identifier: MIT
!> Walls and bins on the GPU: which cells hold particles, the lists of cells and faces, the
!> particles of each cell.
module brz_gpu_coupling_walls
    use brz_air_state, only: air_t
    use brz_buffers, only: arguments_t, buffer_t, integers_t
    use brz_device, only: clear_buffer, copy_out, launch
    use brz_coupling_box, only: is_solid
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t, mark_near_walls
    use brz_gpu_coupling_layout, only: n_count
    use brz_gpu_coupling_state, only: add_grid, column_of, gpu_coupling_t, particles_t, &
        size_cells, size_faces, tags_of
    use brz_gpu_scan, only: running_sum
    use brz_gpu_solid_layout, only: at_mass, scan_chunk, tag_fixed
    use brz_kinds, only: int64, int8
    implicit none
    private
    public :: look_at_particles, list_cells_of_kind, build_gpu_walls, fill_gpu_bins, move_gpu_walls

contains

    !> Find the cell of each particle, and compare the map of these cells with the walls.
    subroutine look_at_particles(gpu, there, particles, counts, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(particles_t), intent(in) :: particles
        integer, intent(out) :: counts(n_count) !! see brz_gpu_coupling_layout
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call clear_buffer(gpu%counts, err)
        call clear_buffer(gpu%mark, err)
        call arguments%add(particles%n)
        call arguments%add_structure(gpu%box, storage_size(gpu%box)/8)
        call arguments%add_all(particles%place, gpu%cell_of, gpu%mark, gpu%counts)
        call launch(gpu%find, [particles%n, 1, 1], arguments, err)
        arguments%n = 0
        call add_grid(gpu, there, arguments)
        call arguments%add_all(there%walls%solid, gpu%mark, gpu%counts)
        call launch(gpu%compare, gpu%box%n, arguments, err)
        counts = 0
        call copy_out(gpu%counts, counts, 4_int64*n_count, err)
    end subroutine look_at_particles

    !> List the cells of a kind, of which there are as many as `list` has room for; or count them.
    subroutine list_cells_of_kind(gpu, kind_of, err, list, total)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int8), intent(in) :: kind_of !! in `mark`
        type(error_t), intent(inout) :: err
        class(buffer_t), intent(in), optional :: list
        integer, intent(out), optional :: total
        type(arguments_t) :: arguments
        integer :: chunks

        chunks = (gpu%box%cells - 1)/scan_chunk + 1
        call arguments%add(gpu%box%cells)
        call arguments%add(int(kind_of))
        call arguments%add_all(gpu%mark, gpu%top)
        call launch(gpu%count_kind, [chunks, 1, 1], arguments, err)
        if (present(total)) then
            call running_sum(gpu%scan, gpu%top, chunks, err, total)
        else
            call running_sum(gpu%scan, gpu%top, chunks, err)
        end if
        if (.not. present(list)) return
        call arguments%add(list)
        call launch(gpu%list_kind, [chunks, 1, 1], arguments, err)
    end subroutine list_cells_of_kind

    !> Put the walls up where `mark` says; there are n solid cells. Velocities are not set.
    subroutine build_gpu_walls(gpu, there, air, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(inout) :: there
        type(air_t), intent(in) :: air
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: faces

        call size_cells(gpu, there, n, err)
        call list_cells_of_kind(gpu, is_solid, err, list=gpu%cell)
        call clear_buffer(there%walls%solid, err)
        call clear_buffer(there%walls%cell_of, err)
        call arguments%add(n)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%cell, there%walls%solid, there%walls%cell_of)
        call launch(gpu%index, [n, 1, 1], arguments, err)
        arguments%n = 0
        call add_grid(gpu, there, arguments)
        call arguments%add_all(there%walls%solid, there%walls%cell_of)
        call launch(gpu%images, air%n + 2*air%g, arguments, err)
        call mark_near_walls(there, air, err)
        arguments%n = 0
        call arguments%add(n)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%cell, there%walls%solid, gpu%start)
        call launch(gpu%count, [n, 1, 1], arguments, err)
        call running_sum(gpu%scan, gpu%start, n, err, faces)
        call size_faces(gpu, there, faces, err)
        call arguments%add_all(there%walls%face_of, gpu%gas, gpu%rows, gpu%owner)
        call launch(gpu%list, [n, 1, 1], arguments, err)
        call gpu%columns%find_above(n, gpu%box, gpu%cell, there%walls%solid, there%walls%cell_of, &
                                    there%walls%face_of, gpu%above, err)
    end subroutine build_gpu_walls

    !> Sort the particles by solid cell.
    subroutine fill_gpu_bins(gpu, there, particles, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(particles_t), intent(in) :: particles
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        type(integers_t) :: ends

        call clear_buffer(gpu%ends, err)
        call arguments%add(particles%n)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%cell_of, there%walls%cell_of, gpu%home, gpu%ends)
        call launch(gpu%bin_count, [particles%n, 1, 1], arguments, err)
        ends = gpu%ends
        ends%address = ends%address + 4
        call running_sum(gpu%scan, ends, gpu%n_cells, err)
        arguments%n = 0
        call arguments%add(particles%n)
        call arguments%add_all(gpu%home, gpu%ends, gpu%binned)
        call launch(gpu%bin_fill, [particles%n, 1, 1], arguments, err)
        arguments%n = 0
        call arguments%add(gpu%n_cells)
        call arguments%add(1)
        call arguments%add_all(ends, gpu%binned)
        call launch(gpu%bin_sort, [gpu%n_cells, 1, 1], arguments, err)
    end subroutine fill_gpu_bins

    !> Give each solid cell the mean velocity by mass of its particles, as move_walls does. The
    !> carriers must be there.
    subroutine move_gpu_walls(gpu, there, particles, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(particles_t), intent(in) :: particles
        type(error_t), intent(inout) :: err

        call gpu%velocities%mean_velocity_of(gpu%n_cells, gpu%box, 4, gpu%bodies, gpu%carrier, &
                                             gpu%ends, gpu%binned, particles%place, &
                                             particles%motion, column_of(particles, at_mass), &
                                             tags_of(particles, tag_fixed), there%walls%v, err)
    end subroutine move_gpu_walls
end module brz_gpu_coupling_walls
