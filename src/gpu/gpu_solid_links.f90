! SPDX-License-Identifier: MIT
!> Contact and bonds between bodies on the GPU: memory, lists of links, launches.
module brz_gpu_solid_links
    use brz_contact, only: law_none
    use brz_device, only: allocate_buffer, arguments_t, clear_buffer, copy_out, device_t, &
        find_kernel, free_buffer, kernel_t, launch, put_buffer
    use brz_errors, only: error_t
    use brz_gpu_scan, only: running_sum
    use brz_gpu_solid_cohesive, only: gather_gpu_points, open_gpu_points
    use brz_gpu_solid_layout, only: link_gpu_t, n_terms, slice_width
    use brz_gpu_solid_search, only: order_body
    use brz_gpu_solid_state, only: bytes_of_real, gpu_solid_t, part_of
    use brz_kinds, only: dp, int64, rk
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_links, build_gpu_links, add_bond_moments, contact_pass

contains

    !> Reserve memory and copy what the laws between the bodies are.
    subroutine open_gpu_links(device, solid, gpu, err)
        type(device_t), intent(in) :: device
        type(solid_t), intent(in) :: solid
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(link_gpu_t) :: params
        integer(int64) :: bytes, n
        integer :: b

        if (.not. gpu%linked) return
        n = gpu%n
        associate (links => gpu%links)
            call put_buffer([(spread(b, 1, solid%bodies(b)%last - solid%bodies(b)%first + 1), &
                              b=1, size(solid%bodies))], links%owner, 4*n, err)
            bytes = size(solid%links%table)*(storage_size(solid%links%table)/8_int64)
            call put_buffer(solid%links%table, links%table, bytes, err)
            call put_buffer(solid%links%cell, links%cell, &
                            size(solid%links%cell)*bytes_of_real, err)
            params%bodies = size(solid%bodies)
            params%touch = gpu%touch
            params%weight = gpu%weight
            params%dimension = solid%dimension
            params%holds = merge(1, 0, gpu%owed > 0)
            params%depth = real(solid%depth, rk)
            call put_buffer(params, links%params, int(storage_size(params)/8, int64), err)
            call allocate_buffer(links%press, 8*bytes_of_real*n, err)
            call allocate_buffer(links%count, 4*n, err)
            call allocate_buffer(links%met, 4_int64*size(solid%bodies)**2, err)
            call allocate_buffer(links%slice, 4*((n - 1)/slice_width + 2), err)
            call free_buffer(gpu%extra)
            call allocate_buffer(gpu%extra, n_terms*bytes_of_real*n, err)
            call find_kernel(device, 'solid_link_search', links%search, err)
            call find_kernel(device, 'solid_link_press', links%find_press, err)
            call find_kernel(device, 'solid_link_push', links%push, err)
            call find_kernel(device, 'solid_bond_moments', links%moments, err)
            call find_kernel(device, 'solid_bond_forces', links%forces, err)
            call find_kernel(device, 'solid_bond_break', links%break, err)
        end associate
    end subroutine open_gpu_links

    !> Build the links for the positions `built`: count them, then list them, body by body.
    subroutine build_gpu_links(gpu, solid, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid !! its search tables are overwritten
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer(int64) :: entries
        integer :: keep, slices, longest, met(size(solid%bodies), size(solid%bodies))

        if (.not. gpu%linked) return
        slices = (gpu%n - 1)/slice_width + 1
        call clear_buffer(gpu%links%met, err)
        do keep = 0, 1
            call clear_buffer(gpu%links%count, err)
            call visit_bodies(gpu, solid, keep, err)
            if (keep == 1) exit
            arguments%n = 0
            call arguments%add(slices)
            call arguments%add(1)
            call arguments%add(gpu%n)
            call arguments%add_all(gpu%links%count, gpu%links%slice)
            call launch(gpu%widths, [slices, 1, 1], arguments, err)
            call running_sum(gpu%scan, gpu%links%slice, slices, err, longest)
            entries = int(longest, int64)*slice_width
            if (entries > gpu%links%room .or. gpu%links%room == 0) then
                call free_buffer(gpu%links%list)
                gpu%links%room = entries + entries/4 + slice_width
                call allocate_buffer(gpu%links%list, 4*gpu%links%room, err)
            end if
        end do
        met = 0
        call copy_out(gpu%links%met, met, 4_int64*size(met), err)
        solid%links%met = met == 1
    end subroutine build_gpu_links

    !> Count or list, for every particle, its links with one body after the other; note which bodies
    !> have some.
    subroutine visit_bodies(gpu, solid, keep, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: keep
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: a, b, cells

        do b = 1, size(gpu%bodies)
            if (all(solid%links%table(:, b)%law == law_none)) cycle
            call order_body(gpu, solid, b, gpu%built, &
                            2*real(maxval(solid%links%table(:, b)%h), dp) + solid%skin, cells, err)
            do a = 1, size(gpu%bodies)
                if (solid%links%table(a, b)%law == law_none) cycle
                arguments%n = 0
                call arguments%add(keep)
                call arguments%add(gpu%bodies(a)%first)
                call arguments%add(gpu%bodies(a)%last)
                call arguments%add(2*real(solid%links%table(a, b)%h, dp) + solid%skin)
                call arguments%add_all(gpu%grid, gpu%box, gpu%code, gpu%start, gpu%order, &
                    gpu%built, gpu%links%slice)
                call arguments%add_all(gpu%links%count, gpu%links%list)
                call arguments%add(part_of(gpu%links%met, &
                                           4_int64*(a - 1 + size(gpu%bodies)*(b - 1))))
                call launch(gpu%links%search, &
                            [gpu%bodies(a)%last - gpu%bodies(a)%first + 1, 1, 1], arguments, err)
            end do
        end do
    end subroutine visit_bodies

    !> Add the bonded partners to the sums of pass 1.
    subroutine add_bond_moments(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        if (.not. gpu%bonded) return
        call arguments%add(gpu%n)
        associate (links => gpu%links)
            call arguments%add_all(links%params, links%owner, links%table, gpu%place, &
                gpu%reference, gpu%motion, gpu%state)
            call arguments%add_all(gpu%tag, links%slice, links%count, links%list, gpu%row, &
                gpu%grad, gpu%hold)
            call arguments%add_all(gpu%held)
            call launch_awake(gpu, links%moments, arguments, err)
        end associate
    end subroutine add_bond_moments

    !> Between the passes: bonds break, interfaces open, then all forces between bodies go into
    !> `extra`.
    subroutine contact_pass(gpu, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        real(dp), intent(in) :: dt !! step just made [s]
        type(error_t), intent(inout) :: err

        if (.not. gpu%linked) return
        if (gpu%bonded .and. dt > 0) call break_bonds(gpu, err)
        call open_gpu_points(gpu, err)
        call find_pressures(gpu, real(dt, rk), err)
        call push_bodies(gpu, real(dt, rk), err)
        if (gpu%bonded) call add_bond_forces(gpu, err)
        call gather_gpu_points(gpu, err)
    end subroutine contact_pass

    subroutine break_bonds(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call begin_bonds(gpu, arguments)
        call arguments%add_all(gpu%state, gpu%links%slice, gpu%links%count, gpu%links%list, &
            gpu%tag)
        call launch_awake(gpu, gpu%links%break, arguments, err)
    end subroutine break_bonds

    subroutine add_bond_forces(gpu, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call begin_bonds(gpu, arguments)
        call arguments%add_all(gpu%state, gpu%hold, gpu%held, gpu%tag, gpu%links%slice, &
            gpu%links%count, gpu%links%list)
        call arguments%add_all(gpu%extra)
        call launch_awake(gpu, gpu%links%forces, arguments, err)
    end subroutine add_bond_forces

    !> The first arguments of the kernels of bonds that read what pass 1 has found.
    subroutine begin_bonds(gpu, arguments)
        type(gpu_solid_t), intent(in) :: gpu
        type(arguments_t), intent(inout) :: arguments

        call arguments%add(gpu%n)
        call arguments%add_all(gpu%links%params, gpu%links%owner, gpu%links%table, gpu%place, &
            gpu%reference, gpu%motion, gpu%row)
    end subroutine begin_bonds

    subroutine find_pressures(gpu, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        real(rk), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(gpu%n)
        call arguments%add(dt)
        associate (links => gpu%links)
            call arguments%add_all(links%params, links%owner, links%table, links%cell, &
                gpu%place, gpu%motion, gpu%state)
            call arguments%add_all(gpu%tag, links%slice, links%count, links%list, links%press, &
                gpu%book)
            call launch_awake(gpu, links%find_press, arguments, err)
        end associate
    end subroutine find_pressures

    subroutine push_bodies(gpu, dt, err)
        type(gpu_solid_t), intent(in) :: gpu
        real(rk), intent(in) :: dt !! [s]
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        call arguments%add(gpu%n)
        call arguments%add(dt)
        associate (links => gpu%links)
            call arguments%add_all(links%params, links%owner, links%table, links%cell, &
                gpu%place, gpu%motion, gpu%row)
            call arguments%add_all(links%press, links%slice, links%count, links%list, gpu%state, &
                gpu%tag, gpu%book)
            call arguments%add_all(gpu%rate, gpu%extra)
            call launch_awake(gpu, links%push, arguments, err)
        end associate
    end subroutine push_bodies

    !> Launch a kernel over the particles of the bodies that are awake; bodies side by side go
    !> together. Its last two arguments are the first and the last particle.
    subroutine launch_awake(gpu, kernel, arguments, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(kernel_t), intent(in) :: kernel
        type(arguments_t), intent(inout) :: arguments !! all but the last two
        type(error_t), intent(inout) :: err
        integer :: b, given, first, last

        given = arguments%n
        first = 0
        do b = 1, size(gpu%bodies)
            if (gpu%bodies(b)%asleep) cycle
            if (first == 0) first = gpu%bodies(b)%first
            last = gpu%bodies(b)%last
            if (b < size(gpu%bodies)) then
                if (.not. gpu%bodies(b + 1)%asleep) cycle
            end if
            arguments%n = given
            call arguments%add(first)
            call arguments%add(last)
            call launch(kernel, [last - first + 1, 1, 1], arguments, err)
            first = 0
        end do
    end subroutine launch_awake
end module brz_gpu_solid_links
