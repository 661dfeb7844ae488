! SPDX-License-Identifier: MIT
!> Particles on several GPUs when lists are built: what the steps of brz_owner_driver need there.
!> The state does not leave the GPUs.
module brz_gpu_solid_owner
    use brz_buffers, only: doubles_t, from
    use brz_device, only: clear_buffer, copy_in, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_formulation_names, only: form_total
    use brz_ghost_wants, only: has_boxes, tell_boxes
    use brz_lists, only: put_changed => put_changed_table, put_list, read_first
    use brz_gpu_solid_layout, only: n_diag, slice_width
    use brz_gpu_solid_state, only: diag_of
    use brz_solid_device, only: solid_device_t
    use brz_gpu_solid_diagnostics, only: fetch_accounts, find_extents
    use brz_owner_launches, only: owner_kernels
    use brz_kinds, only: dp, int64
    use brz_places, only: message_buffers_t
    use brz_present_table, only: attach
    use brz_ranks, only: least_of_all
    use brz_send_lists, only: list_marks
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_part, only: solid_part_t
    implicit none
    private
    public :: close_diagnostics, fetch_homes, find_boxes, find_lowest, list_leaving, put_region, &
        put_wants, send_away, settle_places

contains

    !> Places that decide to which process the particles of body b belong.
    pure type(doubles_t) function owners_of(gpu, solid, b)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b

        owners_of = gpu%x_built
        if (solid%bodies(b)%formulation == form_total) owners_of = gpu%x_ref
    end function owners_of

    !> The lowest homes of particles of all processes, where planes of symmetry are; all must call.
    subroutine find_lowest(gpu, solid, part, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(in) :: solid
        type(solid_part_t), intent(inout) :: part
        type(error_t), intent(inout) :: err
        real(dp) :: box(3, 2, size(gpu%bodies)), lowest(3)
        integer :: b

        part%lowest = -huge(1.0_dp)
        if (.not. any(solid%mirror)) return
        do b = 1, size(gpu%bodies)
            call find_extents(gpu, b, b, owners_of(gpu, solid, b), err)
        end do
        call gpu%common%read_boxes(1, box, err)
        lowest = minval(box(:, 1, :), 2)
        call least_of_all(solid%ranks, lowest)
        where (solid%mirror) part%lowest = lowest
    end subroutine find_lowest

    !> Boxes that the particles of each body fill in each process, where links want them; all must
    !> call.
    subroutine find_boxes(gpu, solid, part, err)
        type(solid_device_t), intent(in) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        type(solid_part_t), intent(inout) :: part
        type(error_t), intent(inout) :: err
        real(dp) :: box(3, 2, size(gpu%bodies))

        if (.not. has_boxes(solid)) return
        call find_extents(gpu, 1, size(gpu%bodies), gpu%x_built, err)
        call gpu%common%read_boxes(1, box, err)
        call tell_boxes(solid%ranks, box, part%boxes)
    end subroutine find_boxes

    !> The regions of all processes, where they are others than the GPU has.
    subroutine put_region(gpu, region, err)
        type(solid_device_t), intent(inout) :: gpu
        real(dp), intent(in), contiguous :: region(:, :, :) !! (3, 2, processes) corners [m]
        type(error_t), intent(inout) :: err

        call put_changed(transfer(region, [0]), gpu%region_there, gpu%region_at, err)
        call attach(region, gpu%region_at)
    end subroutine put_region

    !> The ways of a body to need a ghost, which have a copy until they are given others.
    subroutine put_wants(gpu, want, err)
        type(solid_device_t), intent(inout) :: gpu
        real(dp), intent(in), contiguous :: want(:, :, :)
        type(error_t), intent(inout) :: err

        call reserve_buffer(gpu%wants, 8_int64*size(want), err)
        call copy_in(want, gpu%wants, 8_int64*size(want), err)
        call attach(want, gpu%wants)
    end subroutine put_wants

    !> The homes of particles first..last of body b.
    subroutine fetch_homes(gpu, solid, b, first, last, x, err)
        type(solid_device_t), intent(in) :: gpu
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b, first, last
        real(dp), intent(inout), contiguous :: x(:, :) !! (4, last - first + 1) [m]
        type(error_t), intent(inout) :: err

        call copy_out(from(owners_of(gpu, solid, b), 4_int64*first - 3), x, &
                      32_int64*(last - first + 1), err)
    end subroutine fetch_homes

    !> The marked particles, on the host.
    subroutine list_leaving(gpu, n, part, number, leaving, err)
        type(solid_device_t), intent(inout) :: gpu
        integer, intent(in) :: n !! particles
        type(solid_part_t), intent(inout) :: part
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        type(message_buffers_t), intent(inout) :: leaving
        type(error_t), intent(inout) :: err

        associate (gone => gpu%ghosts%gone)
            call list_marks(.true., n, number, part%marks_t, gone, err)
            leaving%first = gone%first
            allocate (leaving%place(sum(number)), source=0)
            call read_first(.true., int(sum(number)), gone%place, leaving%place, err)
        end associate
    end subroutine list_leaving

    !> Send the particles that leave, and take in those that come.
    subroutine send_away(gpu, number, leaving, coming, err)
        type(solid_device_t), intent(inout) :: gpu
        integer(int64), intent(in) :: number(:, :) !! (to processes, from processes)
        type(message_buffers_t), intent(in) :: leaving, coming
        type(error_t), intent(inout) :: err

        associate (ghosts => gpu%ghosts)
            ghosts%gone%first = leaving%first
            ghosts%come%first = coming%first
            call put_list(.true., leaving%place, ghosts%gone%place, err)
            call put_list(.true., coming%place, ghosts%come%place, err)
            call ghosts%aim(number, ghosts%gone, err)
            call ghosts%send(ghosts%gone, ghosts%come, gpu%record, gpu%record, err)
        end associate
        gpu%bodies%packed = .false.
    end subroutine send_away

    !> The diagnostics of bodies whose particles change: what places have summed goes to the host.
    subroutine close_diagnostics(gpu, solid, changed, err)
        type(solid_device_t), intent(inout) :: gpu
        class(bodies_t), intent(inout) :: solid
        logical, intent(in) :: changed(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: b, c

        gpu%summed = .false.
        call fetch_accounts(gpu, solid, err)
        do b = 1, size(changed)
            if (.not. changed(b)) cycle
            gpu%account(b) = solid%bodies(b)%account
            gpu%reaction(:, b) = solid%bodies(b)%reaction
            do c = 1, n_diag
                call clear_buffer(from(diag_of(gpu, c), int(gpu%bodies(b)%first, int64)), err, &
                                  8_int64*gpu%bodies(b)%room)
            end do
        end do
    end subroutine close_diagnostics

    !> Kernels get to know where bodies lie. What lies behind the particles limits no time step.
    subroutine settle_places(gpu, solid, err)
        type(solid_device_t), intent(inout) :: gpu
        class(listed_bodies_t), intent(in) :: solid
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            associate (body => gpu%bodies(b))
                call put_changed([body%first, body%last - body%gone], body%ends_there, &
                                 body%params, err)
                body%slices = (body%last - body%first)/slice_width + 1
                call reserve_buffer(body%slice, 4_int64*(body%slices + 1), err)
                associate (end => body%first + body%room - 1)
                    call clear_buffer(from(gpu%rate, body%last + 1_int64), err, &
                                      8_int64*(end - body%last))
                    if (.not. solid%links%present) cycle
                    call owner_kernels%put_away(end - body%rim, body%rim + 1, 4, gpu%place, err)
                    call clear_buffer(from(gpu%links%count, body%last + 1_int64), err, &
                                      4_int64*(end - body%last))
                end associate
            end associate
        end do
        if (solid%links%present) call put_changed(gpu%bodies%first + gpu%bodies%room - 1, &
                                                  gpu%links%ends_there, gpu%links%ends, err)
    end subroutine settle_places
end module brz_gpu_solid_owner
