! SPDX-License-Identifier: MIT
!> What brz_owner_driver leaves to each backend: how particles and ghosts travel, and what follows
!> from their places.
module brz_owner_backend
    use brz_errors, only: error_t
    use brz_ghost_wants, only: cpu_find_boxes => find_boxes, cpu_find_lowest => find_lowest, &
        owners_of
    use brz_gpu_solid_owner, only: close_diagnostics, gpu_fetch_homes => fetch_homes, &
        gpu_find_boxes => find_boxes, gpu_find_lowest => find_lowest, &
        gpu_list_leaving => list_leaving, gpu_send_away => send_away, &
        gpu_settle_places => settle_places, put_region, put_wants
    use brz_gpu_solid_state, only: attach_solid, gpu_lay_arrays => lay_arrays, note_ranges
    use brz_kinds, only: dp, int64
    use brz_places, only: message_buffers_t
    use brz_send_lists, only: join_lists, list_marks, place_pieces
    use brz_solid_ghosts, only: send_ghosts
    use brz_solid_owner, only: cpu_lay_arrays => lay_arrays, cpu_send_away => send_away, &
        cpu_settle_places => settle_places
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: find_boxes, find_lowest, fetch_homes, list_leaving, change_hands, swap_ghosts
    public :: lay_arrays, settle_places
    public :: put_region, put_wants ! what only a GPU needs

contains

    !> Boxes that the particles of each body fill in each process; all must call.
    subroutine find_boxes(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call note_ranges(solid%bodies, solid%n, solid%device, err)
            call gpu_find_boxes(solid%device, solid, solid%part, err)
        else
            call cpu_find_boxes(solid, solid%part)
        end if
    end subroutine find_boxes

    !> The lowest homes of particles of all processes, where planes of symmetry are; all must call.
    subroutine find_lowest(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call note_ranges(solid%bodies, solid%n, solid%device, err)
            call gpu_find_lowest(solid%device, solid, solid%part, err)
        else
            call cpu_find_lowest(solid, solid%part)
        end if
    end subroutine find_lowest

    !> The homes of particles first..last of body b.
    subroutine fetch_homes(solid, b, first, last, x, err)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b, first, last
        real(dp), intent(inout), contiguous :: x(:, :) !! (wide, last - first + 1) [m]
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call gpu_fetch_homes(solid%device, solid, b, first, last, x, err)
        else
            associate (home => owners_of(solid, b))
                x = home(:, first:last)
            end associate
        end if
    end subroutine fetch_homes

    !> The marked particles, on the host. The sums of bodies that change are taken before.
    subroutine list_leaving(solid, number, changed, leaving, err)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes)
        logical, intent(in) :: changed(:) !! (bodies)
        type(message_buffers_t), intent(inout) :: leaving
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call close_diagnostics(solid%device, solid, changed, err)
            call gpu_list_leaving(solid%device, solid%n, solid%part, number, leaving, err)
        else
            call list_marks(.false., solid%n, number, solid%part%marks_t, leaving, err)
        end if
    end subroutine list_leaving

    !> Send the particles that leave, and take in those that come.
    subroutine change_hands(solid, number, leaving, coming, err)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: number(:, :) !! (to processes, from processes)
        type(message_buffers_t), intent(in) :: leaving, coming
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call note_ranges(solid%bodies, solid%n, solid%device, err)
            call gpu_send_away(solid%device, number, leaving, coming, err)
        else
            call cpu_send_away(solid, leaving, coming)
        end if
    end subroutine change_hands

    !> Send the marked particles as ghosts, and put those that come from `next` on. A GPU keeps the
    !> ghosts of bodies that keep their places: lists are joined.
    subroutine swap_ghosts(solid, keeps, was, out, in, number, next, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: keeps(:) !! (bodies)
        integer(int64), intent(in) :: was(:, :, :)
        !! (bodies, to processes, from processes) ghosts that there were
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes)
        integer(int64), intent(in) :: number(:, :) !! (to processes, from processes)
        integer, intent(inout) :: next(:) !! (bodies) last place that is taken
        type(error_t), intent(inout) :: err
        integer :: me

        me = solid%ranks%rank + 1
        if (.not. solid%on_gpu) then
            call list_marks(.false., solid%n, out, solid%part%marks_t, solid%part%out, err)
            call place_pieces(.false., in, next, solid%part%marks_t, solid%part%in, err)
            call send_ghosts(solid, solid%part)
            return
        end if
        associate (gpu => solid%device, ghosts => solid%device%ghosts, marks => solid%part%marks_t)
            call list_marks(.true., solid%n, out, marks, ghosts%gone, err)
            call place_pieces(.true., in, next, marks, ghosts%come, err)
            call ghosts%aim(number, ghosts%gone, err)
            call ghosts%send(ghosts%gone, ghosts%come, gpu%record, gpu%record, err)
            where (sum(in, 2) > 0) gpu%bodies%packed = .false.
            call join_lists(.true., was(:, :, me), keeps, out, ghosts%gone, marks, ghosts%out, err)
            call join_lists(.true., was(:, me, :), keeps, in, ghosts%come, marks, ghosts%in, err)
            call ghosts%aim(sum(solid%part%kept, 1), ghosts%out, err)
        end associate
    end subroutine swap_ghosts

    !> Bodies that began at `old` have been given other places: bring their particles there.
    subroutine lay_arrays(solid, old, err)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: old(:) !! (bodies)
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call note_ranges(solid%bodies, solid%n, solid%device, err)
            call gpu_lay_arrays(solid%device, solid, old, err)
            call attach_solid(solid%device, solid)
            call gpu_settle_places(solid%device, solid, err)
        else
            call cpu_lay_arrays(solid, old)
        end if
    end subroutine lay_arrays

    !> Particles and ghosts lie in other places.
    subroutine settle_places(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (solid%on_gpu) then
            call note_ranges(solid%bodies, solid%n, solid%device, err)
            call gpu_settle_places(solid%device, solid, err)
            solid%part%keeps = .true.
            solid%device%settled = .false.
        else
            call cpu_settle_places(solid)
        end if
    end subroutine settle_places
end module brz_owner_backend
