! SPDX-License-Identifier: MIT
!> The solids on their way to the GPU and back.
module brz_gpu_solid_copy
    use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
    use brz_buffers, only: buffer_t, doubles_t, integers_t
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out, device_t, free_buffer, &
                          put_buffer
    use brz_cohesive_state, only: cohesive_t
    use brz_errors, only: error_t, failed
    use brz_field_values, only: carry_columns, carry_marks, carry_rows
    use brz_gpu_cohesive_part, only: enter_cohesive, fetch_gpu_points
    use brz_gpu_solid_bodies, only: open_gpu_bodies
    use brz_gpu_solid_layout, only: at_bulk, at_wave, flag_bad, n_flag, tag_fault
    use brz_gpu_solid_load, only: open_gpu_loads
    use brz_gpu_solid_links, only: open_gpu_links
    use brz_gpu_solid_state, only: attach_solid, bytes_of_real, column_of, open_gpu_solid_memory, &
        tags_of
    use brz_gpu_solid_tiles, only: adders_of
    use brz_solid_device, only: solid_device_t
    use brz_kinds, only: dp, int32, int64, rk
    use brz_materials, only: unloaded_speed
    use brz_particle_order, only: find_place
    use brz_present_table, only: buffer_of
    use brz_snapshots, only: snapshot_t
    use brz_solid_arrays, only: cut_blocks, number_groups
    use brz_solid_fields, only: field_t, fields_of, fields_t, in_motion, in_place, in_state, &
        in_tag
    use brz_solid_owner, only: make_room
    use brz_solid_launches, only: solid_kernels
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_solid, fetch_solid, note_solid, fetch_particles, fetch_faults, settle_bodies

    integer, parameter :: at_once = int(32/bytes_of_real) !! columns that take no more than rows do

contains

    !> Reserve memory on the GPU and copy the solids there; their lists must be built, see
    !> brz_solid_to_gpu.
    subroutine open_gpu_solid(device, solid, in_air, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        logical, intent(in) :: in_air !! the air loads the bodies
        type(error_t), intent(inout) :: err
        type(solid_device_t), pointer :: gpu
        integer :: b

        allocate (gpu)
        solid%device => gpu
        call open_gpu_solid_memory(device, solid, in_air .or. allocated(solid%loads%of), gpu, err)
        if (failed(err)) return
        call open_gpu_bodies(solid, gpu, err)
        do b = 1, size(solid%bodies)
            gpu%account(b) = solid%bodies(b)%account
            gpu%reaction(:, b) = solid%bodies(b)%reaction
        end do
        call carry_fields(gpu, solid, .true., err)
        call put_speeds(solid, gpu, err)
        call open_gpu_links(solid, gpu, err)
        if (solid%cohesive%present) call enter_cohesive(solid%cohesive, err)
        call open_gpu_loads(solid%loads, err)
        solid%on_gpu = .true.
        call attach_solid(gpu, solid)
    end subroutine open_gpu_solid

    !> What follows from the material of the particles.
    subroutine put_speeds(solid, gpu, err)
        class(bodies_t), intent(in) :: solid
        type(solid_device_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        real(rk) :: wave(size(solid%materials)), bulk(size(solid%materials))
        integer :: m

        wave = solid%materials%c_wave
        do m = 1, size(solid%materials)
            bulk(m) = unloaded_speed(solid%materials(m))
        end do
        call copy_in(of_bodies(solid, wave), column_of(gpu, at_wave), bytes_of_real*solid%n, err)
        call copy_in(of_bodies(solid, bulk), column_of(gpu, at_bulk), bytes_of_real*solid%n, err)
    end subroutine put_speeds

    !> A number of each material, for every particle.
    pure function of_bodies(solid, values) result(x)
        class(bodies_t), intent(in) :: solid
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
        type(solid_device_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (gpu%fetched .or. failed(err)) return
        call settle_bodies(gpu, solid, err)
        call carry_fields(gpu, solid, .false., err)
        call fetch_gpu_points(gpu, .true., solid%cohesive, err)
        gpu%fetched = .not. failed(err)
    end subroutine fetch_solid

    !> What fetch_solid reads.
    subroutine note_solid(gpu, cohesive, snapshot)
        type(solid_device_t), intent(in) :: gpu
        type(cohesive_t), intent(in) :: cohesive
        type(snapshot_t), intent(inout) :: snapshot

        call snapshot%note([gpu%place%buffer_t, gpu%reference%buffer_t, gpu%built%buffer_t, &
                            gpu%motion%buffer_t, gpu%state%buffer_t, gpu%tag%buffer_t])
        if (cohesive%present) call snapshot%note([buffer_of(cohesive%place), &
                                              buffer_of(cohesive%damage), &
                                              buffer_of(cohesive%spent), buffer_of(cohesive%held)])
    end subroutine note_solid

    !> The bodies lie in the host arrays where solid_t says, as on the GPU, from now on. Only
    !> numbers of particles are fetched.
    subroutine settle_bodies(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (gpu%settled) return
        call make_room(solid, solid%n)
        call attach_solid(gpu, solid)
        call number_groups(solid)
        call cut_blocks(solid)
        call copy_out(gpu%id, solid%id, 4_int64*gpu%n, err)
        gpu%settled = .true.
    end subroutine settle_bodies

    !> All fields of the particles, to the GPU or from there; what each copy takes lies in the same
    !> memory for a moment.
    subroutine carry_fields(gpu, solid, puts, err)
        type(solid_device_t), intent(in) :: gpu
        class(listed_bodies_t), intent(inout), target :: solid
        logical, intent(in) :: puts !! else they come from the GPU
        type(error_t), intent(inout) :: err
        type(fields_t) :: fields
        type(buffer_t) :: rows(in_place:in_motion)
        real(dp), allocatable, target :: room(:, :)
        real(rk), pointer, contiguous :: motion(:, :)
        integer(int64) :: bytes
        integer :: k, lies

        call fields_of(solid, fields)
        allocate (room(4, gpu%stride_d), source=0.0_dp)
        call c_f_pointer(c_loc(room), motion, [4, gpu%n])
        rows = [gpu%place%buffer_t, gpu%reference%buffer_t, gpu%built%buffer_t, gpu%motion%buffer_t]
        do lies = in_place, in_motion
            bytes = merge(4*bytes_of_real, 32_int64, lies == in_motion)*gpu%n
            if (puts) room = 0
            if (.not. puts) call copy_out(rows(lies), room, bytes, err)
            if (failed(err)) return
            do k = 1, fields%n
                associate (field => fields%of(k), first => fields%of(k)%at, &
                           last => fields%of(k)%at + fields%of(k)%rows - 1)
                    if (field%lies /= lies) cycle
                    if (lies == in_motion) then
                        call carry_rows(field, motion(first:last, :), puts)
                    else
                        call carry_rows(field, room(first:last, :gpu%n), puts)
                    end if
                end associate
            end do
            if (puts) call copy_in(room, rows(lies), bytes, err)
        end do
        do k = 1, fields%n
            call carry_field(gpu, fields%of(k), puts, room, err)
        end do
    end subroutine carry_fields

    !> A field that lies in columns, or marks.
    subroutine carry_field(gpu, field, puts, room, err)
        type(solid_device_t), intent(in) :: gpu
        type(field_t), intent(in) :: field
        logical, intent(in) :: puts
        real(dp), intent(inout), target, contiguous :: room(:, :) !! (4, n) is overwritten
        type(error_t), intent(inout) :: err
        integer(int32), pointer, contiguous :: marks(:)
        real(rk), pointer, contiguous :: columns(:, :)
        integer :: first, n

        if (field%lies == in_tag) then
            call c_f_pointer(c_loc(room), marks, [gpu%n])
            do n = 1, field%rows
                associate (there => tags_of(gpu, field%at + n - 1))
                    if (.not. puts) call copy_out(there, marks, 4_int64*gpu%n, err)
                    if (failed(err)) return
                    call carry_marks(field, n, marks, puts)
                    if (puts) call copy_in(marks, there, 4_int64*gpu%n, err)
                end associate
            end do
        else if (field%lies == in_state) then
            do first = 1, field%rows, at_once
                n = min(at_once, field%rows - first + 1)
                call c_f_pointer(c_loc(room), columns, [gpu%stride_d, n])
                associate (there => column_of(gpu, field%at + first - 1), &
                           bytes => bytes_of_real*n*gpu%stride_d)
                    if (.not. puts) call copy_out(there, columns, bytes, err)
                    if (failed(err)) return
                    call carry_columns(field, first, columns(:gpu%n, :), puts)
                    if (puts) call copy_in(columns, there, bytes, err)
                end associate
            end do
        end if
    end subroutine carry_field

    !> Refresh the motion of some particles on the host, wherever they lie there. Where one has come
    !> from another process since the host knew its particles, it hears of all anew; one that has
    !> gone to another process is forgotten.
    subroutine fetch_particles(gpu, id, place, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        integer(int32), intent(in) :: id(:) !! numbers of particles
        integer, intent(in) :: place(:) !! where they were last on the host
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: values(13, size(id))
        type(integers_t) :: tiles
        integer :: i(size(id)), k, threads(3)

        if (gpu%fetched .or. size(id) == 0) return
        call gpu%common%ask(id, 4_int64*size(id), 8_int64*size(values), err)
        call clear_buffer(gpu%common%told, err, 8_int64*size(values))
        call adders_of(gpu, 1, size(gpu%bodies), tiles, threads)
        if (threads(1) > 0) call solid_kernels%find_particles(threads, gpu%stride_d, tiles, &
            gpu%adders%sets, size(id), integers_t(gpu%common%asked), gpu%tag, gpu%place, &
            gpu%reference, gpu%motion, gpu%state, doubles_t(gpu%common%told), err)
        values = 0
        call copy_out(gpu%common%told, values, 8_int64*size(values), err)
        call settle_bodies(gpu, solid, err)
        i = places_of(solid, id, place, values(13, :) > 0)
        do k = 1, size(id)
            if (i(k) == 0) cycle ! of another process
            if (.not. values(13, k) > 0) then
                solid%id(i(k)) = 0 ! by now
                cycle
            end if
            solid%x(:, i(k)) = values(1:3, k)
            solid%x_ref(:, i(k)) = values(4:6, k)
            solid%v(:, i(k)) = real(values(7:9, k), rk)
            solid%a(:, i(k)) = real(values(10:12, k), rk)
        end do
    end subroutine fetch_particles

    !> Where particles lie on the host, 0 where it does not have one. Those of other processes are
    !> where they were last, or not there.
    pure function places_of(solid, id, place, here) result(i)
        class(bodies_t), intent(in) :: solid
        integer(int32), intent(in) :: id(:) !! numbers of particles
        integer, intent(in) :: place(:) !! where they were last
        logical, intent(in) :: here(:) !! of this process
        integer :: i(size(id)), b, k

        i = place
        do k = 1, size(id)
            if (.not. here(k)) then
                if (i(k) > solid%n) i(k) = 0
                if (i(k) > 0) i(k) = merge(i(k), 0, solid%id(i(k)) == id(k))
                cycle
            end if
            do b = 1, size(solid%bodies)
                associate (number => solid%bodies(b)%number)
                    if (id(k) >= number(1) .and. id(k) <= number(2)) &
                        call find_place(solid, b, id(k), i(k))
                end associate
            end do
        end do
    end function places_of

    !> The particles with an impossible state are noted in the blocks of the host, as its own are.
    subroutine fetch_faults(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: marks(:)
        integer :: flags(n_flag), k

        solid%search%bad = 0
        flags = 0
        call copy_out(gpu%flags, flags, 4_int64*n_flag, err)
        if (failed(err) .or. flags(flag_bad) == 0) return
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
    end subroutine fetch_faults
end module brz_gpu_solid_copy
