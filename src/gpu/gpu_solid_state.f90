! SPDX-License-Identifier: MIT
!> The solids on the GPU: what it keeps there, and what it cannot do.
!>
!> All arrays of the particles stay on the GPU, see brz_gpu_solid_layout. The host arrays of
!> `solid_t` are a mirror that brz_gpu_solid_copy refreshes before a dump or a checkpoint.
module brz_gpu_solid_state
    use brz_artificial_stress, only: artificial_none
    use brz_bilinear_j2, only: bilinear_j2
    use brz_detonation_products, only: detonation_products
    use brz_device, only: allocate_buffer, buffer_t, copy_in, device_t, find_kernel, free_buffer, &
        kernel_t
    use brz_errors, only: error_t, exit_device, failed, raise
    use brz_gpu_solid_layout, only: at_hist, body_gpu_t, grid_gpu_t, n_book, n_flag, n_pose, &
        n_tag, n_total, scan_chunk, slice_width
    use brz_gruneisen, only: gruneisen
    use brz_hjc, only: hjc
    use brz_ideal_gas, only: ideal_gas
    use brz_johnson_cook, only: johnson_cook
    use brz_kernel, only: kernel_scale
    use brz_kinds, only: dp, int64, rk
    use brz_linear_elastic, only: linear_elastic
    use brz_material, only: material_t
    use brz_orthotropic_ply, only: orthotropic_ply
    use brz_polynomial_eos, only: polynomial_eos
    use brz_solid_state, only: body_t, form_bending, form_corrected_hourglass, form_rigid, &
        form_total, ledger_t, n_pair, solid_t
    use brz_text, only: to_text
    implicit none
    private
    public :: gpu_solid_t, gpu_solid_body_t, open_gpu_solid_memory, close_gpu_solid, &
              cannot_run_solid, part_of, bytes_of_real, sum_threads, total_threads, fold_threads

    integer, parameter :: sum_threads = 4096 !! partial sums over a body
    integer, parameter :: total_threads = 65536 !! partial sums of the totals of a body
    integer, parameter :: fold_threads = 1024 !! partial results that the host folds
    integer(int64), parameter :: bytes_of_real = storage_size(1.0_rk)/8
    integer, parameter :: neighbours_guess = 100 !! entries per particle, to judge the memory

    type :: gpu_solid_body_t
        integer :: first = 1, last = 0 !! particles
        integer :: slices = 0
        logical :: total = .false. !! total-Lagrangian
        logical :: rigid = .false.
        logical :: held = .false. !! uses reference positions
        type(buffer_t) :: params, material, drive, slice, list
        integer(int64) :: room = 0 !! entries that `list` has room for
        type(kernel_t) :: moments, update, forces
    end type gpu_solid_body_t

    !> Pairs of particles of different bodies.
    type :: gpu_links_t
        type(buffer_t) :: params, owner, table, cell, press, slice, count, list
        integer(int64) :: room = 0 !! entries that `list` has room for
        type(kernel_t) :: search, find_press, push, moments, forces, break
    end type gpu_links_t

    type :: gpu_solid_t
        logical :: fetched = .true. !! the host arrays hold the state of the GPU
        logical :: stepped = .false. !! the GPU has made a step
        logical :: summed = .false. !! `sums` and the ledgers are those of the present state
        logical :: linked = .false., bonded = .false. !! bodies meet; some are bonded
        type(gpu_links_t) :: links
        integer :: n = 0, n_state = 0 !! particles, columns of `state`
        type(gpu_solid_body_t), allocatable :: bodies(:)
        type(ledger_t), allocatable :: ledger(:) !! of the bodies when the GPU took over
        real(dp), allocatable :: reaction(:, :) !! (3, bodies) likewise
        real(dp), allocatable :: sums(:, :) !! (n_total, bodies) over the particles of each body
        type(buffer_t) :: place, reference, built, motion, state, tag, book, row, grad, hold
        type(buffer_t) :: rate, flags, axes, region, extra
        type(buffer_t) :: count, cell, order, start, code, grid, box, scan, part
        type(buffer_t) :: folded
        integer :: code_room = 0 !! cells that `code` has room for
        type(kernel_t) :: fold, gradients, rows, drift, hold_drive, end_support, totals
        type(kernel_t) :: extent, count_cells, fill_cells, sort_cells, search, widths
        type(kernel_t) :: scan_up, scan_down, most
        type(kernel_t) :: find_particles, rigid_place, rigid_row, rigid_push, rigid_accelerate
        type(kernel_t) :: gather_places, gather_motion, gather_columns, gather_tags, copy
    end type gpu_solid_t

contains

    !> What of a scene the GPU cannot compute yet; unallocated if it can.
    subroutine cannot_run_solid(solid, why)
        type(solid_t), intent(in) :: solid
        character(:), allocatable, intent(out) :: why
        integer :: b

        do b = 1, size(solid%bodies)
            if (model_name(int(solid%materials(solid%bodies(b)%material)%model)) == '') &
                why = "the material of body '"//trim(solid%bodies(b)%id)//"'"
        end do
        if (any(solid%bodies%variable)) why = 'variable_h'
        if (solid%n >= 2**28) why = 'more than 268 million particles'
    end subroutine cannot_run_solid

    !> Reserve all memory and find all kernels.
    subroutine open_gpu_solid_memory(device, solid, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64) :: n
        integer :: b

        gpu%n = solid%n
        gpu%linked = solid%links%present
        gpu%bonded = gpu%linked .and. solid%links%bonds
        gpu%n_state = at_hist + solid%n_hist + merge(1, 0, gpu%linked)
        n = solid%n
        call require(device, solid, err)
        call find_kernels(device, gpu, err)
        call allocate_buffer(gpu%place, 32*n, err)
        call allocate_buffer(gpu%reference, 32*n, err)
        call allocate_buffer(gpu%built, 32*n, err)
        call allocate_buffer(gpu%motion, 4*bytes_of_real*n, err)
        call allocate_buffer(gpu%state, gpu%n_state*bytes_of_real*n, err)
        call allocate_buffer(gpu%tag, 4_int64*n_tag*n, err)
        call allocate_buffer(gpu%book, 8_int64*n_book*n, err)
        call allocate_buffer(gpu%row, n_pair*bytes_of_real*n, err)
        call allocate_buffer(gpu%grad, 9*bytes_of_real*n, err)
        call allocate_buffer(gpu%hold, merge(24*n, 8_int64, any(solid%bodies%directional)), err)
        call allocate_buffer(gpu%rate, 8*n, err)
        call allocate_buffer(gpu%flags, 4_int64*n_flag, err)
        call allocate_buffer(gpu%region, 48_int64, err)
        call allocate_buffer(gpu%box, 48_int64, err)
        call allocate_buffer(gpu%extra, 8_int64, err)
        call allocate_buffer(gpu%count, 4*n, err)
        call allocate_buffer(gpu%cell, 4*n, err)
        call allocate_buffer(gpu%order, 4*n, err)
        call allocate_buffer(gpu%start, 4*(max(512_int64, 2*n) + 2), err)
        call allocate_buffer(gpu%grid, int(storage_size(grid_gpu_t(1, 1, 1, 1, 1, 1.0_dp, 1.0_dp, &
                                                                   1.0_dp))/8, int64), err)
        call allocate_buffer(gpu%scan, scan_bytes(n), err)
        call allocate_buffer(gpu%part, 8_int64*total_threads*(n_total + n_book), err)
        call allocate_buffer(gpu%folded, 8_int64*fold_threads*(n_total + n_book), err)
        call copy_in(solid%region, gpu%region, 48_int64, err)
        allocate (gpu%bodies(size(solid%bodies)), gpu%ledger(size(solid%bodies)), &
                  gpu%reaction(3, size(solid%bodies)), gpu%sums(n_total, size(solid%bodies)))
        call put_axes(solid, gpu, err)
        do b = 1, size(solid%bodies)
            call open_body(device, solid, b, gpu%bodies(b), err)
        end do
    end subroutine open_gpu_solid_memory

    !> Memory of the sums of the levels of a scan over the cells of n particles [B].
    pure integer(int64) function scan_bytes(n)
        integer(int64), intent(in) :: n
        integer(int64) :: m

        scan_bytes = 0
        m = max(512_int64, 2*n) + 2
        do
            m = (m - 1)/scan_chunk + 1
            scan_bytes = scan_bytes + (4*m/256 + 1)*256
            if (m == 1) return
        end do
    end function scan_bytes

    !> Refuse a scene that does not fit, before anything is reserved.
    subroutine require(device, solid, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer(int64) :: bytes

        bytes = solid%n*(bytes_of_real*(4 + at_hist + solid%n_hist + n_pair + 9) + 8*n_book &
                         + 4*n_tag + 3*32 + 8 + 3*4 + 8 + 4*neighbours_guess &
                         + merge(20*bytes_of_real, 0_int64, solid%links%present))
        if (bytes > device%free_bytes) call raise(err, exit_device, 'the bodies need about '// &
            to_text(int(bytes/2**20))//' MiB on the GPU, but only '// &
            to_text(int(device%free_bytes/2**20))//' MiB are free: use fewer particles, a '// &
            'build with PRECISION=mixed, or --backend cpu')
    end subroutine require

    subroutine find_kernels(device, gpu, err)
        type(device_t), intent(in) :: device
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err

        call find_kernel(device, 'solid_gradients', gpu%gradients, err)
        call find_kernel(device, 'solid_rows', gpu%rows, err)
        call find_kernel(device, 'solid_drift', gpu%drift, err)
        call find_kernel(device, 'solid_hold_drive', gpu%hold_drive, err)
        call find_kernel(device, 'solid_end_support', gpu%end_support, err)
        call find_kernel(device, 'solid_rigid_place', gpu%rigid_place, err)
        call find_kernel(device, 'solid_rigid_row', gpu%rigid_row, err)
        call find_kernel(device, 'solid_rigid_push', gpu%rigid_push, err)
        call find_kernel(device, 'solid_rigid_accelerate', gpu%rigid_accelerate, err)
        call find_kernel(device, 'solid_fold', gpu%fold, err)
        call find_kernel(device, 'solid_totals_of', gpu%totals, err)
        call find_kernel(device, 'solid_extent', gpu%extent, err)
        call find_kernel(device, 'count_cells', gpu%count_cells, err)
        call find_kernel(device, 'fill_cells_of', gpu%fill_cells, err)
        call find_kernel(device, 'sort_cells', gpu%sort_cells, err)
        call find_kernel(device, 'solid_search', gpu%search, err)
        call find_kernel(device, 'slice_widths', gpu%widths, err)
        call find_kernel(device, 'scan_up', gpu%scan_up, err)
        call find_kernel(device, 'scan_down', gpu%scan_down, err)
        call find_kernel(device, 'max_strided', gpu%most, err)
        call find_kernel(device, 'find_particles', gpu%find_particles, err)
        call find_kernel(device, 'gather_places', gpu%gather_places, err)
        call find_kernel(device, 'gather_motion', gpu%gather_motion, err)
        call find_kernel(device, 'gather_columns', gpu%gather_columns, err)
        call find_kernel(device, 'gather_tags', gpu%gather_tags, err)
        call find_kernel(device, 'copy_words', gpu%copy, err)
    end subroutine find_kernels

    !> Axes of the plies of all bodies, one after the other.
    subroutine put_axes(solid, gpu, err)
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        real(rk), allocatable :: axes(:, :, :)
        integer :: b, n

        n = axes_before(solid, size(solid%bodies) + 1)
        allocate (axes(3, 3, max(n, 1)))
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%directional) cycle
            n = axes_before(solid, b)
            axes(:, :, n + 1:n + size(solid%bodies(b)%axes, 3)) = solid%bodies(b)%axes
        end do
        call allocate_buffer(gpu%axes, size(axes)*bytes_of_real, err)
        call copy_in(axes, gpu%axes, size(axes)*bytes_of_real, err)
    end subroutine put_axes

    !> Axes of the bodies before body b.
    pure integer function axes_before(solid, b) result(n)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        integer :: k

        n = 0
        do k = 1, b - 1
            if (solid%bodies(k)%directional) n = n + size(solid%bodies(k)%axes, 3)
        end do
    end function axes_before

    !> What one body needs.
    subroutine open_body(device, solid, b, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(gpu_solid_body_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(body_gpu_t) :: params
        type(material_t) :: material
        integer(int64) :: bytes

        material = solid%materials(solid%bodies(b)%material)
        params = params_of(solid%bodies(b), solid%dimension, axes_before(solid, b))
        params%fails = material%fails
        gpu%first = params%first
        gpu%last = params%last
        gpu%slices = (gpu%last - gpu%first)/slice_width + 1
        gpu%total = params%formulation == form_total
        gpu%rigid = params%formulation == form_rigid
        gpu%held = gpu%total .or. params%formulation == form_bending
        bytes = storage_size(params)/8
        call allocate_buffer(gpu%params, bytes, err)
        call copy_in(params, gpu%params, bytes, err)
        bytes = storage_size(material)/8
        call allocate_buffer(gpu%material, bytes, err)
        call copy_in(material, gpu%material, bytes, err)
        call allocate_buffer(gpu%drive, 8_int64*n_pose, err)
        call allocate_buffer(gpu%slice, 4_int64*(gpu%slices + 1), err)
        call find_kernel(device, 'solid_moments'//trim(merge('_held', '     ', gpu%held)), &
                         gpu%moments, err)
        call find_kernel(device, 'update_by_'//model_name(int(material%model)), gpu%update, err)
        call find_kernel(device, 'solid_forces_'//force_name(params), gpu%forces, err)
    end subroutine open_body

    !> A body as the kernels see it.
    pure function params_of(body, dimension, axes) result(p)
        type(body_t), intent(in) :: body
        integer, intent(in) :: dimension, axes
        type(body_gpu_t) :: p

        p%first = body%first
        p%last = body%last
        p%dimension = dimension
        p%formulation = body%formulation
        p%artificial = body%artificial
        p%balsara = merge(1, 0, body%balsara)
        p%directional = merge(1, 0, body%directional)
        p%axes = axes
        p%fails = 0
        p%keep_force = merge(0, 1, body%motion%n > 0)
        p%h = body%h
        p%scale = kernel_scale(body%h, dimension)
        p%half_over_h = 1/(2*body%h)
        p%alpha = body%alpha
        p%beta = body%beta
        p%zeta = body%zeta
        p%zeta_viscous = body%zeta_viscous
        p%cfl = body%cfl
        p%artificial_strength = body%artificial_strength
        p%artificial_power = body%artificial_power
        p%shape_at_spacing = body%shape_at_spacing
    end function params_of

    !> Which forces a body has, as the kernels are named.
    pure function force_name(p) result(name)
        type(body_gpu_t), intent(in) :: p
        character(:), allocatable :: name

        select case (p%formulation)
        case (form_bending, form_total)
            name = 'stiff'
            if (p%directional == 1) name = 'axial'
        case (form_corrected_hourglass)
            name = 'viscous'
        case default
            name = 'plain'
            if (p%artificial /= artificial_none) name = 'artificial'
        end select
    end function force_name

    !> Name of a material model among the kernels.
    pure function model_name(model) result(name)
        integer, intent(in) :: model
        character(:), allocatable :: name

        select case (model)
        case (linear_elastic); name = 'linear_elastic'
        case (gruneisen); name = 'gruneisen'
        case (orthotropic_ply); name = 'orthotropic_ply'
        case (hjc); name = 'hjc'
        case (polynomial_eos); name = 'polynomial_eos'
        case (bilinear_j2); name = 'bilinear_j2'
        case (johnson_cook); name = 'johnson_cook'
        case (ideal_gas); name = 'ideal_gas'
        case (detonation_products); name = 'detonation_products'
        case default; name = ''
        end select
    end function model_name

    !> The rest of a buffer from a byte on; only to be read and written, never freed.
    pure function part_of(buffer, byte) result(rest)
        type(buffer_t), intent(in) :: buffer
        integer(int64), intent(in) :: byte
        type(buffer_t) :: rest

        rest%address = buffer%address + byte
        rest%bytes = buffer%bytes - byte
    end function part_of

    !> Give the memory back.
    subroutine close_gpu_solid(gpu)
        type(gpu_solid_t), intent(inout) :: gpu
        type(buffer_t) :: all(33)
        integer :: b

        all = [gpu%place, gpu%reference, gpu%built, gpu%motion, gpu%state, gpu%tag, gpu%book, &
               gpu%row, gpu%grad, gpu%hold, gpu%rate, gpu%flags, gpu%axes, gpu%region, gpu%extra, &
               gpu%count, gpu%cell, gpu%order, gpu%start, gpu%code, gpu%grid, gpu%scan, gpu%part, &
               gpu%folded, gpu%box, gpu%links%params, gpu%links%owner, gpu%links%table, &
               gpu%links%cell, gpu%links%press, gpu%links%slice, gpu%links%count, gpu%links%list]
        do b = 1, size(all)
            call free_buffer(all(b))
        end do
        do b = 1, size(gpu%bodies)
            call free_buffer(gpu%bodies(b)%params)
            call free_buffer(gpu%bodies(b)%material)
            call free_buffer(gpu%bodies(b)%drive)
            call free_buffer(gpu%bodies(b)%slice)
            call free_buffer(gpu%bodies(b)%list)
        end do
    end subroutine close_gpu_solid
end module brz_gpu_solid_state
