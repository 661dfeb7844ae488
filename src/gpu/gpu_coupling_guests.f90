! SPDX-License-Identifier: MIT
!> Guests on the GPU: copies of the particles in the window of a process, and their loads on the way
!> home, as brz_coupling_guests has them. The host hears how many there are.
module brz_gpu_coupling_guests
    use brz_air_state, only: air_t
    use brz_boxes, only: cells_t => box_t
    use brz_buffers, only: from
    use brz_coupling_box, only: box_t
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, device_t, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_gpu_carrier_steps, only: sum_shifts
    use brz_gpu_coupling_state, only: column_of, gpu_coupling_t, particles_t, seen, tags_of
    use brz_gpu_marks, only: begin_marks, count_marks, find_firsts, list_marks
    use brz_gpu_parcels, only: gpu_places_t, rows_of, rows_t
    use brz_gpu_solid_layout, only: at_mass, tag_fixed, tag_id
    use brz_kinds, only: int64
    use brz_mail, only: tell_counts
    use brz_solid_part, only: nobody => part_t, parcels_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_windows, invite_gpu_guests, send_gpu_loads_home, see_gpu_window

    integer, parameter :: w = int(bytes_of_real/4) !! words of a real number

contains

    !> Get ready to speak with the other processes, whose windows the host knows.
    subroutine open_gpu_windows(device, air, coupling, gpu, err)
        type(device_t), intent(in) :: device
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer, parameter :: most = 8 + 11*w + 2 !! words of a guest
        integer :: none(0:air%part%ranks%n)
        type(cells_t) :: held

        none = 1
        held = cells_t(air%before + 1 - air%g, air%before + air%n + air%g)
        associate (part => gpu%shared, ranks => air%part%ranks)
            part%boxes = air%part%boxes
            part%windows = coupling%part%windows
            part%own%ranks = ranks
            part%own%bodies = coupling%guests%bodies
            call part%kernels%open(device, err)
            call part%window%open(device, ranks, air%part%window, held, air%n_var, err)
            call part%parcels%open(device, ranks, nobody(out=parcels_t([integer ::], none), &
                                   in=parcels_t([integer ::], none)), max(most, 1 + 6*w), err)
        end associate
    end subroutine open_gpu_windows

    !> Bring the gas and the ledgers in the window of this process up to date.
    subroutine see_gpu_window(gpu, there, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(error_t), intent(inout) :: err

        call gpu%shared%window%reals_of_others(there%grid%apart, there%u, err)
    end subroutine see_gpu_window

    !> Renew the guests of all processes: their particles have moved.
    subroutine invite_gpu_guests(gpu, particles, guests, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(inout) :: guests !! of the host: where the guests of a body lie
        type(error_t), intent(inout) :: err
        integer(int64), dimension(size(guests%bodies), guests%ranks%n) :: out, in

        associate (part => gpu%shared)
            part%own%bodies%first = particles%first
            part%own%bodies%last = particles%last
            call list_guests(gpu, particles, part%boxes, out, part%loads_in, err)
            call list_guests(gpu, particles, part%windows, out, part%out, err)
            call tell_counts(guests%ranks, out, in)
            call seat_guests(gpu, in, particles%n, guests, err)
            call part%parcels%send(part%out, part%in, rows_of_particles(particles), &
                                   rows_of_guests(gpu), err)
            call sum_shifts(part%own, seen(particles), gpu, err)
        end associate
    end subroutine invite_gpu_guests

    !> List the particles in each of some boxes of the grid, body by body.
    subroutine list_guests(gpu, particles, cells, number, list, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(cells_t), intent(in) :: cells(0:) !! (processes)
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(gpu_places_t), intent(inout) :: list
        type(error_t), intent(inout) :: err
        type(box_t) :: box
        integer :: b, r

        associate (part => gpu%shared, first => particles%first, last => particles%last, &
                   n => particles%n)
            call begin_marks(n, size(cells), part%marks, err)
            do r = 0, ubound(cells, 1)
                box = gpu%box
                box%before = cells(r)%lo - 1
                box%n = cells(r)%hi - box%before
                do b = 1, size(first)
                    if (last(b) >= first(b)) call part%kernels%mark_guest( &
                        last(b) - first(b) + 1, first(b), box, 4, particles%place, &
                        tags_of(particles, tag_fixed), &
                        from(part%marks%mark, int(n, int64)*r + 1), err)
                end do
            end do
            call count_marks(n, first, gpu%common, part%parcels%kernels, part%marks, number, err)
            call list_marks(n, number, part%parcels%kernels, part%marks, list, err)
        end associate
    end subroutine list_guests

    !> Places for the guests, body by body.
    subroutine seat_guests(gpu, number, particles, guests, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        integer, intent(in) :: particles !! of this process
        type(solid_t), intent(inout) :: guests
        type(error_t), intent(inout) :: err
        integer :: b, n, r, next(size(number, 1))

        call reserve_guests(gpu, sum(number), err)
        n = 0
        do b = 1, size(number, 1)
            next(b) = n
            guests%bodies(b)%first = n + 1
            n = n + int(sum(number(b, :)))
            guests%bodies(b)%last = n
        end do
        gpu%guests%n = n
        associate (part => gpu%shared)
            part%came = number
            call find_firsts(number, part%in%first)
            n = 0
            do r = 1, size(number, 2)
                do b = 1, size(number, 1)
                    if (number(b, r) == 0) cycle
                    call part%kernels%give_seat(int(number(b, r)), n, next(b), part%in%place, err)
                    n = n + int(number(b, r))
                    next(b) = next(b) + int(number(b, r))
                end do
            end do
            n = max(n, particles)
            if (part%seat%address /= 0 .and. part%seat%bytes >= 4_int64*n) return
            call reserve_buffer(part%seat, 4_int64*n, err)
            call part%kernels%give_seat(int(part%seat%bytes/4), 0, 0, part%seat, err)
        end associate
    end subroutine seat_guests

    !> Room for n guests; those that were there are gone.
    subroutine reserve_guests(gpu, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int64), intent(in) :: n
        type(error_t), intent(inout) :: err

        associate (p => gpu%guests)
            p%step_d = 1
            p%step_p = 3
            call reserve_buffer(p%x, 32*max(n, 1_int64), err)
            call reserve_buffer(p%v, 4*bytes_of_real*max(n, 1_int64), err)
            call reserve_buffer(p%mass, bytes_of_real*max(n, 1_int64), err)
            call reserve_buffer(p%load, 3*bytes_of_real*max(n, 1_int64), err)
            call reserve_buffer(gpu%shared%v_before, 3*bytes_of_real*max(n, 1_int64), err)
            call reserve_buffer(p%id, 4*max(n, 1_int64), err)
            call reserve_buffer(p%fixed, 4*max(n, 1_int64), err)
        end associate
        call reserve_buffer(gpu%cell_of, 4*max(n, 1_int64), err)
        call reserve_buffer(gpu%place_of, 4*max(n, 1_int64), err)
        call reserve_buffer(gpu%binned, 4*max(n, 1_int64), err)
        call reserve_buffer(gpu%shared%in%place, 4*max(n, 1_int64), err)
    end subroutine reserve_guests

    !> What of a particle its copies have.
    pure function rows_of_particles(particles) result(rows)
        type(particles_t), intent(in) :: particles
        type(rows_t) :: rows(7)

        associate (p => particles, n => particles%n)
            rows = [rows_of(p%place, 8), rows_of(p%motion, 4*w), &
                    rows_of(column_of(p, at_mass), w), &
                    rows_of(column_of(p, p%load + 1), w, 3, n), &
                    rows_of(column_of(p, p%before + 1), w, 3, n), &
                    rows_of(tags_of(p, tag_id), 1), rows_of(tags_of(p, tag_fixed), 1)]
        end associate
    end function rows_of_particles

    pure function rows_of_guests(gpu) result(rows)
        type(gpu_coupling_t), intent(in) :: gpu
        type(rows_t) :: rows(7)

        associate (p => gpu%guests)
            rows = [rows_of(p%x, 8), rows_of(p%v, 4*w), rows_of(p%mass, w), rows_of(p%load, 3*w), &
                    rows_of(gpu%shared%v_before, 3*w), rows_of(p%id, 1), rows_of(p%fixed, 1)]
        end associate
    end function rows_of_guests

    !> Give every particle the load that the process found in whose cell it is; none outside. The
    !> guests have kept the velocities of this step.
    subroutine send_gpu_loads_home(gpu, particles, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(error_t), intent(inout) :: err
        integer(int64) :: number(1, size(gpu%shared%came, 2))
        integer :: at, b, r
        type(rows_t) :: loads(2)

        associate (part => gpu%shared, p => particles, n => gpu%guests%n)
            call begin_marks(n, size(number), part%marks, err)
            at = 1
            do b = 1, size(part%came, 1)
                do r = 1, size(part%came, 2)
                    if (part%came(b, r) == 0) cycle
                    call part%kernels%mark_own(int(part%came(b, r)), gpu%box, &
                        from(gpu%cell_of, int(at, int64)), &
                        from(part%marks%mark, (r - 1)*int(n, int64) + at), err)
                    at = at + int(part%came(b, r))
                end do
            end do
            call count_marks(n, [1], gpu%common, part%parcels%kernels, part%marks, number, err)
            call list_marks(n, number, part%parcels%kernels, part%marks, part%loads_out, err)
            call clear_buffer(column_of(p, p%load + 1), err, 3*bytes_of_real*p%n)
            loads = [rows_of(gpu%guests%load, 3*w), rows_of(column_of(p, p%load + 1), w, 3, p%n)]
            call part%parcels%send(part%loads_out, part%loads_in, loads(1:1), loads(2:2), err)
            call gpu%velocity_kernels%keep_velocity(p%n, 4, p%n, 1, p%motion, part%seat, &
                                                    column_of(p, p%before + 1), err)
        end associate
    end subroutine send_gpu_loads_home
end module brz_gpu_coupling_guests
