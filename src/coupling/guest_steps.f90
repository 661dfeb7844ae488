! SPDX-License-Identifier: MIT
!> Copies of particles of all processes for the process in whose window of the air they are, and
!> what goes back: their loads. See brz_coupling_part; scripts/steps.py writes the same for the GPU.
module brz_guest_steps
    use brz_carrier_steps, only: sum_shifts
    use brz_coupling_guests, only: send_guests !@cpu
    !@gpu use brz_gpu_coupling_guests, only: find_runs, send_guests
    use brz_coupling_part, only: introduce, list_now, may_have_come
    use brz_coupling_state, only: coupling_t
    use brz_guest_loops, only: each_mark_guest, each_miss_guest, each_take_load
    use brz_kinds, only: int64
    use brz_lists, only: at_least, clear_reals, put_list, room_of
    use brz_mail, only: tell_all
    use brz_mark_steps, only: count_marks, list_marks, place_pieces, reserve_marks
    use brz_parcels, only: rows_of, rows_t
    use brz_place_loops, only: each_give_place
    use brz_ranks, only: most_of_all
    use brz_record_rules, only: words_of_real
    use brz_solid_state, only: solid_t
    use brz_velocity_loops, only: each_keep_velocity
    implicit none
    private
    public :: invite_guests, send_loads_home

contains

    !> Renew the guests of all processes: their particles have moved. They are listed anew where one
    !> of them is missing, or particles lie elsewhere.
    subroutine invite_guests(solid, p, c)
        class(solid_t), intent(in) :: solid !! its bodies
        type(solid_t), intent(inout) :: p !! its particles
        type(coupling_t), intent(inout) :: c
        integer(int64) :: most(1)
        integer :: missed

        call introduce(solid, c%crowd) !@host
        missed = merge(0, 1, c%part%rebuilds == p%rebuilds)
        if (missed == 0) then
            ! as others do when loads come home
            call each_keep_velocity(c%guests%n, c%guests%wide, 1, 3, c%guests%v, c%part%seat, &
                                    c%guests%v_before)
            call send_guests(p, c, .false.)
            if (may_have_come(solid, c%part%since, c%box%whole, c%box%dx)) then
                !@gpu call clear_buffer(c%counts)
                call each_miss_guest(p%n, p%n, size(p%bodies), c%part%bodies_at, c%ranks%n, &
                                     c%part%windows_at, c%box, p%wide, p%x, p%fixed, &
                                     c%part%listed%mark, missed) !@gpu count_missed
                most = missed
                call most_of_all(c%ranks, most) !@host
                missed = int(most(1))
            end if
        end if
        if (missed > 0) then
            call list_guests(solid, p, c)
            call send_guests(p, c, .true.)
            call list_now(solid, c%part%since) !@host
            c%part%rebuilds = p%rebuilds
            c%rebuilds = -1 ! a guest's place was another one's
        end if
        call sum_shifts(solid, p, c)
    end subroutine invite_guests

    !> List the particles in the windows and a layer around, and give them places there.
    subroutine list_guests(solid, p, c)
        class(solid_t), intent(in) :: solid !! its bodies
        type(solid_t), intent(in) :: p
        type(coupling_t), intent(inout) :: c
        integer(int64), dimension(size(p%bodies), c%ranks%n) :: out, in
        integer(int64) :: all(size(out, 1), c%ranks%n, c%ranks%n), away(1, c%ranks%n)
        integer :: b, none(1)

        associate (part => c%part, n => p%n, boxes => c%ranks%n)
            call put_list([(p%bodies(b)%first, p%bodies(b)%last, b=1, size(out, 1))], &
                          part%bodies_at)
            call reserve_marks(n, boxes, part%listed)
            call each_mark_guest(n, n, size(out, 1), part%bodies_at, boxes, part%near_at, c%box, &
                                 p%wide, p%x, p%fixed, part%listed%mark)
            call count_marks(n, p%bodies%first, part%listed, out)
            call tell_all(c%ranks, out, all) !@host
            in = all(:, c%ranks%rank + 1, :)
            call list_marks(n, out, part%listed, part%out)
            call seat_guests(c, in, n, allocated(solid%face_stress))
            ! on their way home loads of others come in the order of the list
            none = 0
            away = reshape(sum(out, 1), [1, boxes])
            away(1, c%ranks%rank + 1) = 0
            call place_pieces(away, none, part%marks, part%home)
            call put_list([part%home%first, part%out%first - part%home%first], part%first_at)
            call at_least(part%loads, 3, part%home%first(boxes) - 1)
            if (allocated(solid%face_stress)) &
                call at_least(part%stresses, 6, part%home%first(boxes) - 1)
            !@gpu call find_runs(p, out, in, c)
            !@gpu call part%parcels%aim(sum(all, 1), part%out)
            !@gpu call part%parcels%aim(transpose(sum(all, 1)), part%in)
        end associate
    end subroutine list_guests

    !> Places for the guests, body by body.
    subroutine seat_guests(c, number, particles, pressed)
        type(coupling_t), intent(inout) :: c
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        integer, intent(in) :: particles !! of this process
        logical, intent(in) :: pressed !! loads bring a stress to faces
        integer :: b, n, taken(size(number, 1))

        n = 0
        do b = 1, size(taken)
            taken(b) = n
            n = n + int(sum(number(b, :)))
            c%guests%bodies(b)%first = taken(b) + 1
            c%guests%bodies(b)%last = n
            c%crowd%bodies(b)%first = taken(b) + 1
            c%crowd%bodies(b)%last = n
        end do
        call size_guests(c, n, pressed)
        associate (part => c%part)
            call place_pieces(number, taken, part%marks, part%in)
            n = max(n, particles)
            if (room_of(part%seat) >= n) return
            call at_least(part%seat, n)
            n = room_of(part%seat)
            call put_list([n, 0], part%marks%pieces)
            call each_give_place(n, 1, part%marks%pieces, part%seat)
        end associate
    end subroutine seat_guests

    !> Room for n guests; those that were there are gone.
    subroutine size_guests(c, n, pressed)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n
        logical, intent(in) :: pressed !! loads bring a stress to faces

        c%guests%n = n
        !@gpu c%guests%step_d = n
        call at_least(c%guests%x, c%guests%wide, n)
        call at_least(c%guests%v, c%guests%wide, n)
        call at_least(c%guests%load, 3, n)
        if (pressed) then
            call at_least(c%guests%face_stress, 6, n)
            call clear_reals(6*n, c%guests%face_stress) ! of bodies that never have one
        end if
        call at_least(c%guests%v_before, 3, n)
        call at_least(c%guests%mass, n)
        call at_least(c%guests%volume, n) !@cpu
        call at_least(c%guests%id, n)
        call at_least(c%guests%fixed, n)
        call at_least(c%cell_of, n)
        call at_least(c%place_of, n)
        call at_least(c%binned, n)
    end subroutine size_guests

    !> Give every particle the load that the process found in whose cell it is; none outside. Those
    !> in the window of their own process have what this found, unless another one says better.
    subroutine send_loads_home(solid, p, c)
        class(solid_t), intent(in) :: solid !! its bodies
        type(solid_t), intent(inout), target :: p
        type(coupling_t), intent(inout), target :: c
        type(rows_t) :: from(2), to(2), own(2)
        integer :: n

        n = merge(2, 1, allocated(solid%face_stress))
        from(1) = rows_of(c%guests%load, 3*words_of_real) !@cpu
        own(1) = rows_of(p%load, 3*words_of_real) !@cpu
        !@gpu from(1) = rows_of(c%guests%load, words_of_real, 3, c%guests%n)
        !@gpu own(1) = rows_of(p%load, words_of_real, 3, p%step_d)
        to(1) = rows_of(c%part%loads, 3*words_of_real)
        if (n == 2) then
            from(2) = rows_of(c%guests%face_stress, 6*words_of_real) !@cpu
            own(2) = rows_of(p%face_stress, 6*words_of_real) !@cpu
            !@gpu from(2) = rows_of(c%guests%face_stress, words_of_real, 6, c%guests%n)
            !@gpu own(2) = rows_of(p%face_stress, words_of_real, 6, p%step_d)
            to(2) = rows_of(c%part%stresses, 6*words_of_real)
            call clear_reals(6*p%n, p%face_stress) !@cpu
            !@gpu call clear_reals(6*p%step_d, p%face_stress)
        end if
        call clear_reals(3*p%n, p%load) !@cpu
        !@gpu call clear_reals(3*p%step_d, p%load)
        call c%part%parcels%send_apart(c%part%in, c%part%home, from(:n), to(:n), c%part%out, &
                                       own(:n))
        call each_take_load(c%part%home%first(c%ranks%n) - 1, c%ranks%n, c%part%first_at, &
                            c%part%boxes_at, c%box, p%wide, p%x, p%fixed, p%step_d, p%step_p, &
                            c%part%out%place, 3, c%part%loads, p%load)
        if (n == 2) call each_take_load(c%part%home%first(c%ranks%n) - 1, c%ranks%n, &
                                        c%part%first_at, c%part%boxes_at, c%box, p%wide, p%x, &
                                        p%fixed, p%step_d, p%step_t, c%part%out%place, 6, &
                                        c%part%stresses, p%face_stress)
    end subroutine send_loads_home
end module brz_guest_steps
