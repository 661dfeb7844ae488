! SPDX-License-Identifier: MIT
!> Particles on several processes: each belongs to the process in whose region its place `x_built`
!> is, and has ghosts on all others whose regions its list may reach.
!>
!> So everything follows from `x_built`, as the lists do: it is the same after a restart, and who
!> holds what changes no bit. When lists are built, particles go home (`send_home`), are sorted, and
!> ghosts are laid behind the particles of each body (`place_ghosts`).
module brz_solid_home
    use brz_ghost_wants, only: find_lowest, inhabited, is_needed, wants_of
    use brz_kinds, only: dp, int64
    use brz_mail, only: tell_counts
    use brz_particle_order, only: reorder_particles
    use brz_ranks, only: several, sum_of_all
    use brz_solid_arrays, only: cut_blocks, number_groups
    use brz_solid_fields, only: fields_of, fields_t, resize_fields
    use brz_solid_ghosts, only: all_of_it, for_a_ghost, send_particles
    use brz_solid_part, only: fill_pieces, find_firsts, parcels_t
    use brz_solid_regions, only: cut_regions, region_of
    use brz_resize, only: resize
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: share_out, hold_all, send_home, place_ghosts, all_particles, spread_bodies, &
        make_room, uneven

    real(dp), parameter :: uneven = 1.05_dp !! most particles over the mean: regions are cut anew

contains

    !> Particles of all processes.
    pure integer function all_particles(solid)
        type(solid_t), intent(in) :: solid

        all_particles = 0
        if (solid%present) all_particles = maxval(solid%bodies%number(2))
    end function all_particles

    !> Every process holds all particles, body by body: keep a share of them, any one. Lists must be
    !> built afterwards.
    subroutine share_out(solid)
        type(solid_t), intent(inout) :: solid
        integer(int64) :: n
        integer :: b, k, lo, hi, own(size(solid%bodies))

        if (.not. several(solid%ranks)) return
        n = solid%n
        lo = int(n*solid%ranks%rank/solid%ranks%n) + 1
        hi = int(n*(solid%ranks%rank + 1)/solid%ranks%n)
        do b = 1, size(solid%bodies)
            own(b) = max(min(hi, solid%bodies(b)%last) - max(lo, solid%bodies(b)%first) + 1, 0)
        end do
        solid%search%order(:hi - lo + 1) = [(k, k=lo, hi)]
        call reorder_particles(solid, 1, hi - lo + 1)
        call lay_bodies(solid, own, 0*own)
        call make_room(solid, solid%n + solid%n/4 + 64, exactly=.true.)
        if (allocated(solid%part%region)) deallocate (solid%part%region)
        if (solid%ranks%rank > 0) solid%bodies%motion%mass = 0 ! the first books what drives them
    end subroutine share_out

    !> Arrays for all particles, body by body, as the set-up has them: a checkpoint is to be read.
    subroutine hold_all(solid)
        type(solid_t), intent(inout) :: solid

        if (.not. several(solid%ranks)) return
        call lay_bodies(solid, solid%bodies%number(2) - solid%bodies%number(1) + 1, &
                        0*solid%bodies%first)
        call make_room(solid, solid%n, exactly=.true.)
    end subroutine hold_all

    !> Ranges of particles and ghosts of all bodies.
    subroutine lay_bodies(solid, own, ghosts, spare)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: own(:), ghosts(:) !! (bodies)
        integer, intent(in), optional :: spare(:) !! (bodies) places behind them
        integer :: b

        solid%n = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%first = solid%n + 1
                body%last = solid%n + own(b)
                body%rim = body%last + ghosts(b)
                solid%n = body%rim
                if (present(spare)) solid%n = body%rim + spare(b)
            end associate
        end do
        if (allocated(solid%links%ends)) solid%links%ends = solid%bodies%rim
    end subroutine lay_bodies

    !> Room for n particles, with something to spare.
    subroutine make_room(solid, n, exactly)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: n
        logical, intent(in), optional :: exactly !! room for n, also where there was more
        integer :: room

        room = n + n/4
        if (present(exactly)) room = n
        if (.not. present(exactly) .and. size(solid%x, 2) >= n) return
        call resize_fields(solid, room)
        if (allocated(solid%links%row)) call resize(solid%links%row, room)
        deallocate (solid%search%order)
        allocate (solid%search%order(room), source=0)
    end subroutine make_room

    !> Send the particles of this process to those in whose regions they are, and take in what
    !> others send. Ghosts are dropped. The regions are cut anew where they are uneven.
    subroutine send_home(solid)
        type(solid_t), intent(inout) :: solid
        integer :: home(solid%n)

        if (.not. allocated(solid%part%region)) then
            allocate (solid%part%region(3, 2, 0:solid%ranks%n - 1))
            solid%part%most = 0
            call cut_anew(solid)
        end if
        call find_homes(solid, home)
        if (most_of_one(solid, home) > uneven*max(solid%part%most, &
                                                  all_particles(solid)/solid%ranks%n)) then
            call cut_anew(solid)
            call find_homes(solid, home)
            solid%part%most = most_of_one(solid, home)
        end if
        call move_home(solid, home)
    end subroutine send_home

    !> Cut the regions for the places `x_built`.
    subroutine cut_anew(solid)
        type(solid_t), intent(inout) :: solid
        real(dp), allocatable :: x(:, :)
        integer :: b, n

        allocate (x(3, sum(solid%bodies%last - solid%bodies%first + 1)))
        n = 0
        do b = 1, size(solid%bodies)
            associate (first => solid%bodies(b)%first, last => solid%bodies(b)%last)
                x(:, n + 1:n + last - first + 1) = solid%x_built(:, first:last)
                n = n + last - first + 1
            end associate
        end do
        call cut_regions(solid%ranks, x, solid%part%region)
    end subroutine cut_anew

    !> Process of each particle; -1 for ghosts.
    pure subroutine find_homes(solid, home)
        type(solid_t), intent(in) :: solid
        integer, intent(out) :: home(:)
        integer :: b, i

        home = -1
        do b = 1, size(solid%bodies)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                home(i) = region_of(solid%part%region, solid%x_built(:, i))
            end do
        end do
    end subroutine find_homes

    !> The most particles that a process will have.
    integer function most_of_one(solid, home) result(most)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: home(:)
        integer(int64) :: n(0:solid%ranks%n - 1)
        integer :: i

        n = 0
        do i = 1, size(home)
            if (home(i) >= 0) n(home(i)) = n(home(i)) + 1
        end do
        call sum_of_all(solid%ranks, n)
        most = int(maxval(n))
    end function most_of_one

    !> Send, take in, and close the ranks.
    subroutine move_home(solid, home)
        type(solid_t), intent(inout), target :: solid
        integer, intent(in) :: home(:)
        integer(int64) :: out(size(solid%bodies), solid%ranks%n), in(size(solid%bodies), &
                                                                     solid%ranks%n)
        type(parcels_t) :: leaving, coming
        integer :: own(size(solid%bodies))
        type(fields_t) :: fields
        integer :: b, i, k, n, r

        call list_by_home(solid, home, leaving, out)
        call tell_counts(solid%ranks, out, in)
        call find_firsts(in, coming%first)
        n = solid%n
        coming%place = [(n + k, k=1, coming%first(solid%ranks%n) - 1)]
        call make_room(solid, n + size(coming%place) + 1)
        solid%n = n + size(coming%place)
        call fields_of(solid, fields)
        call send_particles(solid%ranks, all_of_it, fields, leaving, fields, coming, &
                            solid%part%mail)
        k = 0
        do b = 1, size(solid%bodies)
            own(b) = k
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                if (home(i) /= solid%ranks%rank) cycle
                k = k + 1
                solid%search%order(k) = i
            end do
            do r = 1, solid%ranks%n
                do i = 1, int(in(b, r))
                    k = k + 1
                    solid%search%order(k) = n + coming%first(r - 1) - 1 + int(sum(in(:b - 1, r))) &
                                            + i
                end do
            end do
            own(b) = k - own(b)
        end do
        call reorder_particles(solid, 1, k)
        call lay_bodies(solid, own, 0*own)
    end subroutine move_home

    !> Particles that leave, process by process and body by body; how many there are of each.
    subroutine list_by_home(solid, home, leaving, number)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: home(:)
        type(parcels_t), intent(out) :: leaving
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        integer :: at(size(number, 1), size(number, 2)), b, i, k, r

        number = 0
        do b = 1, size(number, 1)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                if (home(i) /= solid%ranks%rank) &
                    number(b, home(i) + 1) = number(b, home(i) + 1) + 1
            end do
        end do
        allocate (leaving%first(0:size(number, 2)))
        k = 1
        do r = 1, size(number, 2)
            leaving%first(r - 1) = k
            do b = 1, size(number, 1)
                at(b, r) = k
                k = k + int(number(b, r))
            end do
        end do
        leaving%first(size(number, 2)) = k
        allocate (leaving%place(k - 1))
        do b = 1, size(number, 1)
            do i = solid%bodies(b)%first, solid%bodies(b)%last
                if (home(i) == solid%ranks%rank) cycle
                leaving%place(at(b, home(i) + 1)) = i
                at(b, home(i) + 1) = at(b, home(i) + 1) + 1
            end do
        end do
    end subroutine list_by_home

    !> Lay ghosts behind the particles of each body, and number groups and blocks for it.
    subroutine place_ghosts(solid)
        type(solid_t), intent(inout), target :: solid
        integer(int64) :: out(size(solid%bodies), solid%ranks%n), in(size(solid%bodies), &
                                                                     solid%ranks%n)
        integer :: own(size(solid%bodies)), next(size(solid%bodies))
        type(fields_t) :: fields

        associate (part => solid%part, ranks => solid%ranks)
            call list_near(solid, out)
            call tell_counts(ranks, out, in)
            own = solid%bodies%last - solid%bodies%first + 1
            call open_gaps(solid, own, int(sum(in, dim=2)))
            if (allocated(part%in%place)) deallocate (part%in%place)
            allocate (part%in%place(sum(in)))
            next = solid%bodies%last
            call fill_pieces(in, next, part%in)
            call fields_of(solid, fields)
            call send_particles(ranks, for_a_ghost, fields, part%out, fields, part%in, part%mail)
        end associate
        call number_groups(solid)
        call cut_blocks(solid)
        solid%loads%rebuilds = -1 ! its places are others now
    end subroutine place_ghosts

    !> List the particles that others have ghosts of: process by process, body by body.
    subroutine list_near(solid, number)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        real(dp), allocatable :: want(:, :)
        real(dp) :: region(3, 2)
        integer :: b, i, n, r, round

        call find_lowest(solid)
        if (.not. allocated(solid%part%out%first)) &
            allocate (solid%part%out%first(0:solid%ranks%n))
        do round = 1, 2 ! count, then list
            n = 0
            number = 0
            do r = 0, solid%ranks%n - 1
                solid%part%out%first(r) = n + 1
                if (r == solid%ranks%rank) cycle
                region = inhabited(solid, solid%part%region(:, :, r))
                do b = 1, size(solid%bodies)
                    want = wants_of(solid, b)
                    do i = solid%bodies(b)%first, solid%bodies(b)%last
                        if (.not. is_needed(solid, region, want, i)) cycle
                        n = n + 1
                        number(b, r + 1) = number(b, r + 1) + 1
                        if (round == 2) solid%part%out%place(n) = i
                    end do
                end do
            end do
            solid%part%out%first(solid%ranks%n) = n + 1
            if (round == 2) exit
            if (allocated(solid%part%out%place)) deallocate (solid%part%out%place)
            allocate (solid%part%out%place(n))
        end do
    end subroutine list_near

    !> Leave places free behind the particles and ghosts of each body: a share of them, and 64.
    subroutine spread_bodies(solid, share)
        type(solid_t), intent(inout) :: solid
        real(dp), intent(in) :: share
        integer :: own(size(solid%bodies)), ghosts(size(solid%bodies)), b, end, shift(solid%n)

        own = solid%bodies%last - solid%bodies%first + 1
        ghosts = solid%bodies%rim - solid%bodies%last
        call move_bodies(solid, own, ghosts, int(share*(own + ghosts)) + 64, shift)
        associate (place => solid%part%in%place)
            place = place + shift(place)
        end associate
        do b = 1, size(own) ! what lies behind is no particle
            end = solid%n
            if (b < size(own)) end = solid%bodies(b + 1)%first - 1
            solid%id(solid%bodies(b)%rim + 1:end) = 0
        end do
    end subroutine spread_bodies

    !> Move the particles of each body to where they lie once there are ghosts between the bodies.
    subroutine open_gaps(solid, own, ghosts)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: own(:), ghosts(:) !! (bodies)
        integer :: shift(solid%n)

        call move_bodies(solid, own, ghosts, 0*own, shift)
    end subroutine open_gaps

    !> Move the particles of each body, and its ghosts where it has some, to new places.
    subroutine move_bodies(solid, own, ghosts, spare, shift)
        type(solid_t), intent(inout) :: solid
        integer, intent(in) :: own(:), ghosts(:), spare(:) !! (bodies)
        integer, intent(out) :: shift(:) !! (n before)
        integer :: old(size(own)), n(size(own)), b, k

        old = solid%bodies%first
        n = solid%bodies%rim - solid%bodies%first + 1
        call lay_bodies(solid, own, ghosts, spare)
        call make_room(solid, solid%n + 1)
        shift = 0
        if (size(own) == 1) return
        solid%search%order(:solid%n) = 1
        do b = 1, size(own)
            associate (first => solid%bodies(b)%first)
                solid%search%order(first:first + n(b) - 1) = [(old(b) + k, k=0, n(b) - 1)]
                shift(old(b):old(b) + n(b) - 1) = first - old(b)
            end associate
        end do
        call reorder_particles(solid, 1, solid%n)
        associate (place => solid%part%out%place)
            place = place + shift(place)
        end associate
    end subroutine move_bodies
end module brz_solid_home
