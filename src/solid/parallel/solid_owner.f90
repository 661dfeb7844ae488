! SPDX-License-Identifier: MIT
!> Particles on several processes: shares of them before the first lists are built, and what
!> brz_owner_driver needs on the CPU.
module brz_solid_owner
    use brz_kinds, only: dp, int64
    use brz_particle_order, only: reorder_particles
    use brz_places, only: message_buffers_t
    use brz_ranks, only: several
    use brz_solid_arrays, only: cut_blocks, number_groups
    use brz_solid_fields, only: fields_of, fields_t, resize_fields
    use brz_solid_ghosts, only: all_of_it, send_particles
    use brz_resize, only: resize
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: share_out, hold_all, all_particles, are_even, lacks_room, lay_arrays, &
        make_room, send_away, settle_places

    real(dp), parameter :: uneven = 1.05_dp !! most particles over the mean: regions are cut anew

contains

    !> Particles of all processes.
    pure integer function all_particles(solid)
        class(bodies_t), intent(in) :: solid

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
        call lay_bodies(solid, own)
        call make_room(solid, solid%n + solid%n/4 + 64, exactly=.true.)
        if (allocated(solid%part%region)) deallocate (solid%part%region)
        if (solid%ranks%rank > 0) solid%bodies%motion%mass = 0 ! the first records what drives them
    end subroutine share_out

    !> Arrays for all particles, body by body, as the set-up has them: a checkpoint is to be read.
    subroutine hold_all(solid)
        class(listed_bodies_t), intent(inout) :: solid

        if (.not. several(solid%ranks)) return
        call lay_bodies(solid, solid%bodies%number(2) - solid%bodies%number(1) + 1)
        call make_room(solid, solid%n, exactly=.true.)
    end subroutine hold_all

    !> Ranges of particles of all bodies, without room for more.
    subroutine lay_bodies(solid, own)
        class(bodies_t), intent(inout) :: solid
        integer, intent(in) :: own(:) !! (bodies)
        integer :: b

        solid%n = 0
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                body%first = solid%n + 1
                body%last = solid%n + own(b)
                body%rim = body%last
                body%room = own(b)
                solid%n = body%last
            end associate
        end do
    end subroutine lay_bodies

    !> Room for n particles, with something to spare.
    subroutine make_room(solid, n, exactly)
        class(listed_bodies_t), intent(inout) :: solid
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

    !> True where no process will have more particles than it should. After a cut what it has counts
    !> as even.
    logical function are_even(solid, all) result(yes)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: all(:, :, :)
        !! (bodies + 1, to, from) particles that go, last: those that are there
        integer :: most

        associate (n => size(all, 1) - 1)
            most = int(maxval(all(n + 1, 1, :) + sum(sum(all(:n, :, :), 1), 2) &
                              - sum(sum(all(:n, :, :), 1), 1)))
        end associate
        if (solid%part%recut) solid%part%most = most
        yes = most <= uneven*max(solid%part%most, all_particles(solid)/solid%ranks%n)
    end function are_even

    !> True where some process has not enough places for what comes to it.
    pure logical function lacks_room(all, free) result(yes)
        integer(int64), intent(in) :: all(:, :, :) !! (bodies, to, from) particles
        integer(int64), intent(in) :: free(:, :, :) !! (bodies, any, of) places

        yes = any(sum(all, 3) > free(:, 1, :))
    end function lacks_room

    !> Bodies that began at `old` have been given other places: bring their particles there. They
    !> have no ghosts.
    subroutine lay_arrays(solid, old)
        class(listed_bodies_t), intent(inout) :: solid
        integer, intent(in) :: old(:) !! (bodies)
        integer :: b, k

        call make_room(solid, solid%n)
        solid%search%order(:solid%n) = 1
        do b = 1, size(old)
            do k = 0, solid%bodies(b)%last - solid%bodies(b)%first
                solid%search%order(solid%bodies(b)%first + k) = old(b) + k
            end do
        end do
        call reorder_particles(solid, 1, solid%n)
    end subroutine lay_arrays

    !> Send the particles that leave, and take in those that come.
    subroutine send_away(solid, leaving, coming)
        type(solid_t), intent(inout), target :: solid
        type(message_buffers_t), intent(in) :: leaving, coming
        type(fields_t) :: fields

        call fields_of(solid, fields)
        call send_particles(solid%ranks, all_of_it, fields, leaving, fields, coming, &
                            solid%part%exchange)
    end subroutine send_away

    !> Particles and ghosts lie in other places: number groups and blocks for it. What lies behind
    !> them is no particle.
    subroutine settle_places(solid)
        class(listed_bodies_t), intent(inout) :: solid
        integer :: b

        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b))
                solid%id(body%rim + 1:body%first + body%room - 1) = 0
            end associate
        end do
        if (allocated(solid%links%ends)) then
            solid%links%ends = solid%bodies%rim
            solid%links%ends(size(solid%bodies)) = solid%n
        end if
        call number_groups(solid)
        call cut_blocks(solid)
        solid%loads%rebuilds = -1 ! its places are others now
    end subroutine settle_places
end module brz_solid_owner
