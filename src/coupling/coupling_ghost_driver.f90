! SPDX-License-Identifier: MIT
!> Copies of particles of all processes for the process in whose halo of the air they are, and
!> what goes back: their loads. See brz_coupling_part.
module brz_coupling_ghost_driver
    use brz_coupling_ghosts, only: find_runs, needs_volumes, send_coupling_ghosts
    use brz_coupling_part, only: introduce, list_now, may_have_come
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t
    use brz_coupling_ghost_loops, only: for_each_mark_coupling_ghost, &
        for_each_miss_coupling_ghost, for_each_take_load
    use brz_kinds, only: int64
    use brz_lists, only: at_least, clear_reals, put_list, room_of
    use brz_message_exchange, only: tell_all
    use brz_place_loops, only: for_each_give_place
    use brz_ranks, only: most_of_all
    use brz_record_rules, only: words_of_real
    use brz_rows, only: rows_of, rows_t
    use brz_send_lists, only: count_marks, list_marks, place_pieces, reserve_marks
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_velocity_loops, only: for_each_keep_velocity
    implicit none
    private
    public :: renew_coupling_ghosts, send_loads_to_owners

contains

    !> Renew the ghosts of all processes: their particles have moved. They are listed anew where one
    !> of them is missing, or particles lie elsewhere.
    subroutine renew_coupling_ghosts(solid, c, err)
        class(listed_bodies_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer(int64) :: most(1)
        integer :: missed

        call introduce(solid, c%ghost_bodies)
        call give_seats(c, solid%n, err) ! there may be more than when ghosts were listed
        missed = merge(0, 1, c%part%rebuilds == solid%laid)
        if (missed == 0) then
            ! as others do when loads come home
            call for_each_keep_velocity(c%on_gpu, c%ghosts%n, c%ghosts%wide, 1, 3, c%ghosts%v, &
                                        c%part%seat, c%ghosts%v_before, err)
            call send_coupling_ghosts(solid, c, .false., err)
            if (may_have_come(solid, c%part%since, c%box%whole, c%box%dx)) then
                call for_each_miss_coupling_ghost(c%on_gpu, solid%n, solid%n, size(solid%bodies), &
                                         c%part%bodies_at, c%ranks%n, c%part%halos_at, c%box, &
                                         solid%wide, solid%x, solid%fixed, c%part%listed%mark, &
                                         missed, err)
                most = missed
                call most_of_all(c%ranks, most)
                missed = int(most(1))
            end if
        end if
        if (missed > 0) then
            call list_coupling_ghosts(solid, c, err)
            call send_coupling_ghosts(solid, c, .true., err)
            call list_now(solid, c%part%since)
            c%part%rebuilds = solid%laid
        end if
    end subroutine renew_coupling_ghosts

    !> List the particles in the halos and a layer around, and give them places there.
    subroutine list_coupling_ghosts(solid, c, err)
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer(int64), dimension(size(solid%bodies), c%ranks%n) :: out, in
        integer(int64) :: all(size(out, 1), c%ranks%n, c%ranks%n), away(1, c%ranks%n)
        integer :: b, none(1)

        associate (part => c%part, n => solid%n, boxes => c%ranks%n)
            call put_list(c%on_gpu, [(solid%bodies(b)%first, solid%bodies(b)%last, &
                                      b=1, size(out, 1))], part%bodies_at, err)
            call reserve_marks(c%on_gpu, n, boxes, part%listed, err)
            call for_each_mark_coupling_ghost(c%on_gpu, n, n, size(out, 1), part%bodies_at, boxes, &
                                     part%near_at, c%box, solid%wide, solid%x, solid%fixed, &
                                     part%listed%mark, err)
            call count_marks(c%on_gpu, n, solid%bodies%first, part%listed, out, err)
            call tell_all(c%ranks, out, all)
            in = all(:, c%ranks%rank + 1, :)
            call list_marks(c%on_gpu, n, out, part%listed, part%out, err)
            call seat_coupling_ghosts(c, in, n, allocated(solid%face_stress), err)
            ! on their way home loads of others come in the order of the list
            none = 0
            away = reshape(sum(out, 1), [1, boxes])
            away(1, c%ranks%rank + 1) = 0
            call place_pieces(c%on_gpu, away, none, part%marks, part%home, err)
            call put_list(c%on_gpu, [part%home%first, part%out%first - part%home%first], &
                          part%first_at, err)
            call at_least(c%on_gpu, part%loads, 3, part%home%first(boxes) - 1, err)
            if (allocated(solid%face_stress)) &
                call at_least(c%on_gpu, part%stresses, 6, part%home%first(boxes) - 1, err)
            if (c%on_gpu) call find_runs(solid, out, in, c, err)
            call part%messages%aim(sum(all, 1), part%out, err)
            call part%messages%aim(transpose(sum(all, 1)), part%in, err)
        end associate
    end subroutine list_coupling_ghosts

    !> Places for the ghosts, body by body.
    subroutine seat_coupling_ghosts(c, number, particles, pressed, err)
        type(coupling_t), intent(inout) :: c
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        integer, intent(in) :: particles !! of this process
        logical, intent(in) :: pressed !! loads bring a stress to faces
        type(error_t), intent(inout) :: err
        integer :: b, n, taken(size(number, 1))

        n = 0
        do b = 1, size(taken)
            taken(b) = n
            n = n + int(sum(number(b, :)))
            c%ghosts%bodies(b)%first = taken(b) + 1
            c%ghosts%bodies(b)%last = n
            c%ghost_bodies%bodies(b)%first = taken(b) + 1
            c%ghost_bodies%bodies(b)%last = n
        end do
        call size_coupling_ghosts(c, n, pressed, err)
        associate (part => c%part)
            call place_pieces(c%on_gpu, number, taken, part%marks, part%in, err)
        end associate
        call give_seats(c, max(n, particles), err)
    end subroutine seat_coupling_ghosts

    !> The numbers 1, 2, 3, ... for as many particles, those of this process or ghosts.
    subroutine give_seats(c, particles, err)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: particles
        type(error_t), intent(inout) :: err
        integer :: n

        associate (part => c%part)
            if (room_of(part%seat) >= particles) return
            call at_least(c%on_gpu, part%seat, particles, err)
            n = room_of(part%seat)
            call put_list(c%on_gpu, [n, 0], part%marks%pieces, err)
            call for_each_give_place(c%on_gpu, n, 1, part%marks%pieces, part%seat, err)
        end associate
    end subroutine give_seats

    !> Room for n ghosts; those that were there are gone.
    subroutine size_coupling_ghosts(c, n, pressed, err)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n
        logical, intent(in) :: pressed !! loads bring a stress to faces
        type(error_t), intent(inout) :: err

        c%ghosts%n = n
        if (c%on_gpu) c%ghosts%stride_d = n
        call at_least(c%on_gpu, c%ghosts%x, c%ghosts%wide, n, err)
        call at_least(c%on_gpu, c%ghosts%v, c%ghosts%wide, n, err)
        call at_least(c%on_gpu, c%ghosts%load, 3, n, err)
        if (pressed) then
            call at_least(c%on_gpu, c%ghosts%face_stress, 6, n, err)
            ! of bodies that never have one
            call clear_reals(c%on_gpu, 6*n, c%ghosts%face_stress, err)
        end if
        call at_least(c%on_gpu, c%ghosts%v_before, 3, n, err)
        call at_least(c%on_gpu, c%ghosts%mass, n, err)
        if (needs_volumes(c)) call at_least(c%on_gpu, c%ghosts%volume, n, err)
        call at_least(c%on_gpu, c%ghosts%id, n, err)
        call at_least(c%on_gpu, c%ghosts%fixed, n, err)
        call at_least(c%on_gpu, c%cell_of, n, err)
    end subroutine size_coupling_ghosts

    !> Give every particle the load that the process found in whose cell it is; none outside. Those
    !> in the halo of their own process have what this found, unless another one says better.
    subroutine send_loads_to_owners(solid, c, err)
        class(particles_t), intent(inout), target :: solid
        type(coupling_t), intent(inout), target :: c
        type(error_t), intent(inout) :: err
        integer, parameter :: w = words_of_real
        type(rows_t) :: from(2), to(2), own(2)
        integer :: n, places

        n = merge(2, 1, allocated(solid%face_stress))
        places = merge(solid%stride_d, solid%n, c%on_gpu)
        from(1) = rows_of(c%on_gpu, c%ghosts%load, w, 3, c%ghosts%n)
        own(1) = rows_of(c%on_gpu, solid%load, w, 3, solid%stride_d)
        to(1) = rows_of(c%on_gpu, c%part%loads, 3*w)
        if (n == 2) then
            from(2) = rows_of(c%on_gpu, c%ghosts%face_stress, w, 6, c%ghosts%n)
            own(2) = rows_of(c%on_gpu, solid%face_stress, w, 6, solid%stride_d)
            to(2) = rows_of(c%on_gpu, c%part%stresses, 6*w)
            call clear_reals(c%on_gpu, 6*places, solid%face_stress, err)
        end if
        call clear_reals(c%on_gpu, 3*places, solid%load, err)
        associate (part => c%part, p => solid, came => c%part%home%first(c%ranks%n) - 1)
            call part%messages%send_apart(part%in, part%home, from(:n), to(:n), part%out, own(:n), &
                                         err)
            call for_each_take_load(c%on_gpu, came, c%ranks%n, part%first_at, part%boxes_at, &
                                    c%box, p%wide, p%x, p%fixed, p%stride_d, p%stride_p, &
                                    part%out%place, 3, part%loads, p%load, err)
            if (n == 2) call for_each_take_load(c%on_gpu, came, c%ranks%n, part%first_at, &
                part%boxes_at, c%box, p%wide, p%x, p%fixed, p%stride_d, p%stride_t, &
                part%out%place, 6, part%stresses, p%face_stress, err)
        end associate
    end subroutine send_loads_to_owners
end module brz_coupling_ghost_driver
