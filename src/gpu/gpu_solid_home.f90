! SPDX-License-Identifier: MIT
!> Particles on several GPUs when lists are built: what brz_solid_home does on the CPU, without the
!> state leaving the GPUs.
!>
!> Each body has room for its particles and, behind them, its ghosts. Particles that leave make
!> places for those that come; what is left of both is closed up. Where the room of a body is too
!> small all arrays are laid anew. The host hears how many particles go where, never which they are,
!> but for those that leave.
module brz_gpu_solid_home
    use brz_buffers, only: from
    use brz_device, only: clear_buffer, copy_in, copy_out, reserve_buffer
    use brz_errors, only: error_t
    use brz_gpu_marks, only: list_marks, place_pieces
    use brz_gpu_parcels, only: put_places
    use brz_gpu_solid_layout, only: n_book, slice_width
    use brz_gpu_solid_marks, only: mark_ghosts, mark_leaving
    use brz_gpu_solid_state, only: book_of, gpu_solid_t, lay_arrays
    use brz_gpu_solid_sums, only: fetch_ledgers
    use brz_kinds, only: dp, int64
    use brz_mail, only: tell_all
    use brz_ranks, only: most_of_all
    use brz_solid_home, only: all_particles, uneven
    use brz_solid_part, only: find_firsts
    use brz_solid_regions, only: cut_regions
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: go_home, lay_ghosts

contains

    !> Particles of the stale bodies go to the processes in whose regions they are. Ghosts are
    !> dropped. All processes must call. Other bodies keep theirs, unless regions are cut anew.
    subroutine go_home(gpu, solid, stale, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: stale(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer(int64) :: out(size(stale) + 1, solid%ranks%n), in(size(stale), solid%ranks%n)
        integer(int64) :: all(size(stale) + 1, solid%ranks%n, solid%ranks%n)
        integer :: need(size(stale))

        gpu%recut = .false.
        do
            call mark_leaving(gpu, solid, stale .or. gpu%recut, out(:size(stale), :), err)
            out(size(stale) + 1, :) = sum(gpu%bodies%last - gpu%bodies%first + 1)
            call tell_all(solid%ranks, out, all)
            if (gpu%recut) exit
            if (.not. are_uneven(solid, all(size(stale) + 1, 1, :))) exit
            call cut_anew(gpu, solid, err)
            gpu%recut = .true.
        end do
        associate (n => size(stale))
            in = all(:n, solid%ranks%rank + 1, :)
            gpu%bodies%rim = gpu%bodies%last
            need = gpu%bodies%last - gpu%bodies%first + 1 + int(sum(in, dim=2))
            call make_room(gpu, solid, need, gpu%grown, err)
            if (gpu%grown) call mark_leaving(gpu, solid, stale .or. gpu%recut, out(:n, :), err)
            call change_places(gpu, solid, out(:n, :), in, sum(all(:n, :, :), 1), err)
        end associate
    end subroutine go_home

    !> True where one process has more particles than it should. After a cut what it has counts as
    !> even.
    logical function are_uneven(solid, own) result(yes)
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: own(:) !! (processes) particles
        integer :: most

        most = int(maxval(own))
        if (solid%part%most == 0) solid%part%most = most
        yes = most > uneven*max(solid%part%most, all_particles(solid)/solid%ranks%n)
    end function are_uneven

    !> Cut the regions for the places of now.
    subroutine cut_anew(gpu, solid, err)
        type(gpu_solid_t), intent(in) :: gpu
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: x(:, :)
        integer :: b, n

        allocate (x(4, sum(gpu%bodies%last - gpu%bodies%first + 1)), source=0.0_dp)
        n = 0
        do b = 1, size(gpu%bodies)
            associate (body => gpu%bodies(b))
                if (body%last < body%first) cycle
                call copy_out(from(gpu%built, 4_int64*body%first - 3), x(:, n + 1:), &
                              32_int64*(body%last - body%first + 1), err)
                n = n + body%last - body%first + 1
            end associate
        end do
        call cut_regions(solid%ranks, x(:3, :), solid%part%region)
        solid%part%most = 0
    end subroutine cut_anew

    !> Send the marked particles, take in what comes, and close up.
    subroutine change_places(gpu, solid, out, in, all, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes)
        integer(int64), intent(in) :: all(:, :) !! (to processes, from processes)
        type(error_t), intent(inout) :: err
        integer, allocatable :: gone(:), place(:), old(:), new(:)
        logical :: changed(size(out, 1))

        if (sum(all) == 0) return
        changed = sum(out, dim=2) + sum(in, dim=2) > 0
        if (any(changed)) call close_books(gpu, solid, changed, err)
        call list_marks(gpu%n, out, gpu%marks, gpu%ghosts%gone, err)
        call gpu%ghosts%aim(all, gpu%ghosts%gone, err)
        allocate (gone(sum(out)), source=0)
        call copy_out(gpu%ghosts%gone%place, gone, 4_int64*size(gone), err)
        call choose_places(gpu, gone, gpu%ghosts%gone%first, out, in, place, old, new)
        call find_firsts(in, gpu%ghosts%come%first)
        call put_places(place, gpu%ghosts%come%place, err)
        call gpu%ghosts%send(gpu%ghosts%gone, gpu%ghosts%come, gpu%record, gpu%record, err)
        call gpu%ghosts%move(old, new, gpu%record, err)
    end subroutine change_places

    !> The books of bodies whose particles change: what places have summed goes to the host.
    subroutine close_books(gpu, solid, changed, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        logical, intent(in) :: changed(:) !! (bodies)
        type(error_t), intent(inout) :: err
        integer :: b, c

        gpu%summed = .false.
        call fetch_ledgers(gpu, solid, err)
        do b = 1, size(changed)
            if (.not. changed(b)) cycle
            gpu%ledger(b) = solid%bodies(b)%ledger
            gpu%reaction(:, b) = solid%bodies(b)%reaction
            do c = 1, n_book
                call clear_buffer(from(book_of(gpu, c), int(gpu%bodies(b)%first, int64)), err, &
                                  8_int64*gpu%bodies(b)%room)
            end do
        end do
    end subroutine close_books

    !> Where those that come are put, and which of the last particles move to what is left of the
    !> places of those that leave; new ends of the bodies.
    subroutine choose_places(gpu, gone, first, out, in, place, old, new)
        type(gpu_solid_t), intent(inout) :: gpu
        integer, intent(in) :: gone(:) !! places, parcel by parcel, body by body
        integer, intent(in) :: first(0:) !! of each parcel
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes)
        integer, allocatable, intent(out) :: place(:) !! of those that come, in the same order
        integer, allocatable, intent(out) :: old(:), new(:)
        integer, allocatable :: free(:)
        logical, allocatable :: is_free(:)
        integer :: at, b, come, i, k, last, m, r

        allocate (place(sum(in)), old(0), new(0))
        do b = 1, size(out, 1)
            come = int(sum(in(b, :)))
            last = gpu%bodies(b)%last
            gpu%bodies(b)%last = last + come - int(sum(out(b, :)))
            allocate (free(0))
            allocate (is_free(gpu%bodies(b)%last + 1:last), source=.false.)
            do r = 1, size(out, 2)
                at = first(r - 1) + int(sum(out(:b - 1, r)))
                do k = at, at + int(out(b, r)) - 1
                    if (gone(k) > gpu%bodies(b)%last) is_free(gone(k)) = .true.
                end do
                free = [free, pack(gone(at:at + int(out(b, r)) - 1), &
                                   gone(at:at + int(out(b, r)) - 1) <= gpu%bodies(b)%last)]
            end do
            free = [free, (i, i=last + 1, gpu%bodies(b)%last)]
            m = 0
            k = 1
            do r = 1, size(in, 2)
                at = k + int(sum(in(:b - 1, r)))
                place(at:at + int(in(b, r)) - 1) = free(m + 1:m + int(in(b, r)))
                m = m + int(in(b, r))
                k = k + int(sum(in(:, r)))
            end do
            new = [new, free(come + 1:)]
            old = [old, pack([(i, i=lbound(is_free, 1), ubound(is_free, 1))], .not. is_free)]
            deallocate (free, is_free)
        end do
        gpu%bodies%rim = gpu%bodies%last
    end subroutine choose_places

    !> Lay ghosts behind the particles of each body. Ghosts of a body that is not stale are as they
    !> were, unless links reach them.
    subroutine lay_ghosts(gpu, solid, anew, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        logical, intent(inout) :: anew(:) !! (bodies) whose lists must be built
        type(error_t), intent(inout) :: err
        integer(int64), dimension(size(gpu%bodies), solid%ranks%n) :: out, in
        integer(int64) :: all(size(gpu%bodies), solid%ranks%n, solid%ranks%n), any_grown(1)
        integer :: next(size(gpu%bodies))
        logical :: now

        call mark_ghosts(gpu, solid, out, err)
        call tell_all(solid%ranks, out, all)
        in = all(:, solid%ranks%rank + 1, :)
        gpu%bodies%rim = gpu%bodies%last
        call make_room(gpu, solid, gpu%bodies%last - gpu%bodies%first + 1 + int(sum(in, dim=2)), &
                       now, err)
        gpu%grown = gpu%grown .or. now
        if (now) call mark_ghosts(gpu, solid, out, err)
        call list_marks(gpu%n, out, gpu%marks, gpu%ghosts%out, err)
        call gpu%ghosts%aim(sum(all, 1), gpu%ghosts%out, err)
        next = gpu%bodies%last
        call place_pieces(in, next, gpu%marks%pieces, gpu%ghosts%in, err)
        gpu%bodies%rim = next
        call gpu%ghosts%send(gpu%ghosts%out, gpu%ghosts%in, gpu%record, gpu%record, err)
        call tell_kernels(gpu, err)
        any_grown = merge(1, 0, gpu%grown)
        ! all build the same lists
        if (count(anew) < size(anew)) call most_of_all(solid%ranks, any_grown)
        anew = anew .or. gpu%recut .or. any_grown(1) > 0 .or. gpu%linked
        gpu%settled = .false.
        gpu%fetched = .false.
        gpu%summed = .false.
        gpu%laid = gpu%laid + 1
    end subroutine lay_ghosts

    !> Room for so many places of each body. Where one has too few, all arrays are laid anew.
    subroutine make_room(gpu, solid, need, grown, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: need(:) !! (bodies)
        logical, intent(out) :: grown
        type(error_t), intent(inout) :: err
        integer :: b, n_old, old(size(need)), shift

        grown = any(need > gpu%bodies%room)
        if (.not. grown) return
        old = gpu%bodies%first
        n_old = gpu%n
        gpu%n = 0
        do b = 1, size(need)
            associate (body => gpu%bodies(b))
                if (need(b) > body%room) body%room = need(b) + need(b)/4 + 64
                shift = gpu%n + 1 - body%first
                body%first = body%first + shift
                body%last = body%last + shift
                body%rim = body%rim + shift
                gpu%n = gpu%n + body%room
            end associate
        end do
        call lay_arrays(gpu, solid, old, n_old, err)
        call tell_kernels(gpu, err)
    end subroutine make_room

    !> Kernels get to know where bodies lie. What lies behind the particles limits no time step.
    subroutine tell_kernels(gpu, err)
        type(gpu_solid_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: b

        do b = 1, size(gpu%bodies)
            associate (body => gpu%bodies(b))
                call copy_in([body%first, body%last], body%params, 8_int64, err)
                body%slices = (body%last - body%first)/slice_width + 1
                call reserve_buffer(body%slice, 4_int64*(body%slices + 1), err)
                call clear_buffer(from(gpu%rate, body%last + 1_int64), err, &
                                  8_int64*(body%first + body%room - body%last - 1))
            end associate
        end do
        if (gpu%linked) call copy_in(gpu%bodies%rim, gpu%links%ends, 4_int64*size(gpu%bodies), err)
    end subroutine tell_kernels
end module brz_gpu_solid_home
