! SPDX-License-Identifier: MIT
!> Walls inside the air on the GPU, while the host moves them: maps and lists go there when the
!> solid has changed cells, velocities before a step; impulses come back after it. So do the cells
!> near the walls, between which and the bodies the host hands gas over.
module brz_gpu_air_walls
    use brz_air_state, only: air_t, bc_periodic, wall_t
    use brz_buffers, only: arguments_t, buffer_t, bytes_t
    use brz_device, only: allocate_buffer, copy_in, copy_out, free_buffer, &
        launch, reserve_buffer
    use brz_air_grid, only: place_of
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: add_grid, bytes_of_real, gather, gpu_air_t, gpu_walls_t, &
        mark_near_walls
    use brz_kinds, only: int64, int8, rk
    implicit none
    private
    public :: put_walls, put_wall_velocity, fetch_walls, fetch_map, return_cells

contains

    !> Copy the walls to the GPU after they have changed.
    subroutine put_walls(gpu, air, wall, face_of, reach, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: face_of(:, :) !! (6, n_cells) wall face by side, or 0
        integer, intent(in) :: reach !! cells around a surface that the host may look at
        type(error_t), intent(inout) :: err

        call copy_in(wall%solid, gpu%walls%solid, size(wall%solid, kind=int64), err)
        call copy_in(wall%index, gpu%walls%cell_of, 4*size(wall%index, kind=int64), err)
        call size_lists(gpu%walls, wall, err)
        call copy_in(face_of, gpu%walls%face_of, 24_int64*wall%n_cells, err)
        call mark_near_walls(gpu, air, err)
        call list_shared(gpu%walls, air, wall, face_of, reach)
        call put_places(gpu, air%n_var, err)
    end subroutine put_walls

    !> Make room for the lists of walls.
    subroutine size_lists(walls, wall, err)
        type(gpu_walls_t), intent(inout) :: walls
        type(wall_t), intent(in) :: wall
        type(error_t), intent(inout) :: err

        walls%n_cells = wall%n_cells
        walls%n_faces = wall%n_faces
        call reserve_buffer(walls%v, 3*bytes_of_real*wall%n_cells, err)
        call reserve_buffer(walls%face_of, 24_int64*wall%n_cells, err)
        call reserve_buffer(walls%push, bytes_of_real*wall%n_faces, err)
        call reserve_buffer(walls%impulse, bytes_of_real*wall%n_faces, err)
    end subroutine size_lists

    !> List the cells around the surfaces.
    subroutine list_shared(walls, air, wall, face_of, reach)
        type(gpu_walls_t), intent(inout) :: walls
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: face_of(:, :)
        integer, intent(in) :: reach !! cells
        integer(int8), allocatable :: mark(:, :, :)
        integer :: c, d, i, j, k, n, around(3), to(3)

        allocate (mark(air%n(1), air%n(2), air%n(3)), source=0_int8)
        around = merge(reach, 0, air%n > 1)
        do c = 1, wall%n_cells
            if (.not. any(face_of(:, c) > 0)) cycle
            do k = -around(3), around(3)
                do j = -around(2), around(2)
                    do i = -around(1), around(1)
                        to = wall%cell(:, c) + [i, j, k]
                        do d = 1, 3
                            if (air%bc(1, d) == bc_periodic) to(d) = modulo(to(d) - 1, air%n(d)) + 1
                        end do
                        if (any(to < 1 .or. to > air%n)) cycle
                        mark(to(1), to(2), to(3)) = 1
                    end do
                end do
            end do
        end do
        n = count(mark /= 0)
        if (allocated(walls%shared)) deallocate (walls%shared)
        allocate (walls%shared(3, n))
        n = 0
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    if (mark(i, j, k) == 0) cycle
                    n = n + 1
                    walls%shared(:, n) = [i, j, k]
                end do
            end do
        end do
    end subroutine list_shared

    !> Keep the places of the shared cells on the GPU, and room for their state.
    subroutine put_places(gpu, n_var, err)
        type(gpu_air_t), intent(inout) :: gpu
        integer, intent(in) :: n_var
        type(error_t), intent(inout) :: err
        integer(int64), allocatable :: place(:)
        integer :: c, n

        n = size(gpu%walls%shared, 2)
        allocate (place(n))
        do c = 1, n
            place(c) = place_of(gpu%grid, gpu%walls%shared(1, c), gpu%walls%shared(2, c), &
                gpu%walls%shared(3, c))
        end do
        call reserve_buffer(gpu%walls%place_at, 8_int64*n, err)
        call reserve_buffer(gpu%walls%values_at, bytes_of_real*n_var*n, err)
        call copy_in(place, gpu%walls%place_at, 8_int64*n, err)
        if (allocated(gpu%walls%values)) deallocate (gpu%walls%values)
        allocate (gpu%walls%values(n, n_var))
    end subroutine put_places

    !> Copy the velocities of the walls, before a step.
    subroutine put_wall_velocity(gpu, wall, err)
        type(gpu_air_t), intent(in) :: gpu
        type(wall_t), intent(in) :: wall
        type(error_t), intent(inout) :: err

        call copy_in(wall%v, gpu%walls%v, 3*bytes_of_real*wall%n_cells, err)
    end subroutine put_wall_velocity

    !> Bring the impulses of a step to the host, and the cells near the walls.
    subroutine fetch_walls(gpu, air, wall, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err
        integer :: c

        call copy_out(gpu%walls%impulse, wall%impulse, bytes_of_real*wall%n_faces, err)
        associate (cell => gpu%walls%shared, values => gpu%walls%values)
            if (size(cell, 2) == 0) return
            call gather(gpu, gpu%walls%place_at, gpu%walls%values_at, values, err)
            if (failed(err)) return
            do c = 1, size(cell, 2)
                air%u(cell(1, c), cell(2, c), cell(3, c), :) = values(c, :)
            end do
        end associate
    end subroutine fetch_walls

    !> Refresh the host's map of solid cells in a box.
    subroutine fetch_map(gpu, low, high, wall, err)
        type(gpu_air_t), intent(in) :: gpu
        integer, intent(in) :: low(3), high(3) !! corners
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err
        type(bytes_t) :: row
        integer(int8) :: marks(high(1) - low(1) + 1)
        integer :: j, k

        do k = low(3), high(3)
            do j = low(2), high(2)
                row = gpu%walls%solid
                row%address = row%address + place_of(gpu%grid, low(1), j, k) - 1
                marks = 0
                call copy_out(row, marks, size(marks, kind=int64), err)
                wall%solid(low(1):high(1), j, k) = marks
            end do
        end do
    end subroutine fetch_map

    !> Copy the cells near the walls to the GPU, and some more that the host has changed.
    subroutine return_cells(gpu, air, more, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(in) :: air
        integer, intent(in) :: more(:, :) !! (3, n) cells
        type(error_t), intent(inout) :: err
        type(buffer_t) :: place_at, values_at
        real(rk) :: values(size(more, 2), air%n_var)
        integer(int64) :: place(size(more, 2))
        integer :: c

        associate (cell => gpu%walls%shared)
            do c = 1, size(cell, 2)
                gpu%walls%values(c, :) = air%u(cell(1, c), cell(2, c), cell(3, c), :)
            end do
        end associate
        call scatter(gpu, gpu%walls%place_at, gpu%walls%values_at, gpu%walls%values, err)
        if (size(more, 2) == 0) return
        do c = 1, size(more, 2) ! few, and seldom
            place(c) = place_of(gpu%grid, more(1, c), more(2, c), more(3, c))
            values(c, :) = air%u(more(1, c), more(2, c), more(3, c), :)
        end do
        call allocate_buffer(place_at, 8_int64*size(more, 2), err)
        call allocate_buffer(values_at, size(values)*bytes_of_real, err)
        call copy_in(place, place_at, 8_int64*size(more, 2), err)
        call scatter(gpu, place_at, values_at, values, err)
        call free_buffer(place_at)
        call free_buffer(values_at)
    end subroutine return_cells

    !> Copy the state of cells whose places are on the GPU there.
    subroutine scatter(gpu, place_at, values_at, values, err)
        type(gpu_air_t), intent(in) :: gpu
        type(buffer_t), intent(in) :: place_at, values_at
        real(rk), intent(in), contiguous :: values(:, :) !! (n, n_var)
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: n

        n = size(values, 1)
        if (n == 0) return
        call copy_in(values, values_at, size(values, kind=int64)*bytes_of_real, err)
        call arguments%add(n)
        call add_grid(gpu, arguments)
        call arguments%add(place_at)
        call arguments%add(values_at)
        call arguments%add(gpu%u)
        call arguments%add(gpu%bricks%awake)
        call launch(gpu%walls%scatter, [n, 1, 1], arguments, err)
    end subroutine scatter
end module brz_gpu_air_walls
