! SPDX-License-Identifier: MIT
!> The solids on the GPU: what it keeps there.
!>
!> All arrays of the particles stay on the GPU, see brz_gpu_solid_layout. The host arrays of
!> `solid_t` are a mirror that brz_gpu_solid_copy refreshes before a dump or a checkpoint.
module brz_gpu_solid_state
    use brz_buffers, only: buffer_t, doubles_t, from, integers_t, reals_t
    use brz_device, only: allocate_buffer, copy_in, copy_within, device_t, free_buffer, kernel_t, &
        reserve_buffer
    use brz_energy_account, only: ledger_t
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_face_layout, only: n_face
    use brz_formulation_names, only: form_total
    use brz_gpu_cohesive_state, only: gpu_cohesive_t
    use brz_force_items, only: n_sum
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_exact_sum, only: gpu_exact_t
    use brz_gpu_loads, only: gpu_facets_t
    use brz_gpu_parcels, only: gpu_parcels_t, rows_of, gpu_rows_t
    use brz_gpu_places, only: gpu_marks_t
    use brz_gpu_solid_layout, only: at_accel, at_damage, at_energy, at_mass, at_mu, at_stress, &
        book_contact_heat, book_load, grid_gpu_t, &
        n_book, n_flag, n_linked_tag, n_tag, n_terms, tag_bond, tag_face, &
        tag_fixed, tag_id, tag_joined, tag_touch, tag_weight
    use brz_hold_layout, only: n_held
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: link_layout_t, n_press
    use brz_move_level, only: lost_level
    use brz_pair_layout, only: n_pair
    use brz_solid_fields, only: column_of_field, fields_of, fields_t
    use brz_solid_places, only: whole_lanes
    use brz_solid_state, only: solid_t
    use brz_tallies, only: tally_threads
    use brz_text, only: to_text
    implicit none
    private
    public :: columns_t, gpu_solid_t, gpu_solid_body_t, lists_t, open_gpu_solid_memory, &
        lay_arrays, column_of, tags_of, book_of, threads_of, &
        bytes_of_real, words_of_real, total_threads
    public :: news_none, news_part, news_all

    integer, parameter :: total_threads = 65536 !! partial results over a body
    integer, parameter :: words_of_real = storage_size(1.0_rk)/32 !! of 4 B
    integer(int64), parameter :: bytes_of_real = 4*words_of_real
    integer, parameter :: neighbours_guess = 100 !! entries per particle, to judge the memory

    ! what of a list is new: nothing; near marked cells, and in them; all
    integer, parameter :: news_none = 0, news_part = 1, news_all = 2

    !> Lists of particles, in slices of slice_width, see brz_gpu_solid_lists.
    type :: lists_t
        integer :: first = 1, last = 0 !! particles
        integer :: gone = 0 !! how many of them, the last ones, are no longer there: is_gone
        integer :: slices = 0
        integer :: spare = 0 !! entries more than a list needs that moves; 0: none moves yet
        integer :: filled = 0 !! end of the last slice
        type(integers_t) :: slice, list
        type(integers_t) :: width !! room of a list in each slice
    end type lists_t

    type, extends(lists_t) :: gpu_solid_body_t
        integer :: rim = 0 !! last of its ghosts, as in body_t
        integer :: room = 0 !! places for both
        logical :: total = .false. !! total-Lagrangian
        logical :: rigid = .false.
        logical :: drawn = .false. !! has the hold
        logical :: layer = .false. !! a single layer, see brz_lone_layer
        real(rk) :: reach = 0 !! of faces in contact, see strain_face [m]
        real(rk) :: density = 0 !! unloaded [kg/m3]
        logical :: tilted = .false. !! total-Lagrangian, with gradients by tilted arms
        logical :: asleep = .false. !! left out of the steps
        logical :: packed = .false. !! `far` has the reference of its particles
        real(dp) :: box(3, 2) = 0 !! corners of `built` [m]
        type(buffer_t) :: params, material
        type(integers_t) :: pairs !! those of its list that act, see solid_moments
        type(buffer_t) :: grid !! cells of its list, and of the search for links with it
        type(integers_t) :: code, start !! of these, see grid_gpu_t; end of each cell in `order`
        integer, allocatable :: ends_there(:), grid_there(:), code_there(:)
        !! what the GPU has: first and last particle, words of `grid`; what `code` was made for
        type(integers_t) :: marked !! cells of particles with new places: 1
        type(integers_t) :: below !! (6) 1: particles lie below planes of symmetry, see count_cells
        integer :: news = news_all !! what of its list is new since links were built
        type(kernel_t) :: moments, update, forces !! those that suit the body
    end type gpu_solid_body_t

    !> Pairs of particles of different bodies, arrays of links_t.
    type, extends(lists_t) :: gpu_links_t
        type(link_layout_t) :: lay
        logical :: breaks = .true., frees = .true. !! bonds may break; or what ties may let go
        type(buffer_t) :: table, touch, weight, face
        type(integers_t) :: ends, count, met, bond, joined
        integer, allocatable :: ends_there(:) !! what the GPU has of them
        type(doubles_t) :: box !! (3, 2, bodies) corners of `built` [m]
        type(integers_t) :: row !! `count`: not read here
        type(integers_t) :: loose !! `count`, but 0 of particles that are tied for good
        integer, allocatable :: awake(:, :) !! (2, bodies) ranges of particles, see note_awake
        type(integers_t) :: linked, touching !! of these, what may be bonded; may be in contact
        integer :: n_linked = 0, n_touching = 0 !! how many
        logical :: listed = .false. !! they are those of the links and bodies of now
        type(integers_t) :: mark, found !! to list them
        type(reals_t) :: cell, press
    end type gpu_links_t

    !> Loads in scenes without air, arrays of loads_t.
    type :: gpu_loads_t
        type(gpu_facets_t) :: facets
        type(integers_t) :: place
        type(doubles_t) :: mean !! see load_carrier
    end type gpu_loads_t

    !> Columns of `state` that not every scene has, 0: none.
    type :: columns_t
        integer :: grip = 0 !! + 1..3: force on what holds a particle [N]
        integer :: owed = 0 !! energy that the hold owes [J]
        integer :: load = 0 !! + 1..3: force of the air, or of the loads [N]
        integer :: face_stress = 0 !! + 1..6: stress of the load on its faces [Pa]
        integer :: before = 0 !! + 1..3: velocity a step of the air before [m/s]
    end type columns_t

    type :: gpu_solid_t
        logical :: fetched = .true. !! the host arrays hold the state of the GPU
        logical :: stepped = .false. !! the GPU has made a step
        logical :: summed = .false. !! the ledgers are those of the present state
        logical :: settled = .true. !! bodies lie in the host arrays as they do here
        integer(int64) :: laid = 0 !! how often particles of several processes got other places
        logical :: linked = .false., bonded = .false. !! bodies meet; some are bonded
        type(gpu_links_t) :: links
        type(gpu_cohesive_t) :: cohesive
        logical :: points_fetched = .true. !! the host has the state of its points
        type(gpu_loads_t) :: loads
        integer :: n = 0, n_state = 0 !! places of particles, columns of `state`
        type(columns_t) :: column
        type(gpu_solid_body_t), allocatable :: bodies(:)
        type(ledger_t), allocatable :: ledger(:) !! of the bodies when the GPU took over
        real(dp), allocatable :: reaction(:, :) !! (3, bodies) likewise
        type(doubles_t) :: sorted !! positions that lists are built for, cell by cell: order_cells
        type(doubles_t) :: place, reference, built, book, rate, region, partial, sums_of_forces
        type(reals_t) :: motion, state, row, grad, held, axes, extra
        type(reals_t) :: near, far !! place and reference as pairs read them, see pack_places
        type(integers_t) :: tag, flags, count, cell, order
        type(integers_t) :: acting !! (n) how many `pairs` a particle has
        type(integers_t) :: seat !! every place
        type(integers_t) :: chosen !! 1: particles whose lists are built anew
        type(integers_t) :: picked, found !! they, from where a body begins; how many of each
        type(gpu_marks_t) :: part !! who goes where: brz_gpu_home_steps
        type(buffer_t) :: k_axes
        ! parts of these arrays as items have them, under the names of solid_t
        integer :: wide = 4, step_d = 0, step_p = 1, step_t = 1
        type(doubles_t) :: x, x_ref, x_built, work, contact_heat
        type(reals_t) :: v, v_before, volume, a, load, face_stress, grip, mass, mu, energy
        type(reals_t) :: damage, stress, pair, owed
        type(integers_t) :: id, fixed, moved
        type(gpu_exact_t) :: exact
        type(gpu_common_t) :: common
        integer :: n_record = 0, n_left = 0
        type(gpu_rows_t) :: record(7) !! what a particle takes along to another process
        type(gpu_rows_t) :: left(3) !! what pass 1 leaves for pass 2
        type(gpu_parcels_t) :: ghosts
        logical :: offered = .false. !! others have written what they move, and all have met since
        integer(int64) :: rebuilds = -1 !! of lists before the last step
    end type gpu_solid_t

    ! what becomes of an array of the particles
    integer, parameter :: passes = 0, stays = 1 !! is scratch; holds something for its place
    integer, parameter :: goes = 2, is_left = 3 !! with its particle; for pass 2

contains

    !> Reserve all memory.
    subroutine open_gpu_solid_memory(device, solid, loaded, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: loaded !! the air, or what the deck says, loads the bodies
        type(gpu_solid_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        type(grid_gpu_t) :: grid
        integer :: b

        gpu%linked = solid%links%present
        gpu%bonded = gpu%linked .and. solid%links%bonds
        gpu%n = solid%n
        call number_columns(solid, loaded, gpu)
        call require(device, solid, gpu, err)
        if (failed(err)) return
        call gpu%exact%open(solid%ranks, err)
        call gpu%common%open(max(n_book, n_sum), size(solid%bodies), err)
        allocate (gpu%bodies(size(solid%bodies)), gpu%ledger(size(solid%bodies)), &
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
        call gpu%ghosts%open(solid%ranks, solid%part, &
            max(sum(gpu%record%words*gpu%record%columns), &
                sum(gpu%left%words) + 6*words_of_real + n_face), err)
        call allocate_buffer(gpu%flags, 4_int64*(n_flag + lost_level*size(solid%bodies)), err)
        gpu%moved = from(gpu%flags, n_flag + 1_int64)
        call allocate_buffer(gpu%region, 48_int64, err)
        call allocate_buffer(gpu%found, 4_int64*size(gpu%bodies), err)
        call allocate_buffer(gpu%sums_of_forces, 32_int64*tally_threads, err)
        call allocate_buffer(gpu%partial, 8_int64*total_threads*max(n_book, n_sum), err)
        call copy_in(solid%region, gpu%region, 48_int64, err)
    end subroutine open_gpu_solid_memory

    !> Arrays for gpu%n places, and what the old ones hold of the bodies.
    subroutine lay_arrays(gpu, solid, old, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
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
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
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
        if (allocated(solid%held)) call visit(gpu%held, n_held*w, 1, is_left)
        call visit(gpu%book, 2, n_book, stays)
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
            if (how == goes) gpu%record(gpu%n_record) = rows_of(array, words, columns, apart)
            if (how == is_left) gpu%n_left = gpu%n_left + 1
            if (how == is_left) gpu%left(gpu%n_left) = rows_of(array, words)
            do c = 1, merge(columns, 0, how /= passes)
                do b = 1, size(gpu%bodies)
                    associate (body => gpu%bodies(b))
                        if (body%rim < body%first) cycle
                        from%address = before%address &
                            + 4*words*((c - 1_int64)*gpu%step_d + old(b) - 1)
                        to%address = array%address &
                            + 4*words*((c - 1_int64)*apart + body%first - 1)
                        call copy_within(from, to, 4_int64*words*(body%rim - body%first + 1), err)
                    end associate
                end do
            end do
            call free_buffer(before)
        end subroutine visit
    end subroutine walk

    !> Parts of the arrays under the names that items and steps have for them.
    subroutine see_arrays(gpu)
        type(gpu_solid_t), intent(inout) :: gpu
        type(integers_t) :: tags

        gpu%step_d = whole_lanes(gpu%n)
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
        if (gpu%column%owed > 0) gpu%owed = column_of(gpu, gpu%column%owed)
        if (gpu%column%grip > 0) gpu%grip = column_of(gpu, gpu%column%grip + 1)
        gpu%pair = gpu%row
        gpu%work = book_of(gpu, book_load)
        gpu%contact_heat = book_of(gpu, book_contact_heat)
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
            links%lay%step_c = gpu%step_d
        end associate
    end subroutine see_arrays

    !> Number the columns of `state`.
    subroutine number_columns(solid, loaded, gpu)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: loaded
        type(gpu_solid_t), intent(inout) :: gpu
        type(fields_t) :: fields

        call fields_of(solid, fields)
        gpu%n_state = fields%columns
        gpu%column%owed = column_of_field(fields, 'owed')
        if (loaded) gpu%column%load = column_of_field(fields, 'load') - 1
        if (allocated(solid%face_stress)) &
            gpu%column%face_stress = column_of_field(fields, 'face_stress') - 1
        if (allocated(solid%v_before)) gpu%column%before = column_of_field(fields, 'v_before') - 1
        if (allocated(solid%grip)) gpu%column%grip = column_of_field(fields, 'grip') - 1
    end subroutine number_columns

    !> Refuse a scene that does not fit, before anything is reserved.
    subroutine require(device, solid, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(inout) :: gpu
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
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column

        column_of = from(gpu%state, (column - 1_int64)*gpu%step_d + 1)
    end function column_of

    pure type(integers_t) function tags_of(gpu, column)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column

        tags_of = from(gpu%tag, (column - 1_int64)*gpu%step_d + 1)
    end function tags_of

    !> A column of the books.
    pure type(doubles_t) function book_of(gpu, column)
        type(gpu_solid_t), intent(in) :: gpu
        integer, intent(in) :: column

        book_of = from(gpu%book, (column - 1_int64)*gpu%step_d + 1)
    end function book_of

    !> One thread for each particle of a body that is there.
    pure function threads_of(body) result(n)
        type(gpu_solid_body_t), intent(in) :: body
        integer :: n(3)

        n = [body%last - body%gone - body%first + 1, 1, 1]
    end function threads_of
end module brz_gpu_solid_state
