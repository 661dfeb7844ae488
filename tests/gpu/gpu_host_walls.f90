! SPDX-License-Identifier: MIT
!> Walls inside the air on the GPU that a test moves on the host: maps, lists and velocities go
!> there, impulses and the gas come back.
module gpu_host_walls
    use brz_air_device, only: air_device_t
    use brz_air_state, only: air_t, brick, wall_t
    use brz_device, only: copy_in, copy_out
    use brz_device_data, only: enter_data, update_device
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real, fetch_air
    use brz_kinds, only: int64, int8
    use brz_near_walls, only: mark_near_walls, see_walls
    use brz_present_table, only: attach
    implicit none
    private
    public :: put_walls, fetch_walls, return_cells

contains

    !> Copy the walls to the GPU after they have changed.
    subroutine put_walls(air, wall, face_of, err)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: face_of(:, :) !! (6, n_cells) wall face by side, or 0
        type(error_t), intent(inout) :: err

        call attach(wall%solid, air%device%walls%solid)
        call attach(wall%index, air%device%walls%index)
        call update_device(wall%solid, err)
        call update_device(wall%index, err)
        wall%face_of(:, :wall%n_cells) = face_of
        call enter_data(wall%v, err)
        call enter_data(wall%face_of, err)
        call enter_data(wall%face_cell, err)
        call enter_data(wall%push, err)
        call enter_data(wall%impulse, err)
        call see_walls(air, wall)
        call mark_near_walls(air%device, err)
    end subroutine put_walls

    !> Bring the impulses of a step to the host, and the gas.
    subroutine fetch_walls(gpu, air, wall, err)
        type(air_device_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err

        call copy_out(gpu%walls%impulse, wall%impulse, bytes_of_real*wall%n_faces, err)
        call fetch_air(gpu, air, err)
    end subroutine fetch_walls

    !> Copy the gas to the GPU, and wake the bricks of the cells that have been changed.
    subroutine return_cells(gpu, air, changed, err)
        type(air_device_t), intent(in) :: gpu
        type(air_t), intent(in) :: air
        integer, intent(in) :: changed(:, :) !! (3, n)
        type(error_t), intent(inout) :: err
        integer(int8) :: active(size(air%reached, 1), size(air%reached, 2), size(air%reached, 3))
        integer :: c, b(3)

        call copy_in(air%u, gpu%u, size(air%u, kind=int64)*bytes_of_real, err)
        call copy_out(gpu%bricks%active, active, size(active, kind=int64), err)
        do c = 1, size(changed, 2)
            b = (changed(:, c) - 1)/brick + 1
            active(b(1), b(2), b(3)) = 1
        end do
        call copy_in(active, gpu%bricks%active, size(active, kind=int64), err)
    end subroutine return_cells
end module gpu_host_walls
