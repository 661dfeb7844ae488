! SPDX-License-Identifier: MIT
!> The solids on the GPU: what it keeps there.
!>
!> All arrays of the particles stay on the GPU, see brz_gpu_solid_layout. The host arrays of
!> `solid_t` are a mirror that brz_gpu_solid_copy refreshes before a dump or a checkpoint.
module brz_gpu_solid_state
    use brz_body, only: body_t
    use brz_buffers, only: buffer_t, doubles_t, from, integers_t, reals_t
    use brz_device, only: allocate_buffer, copy_in, copy_within, device_t, free_buffer, &
        reserve_buffer
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_face_layout, only: n_face
    use brz_formulation_names, only: form_total
    use brz_motion_loop_bodies, only: n_sum
    use brz_gpu_solid_layout, only: at_accel, at_damage, at_energy, at_mass, at_mu, at_stress, &
        diag_contact_heat, diag_load, grid_gpu_t, &
        n_diag, n_flag, n_linked_tag, n_tag, n_terms, tag_bond, tag_face, &
        tag_fixed, tag_id, tag_joined, tag_touch, tag_weight
    use brz_hold_layout, only: n_control
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: n_press
    use brz_links, only: links_t
    use brz_skin_level, only: lost_level
    use brz_pair_layout, only: n_pair
    use brz_present_table, only: attach, attach_bytes
    use brz_rows, only: rows_of_copy
    use brz_gpu_solid_tiles, only: lay_adders
    use brz_solid_device, only: body_device_t, solid_device_t
    use brz_solid_fields, only: column_of_field, fields_of, fields_t
    use brz_solid_places, only: whole_lanes
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_state, only: solid_t
    use brz_text, only: to_text
    implicit none
    private
    public :: open_gpu_solid_memory, lay_arrays, attach_solid, attach_links, note_ranges
    public :: column_of, tags_of, diag_of, threads_of, bytes_of_real, words_of_real

    integer, parameter :: words_of_real = storage_size(1.0_rk)/32 !! of 4 B
    integer(int64), parameter :: bytes_of_real = 4*words_of_real
    integer, parameter :: neighbours_guess = 100 !! entries per particle, to judge the memory

    ! what becomes of an array of the particles
    integer, parameter :: passes = 0, stays = 1 !! is scratch; holds something for its place
    integer, parameter :: goes = 2, is_left = 3 !! with its particle; for pass 2

contains

    !> Reserve all memory.
    subroutine open_gpu_solid_memory(device, solid, loaded, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: loaded !! the air, or what the deck says, loads the bodies
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(grid_gpu_t) :: grid
        integer :: b

        gpu%linked = solid%links%present
        gpu%bonded = gpu%linked .and. solid%links%bonds
        gpu%n = solid%n
        call number_columns(solid, loaded, gpu)
        call require(device, solid, gpu, err)
        if (failed(err)) return
        call gpu%common%open(max(n_diag, n_sum), size(solid%bodies), err)
        allocate (gpu%bodies(size(solid%bodies)), gpu%account(size(solid%bodies)), &
                  gpu%reaction(3, size(solid%bodies)))
        do b = 1, size(solid%bodies)
            gpu%bodies(b)%first = solid%bodies(b)%first
            gpu%bodies(b)%room = solid%n - solid%bodies(b)%first + 1
            if (b < size(solid%bodies)) gpu%bodies(b)%room = solid%bodies(b + 1)%first &
                - solid%bodies(b)%first
            gpu%bodies(b)%rim = gpu%bodies(b)%first - 1 ! nothing is there yet
            call allocate_buffer(gpu%bodies(b)%grid, int(storage_size(grid)/8, int64), err)
        end do
        call lay_arrays(gpu, solid, gpu%bodies%first, err)
        call gpu%ghosts%open(solid%ranks, solid%part%out, solid%part%in, &
            max(sum(gpu%record%words*gpu%record%columns), &
                sum(gpu%left%words) + 6*words_of_real + n_face), err)
        call allocate_buffer(gpu%flags, 4_int64*(n_flag + lost_level*size(solid%bodies)), err)
        gpu%moved = from(gpu%flags, n_flag + 1_int64)
        call allocate_buffer(gpu%region, 48_int64, err)
        call allocate_buffer(gpu%found, 4_int64*size(gpu%bodies), err)
        call copy_in(solid%region, gpu%region, 48_int64, err)
    end subroutine open_gpu_solid_memory

    !> Arrays for gpu%n places, and what the old ones hold of the bodies.
    subroutine lay_arrays(gpu, solid, old, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: old(:) !! (bodies) where they began
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes
        integer :: k

        call walk(gpu, solid, .true., old, bytes, err)
        gpu%bodies%packed = .false.
        call reserve_buffer(gpu%seat, 4_int64*gpu%n, err)
        call copy_in([(k, k=1, gpu%n)], gpu%seat, 4_int64*gpu%n, err)
        if (.not. failed(err)) call see_arrays(gpu)
    end subroutine lay_arrays

    !> Count the bytes of the arrays of the particles, and lay them all.
    subroutine walk(gpu, solid, lays, old, bytes, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(in) :: solid
        logical, intent(in) :: lays !! else they are only counted
        integer, intent(in) :: old(:) !! see lay_arrays
        integer(int64), intent(out) :: bytes
        type(error_t), intent(inout) :: err
        integer, parameter :: w = words_of_real
        integer :: apart

        bytes = 0
        apart = whole_lanes(gpu%n)
        gpu%n_record = 0
        gpu%n_left = 0
        call visit(gpu%place, 8, 1, goes)
        call visit(gpu%reference, 8, 1, goes)
        call visit(gpu%built, 8, 1, goes)
        call visit(gpu%motion, 4*w, 1, goes)
        call visit(gpu%state, w, gpu%n_state, goes)
        call visit(gpu%tag, 1, merge(n_linked_tag, n_tag, gpu%linked), goes)
        call visit(gpu%rate, 2, 1, goes)
        call visit(gpu%row, n_pair*w, 1, is_left)
        if (allocated(solid%k_axes) .or. allocated(solid%tilt)) &
            call visit(gpu%k_axes, 6, 1, is_left)
        if (allocated(solid%control)) call visit(gpu%control, n_control*w, 1, is_left)
        call visit(gpu%diag, 2, n_diag, stays)
        call visit(gpu%grad, w, merge(18, 9, allocated(solid%tilt) .and. &
            any(solid%bodies%formulation == form_total)), passes)
        call visit(gpu%count, 1, 1, passes)
        call visit(gpu%acting, 1, 1, passes)
        call visit(gpu%cell, 1, 1, passes)
        call visit(gpu%order, 1, 1, passes)
        call visit(gpu%chosen, 1, 1, passes)
        call visit(gpu%picked, 1, 1, passes)
        call visit(gpu%sorted, 8, 1, passes)
        if (.not. gpu%linked) return
        call visit(gpu%links%press, n_press*w, 1, stays)
        call visit(gpu%extra, w, n_terms, passes)
        call visit(gpu%links%count, 1, 1, passes)
        call visit(gpu%links%loose, 1, 1, passes)
        call visit(gpu%links%slice, 1, 1, passes)

    contains

        !> One of them: columns of rows of words of 4 B, with what it holds unless that passes.
        subroutine visit(array, words, columns, how)
            class(buffer_t), intent(inout) :: array
            integer, intent(in) :: words, columns
            integer, intent(in) :: how !! goes, ...
            type(buffer_t) :: before, from, to
            integer :: b, c

            bytes = bytes + 4_int64*words*columns*apart
            if (.not. lays) return
            before%address = array%address
            call allocate_buffer(array, 4_int64*words*columns*apart + 8, err)
            if (how == goes) gpu%n_record = gpu%n_record + 1
            if (how == goes) gpu%record(gpu%n_record) = rows_of_copy(array, words, columns, apart)
            if (how == is_left) gpu%n_left = gpu%n_left + 1
            if (how == is_left) gpu%left(gpu%n_left) = rows_of_copy(array, words)
            do c = 1, merge(columns, 0, how /= passes)
                do b = 1, size(gpu%bodies)
                    associate (body => gpu%bodies(b))
                        if (body%rim < body%first) cycle
                        from%address = before%address &
                            + 4*words*((c - 1_int64)*gpu%stride_d + old(b) - 1)
                        to%address = array%address &
                            + 4*words*((c - 1_int64)*apart + body%first - 1)
                        call copy_within(from, to, 4_int64*words*(body%rim - body%first + 1), err)
                    end associate
                end do
            end do
            call free_buffer(before)
        end subroutine visit
    end subroutine walk

    !> Parts of the arrays under the names that loop bodies and steps have for them.
    subroutine see_arrays(gpu)
        type(solid_device_t), intent(inout) :: gpu
        type(integers_t) :: tags

        gpu%stride_d = whole_lanes(gpu%n)
        gpu%x = gpu%place
        gpu%x_ref = gpu%reference
        gpu%x_built = gpu%built
        gpu%v = gpu%motion
        gpu%volume = from(gpu%motion, 4_int64)
        gpu%a = column_of(gpu, at_accel + 1)
        gpu%mass = column_of(gpu, at_mass)
        gpu%mu = column_of(gpu, at_mu)
        gpu%energy = column_of(gpu, at_energy)
        gpu%damage = column_of(gpu, at_damage)
        gpu%stress = column_of(gpu, at_stress + 1)
        if (gpu%column%load > 0) gpu%load = column_of(gpu, gpu%column%load + 1)
        if (gpu%column%face_stress > 0) &
            gpu%face_stress = column_of(gpu, gpu%column%face_stress + 1)
        if (gpu%column%before > 0) gpu%v_before = column_of(gpu, gpu%column%before + 1)
        if (gpu%column%control_due > 0) gpu%control_due = column_of(gpu, gpu%column%control_due)
        if (gpu%column%reaction_force > 0) gpu%reaction_force = &
            column_of(gpu, gpu%column%reaction_force + 1)
        gpu%pair = gpu%row
        gpu%work = diag_of(gpu, diag_load)
        gpu%contact_heat = diag_of(gpu, diag_contact_heat)
        gpu%id = tags_of(gpu, tag_id)
        gpu%fixed = tags_of(gpu, tag_fixed)
        associate (links => gpu%links)
            links%bond = tags_of(gpu, tag_bond)
            links%joined = tags_of(gpu, tag_joined)
            tags = tags_of(gpu, tag_touch)
            links%touch = tags%buffer_t
            tags = tags_of(gpu, tag_weight)
            links%weight = tags%buffer_t
            tags = tags_of(gpu, tag_face)
            links%face = tags%buffer_t
            links%row = links%count
            links%lay%step_c = gpu%stride_d
        end associate
    end subroutine see_arrays

    !> Where the copies of the arrays of solid_t lie, once the arrays of the host or of the GPU have
    !> been laid anew.
    subroutine attach_solid(gpu, solid)
        type(solid_device_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid

        if (.not. allocated(solid%moved)) allocate (solid%moved(lost_level, size(solid%bodies)))
        if (.not. allocated(solid%work)) allocate (solid%work(solid%n))
        solid%wide = gpu%wide
        solid%stride_d = gpu%stride_d
        solid%stride_p = gpu%stride_p
        solid%stride_t = gpu%stride_t
        solid%stride_w = gpu%wide ! behind the velocity
        call attach(solid%x, gpu%x)
        call attach(solid%x_ref, gpu%x_ref)
        call attach(solid%x_built, gpu%x_built)
        call attach(solid%v, gpu%v)
        call attach(solid%a, gpu%a)
        call attach(solid%mass, gpu%mass)
        call attach(solid%mu, gpu%mu)
        call attach(solid%energy, gpu%energy)
        call attach(solid%damage, gpu%damage)
        call attach(solid%stress, gpu%stress)
        call attach(solid%volume, gpu%volume)
        call attach(solid%pair, gpu%pair)
        call attach(solid%work, gpu%work)
        call attach(solid%id, gpu%id)
        call attach(solid%fixed, gpu%fixed)
        call attach(solid%moved, gpu%moved)
        call attach(solid%region, gpu%region)
        if (allocated(solid%load)) call attach(solid%load, gpu%load)
        if (allocated(solid%face_stress)) call attach(solid%face_stress, gpu%face_stress)
        if (allocated(solid%v_before)) call attach(solid%v_before, gpu%v_before)
        if (allocated(solid%reaction_force)) call attach(solid%reaction_force, gpu%reaction_force)
        if (allocated(solid%control_due)) call attach(solid%control_due, gpu%control_due)
        call attach(solid%device%heat, gpu%contact_heat)
        if (gpu%linked) call attach_links(gpu, solid%links)
    end subroutine attach_solid

    !> The same of links_t. Lists of the host only name those of the GPU.
    subroutine attach_links(gpu, links)
        type(solid_device_t), intent(in) :: gpu
        type(links_t), intent(inout) :: links

        if (.not. allocated(links%row)) allocate (links%row(1))
        if (.not. allocated(links%slice)) allocate (links%slice(0:1))
        if (.not. allocated(links%count)) allocate (links%count(0:1))
        if (.not. allocated(links%list)) allocate (links%list(1))
        if (.not. allocated(links%press)) allocate (links%press(n_press, 0:1))
        if (.not. allocated(links%push)) allocate (links%push(9, 0:1))
        links%lay = gpu%links%lay
        call attach(links%ends, gpu%links%ends)
        call attach_bytes(links%table, size(links%table)*(storage_size(links%table)/8_int64), &
                          gpu%links%table)
        call attach(links%cell, gpu%links%cell)
        call attach(links%touch, gpu%links%touch)
        call attach(links%weight, gpu%links%weight)
        if (allocated(links%face)) call attach(links%face, gpu%links%face)
        call attach(links%bond, gpu%links%bond)
        if (allocated(links%joined)) call attach(links%joined, gpu%links%joined)
        call attach(links%row, gpu%links%row)
        call attach(links%slice(1:), gpu%links%slice)
        call attach(links%count(1:), gpu%links%count)
        call attach(links%list, gpu%links%list)
        call attach(links%press(:, 1:), gpu%links%press)
        call attach(links%push(:, 1:), gpu%extra)
    end subroutine attach_links

    !> The bodies have been given other places.
    subroutine note_ranges(bodies, n, gpu, err)
        type(body_t), intent(in) :: bodies(:)
        integer, intent(in) :: n !! places of all
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        gpu%bodies%first = bodies%first
        gpu%bodies%last = bodies%last
        gpu%bodies%rim = bodies%rim
        gpu%bodies%room = bodies%room
        gpu%n = n
        call lay_adders(gpu, err)
    end subroutine note_ranges

    !> Number the columns of `state`.
    subroutine number_columns(solid, loaded, gpu)
        class(listed_bodies_t), intent(inout) :: solid
        logical, intent(in) :: loaded
        type(solid_device_t), intent(inout) :: gpu
        type(fields_t) :: fields

        call fields_of(solid, fields)
        gpu%n_state = fields%columns
        gpu%column%control_due = column_of_field(fields, 'owed')
        if (loaded) gpu%column%load = column_of_field(fields, 'load') - 1
        if (allocated(solid%face_stress)) &
            gpu%column%face_stress = column_of_field(fields, 'face_stress') - 1
        if (allocated(solid%v_before)) gpu%column%before = column_of_field(fields, 'v_before') - 1
        if (allocated(solid%reaction_force)) gpu%column%reaction_force = &
            column_of_field(fields, 'grip') - 1
    end subroutine number_columns

    !> Refuse a scene that does not fit, before anything is reserved.
    subroutine require(device, solid, gpu, err)
        type(device_t), intent(in) :: device
        class(interacting_bodies_t), intent(in) :: solid
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        call walk(gpu, solid, .false., [integer ::], bytes, err)
        bytes = bytes + solid%n*(8_int64*neighbours_guess + merge(32, 0, words_of_real == 1))
        if (solid%cohesive%present) bytes = bytes + 36_int64*size(solid%cohesive%node) &
            + 176_int64*solid%cohesive%n + 12_int64*solid%cohesive%nodes + 4_int64*solid%n
        if (bytes > device%free_bytes) call raise(err, exit_device, 'the bodies need about '// &
            to_text(int(bytes/2**20))//' MiB on the GPU, but only '// &
            to_text(int(device%free_bytes/2**20))//' MiB are free: use fewer particles, a '// &
            'build with PRECISION=mixed, or --backend cpu')
    end subroutine require

    !> A column of the state, from its first particle on.
    pure type(reals_t) function column_of(gpu, column)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: column

        column_of = from(gpu%state, (column - 1_int64)*gpu%stride_d + 1)
    end function column_of

    pure type(integers_t) function tags_of(gpu, column)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: column

        tags_of = from(gpu%tag, (column - 1_int64)*gpu%stride_d + 1)
    end function tags_of

    !> A column of the diagnostics.
    pure type(doubles_t) function diag_of(gpu, column)
        type(solid_device_t), intent(in) :: gpu
        integer, intent(in) :: column

        diag_of = from(gpu%diag, (column - 1_int64)*gpu%stride_d + 1)
    end function diag_of

    !> One thread for each particle of a body that is there.
    pure function threads_of(body) result(n)
        type(body_device_t), intent(in) :: body
        integer :: n(3)

        n = [body%last - body%gone - body%first + 1, 1, 1]
    end function threads_of
end module brz_gpu_solid_state
