! SPDX-License-Identifier: MIT
!> Particles on several processes when lists are built: each belongs to the process in whose region
!> its home is, and has ghosts on all others that its list may reach. Its home is its place
!> `x_built`, in total-Lagrangian bodies `x_ref`.
!>
!> So everything follows from these places, as the lists do: it is the same after a restart, and who
!> holds what changes no bit. Particles go home (`go_to_owners`), are sorted, and ghosts are laid
!> behind the particles of each body (`lay_ghosts`).
!>
!> A body of which a GPU builds few lists anew keeps its places: its particles stay where they are,
!> also outside the region of their process by `margin`, its ghosts too, and only new ones are laid
!> behind them. The CPU lays all anew.
!>
!> Each body has room for its particles and ghosts. Particles that leave make places for those that
!> come; what is left of both is closed up. Where the room of a body is too small all arrays are
!> laid anew. The host of a GPU hears how many particles go where, never which they are, but for
!> those that leave.
module brz_owner_driver
    use brz_cohesive_driver, only: mark_glue, note_owners
    use brz_ghost_wants, only: owners_of, most_outside, of_lists, planes_of, wants_of
    use brz_errors, only: error_t
    use brz_owner_backend, only: change_hands, fetch_homes, find_boxes, find_lowest, lay_arrays, &
        list_leaving, put_region, put_wants, settle_places, swap_ghosts
    use brz_gpu_solid_state, only: note_ranges
    use brz_owner_loops, only: for_each_mark_owner, for_each_mark_near
    use brz_kinds, only: dp, int64
    use brz_lists, only: at_least
    use brz_load_driver, only: mark_loaded_segments, note_carriers
    use brz_message_exchange, only: tell_all
    use brz_places, only: message_buffers_t
    use brz_solid_owner, only: are_even, lacks_room
    use brz_send_lists, only: begin_marks, count_marks
    use brz_solid_places, only: choose_places, lay_rooms
    use brz_solid_regions, only: cut_regions
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: go_to_owners, lay_ghosts

contains

    !> Particles of the stale bodies go to the processes in whose regions they are, which are cut
    !> anew where they are uneven, unless the body keeps its places: it is then only listed in part.
    !> All processes must call. Other bodies keep their particles, unless regions are cut anew.
    !> Ghosts are dropped but for those of bodies that keep places.
    subroutine go_to_owners(solid, stale, whole, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: stale(:) !! (bodies)
        logical, intent(inout) :: whole(:) !! (bodies) which keep no places
        type(error_t), intent(inout) :: err
        integer(int64) :: out(2*size(stale) + 1, solid%ranks%n), in(size(stale), solid%ranks%n)
        integer(int64) :: all(2*size(stale) + 1, solid%ranks%n, solid%ranks%n)
        logical :: go(size(stale))

        solid%part%recut = .not. allocated(solid%part%region)
        if (solid%part%recut) call cut_anew(solid, err)
        ! of bodies that keep places: by so much more ghosts are needed, or all go home
        if (solid%part%far(1) > 0) solid%part%margin = most_outside(solid)
        whole = whole .or. solid%part%far(2) > 0
        if (.not. any(whole)) return
        associate (n => size(stale), there => solid%bodies)
            do
                go = stale .and. whole .or. solid%part%recut
                call mark_leaving(solid, go, out(:n, :), err)
                out(n + 1, :) = sum(there%last - there%first + 1)
                out(n + 2:, :) = spread(there%room - there%last + there%first - 1, 2, &
                                        solid%ranks%n)
                call tell_all(solid%ranks, out, all)
                if (are_even(solid, all(:n + 1, :, :))) exit
                call cut_anew(solid, err)
                solid%part%recut = .true.
            end do
            whole = whole .or. solid%part%recut .or. lacks_room(all(:n, :, :), all(n + 2:, :, :))
            if (all_of(go)) solid%part%margin = 0
            in = all(:n, solid%ranks%rank + 1, :)
            call give_room(solid, in, whole, err)
            if (solid%part%grown) call mark_leaving(solid, go, out(:n, :), err) ! by place
            call change_places(solid, out(:n, :), in, sum(all(:n, :, :), 1), whole, err)
        end associate
        if (solid%on_gpu) call note_ranges(solid%bodies, solid%n, solid%device, err)
    end subroutine go_to_owners

    !> Cut the regions for the places of now.
    subroutine cut_anew(solid, err)
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: x(:, :)
        integer :: b, m, n

        associate (there => solid%bodies)
            allocate (x(solid%wide, sum(there%last - there%first + 1)), source=0.0_dp)
        end associate
        n = 0
        do b = 1, size(solid%bodies)
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                m = last - first + 1
                call fetch_homes(solid, b, first, last, x(:, n + 1:n + m), err)
                n = n + m
            end associate
        end do
        if (.not. allocated(solid%part%region)) &
            allocate (solid%part%region(3, 2, 0:solid%ranks%n - 1))
        call cut_regions(solid%ranks, x(:3, :), solid%part%region)
    end subroutine cut_anew

    !> Mark the particles of some bodies that leave, and count them.
    subroutine mark_leaving(solid, which, number, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        integer :: b

        call begin_marks(solid%on_gpu, solid%n, solid%ranks%n, solid%part%marks_t, err)
        if (solid%on_gpu) call put_region(solid%device, solid%part%region, err)
        do b = 1, size(which)
            if (.not. which(b)) cycle
            associate (there => solid%bodies(b), part => solid%part)
                call for_each_mark_owner(solid%on_gpu, there%last - there%first + 1, there%first, &
                    solid%wide, solid%n, solid%ranks%n, solid%ranks%rank, part%region, &
                    owners_of(solid, b), part%mark, err)
            end associate
        end do
        call count_marks(solid%on_gpu, solid%n, solid%bodies%first, solid%part%marks_t, number, err)
    end subroutine mark_leaving

    !> Send the marked particles, take in what comes, and close up.
    subroutine change_places(solid, out, in, all, whole, err)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes)
        integer(int64), intent(in) :: all(:, :) !! (to processes, from processes)
        logical, intent(in) :: whole(:) !! (bodies) see go_to_owners
        type(error_t), intent(inout) :: err
        type(message_buffers_t) :: leaving, coming

        if (sum(all) == 0) return
        call list_leaving(solid, out, sum(out + in, dim=2) > 0, leaving, err)
        associate (there => solid%bodies)
            call choose_places(solid%ranks%rank, out, in, there%last, leaving, coming)
            where (whole) there%rim = there%last
        end associate
        call change_hands(solid, all, leaving, coming, err)
    end subroutine change_places

    !> Lay ghosts behind the particles of each body, or where it keeps its places those that are new
    !> behind the others. All processes must call.
    subroutine lay_ghosts(solid, anew, whole, news, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(inout) :: anew(:) !! (bodies) whose lists must be built
        logical, intent(inout) :: whole(:) !! (bodies) which keep no places
        integer, intent(out) :: news(:) !! (bodies) the last of its ghosts that are new
        type(error_t), intent(inout) :: err
        integer(int64) :: out(2*size(anew), solid%ranks%n), in(size(anew), solid%ranks%n)
        integer(int64) :: all(2*size(anew), solid%ranks%n, solid%ranks%n)

        if (any(whole)) call note_owners(solid, err)
        if (any(whole)) call note_carriers(solid, err)
        call find_lowest(solid, err)
        call find_boxes(solid, err)
        associate (n => size(anew), there => solid%bodies)
            do
                call mark_ghosts(solid, whole, out(:n, :), err)
                where (whole) there%rim = there%last
                out(n + 1:, :) = spread(there%room - there%rim + there%first - 1, 2, solid%ranks%n)
                call tell_all(solid%ranks, out, all)
                if (all_of(whole) .or. .not. lacks_room(all(:n, :, :), all(n + 1:, :, :))) exit
                whole = .true.
            end do
            in = all(:n, solid%ranks%rank + 1, :)
            call give_room(solid, in, whole, err)
            if (solid%part%grown) call mark_ghosts(solid, whole, out(:n, :), err)
            news = int(sum(in, 2))
            if (any(whole) .or. sum(all(:n, :, :)) > 0) &
                call take_ghosts(solid, whole, out(:n, :), all(:n, :, :), err)
            anew = anew .or. whole .or. sum(sum(all(:n, :, :), 3), 2) > 0
        end associate
        solid%laid = solid%laid + 1
        if (.not. solid%on_gpu) return
        call note_ranges(solid%bodies, solid%n, solid%device, err)
        solid%device%fetched = .false.
        solid%device%summed = .false.
    end subroutine lay_ghosts

    !> Send the marked particles to others as ghosts, and take in those that come, behind the ghosts
    !> of bodies that keep their places.
    subroutine take_ghosts(solid, whole, out, all, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: whole(:) !! (bodies) which keep no places
        integer(int64), intent(in) :: out(:, :) !! (bodies, processes)
        integer(int64), intent(in) :: all(:, :, :) !! (bodies, to processes, from processes)
        type(error_t), intent(inout) :: err
        integer(int64), dimension(size(whole), solid%ranks%n, solid%ranks%n) :: was
        integer(int64), dimension(size(whole), solid%ranks%n) :: in
        integer :: me, next(size(whole))
        logical :: keeps(size(whole))

        keeps = .not. whole
        was = 0
        if (allocated(solid%part%kept)) was = solid%part%kept
        me = solid%ranks%rank + 1
        solid%part%kept = all + merge(was, 0_int64, spread(spread(keeps, 2, size(out, 2)), 3, &
                                                           size(out, 2)))
        associate (there => solid%bodies)
            next = there%rim
            in = all(:, me, :)
            call swap_ghosts(solid, keeps, was, out, in, sum(all, 1), next, err)
            there%rim = next
        end associate
        call settle_places(solid, err)
    end subroutine take_ghosts

    !> True where all are; `all` is what all processes have told.
    pure logical function all_of(which)
        logical, intent(in) :: which(:)

        all_of = all(which)
    end function all_of

    !> Mark the particles that others need ghosts of, and count them; of bodies that keep their
    !> places those that have none yet.
    subroutine mark_ghosts(solid, whole, number, err)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: whole(:) !! (bodies) which keep no places
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: want(:, :, :)
        integer :: b

        call begin_marks(solid%on_gpu, solid%n, solid%ranks%n, solid%part%marks_t, err)
        call at_least(solid%on_gpu, solid%part%sent, solid%n*solid%ranks%n, err)
        do b = 1, size(number, 1)
            want = wants_of(solid, solid%part, b, solid%part%region)
            if (size(want) == 0 .and. .not. whole(b)) cycle
            if (solid%on_gpu) call put_wants(solid%device, want, err)
            associate (there => solid%bodies(b), part => solid%part)
                call for_each_mark_near(solid%on_gpu, there%last - there%first + 1, there%first, &
                    solid%wide, solid%n, solid%ranks%n, solid%ranks%rank, merge(1, 0, whole(b)), &
                    planes_of(solid), of_lists(solid, b), size(want, 2), want, owners_of(solid, &
                    b), solid%x_built, solid%fixed, part%sent, part%mark, err)
            end associate
            call mark_glue(solid, b, err)
        end do
        call mark_loaded_segments(solid, err)
        call count_marks(solid%on_gpu, solid%n, solid%bodies%first, solid%part%marks_t, number, err)
    end subroutine mark_ghosts

    !> Room for the particles of this process, ghosts that are kept, and those that come.
    subroutine give_room(solid, in, whole, err)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: in(:, :) !! (bodies, processes)
        logical, intent(in) :: whole(:) !! (bodies) ghosts are dropped
        type(error_t), intent(inout) :: err
        integer :: need(size(in, 1)), old(size(in, 1))

        associate (there => solid%bodies)
            where (whole) there%rim = there%last
            need = there%rim - there%first + 1 + int(sum(in, dim=2))
            solid%part%grown = any(need > there%room)
            if (.not. solid%part%grown) return
            old = there%first
            call lay_rooms(need, there%first, there%last, there%rim, there%room, solid%n)
        end associate
        call lay_arrays(solid, old, err)
    end subroutine give_room
end module brz_owner_driver
