! SPDX-License-Identifier: MIT
!> Copies of particles of all processes for the process in whose window of the air they are, and
!> what goes back: their loads. See brz_coupling_part.
module brz_coupling_guests
    use brz_air_part, only: window_of
    use brz_air_state, only: air_t
    use brz_cell_place, only: cell_number
    use brz_cell_shells, only: cell_at
    use brz_coupling_box, only: is_own
    use brz_coupling_part, only: introduce
    use brz_carrier_steps, only: sum_shifts
    use brz_coupling_state, only: coupling_t
    use brz_fetch, only: fetch
    use brz_kinds, only: dp, int32, int64, rk
    use brz_mail, only: incoming, make_room, outgoing, post, tell_counts
    use brz_solid_fields, only: fields_of, fields_t
    use brz_solid_ghosts, only: for_the_air, send_particles
    use brz_solid_part, only: fill_pieces
    use brz_solid_state, only: is_gone, solid_t
    implicit none
    private
    public :: open_windows, invite_guests, send_loads_home, see_window

contains

    !> The cells that each process sees.
    subroutine open_windows(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: r

        associate (part => coupling%part)
            part%boxes = air%part%boxes
            allocate (part%windows(0:air%part%ranks%n - 1))
            do r = 0, ubound(part%windows, 1)
                part%windows(r) = window_of(air%part, r, air%whole, air%around)
            end do
            allocate (part%out%first(0:air%part%ranks%n), part%in%first(0:air%part%ranks%n))
            allocate (part%out%place(0), part%theirs(0), part%in%place(0), part%cell(3, 0))
        end associate
    end subroutine open_windows

    !> Bring the gas and the ledgers in the window of this process up to date.
    subroutine see_window(air)
        type(air_t), intent(inout) :: air

        call fetch(air%part%ranks, air%part%window, air%n_var, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%u)
    end subroutine see_window

    !> Renew the guests of all processes: their particles have moved.
    subroutine invite_guests(bodies, solid, coupling)
        class(solid_t), intent(in) :: bodies !! with its bodies
        type(solid_t), intent(inout), target :: solid
        type(coupling_t), intent(inout), target :: coupling
        integer(int64) :: out(size(solid%bodies), solid%ranks%n), in(size(solid%bodies), &
                                                                     solid%ranks%n)
        type(fields_t) :: from, to

        call find_places(solid, coupling)
        call list_guests(solid, coupling, out)
        call tell_counts(solid%ranks, out, in)
        call seat_guests(bodies, in, coupling)
        call seat_own(solid%n, coupling%part%seat)
        call fields_of(solid, from)
        call fields_of(coupling%guests, to)
        associate (part => coupling%part)
            call send_particles(solid%ranks, for_the_air, from, part%out, to, part%in, &
                                part%guest_mail)
        end associate
        call introduce(bodies, coupling%guests)
        call sum_shifts(bodies, solid, coupling)
    end subroutine invite_guests

    !> Cell of the grid in which each particle of this process is.
    subroutine find_places(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer(int32) :: c
        integer :: b, i
        integer, parameter :: nothing(3) = 0

        if (size(coupling%part%cell, 2) < solid%n) then
            deallocate (coupling%part%cell)
            allocate (coupling%part%cell(3, solid%n + solid%n/4))
        end if
        associate (box => coupling%box, cell => coupling%part%cell)
            do b = 1, size(solid%bodies)
                do i = solid%bodies(b)%first, solid%bodies(b)%last
                    c = cell_number(solid%x(:, i), box%lo, box%dx, box%whole, box%wraps, nothing, &
                                    box%whole)
                    if (solid%fixed(i) == is_gone) c = 0
                    cell(:, i) = 0
                    if (c > 0) cell(:, i) = cell_at(box%whole, c)
                end do
            end do
        end associate
    end subroutine find_places

    !> List the particles in each window, body by body.
    subroutine list_guests(solid, coupling, number)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer(int64), intent(out) :: number(:, :) !! (bodies, processes)
        integer :: b, i, n, r, round

        associate (part => coupling%part)
            do round = 1, 2 ! count, then list
                n = 0
                number = 0
                do r = 0, solid%ranks%n - 1
                    part%out%first(r) = n + 1
                    associate (window => part%windows(r), box => part%boxes(r))
                        do b = 1, size(solid%bodies)
                            do i = solid%bodies(b)%first, solid%bodies(b)%last
                                if (any(part%cell(:, i) < window%lo)) cycle
                                if (any(part%cell(:, i) > window%hi)) cycle
                                n = n + 1
                                number(b, r + 1) = number(b, r + 1) + 1
                                if (round == 1) cycle
                                part%out%place(n) = i
                                part%theirs(n) = all(part%cell(:, i) >= box%lo &
                                                     .and. part%cell(:, i) <= box%hi)
                            end do
                        end do
                    end associate
                end do
                part%out%first(solid%ranks%n) = n + 1
                if (round == 2 .or. size(part%out%place) >= n) cycle
                deallocate (part%out%place, part%theirs)
                allocate (part%out%place(n + n/4), part%theirs(n + n/4))
            end do
        end associate
    end subroutine list_guests

    !> Places for the guests, body by body.
    subroutine seat_guests(solid, number, coupling)
        class(solid_t), intent(in) :: solid
        integer(int64), intent(in) :: number(:, :) !! (bodies, processes) that come
        type(coupling_t), intent(inout) :: coupling
        integer :: next(size(number, 1)), b, n

        if (.not. allocated(coupling%guests)) call open_house(solid, coupling)
        n = 0
        do b = 1, size(number, 1)
            associate (body => coupling%guests%bodies(b))
                next(b) = n
                body%first = n + 1
                n = n + int(sum(number(b, :)))
                body%last = n
                body%rim = n
            end associate
        end do
        coupling%guests%n = n
        if (size(coupling%guests%x, 2) < n) call make_seats(n + n/4, coupling)
        call fill_pieces(number, next, coupling%part%in)
    end subroutine seat_guests

    !> No guests are there yet, but the bodies are known.
    subroutine open_house(solid, coupling)
        class(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling

        allocate (coupling%guests)
        coupling%guests%present = .true.
        coupling%guests%ranks = solid%ranks
        coupling%guests%bodies = solid%bodies
        allocate (coupling%guests%x(3, 0))
        call make_seats(0, coupling)
    end subroutine open_house

    !> Room for n guests; those that were there are gone.
    subroutine make_seats(n, coupling)
        integer, intent(in) :: n
        type(coupling_t), intent(inout) :: coupling

        associate (guests => coupling%guests)
            deallocate (guests%x)
            if (allocated(guests%v)) deallocate (guests%v, guests%mass, guests%volume, guests%id, &
                                                 guests%fixed, guests%load, guests%v_before)
            allocate (guests%x(3, n), source=0.0_dp)
            allocate (guests%v(3, n), guests%load(3, n), guests%v_before(3, n), source=0.0_rk)
            allocate (guests%mass(n), guests%volume(n), source=0.0_rk)
            allocate (guests%id(n), guests%fixed(n), source=0_int32)
        end associate
        if (allocated(coupling%cell_of)) &
            deallocate (coupling%cell_of, coupling%place_of, coupling%binned)
        allocate (coupling%cell_of(n), coupling%place_of(n), coupling%binned(n))
        call seat_own(n, coupling%part%seat)
    end subroutine make_seats

    !> Numbers up to n at least, of places that are seats.
    subroutine seat_own(n, seat)
        integer, intent(in) :: n
        integer(int32), allocatable, intent(inout) :: seat(:)
        integer :: p

        if (allocated(seat)) then
            if (size(seat) >= n) return
        end if
        seat = [(p, p=1, n + n/4)]
    end subroutine seat_own

    !> Give every particle the load that the process found in whose cell it is; none outside.
    subroutine send_loads_home(solid, coupling)
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout), target :: coupling
        integer(int64) :: out(0:solid%ranks%n - 1), in(0:solid%ranks%n - 1)
        real(dp), pointer, contiguous :: loads(:, :)
        integer :: i, n, r

        associate (part => coupling%part)
            do r = 0, solid%ranks%n - 1
                in(r) = 24*count(part%theirs(part%out%first(r):part%out%first(r + 1) - 1))
                out(r) = 0
                do i = part%in%first(r), part%in%first(r + 1) - 1
                    if (is_own(coupling%box, coupling%cell_of(part%in%place(i)))) &
                        out(r) = out(r) + 24
                end do
            end do
            call make_room(solid%ranks, out, in, part%load_mail)
            do r = 0, solid%ranks%n - 1
                loads => outgoing(part%load_mail, r, 3)
                n = 0
                do i = part%in%first(r), part%in%first(r + 1) - 1
                    associate (place => part%in%place(i))
                        if (.not. is_own(coupling%box, coupling%cell_of(place))) cycle
                        n = n + 1
                        loads(:, n) = coupling%guests%load(:, place)
                    end associate
                end do
            end do
            call post(solid%ranks, part%load_mail)
            solid%load(:, :solid%n) = 0
            do r = 0, solid%ranks%n - 1
                loads => incoming(part%load_mail, r, 3)
                n = 0
                do i = part%out%first(r), part%out%first(r + 1) - 1
                    if (.not. part%theirs(i)) cycle
                    n = n + 1
                    solid%load(:, part%out%place(i)) = real(loads(:, n), rk)
                end do
            end do
        end associate
    end subroutine send_loads_home
end module brz_coupling_guests
