! SPDX-License-Identifier: MIT
!> Guests on the GPU: copies of the particles in the window of a process, and their loads on the way
!> home, as brz_coupling_guests has them. The host hears how many there are.
module brz_gpu_coupling_guests
    use brz_air_state, only: air_t
    use brz_boxes, only: cells_t => box_t
    use brz_coupling_state, only: coupling_t
    use brz_device, only: clear_buffer, device_t, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_gpu_carrier_steps, only: sum_shifts
    use brz_gpu_coupling_state, only: column_of, gpu_coupling_t, particles_t, seen, tags_of
    use brz_gpu_marks, only: asks_of, count_marks, list_marks, place_pieces, reserve_marks
    use brz_gpu_parcels, only: put_places, rows_of, rows_t
    use brz_gpu_solid_layout, only: at_mass, tag_fixed, tag_id
    use brz_kinds, only: int64
    use brz_mail, only: tell_all
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
            call part%window%open(ranks, air%part%window, held, air%n_var, err)
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
        integer(int64) :: number(size(guests%bodies), 2*guests%ranks%n)
        integer(int64) :: out(size(guests%bodies) + 1, guests%ranks%n)
        integer(int64) :: all(size(guests%bodies) + 1, guests%ranks%n, guests%ranks%n)

        associate (part => gpu%shared, n => guests%ranks%n, bodies => size(guests%bodies))
            part%own%bodies%first = particles%first
            part%own%bodies%last = particles%last
            call mark_guests(gpu, particles, number, err)
            out(:bodies, :) = number(:, :n)
            out(bodies + 1, :) = sum(number(:, n + 1:), 1) ! loads that will come back
            call tell_all(guests%ranks, out, all)
            call list_marks(particles%n, [1, n], number, part%parcels%kernels, part%marks, &
                            part%out, err)
            call list_marks(particles%n, [n + 1, 2*n], number, part%parcels%kernels, part%marks, &
                            part%loads_in, err)
            call part%parcels%aim(sum(all(:bodies, :, :), 1), part%out, err)
            call part%parcels%aim(transpose(all(bodies + 1, :, :)), part%loads_out, err)
            call seat_guests(gpu, all(:bodies, guests%ranks%rank + 1, :), particles%n, guests, err)
            call part%parcels%send(part%out, part%in, rows_of_particles(particles), &
                                   rows_of_guests(gpu), err)
            call sum_shifts(part%own, seen(particles), gpu, err)
        end associate
    end subroutine invite_gpu_guests

    !> Mark the particles in the window of each process, and in its box, and count them.
    subroutine mark_guests(gpu, particles, number, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(particles_t), intent(in) :: particles
        integer(int64), intent(out) :: number(:, :) !! (bodies, windows and boxes)
        type(error_t), intent(inout) :: err
        integer :: b, body(2, size(particles%first)), n

        associate (part => gpu%shared, marks => gpu%shared%marks)
            n = particles%n
            body(1, :) = particles%first
            body(2, :) = particles%last
            call put_places([(body(:, b), b=1, size(body, 2))], marks%pieces, err)
            call put_places(asks_of([part%windows, part%boxes]), part%marks%asks, err)
            call reserve_marks(n, size(number, 2), marks, err)
            call part%kernels%mark_guest(n, n, size(body, 2), marks%pieces, size(number, 2), &
                part%marks%asks, gpu%box, 4, particles%place, tags_of(particles, tag_fixed), &
                marks%mark, err)
            call count_marks(n, particles%first, gpu%common, part%parcels%kernels, marks, number, &
                             err)
        end associate
    end subroutine mark_guests

    !> Places for the guests, body by body.
    subroutine seat_guests(gpu, number, particles, guests, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        integer, intent(in) :: particles !! of this process
        type(solid_t), intent(inout) :: guests
        type(error_t), intent(inout) :: err
        integer :: b, n, next(1), taken(size(number, 1))

        call reserve_guests(gpu, sum(number), err)
        n = 0
        do b = 1, size(number, 1)
            taken(b) = n
            guests%bodies(b)%first = n + 1
            n = n + int(sum(number(b, :)))
            guests%bodies(b)%last = n
        end do
        gpu%guests%n = n
        associate (part => gpu%shared, k => gpu%shared%parcels%kernels)
            part%came = number
            call place_pieces(number, taken, k, part%marks%pieces, part%in, err)
            n = max(n, particles)
            if (part%seat%address /= 0 .and. part%seat%bytes >= 4_int64*n) return
            call reserve_buffer(part%seat, 4_int64*n, err)
            n = int(part%seat%bytes/4)
            call put_places([n, 0], part%marks%pieces, err)
            call k%give_place(n, 1, part%marks%pieces, part%seat, err)
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
        integer :: b, ends(size(gpu%shared%came)), k, r
        type(rows_t) :: loads(2)

        k = 0
        associate (came => gpu%shared%came)
            do b = 1, size(came, 1)
                do r = 1, size(came, 2)
                    k = k + 1
                    ends(k) = int(came(b, r))
                    if (k > 1) ends(k) = ends(k) + ends(k - 1)
                end do
            end do
        end associate
        associate (part => gpu%shared, p => particles, n => gpu%guests%n, marks => gpu%shared%marks)
            call put_places(ends, marks%pieces, err)
            call reserve_marks(n, size(number), marks, err)
            call part%kernels%mark_load(n, n, size(number), k, marks%pieces, gpu%box, gpu%cell_of, &
                                        marks%mark, err)
            call count_marks(n, [1], gpu%common, part%parcels%kernels, marks, number, err)
            call list_marks(n, [1, size(number)], number, part%parcels%kernels, marks, &
                            part%loads_out, err)
            call clear_buffer(column_of(p, p%load + 1), err, 3*bytes_of_real*p%n)
            loads = [rows_of(gpu%guests%load, 3*w), rows_of(column_of(p, p%load + 1), w, 3, p%n)]
            call part%parcels%send(part%loads_out, part%loads_in, loads(1:1), loads(2:2), err)
            call gpu%velocity_kernels%keep_velocity(p%n, 4, p%n, 1, p%motion, part%seat, &
                                                    column_of(p, p%before + 1), err)
        end associate
    end subroutine send_gpu_loads_home
end module brz_gpu_coupling_guests
