! SPDX-License-Identifier: MIT
!> What the air on a GPU knows of the walls in it: where the copies of their arrays are, and which
!> cells are near them.
module brz_near_walls
    use brz_air_device, only: air_device_t
    use brz_air_launches, only: air_kernels
    use brz_air_state, only: air_t, wall_t
    use brz_buffers, only: integers_t
    use brz_cell_loop_bodies, only: cells_of_a_chunk
    use brz_cell_launches, only: cell_kernels
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_list_launches, only: cut_list_kernels
    use brz_device, only: reserve_buffer
    use brz_errors, only: error_t
    use brz_kinds, only: int64
    use brz_present_table, only: buffer_of, on_device
    implicit none
    private
    public :: see_walls, see_cut_cells, mark_near_walls

contains

    !> Walls have been built anew: note where all is that the kernels of the air read of them.
    subroutine see_walls(air, wall)
        type(air_t), intent(in) :: air !! on a GPU
        type(wall_t), intent(in) :: wall !! its arrays have copies there

        associate (walls => air%device%walls)
            walls%n_cells = wall%n_cells
            walls%n_faces = wall%n_faces
            walls%solid%buffer_t = buffer_of(wall%solid)
            walls%index%buffer_t = buffer_of(wall%index)
            walls%v%buffer_t = buffer_of(wall%v)
            walls%face_of%buffer_t = buffer_of(wall%face_of)
            walls%face_cell%buffer_t = buffer_of(wall%face_cell)
            walls%push%buffer_t = buffer_of(wall%push)
            walls%impulse%buffer_t = buffer_of(wall%impulse)
        end associate
    end subroutine see_walls

    !> Cut cells have been listed anew: the sweeps leave these to rates of their own.
    subroutine see_cut_cells(gpu, cells, err)
        type(air_device_t), intent(in) :: gpu
        type(cut_cells_t), intent(in) :: cells !! its arrays have copies on the GPU
        type(error_t), intent(inout) :: err

        call cut_list_kernels%cut_set_near(product(cells%nodes%n), cells%nodes, &
            integers_t(address=on_device(cells%slot)), gpu%walls%near, err)
    end subroutine see_cut_cells

    !> Mark and list the cells beside walls, once the map of solid cells is there.
    subroutine mark_near_walls(gpu, err)
        type(air_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: cells, chunks

        call air_kernels%air_near(gpu%grid%n, gpu%grid, gpu%scheme, gpu%walls%solid, &
                                  gpu%walls%near, gpu%bricks%reached, err)
        cells = int(gpu%grid%apart)
        chunks = (cells - 1)/cells_of_a_chunk + 1
        call reserve_buffer(gpu%near_before, 4_int64*(chunks + 1), err)
        call cell_kernels%count_kind(chunks, cells, 1, gpu%walls%near, gpu%near_before, err)
        call gpu%common%running_sum(gpu%near_before, chunks, err, gpu%n_near)
        call reserve_buffer(gpu%near_at, 4_int64*gpu%n_near, err)
        call cell_kernels%list_kind(chunks, cells, 1, gpu%walls%near, gpu%near_before, &
                                    gpu%near_at, err)
    end subroutine mark_near_walls
end module brz_near_walls
