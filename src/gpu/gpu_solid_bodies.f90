! SPDX-License-Identifier: MIT
!> Each body on the GPU: its parameters, its material, and the kernels that suit them.
module brz_gpu_solid_bodies
    use brz_body, only: body_t
    use brz_device, only: allocate_buffer, copy_in, find_kernel, put_buffer
    use brz_errors, only: error_t, exit_device, raise
    use brz_formulation_names, only: artificial_none, form_bending, form_corrected_hourglass, &
        form_rigid, form_total
    use brz_gradient, only: limiter_slope
    use brz_gpu_solid_layout, only: body_gpu_t, slice_width
    use brz_gpu_solid_state, only: bytes_of_real
    use brz_gpu_solid_tiles, only: find_kinds, lay_adders
    use brz_solid_device, only: columns_t, body_device_t, solid_device_t
    use brz_kernel, only: kernel_scale
    use brz_kinds, only: int64, rk
    use brz_material, only: class_elastic, material_t
    use brz_model_list, only: find_kernel_of
    use brz_particle_marks, only: is_gone
    use brz_row_loop_bodies, only: rules_of
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_text, only: to_text
    implicit none
    private
    public :: open_gpu_bodies, cannot_run_solid

contains

    !> What of a scene the GPU cannot compute yet; unallocated if it can.
    subroutine cannot_run_solid(solid, why)
        class(bodies_t), intent(in) :: solid
        character(:), allocatable, intent(out) :: why
        character(:), allocatable :: name
        integer :: b, slots

        do b = 1, size(solid%bodies)
            associate (material => solid%materials(solid%bodies(b)%material))
                call find_kernel_of(int(material%model), name, slots)
                if (name == '' .or. slots < material%n_hist) &
                    why = "the material of body '"//trim(solid%bodies(b)%id)//"'"
            end associate
        end do
        if (solid%n >= 2**28) why = 'more than 268 million particles'
    end subroutine cannot_run_solid

    !> Memory and kernels of all bodies.
    subroutine open_gpu_bodies(solid, gpu, err)
        class(bodies_t), intent(in) :: solid
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(body_gpu_t) :: params
        integer :: b

        call put_axes(solid, gpu, err)
        call allocate_buffer(gpu%params, size(solid%bodies)*bytes_of(params), err)
        do b = 1, size(solid%bodies)
            associate (part => gpu%bodies(b)%params)
                part%bytes = bytes_of(params)
                part%address = gpu%params%address + (b - 1)*part%bytes
            end associate
            call open_body(solid, b, gpu%column, gpu%bodies(b), err)
        end do
        call find_kinds(gpu)
        call lay_adders(gpu, err)
    end subroutine open_gpu_bodies

    !> Bytes of a structure in an array.
    pure integer(int64) function bytes_of(x)
        class(*), intent(in) :: x

        bytes_of = storage_size(x)/8
    end function bytes_of

    !> Axes of the plies of all bodies, one after the other.
    subroutine put_axes(solid, gpu, err)
        class(bodies_t), intent(in) :: solid
        type(solid_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        real(rk), allocatable :: axes(:, :, :)
        integer :: b, n

        n = axes_before(solid, size(solid%bodies) + 1)
        allocate (axes(3, 4, max(n, 1)))
        do b = 1, size(solid%bodies)
            if (.not. solid%bodies(b)%directional) cycle
            n = axes_before(solid, b)
            axes(:, :, n + 1:n + size(solid%bodies(b)%axes, 3)) = solid%bodies(b)%axes
        end do
        call put_buffer(axes, gpu%axes, size(axes)*bytes_of_real, err)
    end subroutine put_axes

    !> Axes of the bodies before body b.
    pure integer function axes_before(solid, b) result(n)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        integer :: k

        n = 0
        do k = 1, b - 1
            if (solid%bodies(k)%directional) n = n + size(solid%bodies(k)%axes, 3)
        end do
    end function axes_before

    !> What one body needs.
    subroutine open_body(solid, b, column, gpu, err)
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b
        type(columns_t), intent(in) :: column
        type(body_device_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(body_gpu_t) :: params
        type(material_t) :: material
        character(:), allocatable :: name
        integer :: slots

        material = solid%materials(solid%bodies(b)%material)
        params = params_of(solid%bodies(b), solid, axes_before(solid, b))
        params%rules = rules_of(solid%bodies(b), material)
        params%material = material
        params%springs = merge(1, 0, material%class == class_elastic)
        params%control_due = column%control_due
        params%reaction_force = column%reaction_force
        params%in_air = merge(0, 1, allocated(solid%loads%of))
        params%face_stress = merge(column%face_stress, 0, solid%bodies(b)%face_share > 0)
        gpu%first = params%first
        gpu%last = params%last
        gpu%gone = count(solid%fixed(gpu%first:gpu%last) == is_gone)
        gpu%rim = solid%bodies(b)%rim
        gpu%slices = (gpu%last - gpu%first)/slice_width + 1
        gpu%total = params%formulation == form_total
        gpu%rigid = params%formulation == form_rigid
        gpu%in_tension = params%tensile_control > 0
        gpu%layer = params%layer > 0
        call copy_in(params, gpu%params, bytes_of(params), err)
        call allocate_buffer(gpu%slice, 4_int64*(gpu%slices + 1), err)
        call find_kernel('solid_moments_'//moment_name(params), gpu%moments, err)
        call find_kernel_of(int(material%model), name, slots)
        if (slots < material%n_hist) call raise(err, exit_device, 'the kernel '//name//' holds '// &
            to_text(slots)//' history variables, the material '//to_text(int(material%n_hist)))
        call find_kernel(name, gpu%update, err)
        call find_kernel('solid_forces_'//force_name(params), gpu%forces, err)
    end subroutine open_body

    !> A body as the kernels see it.
    pure function params_of(body, solid, axes) result(p)
        type(body_t), intent(in) :: body
        class(particles_t), intent(in) :: solid
        integer, intent(in) :: axes
        type(body_gpu_t) :: p

        p%body_numbers_t = body%body_numbers_t
        p%dimension = solid%dimension
        p%directional = merge(1, 0, body%directional)
        p%variable = merge(1, 0, body%variable)
        p%axes = axes
        p%keep_force = merge(0, 1, body%motion%n > 0)
        p%scale = kernel_scale(body%h, solid%dimension)/real(solid%depth, rk)
        p%depth = real(solid%depth, rk)
        p%half_over_h = 1/(2*body%h)
        p%spares = merge(1, 0, body%limiter == limiter_slope)
        p%curved = merge(1, 0, body%curved)
        p%middle = body%round%centre
        p%width = real(1/body%stretch, rk)
        p%layer_of_ply = merge(1, 0, body%layer_of_ply)
        p%reach = body%face_share*real(body%spacing, rk)
    end function params_of

    !> Which sums of pass 1 a body needs, as the kernels are named.
    pure function moment_name(p) result(name)
        type(body_gpu_t), intent(in) :: p
        character(:), allocatable :: name

        name = 'alone'
        if (p%formulation == form_bending .or. p%formulation == form_total) name = 'beside'
        if (p%tensile_control > 0) name = 'drawn'
        if (any(p%normal > 0)) name = 'tilted'
        if (p%curved == 1) name = 'curved'
        if (any(p%normal > 0) .and. p%formulation == form_total) name = 'referred'
    end function moment_name

    !> Which forces a body has, as the kernels are named.
    pure function force_name(p) result(name)
        type(body_gpu_t), intent(in) :: p
        character(:), allocatable :: name

        select case (p%formulation)
        case (form_bending, form_total)
            name = 'stiff'
            if (p%directional == 1) name = 'axial'
            if (p%directional == 1 .and. p%formulation == form_total) name = 'wide'
        case (form_corrected_hourglass)
            name = 'viscous'
            if (p%tensile_control > 0) name = 'drawn'
            if (any(p%normal > 0)) name = 'plate'
            if (p%curved == 1) name = 'wall'
        case default
            name = 'plain'
            if (p%artificial /= artificial_none) name = 'artificial'
        end select
    end function force_name
end module brz_gpu_solid_bodies
