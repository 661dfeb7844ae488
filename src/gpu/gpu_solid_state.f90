! SPDX-License-Identifier: MIT
!> The solids on the GPU: what it keeps there.
!>
!> All arrays of the particles stay on the GPU, see brz_gpu_solid_layout. The host arrays of
!> `solid_t` are a mirror that brz_gpu_solid_copy refreshes before a dump or a checkpoint.
module brz_gpu_solid_state
    use brz_buffers, only: doubles_t, from, integers_t, reals_t
    use brz_bond_launches, only: bond_kernels_t
    use brz_cohesive_launches, only: cohesive_kernels_t
    use brz_between_launches, only: between_kernels_t
    use brz_contact_launches, only: contact_kernels_t
    use brz_device, only: allocate_buffer, buffer_t, copy_in, copy_within, device_t, free_buffer, &
        free_buffers, kernel_t
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_drift_launches, only: drift_kernels_t
    use brz_facet_launches, only: facet_kernels_t
    use brz_force_launches, only: force_kernels_t
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_exact, only: gpu_exact_t
    use brz_gpu_marks, only: gpu_marks_t
    use brz_gpu_parcels, only: gpu_parcels_t, rows_of, rows_t
    use brz_gpu_solid_layout, only: grid_gpu_t, n_book, n_flag, n_tag, n_terms, n_total, &
        slice_width
    use brz_home_launches, only: home_kernels_t
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: link_layout_t, n_press
    use brz_motion_launches, only: motion_kernels_t
    use brz_move_level, only: move_levels
    use brz_row_launches, only: row_kernels_t
    use brz_solid_fields, only: column_of_field, fields_of, fields_t
    use brz_solid_launches, only: solid_kernels_t
    use brz_solid_state, only: ledger_t, n_held, n_pair, solid_t
    use brz_tie_launches, only: tie_kernels_t
    use brz_tallies, only: tally_threads
    use brz_text, only: to_text
    implicit none
    private
    public :: gpu_solid_t, gpu_solid_body_t, open_gpu_solid_memory, lay_arrays, record_of, &
              close_gpu_solid, &
              moved_flags, column_of, tags_of, book_of, threads_of, bytes_of_real, &
              words_of_real, &
              sum_threads, total_threads, most_folded

    integer, parameter :: sum_threads = 4096 !! partial sums over a body
    integer, parameter :: total_threads = 65536 !! partial sums of the totals of a body
    integer, parameter :: most_folded = 256 !! rows of partial results that the host adds up
    integer(int64), parameter :: bytes_of_real = storage_size(1.0_rk)/8
    integer, parameter :: words_of_real = storage_size(1.0_rk)/32 !! of 4 B
    integer, parameter :: neighbours_guess = 100 !! entries per particle, to judge the memory

    type :: gpu_solid_body_t
        integer :: first = 1, last = 0 !! particles
        integer :: rim = 0 !! last of its ghosts, as in body_t
        integer :: room = 0 !! places for both
        integer :: slices = 0
        logical :: total = .false. !! total-Lagrangian
        logical :: rigid = .false.
        logical :: drawn = .false. !! has the hold
        logical :: layer = .false. !! a single layer, see brz_lone_layer
        logical :: asleep = .false. !! left out of the steps
        real(dp) :: box(3, 2) = 0 !! corners of `built` [m]
        type(buffer_t) :: params, material
        type(doubles_t) :: drive
        type(integers_t) :: slice, list
        type(kernel_t) :: moments, update, forces !! those that suit the body
    end type gpu_solid_body_t

    !> Pairs of particles of different bodies.
    type :: gpu_links_t
        type(link_layout_t) :: lay
        logical :: breaks = .true., frees = .true. !! bonds may break; or what ties may let go
        type(buffer_t) :: table
        type(integers_t) :: ends, slice, count, list, met
        type(integers_t) :: loose !! `count`, but 0 of particles that are tied for good
        type(reals_t) :: cell, press
        type(contact_kernels_t) :: contact
        type(between_kernels_t) :: between
        type(bond_kernels_t) :: bonds
        type(tie_kernels_t) :: ties
    end type gpu_links_t

    !> Cohesive interfaces, arrays of cohesive_t.
    type :: gpu_cohesive_t
        logical :: present = .false.
        logical :: fetched = .true. !! the host has the state of the points
        integer :: n = 0, nodes = 0
        type(buffer_t) :: law
        type(integers_t) :: bit, of, first, entry, back_first, back, row, place_of
        type(doubles_t) :: area, gap, rest, weight, pull, push
        type(doubles_t) :: state !! (3, n) slots of brz_cohesive_law
        type(cohesive_kernels_t) :: kernels
    end type gpu_cohesive_t

    !> Loads in scenes without air, arrays of facets_t.
    type :: gpu_loads_t
        logical :: present = .false.
        integer :: carriers = 0, rebuilds = -1
        type(integers_t) :: first, id, of, beside, mirror, side, place
        type(doubles_t) :: width, most, wave, mean
        type(facet_kernels_t) :: kernels
    end type gpu_loads_t

    type :: gpu_solid_t
        logical :: fetched = .true. !! the host arrays hold the state of the GPU
        logical :: stepped = .false. !! the GPU has made a step
        logical :: summed = .false. !! `sums` and the ledgers are those of the present state
        logical :: settled = .true. !! bodies lie in the host arrays as they do here
        logical :: linked = .false., bonded = .false. !! bodies meet; some are bonded
        type(gpu_links_t) :: links
        type(gpu_cohesive_t) :: glue
        type(gpu_loads_t) :: loads
        integer :: n = 0, n_state = 0 !! places of particles, columns of `state`
        ! columns of `state` that not every scene has, 0: none
        integer :: grip = 0 !! + 1..3: force on what holds a particle [N]
        integer :: owed = 0 !! energy that the hold owes [J]
        integer :: lift = 0 !! of total-Lagrangian plates [1/m]
        integer :: load = 0 !! + 1..3: force of the air, or of the loads [N]
        integer :: before = 0 !! + 1..3: velocity a step of the air before [m/s]
        type(gpu_solid_body_t), allocatable :: bodies(:)
        type(ledger_t), allocatable :: ledger(:) !! of the bodies when the GPU took over
        real(dp), allocatable :: reaction(:, :) !! (3, bodies) likewise
        real(dp), allocatable :: sums(:, :) !! (n_total, bodies) over the particles of each body
        type(doubles_t) :: place, reference, built, book, rate, region, box, part
        type(reals_t) :: motion, state, row, grad, held, axes, extra
        type(reals_t) :: near, far !! place and reference as pairs read them, see pack_places
        type(integers_t) :: tag, flags, count, cell, order, start, code
        type(gpu_marks_t) :: marks !! who goes where, see brz_gpu_solid_home
        type(buffer_t) :: hold, grid
        type(solid_kernels_t) :: kernels
        type(force_kernels_t) :: forces
        type(motion_kernels_t) :: moves
        type(row_kernels_t) :: rows
        type(doubles_t) :: sums_of_forces
        type(gpu_exact_t) :: exact
        type(gpu_common_t) :: common
        type(device_t) :: device
        type(gpu_parcels_t) :: ghosts
        type(drift_kernels_t) :: drifts
        type(home_kernels_t) :: homes
    end type gpu_solid_t

contains

    !> Reserve all memory and find all kernels.
    subroutine open_gpu_solid_memory(device, solid, loaded, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: loaded !! the air, or what the deck says, loads the bodies
        type(gpu_solid_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        integer :: b

        gpu%linked = solid%links%present
        gpu%bonded = gpu%linked .and. solid%links%bonds
        call number_columns(solid, loaded, gpu)
        call require(device, solid, gpu%n_state, err)
        call gpu%kernels%open(device, err)
        call gpu%forces%open(device, err)
        call gpu%drifts%open(device, err)
        call gpu%homes%open(device, err)
        gpu%device = device
        call gpu%ghosts%open(device, solid%ranks, solid%part, max(words_of_record(gpu), &
                             words_of_real*(n_pair + n_held + 6) + 6), err)
        call gpu%exact%open(device, solid%ranks, err)
        call gpu%moves%open(device, err)
        call gpu%rows%open(device, err)
        call gpu%common%open(device, most_folded*(n_total + n_book), err)
        allocate (gpu%bodies(size(solid%bodies)), gpu%ledger(size(solid%bodies)), &
                  gpu%reaction(3, size(solid%bodies)), gpu%sums(n_total, size(solid%bodies)))
        do b = 1, size(solid%bodies)
            gpu%bodies(b)%first = solid%bodies(b)%first
            gpu%bodies(b)%room = solid%n - solid%bodies(b)%first + 1
            if (b < size(solid%bodies)) gpu%bodies(b)%room = solid%bodies(b + 1)%first &
                - solid%bodies(b)%first
            gpu%bodies(b)%rim = gpu%bodies(b)%first - 1 ! nothing is there yet
        end do
        gpu%n = solid%n
        call lay_arrays(gpu, solid, gpu%bodies%first, 0, err)
        call allocate_buffer(gpu%flags, 4_int64*(n_flag + move_levels*size(solid%bodies)), err)
        call allocate_buffer(gpu%region, 48_int64, err)
        call allocate_buffer(gpu%box, 48_int64, err)
        call allocate_buffer(gpu%sums_of_forces, 32_int64*tally_threads, err)
        call allocate_buffer(gpu%start, 4*(max(512_int64, 2_int64*maxval( &
            solid%bodies%number(2) - solid%bodies%number(1) + 1)) + 2), err)
        call allocate_buffer(gpu%grid, int(storage_size(grid_gpu_t(1, 1, 1, 1, 1, 1.0_dp, 1.0_dp, &
                                                                   1.0_dp))/8, int64), err)
        call allocate_buffer(gpu%part, 8_int64*total_threads*(n_total + n_book), err)
        call copy_in(solid%region, gpu%region, 48_int64, err)
    end subroutine open_gpu_solid_memory

    !> Arrays for gpu%n places, and what the old ones hold of the bodies.
    subroutine lay_arrays(gpu, solid, old, n_old, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: old(:) !! (bodies) where they began
        integer, intent(in) :: n_old !! places that there were
        type(error_t), intent(inout) :: err
        integer(int64) :: n

        n = gpu%n
        associate (w => words_of_real, held => allocated(solid%held), &
                   hold => allocated(solid%hold) .or. allocated(solid%tilt))
            call lay_array(gpu, old, n_old, 8, 1, gpu%place, err)
            call lay_array(gpu, old, n_old, 8, 1, gpu%reference, err)
            call lay_array(gpu, old, n_old, 8, 1, gpu%built, err)
            call lay_array(gpu, old, n_old, 4*w, 1, gpu%motion, err)
            call lay_array(gpu, old, n_old, w, gpu%n_state, gpu%state, err)
            call lay_array(gpu, old, n_old, 1, n_tag, gpu%tag, err)
            call lay_array(gpu, old, n_old, 2, n_book, gpu%book, err)
            call lay_array(gpu, old, n_old, 2, 1, gpu%rate, err)
            call lay_array(gpu, old, n_old, n_pair*w, 1, gpu%row, err)
            call lay_array(gpu, old, n_old, 6, merge(1, 0, hold), gpu%hold, err)
            call lay_array(gpu, old, n_old, n_held*w, merge(1, 0, held), gpu%held, err)
            if (gpu%linked) call lay_array(gpu, old, n_old, n_press*w, 1, gpu%links%press, err)
        end associate
        call free_buffers(gpu%grad, gpu%count, gpu%cell, gpu%order, gpu%extra)
        call allocate_buffer(gpu%grad, merge(18, 9, allocated(solid%lift))*bytes_of_real*n, err)
        call allocate_buffer(gpu%count, 4*n, err)
        call allocate_buffer(gpu%cell, 4*n, err)
        call allocate_buffer(gpu%order, 4*n, err)
        call allocate_buffer(gpu%extra, merge(n_terms*bytes_of_real*n, 8_int64, gpu%linked), err)
        if (.not. gpu%linked) return
        call free_buffers(gpu%links%count, gpu%links%loose, gpu%links%slice)
        call allocate_buffer(gpu%links%count, 4*n, err)
        call allocate_buffer(gpu%links%loose, 4*n, err)
        call allocate_buffer(gpu%links%slice, 4*((n - 1)/slice_width + 2), err)
    end subroutine lay_arrays

    !> One of them: rows of words of 4 B, or columns of such rows.
    subroutine lay_array(gpu, old, n_old, words, columns, array, err)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: old(:), n_old, words, columns
        class(buffer_t), intent(inout) :: array
        type(error_t), intent(inout) :: err
        type(buffer_t) :: before, from, to
        integer :: b, c

        before%address = array%address
        before%bytes = array%bytes
        call allocate_buffer(array, max(4_int64*words*columns*gpu%n, 8_int64), err)
        do c = 1, columns
            do b = 1, size(gpu%bodies)
                associate (body => gpu%bodies(b))
                    if (body%rim < body%first) cycle
                    from%address = before%address + 4*words*((c - 1_int64)*n_old + old(b) - 1)
                    to%address = array%address + 4*words*((c - 1_int64)*gpu%n + body%first - 1)
                    call copy_within(from, to, 4_int64*words*(body%rim - body%first + 1), err)
                end associate
            end do
        end do
        call free_buffer(before)
    end subroutine lay_array

    !> All that a particle takes along when it goes to another process, or becomes a ghost there.
    pure function record_of(gpu) result(record)
        type(gpu_solid_t), intent(in) :: gpu
        type(rows_t) :: record(7)

        record = [rows_of(gpu%place, 8), rows_of(gpu%reference, 8), rows_of(gpu%built, 8), &
                  rows_of(gpu%motion, 4*words_of_real), &
                  rows_of(gpu%state, words_of_real, gpu%n_state, gpu%n), &
                  rows_of(gpu%tag, 1, n_tag, gpu%n), rows_of(gpu%rate, 2)]
    end function record_of

    pure integer function words_of_record(gpu) result(words)
        type(gpu_solid_t), intent(in) :: gpu

        words = 26 + words_of_real*(4 + gpu%n_state) + n_tag + 1
    end function words_of_record

    !> Number the columns of `state`.
    subroutine number_columns(solid, loaded, gpu)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: loaded
        type(gpu_solid_t), intent(inout) :: gpu
        type(fields_t) :: fields

        call fields_of(solid, fields)
        gpu%n_state = fields%columns
        gpu%owed = column_of_field(fields, 'owed')
        gpu%lift = column_of_field(fields, 'lift')
        if (loaded) gpu%load = column_of_field(fields, 'load') - 1
        if (allocated(solid%v_before)) gpu%before = column_of_field(fields, 'v_before') - 1
        if (allocated(solid%grip)) gpu%grip = column_of_field(fields, 'grip') - 1
    end subroutine number_columns

    !> Refuse a scene that does not fit, before anything is reserved.
    subroutine require(device, solid, n_state, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: n_state !! columns of `state`
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        bytes = 0
        if (solid%cohesive%present) bytes = 36_int64*size(solid%cohesive%node) &
            + 168_int64*solid%cohesive%n + 8_int64*solid%cohesive%nodes + 4_int64*solid%n
        bytes = bytes + solid%n*(bytes_of_real*(4 + n_state + n_pair + 9) + 8*n_book &
                         + 4*n_tag + 3*32 + 8 + 3*4 + 8 + 4*neighbours_guess &
                         + merge(20*bytes_of_real, 0_int64, solid%links%present) &
                         + merge(32, 0, words_of_real == 1) &
                         + merge(24, 0, allocated(solid%hold) .or. allocated(solid%tilt)) &
                         + merge(n_held*bytes_of_real, 0_int64, allocated(solid%held)))
        if (bytes > device%free_bytes) call raise(err, exit_device, 'the bodies need about '// &
            to_text(int(bytes/2**20))//' MiB on the GPU, but only '// &
            to_text(int(device%free_bytes/2**20))//' MiB are free: use fewer particles, a '// &
            'build with PRECISION=mixed, or --backend cpu')
    end subroutine require

    !> Flags of body b for the levels of motion.
    pure function moved_flags(gpu, b) result(flags)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: b
        type(integers_t) :: flags

        flags = from(gpu%flags, n_flag + move_levels*(b - 1_int64) + 1)
    end function moved_flags

    !> A column of the state, from its first particle on.
    pure type(reals_t) function column_of(gpu, column)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column

        column_of = from(gpu%state, (column - 1_int64)*gpu%n + 1)
    end function column_of

    pure type(integers_t) function tags_of(gpu, column)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column

        tags_of = from(gpu%tag, (column - 1_int64)*gpu%n + 1)
    end function tags_of

    !> A column of the books.
    pure type(doubles_t) function book_of(gpu, column)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column

        book_of = from(gpu%book, (column - 1_int64)*gpu%n + 1)
    end function book_of

    !> One thread for each particle of a body.
    pure function threads_of(body) result(n)
        type(gpu_solid_body_t), intent(in) :: body
        integer :: n(3)

        n = [body%last - body%first + 1, 1, 1]
    end function threads_of

    !> Give the memory back.
    subroutine close_gpu_solid(gpu)
        type(gpu_solid_t), intent(inout) :: gpu
        integer :: b

        call free_buffers(gpu%place, gpu%reference, gpu%built, gpu%motion, gpu%state, gpu%tag, &
            gpu%book, gpu%row)
        call free_buffers(gpu%grad, gpu%hold, gpu%held, gpu%rate, gpu%flags, gpu%axes, &
            gpu%region, gpu%extra)
        call free_buffers(gpu%count, gpu%cell, gpu%order, gpu%start, gpu%code, gpu%grid, &
            gpu%part, gpu%box)
        call free_buffers(gpu%sums_of_forces, gpu%marks%mark, gpu%marks%ends, gpu%marks%sums)
        if (words_of_real == 1) call free_buffers(gpu%near, gpu%far)
        call gpu%ghosts%close()
        call gpu%exact%close()
        call gpu%common%close()
        associate (links => gpu%links, glue => gpu%glue, loads => gpu%loads)
            call free_buffers(links%ends, links%table, links%cell, links%press, links%slice, &
                links%count, links%list, links%met)
            call free_buffers(links%loose)
            call free_buffers(glue%law, glue%bit, glue%of, glue%first, glue%area, glue%gap, &
                glue%rest, glue%weight)
            call free_buffers(glue%back_first, glue%back, glue%row, glue%pull, glue%push, &
                glue%entry, glue%place_of, glue%state)
            call free_buffers(loads%first, loads%id, loads%of, loads%beside, loads%mirror, &
                loads%side, loads%place)
            call free_buffers(loads%width, loads%most, loads%wave, loads%mean)
        end associate
        do b = 1, size(gpu%bodies)
            associate (body => gpu%bodies(b))
                call free_buffers(body%params, body%material, body%drive, body%slice, &
                    body%list)
            end associate
        end do
    end subroutine close_gpu_solid
end module brz_gpu_solid_state
