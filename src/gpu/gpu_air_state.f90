! SPDX-License-Identifier: MIT
!> The air on the GPU: what it keeps there, and the way there and back.
!>
!> All fields stay on the GPU. The host arrays of `air_t` are a mirror that `fetch_air` refreshes
!> before a dump or a checkpoint, and `fetch_cells` at the places of gauges.
module brz_gpu_air_state
    use brz_air_boundary, only: beyond_wall
    use brz_air_device, only: air_device_t
    use brz_air_grid, only: column, grid_of, grid_t, place_of
    use brz_air_outside, only: keep_outside
    use brz_air_setup, only: reconstruction_names
    use brz_air_state, only: air_t, bc_periodic, set_scale, wall_t
    use brz_boxes, only: cells_t
    use brz_buffers, only: reals_t
    use brz_device, only: allocate_buffer, clear_buffer, copy_out, &
        device_t, find_kernel, put_buffer
    use brz_place_launches, only: place_kernels
    use brz_face_launches, only: face_kernels
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_kinds, only: dp, int64, int8, rk
    use brz_near_walls, only: mark_near_walls
    use brz_ranks, only: several
    use brz_present_table, only: attach, attach_bytes
    use brz_scheme, only: hllc, max_var
    use brz_snapshots, only: snapshot_t
    use brz_text, only: to_text
    implicit none
    private
    public :: open_gpu_air, go_on
    public :: fetch_air, note_air, fetch_cells, fetch_walls, bytes_of_real

    integer(int64), parameter :: bytes_of_real = storage_size(1.0_rk)/8

contains

    !> Reserve memory on the GPU and copy the air there: it is computed there from now on.
    subroutine open_gpu_air(device, air, walls, err)
        type(device_t), intent(in) :: device
        type(air_t), intent(inout) :: air
        logical, intent(in) :: walls !! bodies will be in it
        type(error_t), intent(inout) :: err
        type(air_device_t), pointer :: gpu
        integer(int64) :: cells, field, ends
        character(:), allocatable :: scheme !! its name among the kernels
        logical :: held

        allocate (gpu)
        air%device => gpu
        air%on_gpu = .true.
        gpu%grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        held = walls .or. has_wall_ends(air)
        gpu%grid%walls = merge(2, merge(1, 0, held), walls)
        cells = gpu%grid%apart
        field = cells*air%n_var*bytes_of_real
        ends = int(gpu%grid%lines, int64)*air%n_var
        call require(device, 4*field + merge(3, 1, held)*cells + 4*ends*bytes_of_real, err)
        call gpu%common%open(1, 1, err)
        scheme = trim(reconstruction_names(air%scheme%reconstruction))// &
            merge('_hllc ', '_split', air%scheme%flux == hllc)
        call find_kernel('faces_'//trim(scheme), gpu%faces, err)
        call find_kernel('march_'//trim(scheme), gpu%march, err)
        call find_kernel('last_'//trim(scheme), gpu%last, err)
        call find_kernel('redo_'//trim(scheme), gpu%redo, err)
        call allocate_buffer(gpu%flux, field, err)
        call allocate_buffer(gpu%bad, cells, err)
        call allocate_buffer(gpu%found, 8_int64, err)
        call allocate_buffer(gpu%edge, 2*ends*bytes_of_real, err)
        call allocate_buffer(gpu%leaving, 8_int64*size(air%leaving), err)
        call allocate_buffer(gpu%part, 8_int64*max(air%n(1)*air%n(2)*((air%n(3) - 1)/column + 1), &
                             (max_var + 1)*size(air%reached)), err)
        call allocate_buffer(gpu%walls%solid, merge(cells, 1_int64, walls), err)
        call allocate_buffer(gpu%walls%near, merge(cells, 1_int64, held), err)
        call open_bricks(air, gpu, err)
        call gpu%halo%open(air%part%ranks, air%part%halo, box_of(air), air%n_var, err)
        call gpu%beside%open(air%part%ranks, air%part%beside, box_of(air), 0, err)
        gpu%left_before = air%left
        call keep_outside(air)
        call set_scale(air)
        gpu%scheme = air%scheme
        gpu%rho_rest = air%rho_rest
        gpu%p_rest = air%p_rest
        call put_buffer(air%outside, gpu%outside, 2*ends*bytes_of_real, err)
        call put_buffer(air%u, gpu%u, field, err)
        call put_buffer(air%u, gpu%new, field, err)
        call put_buffer(air%u, gpu%spare, field, err)
        air%grid = gpu%grid
        call attach_air(air)
        if (.not. held) return
        if (walls) call clear_buffer(gpu%walls%solid, err)
        call mark_near_walls(gpu, err)
    end subroutine open_gpu_air

    !> Where the copies of the arrays of air_t lie.
    subroutine attach_air(air)
        type(air_t), intent(inout) :: air

        if (.not. allocated(air%edge)) allocate (air%edge, mold=air%outside)
        if (.not. allocated(air%bad)) allocate (air%bad, mold=reshape([0_int8], [1, 1, 1]))
        associate (gpu => air%device)
            call attach(air%u, gpu%u)
            call attach(air%outside, gpu%outside)
            call attach(air%edge, gpu%edge)
            call attach(air%leaving, gpu%leaving)
            call attach(air%bad, gpu%bad)
            call attach(air%found, gpu%found)
            call attach(air%rate, gpu%new)
            call attach(air%reached, gpu%bricks%reached)
            call attach(air%active, gpu%bricks%active)
            call attach(air%brick_sum, gpu%part)
            if (.not. several(air%part%ranks)) return
            call attach(air%part%reached, gpu%bricks%near_reached)
            call attach(air%part%active, gpu%bricks%near_active)
            call attach_bytes(air%part%own, 8*size(air%part%own, kind=int64), gpu%bricks%own)
        end associate
    end subroutine attach_air

    !> After a stage: the next state is that which the next stage starts from.
    subroutine go_on(air)
        type(air_t), intent(in) :: air
        type(reals_t) :: before

        associate (gpu => air%device)
            before = gpu%u
            gpu%u = gpu%new
            gpu%new = before
            if (before%address == gpu%start%address) then
                gpu%new = gpu%spare
                gpu%spare = before
            end if
            call attach(air%u, gpu%u)
            call attach(air%rate, gpu%new) ! where rates stand until it is complete
        end associate
    end subroutine go_on

    !> Cells of the whole grid that the arrays of this process hold.
    pure type(cells_t) function box_of(air) result(box)
        type(air_t), intent(in) :: air

        box = cells_t(air%before + 1 - air%g, air%before + air%n + air%g)
    end function box_of

    !> True where a boundary is a wall that needs the flux at walls.
    pure logical function has_wall_ends(air) result(has)
        type(air_t), intent(in) :: air
        integer :: d

        has = .false.
        do d = 1, 3
            if (air%n(d) == 1) cycle
            has = has .or. beyond_wall(air%scheme, air%bc(1, d), air%bc(2, d), air%n(d), 0) &
                .or. beyond_wall(air%scheme, air%bc(1, d), air%bc(2, d), air%n(d), air%n(d) + 1)
        end do
    end function has_wall_ends

    !> All bricks are active at first.
    subroutine open_bricks(air, gpu, err)
        type(air_t), intent(in) :: air
        type(air_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer(int8) :: active(size(air%reached))

        active = 1
        call put_buffer(air%reached, gpu%bricks%reached, size(active, kind=int64), err)
        call put_buffer(active, gpu%bricks%active, size(active, kind=int64), err)
        if (.not. several(air%part%ranks)) return
        associate (map => air%part%bricks, bricks => gpu%bricks)
            call allocate_buffer(bricks%near_reached, size(air%part%reached, kind=int64), err)
            call allocate_buffer(bricks%near_active, size(air%part%reached, kind=int64), err)
            call put_buffer(air%part%own, bricks%own, 8*size(active, kind=int64), err)
            call bricks%others%open(air%part%ranks, map, map%whole, 0, err)
        end associate
    end subroutine open_bricks

    !> Refuse a scene that does not fit, before anything is reserved.
    subroutine require(device, bytes, err)
        type(device_t), intent(in) :: device
        integer(int64), intent(in) :: bytes
        type(error_t), intent(inout) :: err

        if (bytes > device%free_bytes) call raise(err, exit_device, 'the air needs '// &
            to_text(int(bytes/2**20))//' MiB on the GPU, but only '// &
            to_text(int(device%free_bytes/2**20))//' MiB are free: use fewer cells, a build '// &
            'with PRECISION=mixed, or --backend cpu')
    end subroutine require

    !> Refresh the host's conserved variables and what it knows of bricks, if the GPU has moved on.
    subroutine fetch_air(gpu, air, err)
        type(air_device_t), intent(inout) :: gpu
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err

        if (gpu%fetched) return
        call copy_out(gpu%u, air%u, size(air%u, kind=int64)*bytes_of_real, err)
        call copy_out(gpu%bricks%reached, air%reached, size(air%reached, kind=int64), err)
        gpu%fetched = .not. failed(err)
    end subroutine fetch_air

    !> What fetch_air reads.
    subroutine note_air(gpu, snapshot)
        type(air_device_t), intent(in) :: gpu
        type(snapshot_t), intent(inout) :: snapshot

        call snapshot%note([gpu%u%buffer_t, gpu%bricks%reached%buffer_t])
    end subroutine note_air

    !> Refresh the host's conserved variables in a list of cells, of which those of others are left.
    subroutine fetch_cells(gpu, cell, air, err)
        type(air_device_t), intent(inout) :: gpu
        integer, intent(in) :: cell(:, :) !! (3, n) indices in the box of this process
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        integer(int64), allocatable :: place(:)
        real(rk), allocatable :: values(:, :)
        integer :: at(3, size(cell, 2)), c, n

        n = 0
        do c = 1, size(cell, 2)
            at(:, n + 1) = cell(:, c)
            if (all(at(:, n + 1) >= 1 - air%g .and. at(:, n + 1) <= air%n + air%g)) n = n + 1
        end do
        if (gpu%fetched .or. n == 0) return
        place = [(place_of(gpu%grid, at(1, c), at(2, c), at(3, c)), c=1, n)]
        allocate (values(n, air%n_var), source=0.0_rk)
        call gpu%common%ask(place, 8_int64*n, size(values)*bytes_of_real, err)
        call place_kernels%pick_reals(n, n, air%n_var, gpu%grid%apart, gpu%common%asked, gpu%u, &
                                      reals_t(gpu%common%told), err)
        call copy_out(gpu%common%told, values, size(values)*bytes_of_real, err)
        if (failed(err)) return
        do c = 1, n
            air%u(at(1, c), at(2, c), at(3, c), :) = values(c, :)
        end do
    end subroutine fetch_cells

    !> Refresh the host's map of cells without gas in some places.
    subroutine fetch_walls(gpu, cell, wall, err)
        type(air_device_t), intent(inout) :: gpu
        integer, intent(in) :: cell(:, :) !! (3, n) indices, ghosts among them
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err
        integer(int64) :: place(size(cell, 2))
        real(rk) :: row(size(cell, 2))
        integer :: c, n

        n = size(cell, 2)
        place = [(place_of(gpu%grid, cell(1, c), cell(2, c), cell(3, c)), c=1, n)]
        row = 0
        call gpu%common%ask(place, 8_int64*n, size(row)*bytes_of_real, err)
        call face_kernels%see_wall(n, gpu%common%asked, gpu%walls%solid, &
                                   reals_t(gpu%common%told), err)
        call copy_out(gpu%common%told, row, size(row)*bytes_of_real, err)
        if (failed(err)) return
        do c = 1, n
            wall%solid(cell(1, c), cell(2, c), cell(3, c)) = int(row(c), int8)
        end do
    end subroutine fetch_walls
end module brz_gpu_air_state
