! SPDX-License-Identifier: MIT
!> The solids on their way to the GPU and back.
module brz_gpu_solid_copy
    use brz_device, only: allocate_buffer, arguments_t, buffer_t, copy_in, copy_out, device_t, &
        free_buffer, launch
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_bodies, only: open_gpu_bodies
    use brz_gpu_solid_cohesive, only: fetch_gpu_points, open_gpu_cohesive
    use brz_gpu_solid_layout, only: at_accel, at_bulk, at_damage, at_energy, at_hist, at_mass, &
        at_mu, at_stress, at_wave, tag_bond, tag_cut, tag_fault, tag_fixed, tag_id, tag_joined, &
        tag_ply, tag_support
    use brz_gpu_solid_links, only: build_gpu_links, open_gpu_links
    use brz_gpu_solid_search, only: build_gpu_lists
    use brz_gpu_solid_state, only: bytes_of_real, gpu_solid_t, open_gpu_solid_memory, part_of
    use brz_kinds, only: dp, int16, int32, int64, int8, real32, rk
    use brz_materials, only: unloaded_speed
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_solid, fetch_solid, fetch_particles, faults_of

contains

    !> Reserve memory on the GPU, copy the solids there and build their lists.
    subroutine open_gpu_solid(device, solid, in_air, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        logical, intent(in) :: in_air !! the air loads the bodies
        type(gpu_solid_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        integer :: b

        call open_gpu_solid_memory(device, solid, in_air, gpu, err)
        if (failed(err)) return
        call open_gpu_bodies(device, solid, gpu, err)
        do b = 1, size(solid%bodies)
            gpu%ledger(b) = solid%bodies(b)%ledger
            gpu%reaction(:, b) = solid%bodies(b)%reaction
        end do
        call put_rows(solid, gpu, err)
        call put_columns(solid, gpu, err)
        call open_gpu_links(device, solid, gpu, err)
        call open_gpu_cohesive(device, solid%cohesive, gpu, err)
        call build_gpu_lists(gpu, solid, .false., spread(.true., 1, size(solid%bodies)), err)
        call build_gpu_links(gpu, solid, .true., err)
    end subroutine open_gpu_solid

    subroutine put_rows(solid, gpu, err)
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        real(rk), allocatable :: motion(:, :)

        call put_places(solid%x, gpu%place, .false.)
        call put_places(solid%x_ref, gpu%reference, allocated(solid%tilt))
        call put_places(solid%x_built, gpu%built, .false.)
        allocate (motion(4, solid%n))
        motion(1:3, :) = solid%v
        motion(4, :) = solid%volume
        call copy_in(motion, gpu%motion, size(motion, kind=int64)*bytes_of_real, err)

    contains

        subroutine put_places(x, buffer, tilted)
            real(dp), intent(in) :: x(:, :)
            type(buffer_t), intent(in) :: buffer
            logical, intent(in) :: tilted !! tilts, not lengths, go with them
            real(dp), allocatable :: place(:, :)

            allocate (place(4, solid%n), source=0.0_dp)
            place(1:3, :) = x
            if (size(solid%h) > 0) place(4, :) = solid%h
            if (tilted) place(4, :) = solid%tilt
            call copy_in(place, buffer, 32_int64*solid%n, err)
        end subroutine put_places
    end subroutine put_rows

    subroutine put_columns(solid, gpu, err)
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        real(rk) :: wave(size(solid%materials)), bulk(size(solid%materials))
        integer :: b, c

        call put(at_mu, solid%mu)
        call put(at_energy, solid%energy)
        call put(at_damage, solid%damage)
        call put(at_mass, solid%mass)
        do c = 1, 6
            call put(at_stress + c, solid%stress(c, :))
        end do
        do c = 1, 3
            call put(at_accel + c, solid%a(c, :))
        end do
        do c = 1, solid%n_hist
            call put(at_hist + c, solid%hist(c, :))
        end do
        wave = solid%materials%c_wave
        do b = 1, size(solid%materials)
            bulk(b) = unloaded_speed(solid%materials(b))
        end do
        call put(at_wave, of_bodies(solid, wave))
        call put(at_bulk, of_bodies(solid, bulk))
        call put_tag(tag_id, solid%id)
        call put_tag(tag_ply, int(solid%ply, int32))
        call put_tag(tag_support, int(solid%support, int32))
        call put_tag(tag_fixed, int(solid%fixed, int32))
        call put_tag(tag_cut, int(solid%cut, int32))
        do c = 1, merge(3, 0, gpu%load > 0)
            call put(gpu%load + c, solid%load(c, :))
        end do
        if (gpu%owed > 0) call put(gpu%owed, solid%owed)
        if (.not. gpu%linked) return
        call put(gpu%touch, real(solid%links%touch, rk))
        call put(gpu%weight, real(solid%links%weight, rk))
        call put_tag(tag_bond, int(solid%links%bond, int32))
        if (allocated(solid%links%joined)) call put_tag(tag_joined, solid%links%joined)

    contains

        subroutine put(column, values)
            integer, intent(in) :: column
            real(rk), intent(in) :: values(:)

            call copy_in(values, column_of(gpu, column), bytes_of_real*solid%n, err)
        end subroutine put

        subroutine put_tag(column, values)
            integer, intent(in) :: column
            integer(int32), intent(in) :: values(:)

            call copy_in(values, part_of(gpu%tag, 4_int64*(column - 1)*solid%n), &
                         4_int64*solid%n, err)
        end subroutine put_tag
    end subroutine put_columns

    pure function column_of(gpu, column) result(rest)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column !! of `state`
        type(buffer_t) :: rest

        rest = part_of(gpu%state, (column - 1)*bytes_of_real*gpu%n)
    end function column_of

    !> A number of each material, for every particle.
    pure function of_bodies(solid, values) result(x)
        type(solid_t), intent(in) :: solid
        real(rk), intent(in) :: values(:)
        real(rk), allocatable :: x(:)
        integer :: b

        allocate (x(solid%n))
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
        call fetch_rows(gpu, solid, err)
        call fetch_columns(gpu, solid, err)
        call fetch_gpu_points(gpu, .true., solid%cohesive, err)
        gpu%fetched = .not. failed(err)
    end subroutine fetch_solid

    subroutine fetch_rows(gpu, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        call fetch_places(gpu, gpu%place, solid%x, err)
        call fetch_places(gpu, gpu%reference, solid%x_ref, err)
        call fetch_places(gpu, gpu%built, solid%x_built, err)
        call fetch_velocities(gpu, solid, err)
    end subroutine fetch_rows

    subroutine fetch_places(gpu, buffer, x, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(buffer_t), intent(in) :: buffer
        real(dp), intent(inout) :: x(:, :)
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: place(:, :)

        allocate (place(4, gpu%n))
        call copy_out(buffer, place, 32_int64*gpu%n, err)
        x = place(1:3, :)
    end subroutine fetch_places

    subroutine fetch_velocities(gpu, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(rk), allocatable :: motion(:, :)

        allocate (motion(4, gpu%n))
        call copy_out(gpu%motion, motion, size(motion, kind=int64)*bytes_of_real, err)
        solid%v = motion(1:3, :)
        solid%volume = motion(4, :)
    end subroutine fetch_velocities

    subroutine fetch_columns(gpu, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(rk), allocatable :: x(:)
        integer(int32), allocatable :: marks(:)
        integer :: c

        allocate (x(solid%n), marks(solid%n))
        call fetch(at_mu, solid%mu)
        call fetch(at_energy, solid%energy)
        call fetch(at_damage, solid%damage)
        call fetch(at_mass, solid%mass)
        do c = 1, 6
            call fetch(at_stress + c, x)
            solid%stress(c, :) = x
        end do
        do c = 1, 3
            call fetch(at_accel + c, x)
            solid%a(c, :) = x
        end do
        do c = 1, solid%n_hist
            call fetch(at_hist + c, x)
            solid%hist(c, :) = x
        end do
        do c = 1, merge(3, 0, gpu%load > 0)
            call fetch(gpu%load + c, x)
            solid%load(c, :) = x
        end do
        call fetch_tag(gpu, tag_id, solid%id, err)
        call fetch_tag(gpu, tag_ply, marks, err)
        solid%ply = int(marks, int16)
        call fetch_tag(gpu, tag_support, marks, err)
        solid%support = int(marks, int16)
        call fetch_tag(gpu, tag_fixed, marks, err)
        solid%fixed = int(marks, int8)
        call fetch_tag(gpu, tag_cut, marks, err)
        solid%cut = int(marks, int8)
        if (gpu%owed > 0) call fetch(gpu%owed, solid%owed)
        if (.not. gpu%linked) return
        call fetch(gpu%touch, x)
        solid%links%touch = real(x, real32)
        call fetch(gpu%weight, x)
        solid%links%weight = real(x, real32)
        call fetch_tag(gpu, tag_bond, marks, err)
        solid%links%bond = int(marks, int8)
        if (allocated(solid%links%joined)) call fetch_tag(gpu, tag_joined, solid%links%joined, err)

    contains

        subroutine fetch(column, values)
            integer, intent(in) :: column
            real(rk), intent(inout) :: values(:)

            call copy_out(column_of(gpu, column), values, bytes_of_real*solid%n, err)
        end subroutine fetch
    end subroutine fetch_columns

    !> Refresh the motion of some particles on the host, wherever they lie there.
    subroutine fetch_particles(gpu, id, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer(int32), intent(in) :: id(:) !! numbers of particles
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        type(buffer_t) :: id_at, values_at
        type(arguments_t) :: arguments
        real(dp) :: values(12, size(id))
        integer :: i, k

        if (gpu%fetched .or. size(id) == 0) return
        call allocate_buffer(id_at, 4_int64*size(id), err)
        call allocate_buffer(values_at, 8_int64*size(values), err)
        call copy_in(id, id_at, 4_int64*size(id), err)
        call arguments%add(gpu%n)
        call arguments%add(size(id))
        call arguments%add(id_at)
        call arguments%add(gpu%tag)
        call arguments%add(gpu%place)
        call arguments%add(gpu%reference)
        call arguments%add(gpu%motion)
        call arguments%add(gpu%state)
        call arguments%add(values_at)
        call launch(gpu%find_particles, [gpu%n, 1, 1], arguments, err)
        values = 0
        call copy_out(values_at, values, 8_int64*size(values), err)
        call free_buffer(id_at)
        call free_buffer(values_at)
        do k = 1, size(id)
            i = findloc(solid%id, id(k), dim=1)
            solid%x(:, i) = values(1:3, k)
            solid%x_ref(:, i) = values(4:6, k)
            solid%v(:, i) = real(values(7:9, k), rk)
            solid%a(:, i) = real(values(10:12, k), rk)
        end do
    end subroutine fetch_particles

    subroutine fetch_tag(gpu, column, values, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column
        integer(int32), intent(inout) :: values(:)
        type(error_t), intent(inout) :: err

        call copy_out(part_of(gpu%tag, 4_int64*(column - 1)*gpu%n), values, 4_int64*gpu%n, err)
    end subroutine fetch_tag

    !> The particles with an impossible state are noted in the blocks of the host, as its own are.
    subroutine faults_of(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: marks(:)
        integer :: k

        call fetch_solid(gpu, solid, err)
        allocate (marks(solid%n), source=0_int32)
        call fetch_tag(gpu, tag_fault, marks, err)
        do k = 1, size(solid%block, 2)
            associate (first => solid%block(2, k), last => solid%block(3, k))
                solid%search%bad(k) = findloc(marks(first:last), 1, dim=1)
                if (solid%search%bad(k) > 0) &
                    solid%search%bad(k) = solid%search%bad(k) + first - 1
            end associate
        end do
    end subroutine faults_of
end module brz_gpu_solid_copy
