! SPDX-License-Identifier: MIT
!> The solids on their way to the GPU and back.
module brz_gpu_solid_copy
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use brz_buffers, only: doubles_t, integers_t
    use brz_device, only: allocate_buffer, copy_in, copy_out, device_t, free_buffers, put_buffer
    use brz_errors, only: error_t, failed
    use brz_field_values, only: get_columns, get_marks, get_rows, set_columns, set_marks, set_rows
    use brz_gpu_solid_bodies, only: open_gpu_bodies
    use brz_gpu_solid_cohesive, only: fetch_gpu_points, open_gpu_cohesive
    use brz_gpu_solid_layout, only: at_bulk, at_wave, tag_fault
    use brz_gpu_solid_load, only: open_gpu_loads
    use brz_gpu_solid_links, only: build_gpu_links, open_gpu_links, settle_gpu_links
    use brz_gpu_solid_search, only: build_gpu_lists
    use brz_gpu_solid_state, only: bytes_of_real, column_of, gpu_solid_t, &
        open_gpu_solid_memory, tags_of, threads_of
    use brz_kinds, only: dp, int32, int64, rk
    use brz_materials, only: unloaded_speed
    use brz_ranks, only: several
    use brz_snapshots, only: snapshot_t
    use brz_solid_arrays, only: cut_blocks, number_groups
    use brz_solid_fields, only: field_t, fields_of, fields_t, in_built, in_motion, in_place, &
        in_reference, in_state, in_tag
    use brz_solid_home, only: make_room, spread_bodies
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_solid, fetch_solid, note_solid, fetch_particles, faults_of

    integer, parameter :: at_once = int(32/bytes_of_real) !! columns that take no more than rows do
    real(dp), parameter :: spare = 0.25_dp !! of the places of a body, kept free on several GPUs

contains

    !> Reserve memory on the GPU, copy the solids there and build their lists.
    subroutine open_gpu_solid(device, solid, in_air, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        logical, intent(in) :: in_air !! the air loads the bodies
        type(gpu_solid_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        integer :: b

        if (several(solid%ranks)) call spread_bodies(solid, spare)
        call open_gpu_solid_memory(device, solid, in_air .or. allocated(solid%loads%of), gpu, err)
        if (failed(err)) return
        call open_gpu_bodies(device, solid, gpu, err)
        do b = 1, size(solid%bodies)
            gpu%ledger(b) = solid%bodies(b)%ledger
            gpu%reaction(:, b) = solid%bodies(b)%reaction
        end do
        call put_fields(solid, gpu, err)
        call open_gpu_links(solid, gpu, err)
        call open_gpu_cohesive(solid%cohesive, gpu, err)
        call open_gpu_loads(solid%loads, gpu, err)
        call build_gpu_lists(gpu, solid, .false., spread(.true., 1, size(solid%bodies)), err)
        call settle_gpu_links(gpu, solid, .true.)
        call build_gpu_links(gpu, solid, err)
    end subroutine open_gpu_solid

    !> All fields of the particles, and what follows from their material.
    subroutine put_fields(solid, gpu, err)
        type(solid_t), intent(inout), target :: solid
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        type(fields_t) :: fields
        real(dp), allocatable :: rows(:, :)
        real(rk) :: wave(size(solid%materials)), bulk(size(solid%materials))
        integer :: k, lies, m

        call fields_of(solid, fields)
        allocate (rows(4, solid%n))
        do lies = in_place, in_motion
            rows = 0
            do k = 1, fields%n
                associate (field => fields%of(k))
                    if (field%lies == lies) &
                        call get_rows(field, rows(field%at:field%at + field%rows - 1, :))
                end associate
            end do
            if (lies == in_motion) then
                call copy_in(real(rows, rk), gpu%motion, 4*bytes_of_real*solid%n, err)
            else
                call copy_in(rows, rows_of(gpu, lies), 32_int64*solid%n, err)
            end if
        end do
        deallocate (rows)
        call put_columns(gpu, fields, err)
        wave = solid%materials%c_wave
        do m = 1, size(solid%materials)
            bulk(m) = unloaded_speed(solid%materials(m))
        end do
        call copy_in(of_bodies(solid, wave), column_of(gpu, at_wave), bytes_of_real*solid%n, err)
        call copy_in(of_bodies(solid, bulk), column_of(gpu, at_bulk), bytes_of_real*solid%n, err)
    end subroutine put_fields

    !> The fields that lie in columns, and the marks.
    subroutine put_columns(gpu, fields, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(fields_t), intent(in) :: fields
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: marks(:)
        real(rk), allocatable :: columns(:, :)
        integer :: first, k, n

        allocate (columns(gpu%n, at_once), marks(gpu%n))
        do k = 1, fields%n
            associate (field => fields%of(k))
                if (field%lies == in_tag) then
                    call get_marks(field, marks)
                    call copy_in(marks, tags_of(gpu, field%at), 4_int64*gpu%n, err)
                else if (field%lies == in_state) then
                    do first = 1, field%rows, at_once
                        n = min(at_once, field%rows - first + 1)
                        call get_columns(field, first, columns(:, :n))
                        call copy_in(columns, column_of(gpu, field%at + first - 1), &
                                     bytes_of_real*n*gpu%n, err)
                    end do
                end if
            end associate
        end do
    end subroutine put_columns

    !> The rows of four real64 that fields lie in.
    pure function rows_of(gpu, lies) result(buffer)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: lies
        type(doubles_t) :: buffer

        buffer = gpu%place
        if (lies == in_reference) buffer = gpu%reference
        if (lies == in_built) buffer = gpu%built
    end function rows_of

    !> A number of each material, for every particle.
    pure function of_bodies(solid, values) result(x)
        type(solid_t), intent(in) :: solid
        real(rk), intent(in) :: values(:)
        real(rk), allocatable :: x(:)
        integer :: b

        allocate (x(solid%n), source=0.0_rk)
        do b = 1, size(solid%bodies)
            x(solid%bodies(b)%first:solid%bodies(b)%last) = values(solid%bodies(b)%material)
        end do
    end function of_bodies

    !> Refresh the host's particles, if the GPU has moved on.
    subroutine fetch_solid(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (gpu%fetched .or. failed(err)) return
        call settle_bodies(gpu, solid, err)
        call fetch_fields(gpu, solid, err)
        call fetch_gpu_points(gpu, .true., solid%cohesive, err)
        gpu%fetched = .not. failed(err)
    end subroutine fetch_solid

    !> What fetch_solid reads.
    subroutine note_solid(gpu, snapshot)
        type(gpu_solid_t), intent(in) :: gpu
        type(snapshot_t), intent(inout) :: snapshot

        call snapshot%note(gpu%place)
        call snapshot%note(gpu%reference)
        call snapshot%note(gpu%built)
        call snapshot%note(gpu%motion)
        call snapshot%note(gpu%state)
        call snapshot%note(gpu%tag)
        call snapshot%note(gpu%cohesive%place)
        call snapshot%note(gpu%cohesive%damage)
        call snapshot%note(gpu%cohesive%spent)
        call snapshot%note(gpu%cohesive%held)
    end subroutine note_solid

    !> The bodies lie in the host arrays as on the GPU from now on. Only numbers of particles are
    !> fetched.
    subroutine settle_bodies(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (gpu%settled) return
        solid%bodies%first = gpu%bodies%first
        solid%bodies%last = gpu%bodies%last
        solid%bodies%rim = gpu%bodies%rim
        solid%n = gpu%n
        call make_room(solid, solid%n)
        call number_groups(solid)
        call cut_blocks(solid)
        call copy_out(gpu%id, solid%id, 4_int64*gpu%n, err)
        gpu%settled = .true.
    end subroutine settle_bodies

    !> All fields; what each copy brings lies in the same memory for a moment.
    subroutine fetch_fields(gpu, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout), target :: solid
        type(error_t), intent(inout) :: err
        type(fields_t) :: fields
        real(dp), allocatable, target :: room(:, :)
        real(rk), pointer, contiguous :: motion(:, :)
        integer :: k, lies

        call fields_of(solid, fields)
        allocate (room(4, gpu%n))
        call c_f_pointer(c_loc(room), motion, [4, gpu%n])
        do lies = in_place, in_motion
            if (lies == in_motion) then
                call copy_out(gpu%motion, motion, 4*bytes_of_real*gpu%n, err)
            else
                call copy_out(rows_of(gpu, lies), room, 32_int64*gpu%n, err)
            end if
            if (failed(err)) return
            do k = 1, fields%n
                associate (field => fields%of(k))
                    if (field%lies /= lies) cycle
                    associate (first => field%at, last => field%at + field%rows - 1)
                        if (lies == in_motion) then
                            call set_rows(field, motion(first:last, :))
                        else
                            call set_rows(field, room(first:last, :))
                        end if
                    end associate
                end associate
            end do
        end do
        do k = 1, fields%n
            call fetch_columns(gpu, fields%of(k), room, err)
        end do
    end subroutine fetch_fields

    !> A field that lies in columns, or marks.
    subroutine fetch_columns(gpu, field, room, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(field_t), intent(in) :: field
        real(dp), intent(inout), target, contiguous :: room(:, :) !! (4, n) is overwritten
        type(error_t), intent(inout) :: err
        integer(int32), pointer, contiguous :: marks(:)
        real(rk), pointer, contiguous :: columns(:, :)
        integer :: first, n

        if (field%lies == in_tag) then
            call c_f_pointer(c_loc(room), marks, [gpu%n])
            call copy_out(tags_of(gpu, field%at), marks, 4_int64*gpu%n, err)
            if (.not. failed(err)) call set_marks(field, marks)
        else if (field%lies == in_state) then
            do first = 1, field%rows, at_once
                n = min(at_once, field%rows - first + 1)
                call c_f_pointer(c_loc(room), columns, [gpu%n, n])
                call copy_out(column_of(gpu, field%at + first - 1), columns, &
                              bytes_of_real*n*gpu%n, err)
                if (.not. failed(err)) call set_columns(field, first, columns)
            end do
        end if
    end subroutine fetch_columns

    !> Refresh the motion of some particles on the host, wherever they lie there.
    subroutine fetch_particles(gpu, id, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        integer(int32), intent(in) :: id(:) !! numbers of particles
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(integers_t) :: id_at
        type(doubles_t) :: values_at
        real(dp) :: values(12, size(id))
        integer :: b, i, k

        if (gpu%fetched .or. size(id) == 0) return
        call settle_bodies(gpu, solid, err)
        call put_buffer(id, id_at, 4_int64*size(id), err)
        call allocate_buffer(values_at, 8_int64*size(values), err)
        do b = 1, size(gpu%bodies)
            call gpu%kernels%find_particles(threads_of(gpu%bodies(b)), gpu%n, &
                gpu%bodies(b)%first, gpu%bodies(b)%last, size(id), id_at, gpu%tag, gpu%place, &
                gpu%reference, gpu%motion, gpu%state, values_at, err)
        end do
        values = 0
        call copy_out(values_at, values, 8_int64*size(values), err)
        call free_buffers(id_at, values_at)
        do k = 1, size(id)
            i = place_of(solid, id(k))
            if (i == 0) cycle ! of another process
            solid%x(:, i) = values(1:3, k)
            solid%x_ref(:, i) = values(4:6, k)
            solid%v(:, i) = real(values(7:9, k), rk)
            solid%a(:, i) = real(values(10:12, k), rk)
        end do
    end subroutine fetch_particles

    !> Where a particle of this process lies on the host, else 0.
    pure integer function place_of(solid, id) result(place)
        type(solid_t), intent(in) :: solid
        integer(int32), intent(in) :: id
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                if (id < body%number(1) .or. id > body%number(2)) cycle
                place = findloc(solid%id(body%first:body%last), id, dim=1)
                if (place > 0) place = place + body%first - 1
                return
            end associate
        end do
        place = 0
    end function place_of

    !> The particles with an impossible state are noted in the blocks of the host, as its own are.
    subroutine faults_of(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: marks(:)
        integer :: k

        call fetch_solid(gpu, solid, err)
        allocate (marks(solid%n), source=0_int32)
        call copy_out(tags_of(gpu, tag_fault), marks, 4_int64*gpu%n, err)
        do k = 1, size(solid%block, 2)
            associate (first => solid%block(2, k), last => solid%block(3, k))
                solid%search%bad(k) = findloc(marks(first:last), 1, dim=1)
                if (solid%search%bad(k) > 0) &
                    solid%search%bad(k) = solid%search%bad(k) + first - 1
            end associate
        end do
    end subroutine faults_of
end module brz_gpu_solid_copy
