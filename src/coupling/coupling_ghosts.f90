! SPDX-License-Identifier: MIT
!> Ghost exchange in the coupling halo: ghosts on their way between processes, see
!> brz_coupling_ghost_driver.
module brz_coupling_ghosts
    use brz_air_part, only: halo_of
    use brz_air_state, only: air_t
    use brz_boxes, only: widened
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: int64
    use brz_record_rules, only: w => words_of_real
    use brz_rows, only: rows_of, rows_t
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: open_halos, find_runs, send_coupling_ghosts, needs_volumes

    integer, parameter :: most_runs = 4 !! bodies whose particles are copied one by one
    integer, parameter :: n_known = 7 !! arrays of a ghost
    integer, parameter :: n_moving = 4 !! those of them that change in a step

contains

    !> The cells that each process sees. No ghosts are there yet, but the bodies are known.
    subroutine open_halos(air, solid, coupling)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: r

        associate (part => coupling%part)
            part%boxes = air%part%boxes
            allocate (part%halos(0:air%part%ranks%n - 1))
            do r = 0, ubound(part%halos, 1)
                part%halos(r) = halo_of(air%part, r, air%whole, air%around)
            end do
            part%near = part%halos ! a particle may move for some steps until it is missed
            do r = 0, ubound(part%near, 1)
                associate (near => part%near(r), n => coupling%box%whole)
                    near = widened(near, [1, 1, 1]) ! beyond the grid, too
                    ! where a particle in the layer beyond it makes walls of cut cells
                    if (.not. coupling%wall%cells%present) cycle
                    near%lo = merge(-1, near%lo, near%lo == 0)
                    near%hi = merge(n + 2, near%hi, near%hi == n + 1)
                end associate
            end do
            part%messages%ranks = air%part%ranks
        end associate
        coupling%ghost_bodies%present = .true.
        coupling%ghost_bodies%ranks = solid%ranks
        coupling%ghost_bodies%bodies = solid%bodies
        allocate (coupling%ghosts, source=coupling%ghost_bodies)
    end subroutine open_halos

    !> Where the particles lie that a process has for itself, if these are all of a few bodies: a
    !> GPU copies them as they lie.
    subroutine find_runs(solid, out, in, c, err)
        class(bodies_t), intent(in) :: solid
        integer(int64), intent(in) :: out(:, :), in(:, :) !! (bodies, processes) that go, and come
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(in) :: err
        integer :: me, n(size(out, 1)), whole(size(out, 1)), from(size(out, 1)), to(size(out, 1))

        if (failed(err)) return
        me = c%ranks%rank + 1
        n = int(out(:, me))
        whole = solid%bodies%last - solid%bodies%first + 1
        associate (part => c%part)
            if (allocated(part%out%run)) deallocate (part%out%run, part%in%run)
            if (count(n > 0) > most_runs .or. any(n > 0 .and. n < whole)) return
            from = solid%bodies%first
            to = c%ghosts%bodies%first + int(sum(in(:, :me - 1), 2))
            part%out%run = listed(from)
            part%in%run = listed(to)
        end associate

    contains

        !> Runs of bodies from these places.
        pure function listed(first) result(run)
            integer, intent(in) :: first(:)
            integer, allocatable :: run(:, :)

            run = transpose(reshape([pack(first, n > 0), pack(n, n > 0)], [count(n > 0), 2]))
        end function listed
    end subroutine find_runs

    !> Send what the copies have of their particles.
    subroutine send_coupling_ghosts(solid, c, all_of_it, err)
        class(particles_t), intent(in), target :: solid
        type(coupling_t), intent(inout), target :: c
        logical, intent(in) :: all_of_it !! else what changes in a step
        type(error_t), intent(inout) :: err
        type(rows_t) :: from(n_known + 1), to(n_known + 1)
        integer :: n

        call list_rows(c%on_gpu, solid, rows_of(c%on_gpu, solid%v_before, w, 3, solid%stride_d), &
            from)
        call list_rows(c%on_gpu, c%ghosts, rows_of(c%on_gpu, c%ghosts%v_before, 3*w), to)
        n = n_moving
        if (all_of_it) then
            n = merge(n_known + 1, n_known, needs_volumes(c))
        else if (c%wall%cells%present) then
            ! nodes are filled by the volumes of now
            n = n_moving + 1
            from(n) = from(n_known + 1)
            to(n) = to(n_known + 1)
        end if
        call c%part%messages%send(c%part%out, c%part%in, from(:n), to(:n), err)
    end subroutine send_coupling_ghosts

    !> Have copies of particles volumes? On a GPU only cut cells need them.
    pure logical function needs_volumes(c)
        type(coupling_t), intent(in) :: c

        needs_volumes = c%wall%cells%present .or. .not. c%on_gpu
    end function needs_volumes

    !> What of a particle its copies have; volumes, where these are needed, come last.
    subroutine list_rows(on_gpu, p, v_before, rows)
        logical, intent(in) :: on_gpu
        class(particles_t), intent(in), target :: p
        type(rows_t), intent(in) :: v_before
        type(rows_t), intent(out) :: rows(n_known + 1)

        rows(1) = rows_of(on_gpu, p%x, 6, pitch=2*p%wide)
        rows(2) = rows_of(on_gpu, p%v, 3*w, pitch=p%wide*w)
        rows(3) = rows_of(on_gpu, p%load, w, 3, p%stride_d)
        rows(4) = rows_of(on_gpu, p%fixed, 1)
        rows(5) = v_before
        rows(6) = rows_of(on_gpu, p%mass, w)
        rows(7) = rows_of(on_gpu, p%id, 1)
        if (allocated(p%volume)) rows(8) = rows_of(on_gpu, p%volume, w, pitch=p%stride_w*w)
    end subroutine list_rows
end module brz_coupling_ghosts
