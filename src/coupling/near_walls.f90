! SPDX-License-Identifier: MIT
!> Which cells of the air on a GPU the sweeps leave to others: those at walls at the ends of lines,
!> and cut ones.
module brz_near_walls
    use brz_air_device, only: air_device_t
    use brz_air_launches, only: air_kernels
    use brz_buffers, only: integers_t
    use brz_cell_loop_bodies, only: cells_of_a_chunk
    use brz_cell_launches, only: cell_kernels
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_list_launches, only: cut_list_kernels
    use brz_device, only: reserve_buffer
    use brz_errors, only: error_t
    use brz_kinds, only: int64
    use brz_present_table, only: on_device
    implicit none
    private
    public :: see_cut_cells, mark_near_walls

contains

    !> Cut cells have been listed anew: the sweeps leave these to rates of their own.
    subroutine see_cut_cells(gpu, cells, err)
        type(air_device_t), intent(in) :: gpu
        type(cut_cells_t), intent(in) :: cells !! its arrays have copies on the GPU
        type(error_t), intent(inout) :: err

        call cut_list_kernels%cut_set_near(product(cells%nodes%n), cells%nodes, &
            integers_t(address=on_device(cells%slot)), gpu%walls%near, err)
    end subroutine see_cut_cells

    !> Mark and list the cells at walls at the ends of lines.
    subroutine mark_near_walls(gpu, err)
        type(air_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: cells, chunks

        call air_kernels%air_near(gpu%grid%n, gpu%grid, gpu%scheme, gpu%walls%near, err)
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
