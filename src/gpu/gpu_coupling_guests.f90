! SPDX-License-Identifier: MIT
!> Guests on the GPU: copies of the particles in the window of a process, and their loads on the way
!> home, as brz_coupling_guests has them. The host hears how many there are.
module brz_gpu_coupling_guests
    use brz_air_state, only: air_t
    use brz_boxes, only: cells_t => box_t
    use brz_coupling_part, only: introduce
    use brz_coupling_state, only: coupling_t
    use brz_buffers, only: from, integers_t, reals_t
    use brz_device, only: clear_buffer, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real
    use brz_gpu_carrier_steps, only: sum_shifts
    use brz_guest_items, only: always_near, block_at, blocks_of
    use brz_gpu_coupling_state, only: gpu_coupling_t, range_t, seen_t
    use brz_gpu_lists, only: at_least, room_of
    use brz_gpu_marks, only: asks_of, count_marks, list_marks, place_pieces, reserve_marks
    use brz_gpu_parcels, only: put_places, put_rows, rows_of, rows_t
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
    public :: open_gpu_windows, invite_guests, send_loads_home

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
        associate (part => gpu%part, ranks => air%part%ranks)
            part%boxes = air%part%boxes
            part%windows = coupling%part%windows
            gpu%crowd%ranks = ranks
            gpu%crowd%bodies = coupling%guests%bodies
            allocate (gpu%guests%bodies(size(gpu%crowd%bodies)))
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

        associate (window => gpu%part%window, me => gpu%crowd%ranks%rank, &
                   n => gpu%crowd%ranks%n)
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

            associate (n => held%hi - held%lo + 1)
                do r = 0, ubound(first, 1) - 1
                    box = gpu%part%boxes(merge(r, gpu%crowd%ranks%rank, goes))
                    do t = int((first(r) - 1)/gpu%part%window%of_cell) + 1, &
                        int((first(r + 1) - 1)/gpu%part%window%of_cell)
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

    !> Renew the guests of all processes: their particles have moved. They are listed anew where one
    !> of them is missing, or particles lie elsewhere.
    subroutine invite_guests(solid, p, gpu, err)
        class(solid_t), intent(in) :: solid !! its bodies
        type(seen_t), intent(in) :: p
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer(int64) :: missed(1)
        integer :: word(1)

        call introduce(solid, gpu%crowd)
        associate (part => gpu%part, ranks => gpu%crowd%ranks)
            missed = merge(0, 1, part%laid == p%laid)
            if (missed(1) == 0) then
                call clear_buffer(part%missed, err, 4_int64)
                call guest_kernels%miss_guest(p%n, p%n, size(p%bodies), part%bodies_at, ranks%n, &
                    part%asks_at, gpu%box, p%wide, p%x, p%fixed, part%listed%mark, part%missed, err)
                call velocity_kernels%keep_velocity(gpu%guests%n, 4, 1, 3, gpu%guests%v, &
                    part%seat, gpu%guests%v_before, err) ! as others do when loads come home
                call send_guests(gpu, p, n_moving, err)
                word = 0
                call copy_out(part%missed, word, 4_int64, err)
                missed = word
                call most_of_all(ranks, missed)
            end if
            if (missed(1) > 0) then
                call list_guests(gpu, p, err)
                call send_guests(gpu, p, n_known, err)
                part%laid = p%laid
                gpu%rebuilds = -1 ! a guest's place was another one's
            end if
        end associate
        call sum_shifts(gpu%crowd, p, gpu, err)
    end subroutine invite_guests

    !> Send what the copies have of their particles.
    subroutine send_guests(gpu, p, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(seen_t), intent(in) :: p
        integer, intent(in) :: n !! arrays
        type(error_t), intent(inout) :: err
        type(rows_t) :: from(n_known), to(n_known)

        from = rows_of_seen(p)
        to = rows_of_seen(gpu%guests)
        call gpu%part%parcels%send(gpu%part%out, gpu%part%in, from(:n), to(:n), err)
    end subroutine send_guests

    !> List the particles in the windows and a layer around, and give them places there.
    subroutine list_guests(gpu, p, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(seen_t), intent(in) :: p
        type(error_t), intent(inout) :: err
        integer(int64) :: number(size(p%bodies), gpu%crowd%ranks%n)
        integer(int64) :: all(size(p%bodies), gpu%crowd%ranks%n, gpu%crowd%ranks%n)
        integer :: b

        associate (part => gpu%part, ranks => gpu%crowd%ranks, n => p%n)
            call put_places([(p%bodies(b)%first, p%bodies(b)%last, b=1, size(p%bodies))], &
                            part%bodies_at, err)
            call reserve_marks(n, ranks%n, part%listed, err)
            call guest_kernels%mark_guest(n, n, size(p%bodies), part%bodies_at, ranks%n, &
                from(part%asks_at, 12_int64*ranks%n + 1), gpu%box, p%wide, p%x, p%fixed, &
                part%listed%mark, err)
            call count_marks(n, p%bodies%first, gpu%common, part%listed, number, err)
            call tell_all(ranks, number, all)
            call list_marks(n, number, part%listed, part%out, err)
            call seat_guests(gpu, all(:, ranks%rank + 1, :), n, err)
            call part%parcels%aim(sum(all, 1), part%out, err)
            call part%parcels%aim(transpose(sum(all, 1)), part%in, err) ! on which loads go home
        end associate
    end subroutine list_guests

    !> Places for the guests, body by body.
    subroutine seat_guests(gpu, number, particles, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        integer, intent(in) :: particles !! of this process
        type(error_t), intent(inout) :: err
        integer :: b, n, taken(size(number, 1))

        n = 0
        do b = 1, size(number, 1)
            taken(b) = n
            n = n + int(sum(number(b, :)))
            gpu%guests%bodies(b) = range_t(taken(b) + 1, n)
            gpu%crowd%bodies(b)%first = taken(b) + 1
            gpu%crowd%bodies(b)%last = n
        end do
        call size_guests(gpu, n, err)
        associate (part => gpu%part)
            call place_pieces(number, taken, part%marks%pieces, part%in, err)
            n = max(n, particles)
            if (room_of(part%seat) >= n) return
            call at_least(part%seat, n, err)
            n = room_of(part%seat)
            call put_places([n, 0], part%marks%pieces, err)
            call place_kernels%give_place(n, 1, part%marks%pieces, part%seat, err)
        end associate
    end subroutine seat_guests

    !> Room for n guests; those that were there are gone.
    subroutine size_guests(gpu, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err

        associate (p => gpu%guests)
            p%n = n
            p%step_d = 1
            p%step_p = 3
            call at_least(p%x, p%wide, n, err)
            call at_least(p%v, p%wide, n, err)
            call at_least(p%mass, n, err)
            call at_least(p%load, 3, n, err)
            call at_least(p%v_before, 3, n, err)
            call at_least(p%id, n, err)
            call at_least(p%fixed, n, err)
        end associate
        call at_least(gpu%cell_of, n, err)
        call at_least(gpu%place_of, n, err)
        call at_least(gpu%binned, n, err)
    end subroutine size_guests

    !> What of a particle its copies have.
    pure function rows_of_seen(p) result(rows)
        type(seen_t), intent(in) :: p
        type(rows_t) :: rows(n_known)

        rows = [rows_of(p%x, 2*p%wide), rows_of(p%v, p%wide*w), vectors(p%load), &
                rows_of(p%fixed, 1), vectors(p%v_before), rows_of(p%mass, w), rows_of(p%id, 1)]

    contains

        !> Rows of three numbers, or three columns.
        pure type(rows_t) function vectors(x)
            type(reals_t), intent(in) :: x

            vectors = rows_of(x, p%step_p*w, 3/p%step_p, p%n)
        end function vectors
    end function rows_of_seen

    !> Give every particle the load that the process found in whose cell it is; none outside.
    subroutine send_loads_home(p, gpu, err)
        type(seen_t), intent(in) :: p
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        type(rows_t) :: came(1), loads(1)
        integer :: n, r

        associate (part => gpu%part, ranks => gpu%crowd%ranks)
            loads = [rows_of(gpu%guests%load, 3*w)]
            call clear_buffer(p%load, err, 3*bytes_of_real*p%n)
            call part%parcels%post(part%in, part%out, loads, err)
            call at_least(part%loads, 3, p%n, err)
            came = [rows_of(part%loads, 3*w)]
            do r = 0, ranks%n - 1
                n = part%out%first(r + 1) - part%out%first(r)
                if (r == ranks%rank) call take_loads(r, gpu%guests%load)
                if (r == ranks%rank) cycle
                call put_rows(part%parcels%parcel_from(part%out, loads, r), part%seat, n, came, err)
                call take_loads(r, part%loads)
            end do
        end associate

    contains

        !> Take the loads that process r has for particles of this one.
        subroutine take_loads(r, load)
            integer, intent(in) :: r
            type(reals_t), intent(in) :: load !! (3, copies) in the order of the list, or of seats
            type(integers_t) :: seat

            associate (part => gpu%part, first => gpu%part%out%first)
                if (first(r + 1) == first(r)) return
                seat = part%seat
                if (r == gpu%crowd%ranks%rank) seat = from(part%in%place, &
                                                          int(part%in%first(r), int64))
                call guest_kernels%take_load(first(r + 1) - first(r), &
                    gpu%crowd%ranks%n + r + 1, part%asks_at, gpu%box, p%wide, p%x, p%fixed, p%n, &
                    from(part%out%place, int(first(r), int64)), seat, load, p%load, err)
            end associate
        end subroutine take_loads
    end subroutine send_loads_home
end module brz_gpu_coupling_guests
