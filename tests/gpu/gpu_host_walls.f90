! SPDX-License-Identifier: MIT
!> Walls inside the air on the GPU that a test moves on the host: maps, lists and velocities go
!> there, impulses and the gas come back.
module gpu_host_walls
    use brz_air_device, only: air_device_t
    use brz_air_state, only: air_t, brick, wall_t
    use brz_device, only: copy_in, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real, fetch_air, mark_near_walls
    use brz_kinds, only: int64, int8
    implicit none
    private
    public :: put_walls, fetch_walls, return_cells

contains

    !> Copy the walls to the GPU after they have changed.
    subroutine put_walls(gpu, wall, face_of, err)
        type(air_device_t), intent(inout) :: gpu
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: face_of(:, :) !! (6, n_cells) wall face by side, or 0
        type(error_t), intent(inout) :: err

        associate (walls => gpu%walls)
            walls%n_cells = wall%n_cells
            walls%n_faces = wall%n_faces
            call reserve_buffer(walls%v, 3*bytes_of_real*wall%n_cells, err)
            call reserve_buffer(walls%face_of, 24_int64*wall%n_cells, err)
            call reserve_buffer(walls%push, bytes_of_real*wall%n_faces, err)
            call reserve_buffer(walls%impulse, bytes_of_real*wall%n_faces, err)
            call copy_in(wall%solid, walls%solid, size(wall%solid, kind=int64), err)
            call copy_in(wall%index, walls%index, 4*size(wall%index, kind=int64), err)
            call copy_in(face_of, walls%face_of, 24_int64*wall%n_cells, err)
            call copy_in(wall%v, walls%v, 3*bytes_of_real*wall%n_cells, err)
        end associate
        call mark_near_walls(gpu, err)
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
        integer(int8) :: awake(size(air%reached, 1), size(air%reached, 2), size(air%reached, 3))
        integer :: c, b(3)

        call copy_in(air%u, gpu%u, size(air%u, kind=int64)*bytes_of_real, err)
        call copy_out(gpu%bricks%awake, awake, size(awake, kind=int64), err)
        do c = 1, size(changed, 2)
            b = (changed(:, c) - 1)/brick + 1
            awake(b(1), b(2), b(3)) = 1
        end do
        call copy_in(awake, gpu%bricks%awake, size(awake, kind=int64), err)
    end subroutine return_cells
end module gpu_host_walls
