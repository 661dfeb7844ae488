! SPDX-License-Identifier: MIT
!> Guests on the GPU: copies of the particles in the window of a process, and their loads on the way
!> home, as brz_coupling_guests has them. The host hears how many there are.
module brz_gpu_coupling_guests
    use brz_air_state, only: air_t
    use brz_boxes, only: cells_t => box_t
    use brz_coupling_state, only: coupling_t
    use brz_buffers, only: from, integers_t, reals_t
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_gpu_carrier_steps, only: sum_shifts
    use brz_guest_items, only: always_near, block_at, blocks_of
    use brz_gpu_coupling_state, only: column_of, gpu_coupling_t, particles_t, seen, tags_of
    use brz_gpu_marks, only: asks_of, count_marks, list_marks, place_pieces, reserve_marks
    use brz_gpu_parcels, only: put_places, put_rows, rows_of, rows_t
    use brz_gpu_solid_layout, only: at_mass, tag_fixed, tag_id
    use brz_guest_launches, only: guest_kernels
    use brz_kinds, only: int64
    use brz_mail, only: tell_all
    use brz_place_launches, only: place_kernels
    use brz_ranks, only: most_of_all
    use brz_solid_part, only: nobody => part_t, parcels_t
    use brz_solid_state, only: solid_t
    use brz_velocity_launches, only: velocity_kernels
    implicit none
    private
    public :: open_gpu_windows, invite_gpu_guests, send_gpu_loads_home, see_gpu_window

    integer, parameter :: w = int(bytes_of_real/4) !! words of a real number
    integer, parameter :: n_known = 7 !! arrays of a guest
    integer, parameter :: n_moving = 4 !! those of them that change in a step

contains

    !> Get ready to speak with the other processes, whose windows the host knows.
    subroutine open_gpu_windows(air, coupling, gpu, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer, parameter :: most = 8 + 11*w + 2 !! words of a guest
        integer :: none(0:air%part%ranks%n), r
        type(cells_t) :: held, near(0:air%part%ranks%n - 1)

        none = 1
        held = cells_t(air%before + 1 - air%g, air%before + air%n + air%g)
        associate (part => gpu%shared, ranks => air%part%ranks)
            part%boxes = air%part%boxes
            part%windows = coupling%part%windows
            part%own%ranks = ranks
            part%own%bodies = coupling%guests%bodies
            near = part%windows ! a particle may move for some steps until it is missed
            do r = 0, ubound(near, 1)
                near(r)%lo = max(near(r)%lo - 1, 1)
                near(r)%hi = min(near(r)%hi + 1, air%whole)
            end do
            call put_places(asks_of([part%windows, part%boxes, near]), part%asks_at, err)
            call reserve_buffer(part%missed, 4_int64, err)
            call part%window%open(ranks, air%part%window, held, air%n_var, err)
            if (.not. any(gpu%box%wraps)) call map_blocks(gpu, held, err)
            call part%parcels%open(ranks, nobody(out=parcels_t([integer ::], none), &
                                   in=parcels_t([integer ::], none)), max(most, 1 + 6*w), err)
        end associate
    end subroutine open_gpu_windows

    !> Of the window what lies around walls is fetched, and three layers around the box for gauges:
    !> say in which block of the map that brz_gpu_coupling_shared keeps each cell is.
    subroutine map_blocks(gpu, held, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(cells_t), intent(in) :: held !! cells of the arrays of the air
        type(error_t), intent(inout) :: err
        integer, allocatable :: block(:)

        associate (window => gpu%shared%window, me => gpu%shared%own%ranks%rank, &
                   n => gpu%shared%own%ranks%n)
            call reserve_buffer(window%near, int(always_near + n*blocks_of(gpu%box), int64), err)
            call clear_buffer(window%near, err)
            block = blocks(window%list%out, window%list%mail%out_first, .true.)
            call put_places(block, window%out_block, err)
            block = blocks(window%list%in, window%list%mail%in_first, .false.)
            call put_places(block, window%in_block, err)
        end associate

    contains

        !> Blocks of listed cells, process by process.
        function blocks(place, first, goes) result(block)
            integer(int64), intent(in) :: place(:) !! in the arrays
            integer(int64), intent(in) :: first(0:) !! (processes + 1) bytes
            logical, intent(in) :: goes !! to the process
            integer :: block(size(place)), cell(3), r, t
            integer(int64) :: at
            type(cells_t) :: box

            associate (shared => gpu%shared, n => held%hi - held%lo + 1)
                do r = 0, ubound(first, 1) - 1
                    box = shared%boxes(merge(r, shared%own%ranks%rank, goes))
                    do t = int((first(r) - 1)/shared%window%of_cell) + 1, &
                        int((first(r + 1) - 1)/shared%window%of_cell)
                        at = place(t) - 1
                        cell = held%lo + int([mod(at, int(n(1), int64)), &
                            mod(at/n(1), int(n(2), int64)), at/n(1)/n(2)])
                        block(t) = block_at(gpu%box, r + 1, cell - gpu%box%before)
                        if (all(cell >= box%lo - 3 .and. cell <= box%hi + 3)) &
                            block(t) = always_near
                    end do
                end do
            end associate
        end function blocks
    end subroutine map_blocks

    !> Bring the gas and the ledgers in the window of this process up to date, where the coupling
    !> and gauges look.
    subroutine see_gpu_window(gpu, there, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(error_t), intent(inout) :: err

        call gpu%shared%window%reals_of_others(there%grid%apart, there%u, err)
    end subroutine see_gpu_window

    !> Renew the guests of all processes: their particles have moved. They are listed anew where one
    !> of them is missing, or particles lie elsewhere.
    subroutine invite_gpu_guests(gpu, particles, guests, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(inout) :: guests !! of the host: where the guests of a body lie
        type(error_t), intent(inout) :: err
        integer(int64) :: missed(1)
        integer :: word(1)

        associate (part => gpu%shared, n => particles%n)
            missed = merge(0, 1, part%laid == particles%laid)
            if (missed(1) == 0) then
                call clear_buffer(part%missed, err, 4_int64)
                call guest_kernels%miss_guest(n, n, size(guests%bodies), part%bodies_at, &
                    guests%ranks%n, part%asks_at, gpu%box, 4, particles%place, &
                    tags_of(particles, tag_fixed), part%listed%mark, part%missed, err)
                call velocity_kernels%keep_velocity(gpu%guests%n, 4, 1, 3, gpu%guests%v, &
                    part%seat, part%v_before, err) ! as their processes do when loads come home
                call send_guests(gpu, particles, n_moving, err)
                word = 0
                call copy_out(part%missed, word, 4_int64, err)
                missed = word
                call most_of_all(guests%ranks, missed)
            end if
            if (missed(1) > 0) then
                call list_guests(gpu, particles, guests, err)
                call send_guests(gpu, particles, n_known, err)
                part%laid = particles%laid
                gpu%rebuilds = -1 ! a guest's place was another one's
            end if
            call sum_shifts(part%own, seen(particles), gpu, err)
        end associate
    end subroutine invite_gpu_guests

    !> Send what the copies have of their particles.
    subroutine send_guests(gpu, particles, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        integer, intent(in) :: n !! arrays
        type(error_t), intent(inout) :: err
        type(rows_t) :: from(n_known), to(n_known)

        from = rows_of_particles(particles)
        to = rows_of_guests(gpu)
        associate (part => gpu%shared)
            call part%parcels%send(part%out, part%in, from(:n), to(:n), err)
        end associate
    end subroutine send_guests

    !> List the particles in the windows and a layer around, and give them places there.
    subroutine list_guests(gpu, particles, guests, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(solid_t), intent(inout) :: guests
        type(error_t), intent(inout) :: err
        integer(int64) :: number(size(guests%bodies), guests%ranks%n)
        integer(int64) :: all(size(guests%bodies), guests%ranks%n, guests%ranks%n)
        integer :: b

        associate (part => gpu%shared, ranks => guests%ranks, n => particles%n)
            part%own%bodies%first = particles%first
            part%own%bodies%last = particles%last
            call put_places([([particles%first(b), particles%last(b)], b=1, &
                              size(particles%first))], part%bodies_at, err)
            call reserve_marks(n, ranks%n, part%listed, err)
            call guest_kernels%mark_guest(n, n, size(particles%first), part%bodies_at, ranks%n, &
                from(part%asks_at, 12_int64*ranks%n + 1), gpu%box, 4, particles%place, &
                tags_of(particles, tag_fixed), part%listed%mark, err)
            call count_marks(n, particles%first, gpu%common, part%listed, &
                             number, err)
            call tell_all(ranks, number, all)
            call list_marks(n, [1, ranks%n], number, part%listed, part%out, &
                            err)
            call seat_guests(gpu, all(:, ranks%rank + 1, :), n, guests, err)
            call part%parcels%aim(sum(all, 1), part%out, err)
            call part%parcels%aim(transpose(sum(all, 1)), part%in, err) ! on which loads go home
        end associate
    end subroutine list_guests

    !> Places for the guests, body by body.
    subroutine seat_guests(gpu, number, particles, guests, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        integer, intent(in) :: particles !! of this process
        type(solid_t), intent(inout) :: guests
        type(error_t), intent(inout) :: err
        integer :: b, n, taken(size(number, 1))

        call reserve_guests(gpu, sum(number), err)
        n = 0
        do b = 1, size(number, 1)
            taken(b) = n
            guests%bodies(b)%first = n + 1
            n = n + int(sum(number(b, :)))
            guests%bodies(b)%last = n
        end do
        gpu%guests%n = n
        associate (part => gpu%shared)
            call place_pieces(number, taken, part%marks%pieces, part%in, err)
            n = max(n, particles)
            if (part%seat%address /= 0 .and. part%seat%bytes >= 4_int64*n) return
            call reserve_buffer(part%seat, 4_int64*n, err)
            n = int(part%seat%bytes/4)
            call put_places([n, 0], part%marks%pieces, err)
            call place_kernels%give_place(n, 1, part%marks%pieces, part%seat, err)
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
    end subroutine reserve_guests

    !> What of a particle its copies have.
    pure function rows_of_particles(particles) result(rows)
        type(particles_t), intent(in) :: particles
        type(rows_t) :: rows(n_known)

        associate (p => particles, n => particles%n)
            rows = [rows_of(p%place, 8), rows_of(p%motion, 4*w), &
                    rows_of(column_of(p, p%load + 1), w, 3, n), rows_of(tags_of(p, tag_fixed), 1), &
                    rows_of(column_of(p, p%before + 1), w, 3, n), &
                    rows_of(column_of(p, at_mass), w), rows_of(tags_of(p, tag_id), 1)]
        end associate
    end function rows_of_particles

    pure function rows_of_guests(gpu) result(rows)
        type(gpu_coupling_t), intent(in) :: gpu
        type(rows_t) :: rows(n_known)

        associate (p => gpu%guests)
            rows = [rows_of(p%x, 8), rows_of(p%v, 4*w), rows_of(p%load, 3*w), rows_of(p%fixed, 1), &
                    rows_of(gpu%shared%v_before, 3*w), rows_of(p%mass, w), rows_of(p%id, 1)]
        end associate
    end function rows_of_guests

    !> Give every particle the load that the process found in whose cell it is; none outside. The
    !> guests have kept the velocities of this step.
    subroutine send_gpu_loads_home(gpu, particles, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        type(error_t), intent(inout) :: err
        type(rows_t) :: came(1), loads(1)
        integer :: n, r

        associate (part => gpu%shared, p => particles, ranks => gpu%shared%own%ranks)
            loads = [rows_of(gpu%guests%load, 3*w)]
            call clear_buffer(column_of(p, p%load + 1), err, 3*bytes_of_real*p%n)
            call part%parcels%post(part%in, part%out, loads, err)
            call reserve_buffer(part%loads, 3*bytes_of_real*p%n, err)
            came = [rows_of(part%loads, 3*w)]
            do r = 0, ranks%n - 1
                n = part%out%first(r + 1) - part%out%first(r)
                if (r == ranks%rank) call take_loads(r, gpu%guests%load)
                if (r == ranks%rank) cycle
                call put_rows(part%parcels%parcel_from(part%out, loads, r), &
                              part%seat, n, came, err)
                call take_loads(r, part%loads)
            end do
            call velocity_kernels%keep_velocity(p%n, 4, p%n, 1, p%motion, part%seat, &
                                                    column_of(p, p%before + 1), err)
        end associate

    contains

        !> Take the loads that process r has for particles of this one.
        subroutine take_loads(r, load)
            integer, intent(in) :: r
            type(reals_t), intent(in) :: load !! (3, copies) in the order of the list, or of seats
            type(integers_t) :: seat

            associate (part => gpu%shared, p => particles, first => gpu%shared%out%first)
                if (first(r + 1) == first(r)) return
                seat = part%seat
                if (r == part%own%ranks%rank) seat = from(part%in%place, &
                                                          int(part%in%first(r), int64))
                call guest_kernels%take_load(first(r + 1) - first(r), &
                    part%own%ranks%n + r + 1, part%asks_at, gpu%box, 4, p%place, &
                    tags_of(p, tag_fixed), p%n, from(part%out%place, int(first(r), int64)), &
                    seat, load, column_of(p, p%load + 1), err)
            end associate
        end subroutine take_loads
    end subroutine send_gpu_loads_home
end module brz_gpu_coupling_guests
