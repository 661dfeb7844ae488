! SPDX-License-Identifier: MIT
!> Particles on several processes when lists are built: each belongs to the process in whose region
!> its place `x_built` is, and has ghosts on all others whose regions its list may reach.
!> scripts/steps.py writes the same for the GPU.
!>
!> So everything follows from `x_built`, as the lists do: it is the same after a restart, and who
!> holds what changes no bit. Particles go home (`go_home`), are sorted, and ghosts are laid behind
!> the particles of each body (`lay_ghosts`).
!>
!> Each body has room for its particles and ghosts. Particles that leave make places for those that
!> come; what is left of both is closed up. Where the room of a body is too small all arrays are
!> laid anew. The host of a GPU hears how many particles go where, never which they are, but for
!> those that leave.
module brz_home_steps
    use brz_ghost_wants, only: find_lowest !@cpu
    use brz_ghost_wants, only: inhabited, planes_of, wants_of
    !@gpu use brz_device, only: copy_out
    !@gpu use brz_gpu_mark_steps, only: begin_marks, count_marks, list_marks, place_pieces
    !@gpu use brz_gpu_solid_home, only: close_books, list_leaving, put_table, send_away
    !@gpu use brz_gpu_solid_home, only: settle_places
    !@gpu use brz_gpu_solid_state, only: lay_arrays
    use brz_home_loops, only: each_mark_home, each_mark_near
    use brz_kinds, only: dp, int64
    use brz_mail, only: tell_all
    use brz_mark_steps, only: begin_marks, count_marks, list_marks, place_pieces !@cpu
    use brz_places, only: parcels_t
    use brz_ranks, only: most_of_all
    use brz_solid_ghosts, only: send_ghosts !@cpu
    use brz_solid_home, only: are_even
    use brz_solid_home, only: lay_arrays, send_away, settle_places !@cpu
    use brz_solid_places, only: choose_places, lay_rooms
    use brz_solid_regions, only: cut_regions
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: go_home, lay_ghosts

contains

    !> Particles of the stale bodies go to the processes in whose regions they are, which are cut
    !> anew where they are uneven. Ghosts are dropped. All processes must call. Other bodies keep
    !> their particles, unless regions are cut anew.
    subroutine go_home(solid, stale)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: stale(:) !! (bodies)
        integer(int64) :: out(size(stale) + 1, solid%ranks%n), in(size(stale), solid%ranks%n)
        integer(int64) :: all(size(stale) + 1, solid%ranks%n, solid%ranks%n)

        solid%part%recut = .not. allocated(solid%part%region)
        if (solid%part%recut) call cut_anew(solid)
        associate (n => size(stale), there => solid%bodies)
            do
                call mark_leaving(solid, stale .or. solid%part%recut, out(:n, :))
                out(n + 1, :) = sum(there%last - there%first + 1)
                call tell_all(solid%ranks, out, all)
                if (are_even(solid, all)) exit
                call cut_anew(solid)
                solid%part%recut = .true.
            end do
            in = all(:n, solid%ranks%rank + 1, :)
            call give_room(solid, in)
            if (solid%part%grown) & ! marks are those of places
                call mark_leaving(solid, stale .or. solid%part%recut, out(:n, :))
            call change_places(solid, out(:n, :), in, sum(all(:n, :, :), 1))
        end associate
    end subroutine go_home

    !> Cut the regions for the places of now.
    subroutine cut_anew(solid)
        type(solid_t), intent(inout) :: solid
        real(dp), allocatable :: x(:, :)
        integer :: b, m, n

        associate (there => solid%bodies)
            allocate (x(solid%wide, sum(there%last - there%first + 1)), source=0.0_dp)
        end associate
        n = 0
        do b = 1, size(solid%bodies)
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                m = last - first + 1
                x(:, n + 1:n + m) = solid%x_built(:, first:last) !@cpu
                !@gpu call copy_out(from(gpu%x_built, 4_int64*first - 3), x(:, n + 1:), 32_int64*m)
                n = n + m
            end associate
        end do
        if (.not. allocated(solid%part%region)) &
            allocate (solid%part%region(3, 2, 0:solid%ranks%n - 1))
        call cut_regions(solid%ranks, x(:3, :), solid%part%region)
    end subroutine cut_anew

    !> Mark the particles of some bodies that leave, and count them.
    subroutine mark_leaving(solid, which, number)
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: which(:) !! (bodies)
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        integer :: b

        call begin_marks(solid%n, solid%ranks%n, solid%part%marks_t) !@cpu
        !@gpu call begin_marks(gpu%n, solid%ranks%n, gpu%part)
        !@gpu call put_table(solid%part%region, size(solid%part%region), gpu%part%region)
        do b = 1, size(which)
            if (.not. which(b)) cycle
            associate (there => solid%bodies(b), part => solid%part)
                call each_mark_home(there%last - there%first + 1, there%first, solid%wide, &
                    solid%n, solid%ranks%n, solid%ranks%rank, part%region, solid%x_built, &
                    part%mark)
            end associate
        end do
        call count_marks(solid%n, solid%bodies%first, solid%part%marks_t, number) !@cpu
        !@gpu call count_marks(gpu%n, gpu%bodies%first, gpu%part, number)
    end subroutine mark_leaving

    !> Send the marked particles, take in what comes, and close up.
    subroutine change_places(solid, out, in, all)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes)
        integer(int64), intent(in) :: all(:, :) !! (to processes, from processes)
        type(parcels_t) :: leaving, coming

        if (sum(all) == 0) return
        !@gpu call close_books(gpu, solid, sum(out + in, dim=2) > 0)
        call list_marks(solid%n, out, solid%part%marks_t, leaving) !@cpu
        !@gpu call list_leaving(gpu, out, leaving)
        associate (there => solid%bodies)
            call choose_places(solid%ranks%rank, out, in, there%last, leaving, coming)
            there%rim = there%last
        end associate
        call send_away(solid, leaving, coming) !@cpu
        !@gpu call send_away(gpu, all, leaving, coming)
    end subroutine change_places

    !> Lay ghosts behind the particles of each body. Ghosts of a body that is not stale are as they
    !> were, unless links reach them.
    subroutine lay_ghosts(solid, anew)
        type(solid_t), intent(inout) :: solid
        logical, intent(inout) :: anew(:) !! (bodies) whose lists must be built
        integer(int64), dimension(size(anew), solid%ranks%n) :: out, in
        integer(int64) :: all(size(anew), solid%ranks%n, solid%ranks%n), grown(1)
        integer :: next(size(anew))
        !@gpu integer :: k

        call find_lowest(solid) !@cpu
        !@gpu solid%part%lowest = [(minval(gpu%bodies%box(k, 1)), k=1, 3)]
        !@gpu where (.not. solid%mirror) solid%part%lowest = -huge(1.0_dp)
        call mark_ghosts(solid, out)
        call tell_all(solid%ranks, out, all)
        in = all(:, solid%ranks%rank + 1, :)
        grown = merge(1, 0, solid%part%grown)
        call give_room(solid, in)
        if (solid%part%grown) call mark_ghosts(solid, out)
        associate (there => solid%bodies)
            next = there%last
            call list_marks(solid%n, out, solid%part%marks_t, solid%part%out) !@cpu
            call place_pieces(in, next, solid%part%marks_t, solid%part%in) !@cpu
            !@gpu call list_marks(gpu%n, out, gpu%part, gpu%ghosts%out)
            !@gpu call gpu%ghosts%aim(sum(all, 1), gpu%ghosts%out)
            !@gpu call place_pieces(in, next, gpu%part, gpu%ghosts%in)
            there%rim = next
        end associate
        call send_ghosts(solid) !@cpu
        !@gpu call gpu%ghosts%send(gpu%ghosts%out, gpu%ghosts%in, gpu%record, gpu%record)
        call settle_places(solid)
        if (solid%part%grown) grown = 1
        ! all build the same lists
        if (count(anew) < size(anew)) call most_of_all(solid%ranks, grown)
        anew = anew .or. solid%part%recut .or. grown(1) > 0 .or. solid%links%present
        !@gpu gpu%settled = .false.
        !@gpu gpu%fetched = .false.
        !@gpu gpu%summed = .false.
        !@gpu gpu%laid = gpu%laid + 1
    end subroutine lay_ghosts

    !> Mark the particles that others have ghosts of, and count them.
    subroutine mark_ghosts(solid, number)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        real(dp) :: regions(3, 2, 0:solid%ranks%n - 1)
        real(dp), allocatable :: want(:, :)
        integer :: b, r

        do r = 0, solid%ranks%n - 1
            regions(:, :, r) = inhabited(solid, solid%part%region(:, :, r))
        end do
        call begin_marks(solid%n, solid%ranks%n, solid%part%marks_t) !@cpu
        !@gpu call begin_marks(gpu%n, solid%ranks%n, gpu%part)
        !@gpu call put_table(regions, size(regions), gpu%part%region)
        do b = 1, size(number, 1)
            want = wants_of(solid, b)
            if (size(want) == 0) cycle
            !@gpu call put_table(want, size(want), gpu%part%wants)
            associate (there => solid%bodies(b), part => solid%part)
                do r = 0, solid%ranks%n - 1
                    if (r == solid%ranks%rank) cycle
                    call each_mark_near(there%last - there%first + 1, there%first, solid%wide, &
                        solid%n, r, planes_of(solid), size(want, 2), want, regions, &
                        solid%x_built, solid%fixed, &
                        part%mark) !@gpu want => part%wants, regions => part%region
                end do
            end associate
        end do
        call count_marks(solid%n, solid%bodies%first, solid%part%marks_t, number) !@cpu
        !@gpu call count_marks(gpu%n, gpu%bodies%first, gpu%part, number)
    end subroutine mark_ghosts

    !> Room for the particles of this process and those that come; ghosts are dropped.
    subroutine give_room(solid, in)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: in(:, :) !! (bodies, processes)
        integer :: need(size(in, 1)), old(size(in, 1))

        associate (there => solid%bodies)
            need = there%last - there%first + 1 + int(sum(in, dim=2))
            there%rim = there%last
            solid%part%grown = any(need > there%room)
            if (.not. solid%part%grown) return
            old = there%first
            call lay_rooms(need, there%first, there%last, there%rim, there%room, solid%n)
        end associate
        call lay_arrays(solid, old)
        !@gpu call settle_places(gpu, solid)
    end subroutine give_room
end module brz_home_steps
