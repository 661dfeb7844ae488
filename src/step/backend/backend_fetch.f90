! SPDX-License-Identifier: MIT
!> What results need of the state, wherever it is: totals, cells and particles of gauges, all of it.
module brz_backend_fetch
    use brz_air_probe, only: cells_around, has_point, probe_reach, sees_gas
    use brz_air_state, only: air_t, wall_t
    use brz_backend, only: backend_t
    use brz_coupling_copy, only: fetch_coupling, note_coupling
    use brz_coupling_state, only: coupling_t
    use brz_cut_meet_driver, only: meet_cut_walls
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: fetch_air, fetch_cells, fetch_walls, note_air
    use brz_gpu_air_sums, only: gpu_outflow
    use brz_gpu_cohesive_part, only: fetch_gpu_points
    use brz_gpu_solid_copy, only: fetch_particles, fetch_solid, note_solid, settle_bodies
    use brz_gpu_solid_diagnostics, only: fetch_accounts
    use brz_kinds, only: dp, rk
    use brz_ranks, only: bits_of_all, several
    use brz_snapshots, only: snapshot_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: fetch_sums, fetch_order, fetch_exchange, fetch_state, take_snapshot
    public :: fetch_followed, fetch_around

contains

    !> Bring sums and diagnostics to the host that the GPU must work out, for a dump or a
    !> checkpoint.
    subroutine fetch_sums(backend, air, solid, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (backend%on_gpu) call gpu_outflow(air%device, air, err)
        if (backend%bodies_on_gpu) call fetch_accounts(solid%device, solid, err)
    end subroutine fetch_sums

    !> Bring to the host what several processes must know of each other before they gather: where
    !> bodies lie, what has become of interfaces.
    subroutine fetch_order(backend, solid, err)
        type(backend_t), intent(inout) :: backend
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (failed(err) .or. .not. backend%bodies_on_gpu) return
        call settle_bodies(solid%device, solid, err)
        call fetch_gpu_points(solid%device, .false., solid%cohesive, err)
    end subroutine fetch_order

    !> The same for a checkpoint: cut cells and diagnostics of the coupling.
    subroutine fetch_exchange(coupling, err)
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err

        if (failed(err) .or. .not. coupling%on_gpu) return
        call fetch_coupling(coupling, err)
    end subroutine fetch_exchange

    !> Bring the state to the host, for a dump or a checkpoint, with fetch_sums before. It is read
    !> alone, so that a snapshot can take the place of the GPU.
    subroutine fetch_state(backend, air, solid, coupling, err)
        type(backend_t), intent(inout) :: backend
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err

        if (failed(err)) return
        if (backend%on_gpu) call fetch_air(air%device, air, err)
        if (backend%bodies_on_gpu) call fetch_solid(solid%device, solid, err)
        if (coupling%on_gpu) call fetch_coupling(coupling, err)
    end subroutine fetch_state

    !> Put by what fetch_state reads; whether that was done tells snapshot%room.
    subroutine take_snapshot(backend, air, solid, coupling, snapshot)
        type(backend_t), intent(in) :: backend
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        type(snapshot_t), intent(out) :: snapshot

        if (backend%on_gpu) call note_air(air%device, snapshot)
        if (backend%bodies_on_gpu) call note_solid(solid%device, solid%cohesive, snapshot)
        if (coupling%on_gpu) call note_coupling(coupling, snapshot)
        call snapshot%take()
    end subroutine take_snapshot

    !> Bring the motion of some particles to the host, for gauges; with `all` the whole state.
    subroutine fetch_followed(backend, id, place, all, solid, err)
        type(backend_t), intent(inout) :: backend
        integer, intent(in) :: id(:) !! numbers of the particles
        integer, intent(in) :: place(:) !! where they were last on the host
        logical, intent(in) :: all
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err

        if (.not. backend%bodies_on_gpu .or. failed(err)) return
        if (all) then
            call fetch_solid(solid%device, solid, err)
        else
            call fetch_particles(solid%device, id, place, solid, err)
        end if
    end subroutine fetch_followed

    !> Bring the cells around some points to the host, for gauges, and what stands at the walls of
    !> bodies there.
    subroutine fetch_around(backend, points, air, wall, err)
        type(backend_t), intent(inout) :: backend
        real(dp), intent(in) :: points(:, :) !! (3, n) [m]
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err
        integer, allocatable :: cells(:, :)

        if ((backend%on_gpu .or. wall%present) .and. .not. failed(err)) then
            call list_around(backend, points, air, wall, cells, err)
            if (backend%on_gpu) call fetch_cells(air%device, cells, air, err)
            if (wall%cells%present) call meet_cut_walls(air, cells, wall, err)
        end if
        if (several(air%part%ranks) .and. .not. wall%present) call gather_cells(points, air)
    end subroutine fetch_around

    !> Cells that count at some points: the eight around each and, where these hold solid, those in
    !> reach. Where there are walls, of the points of this process alone: its host knows then which
    !> of them hold solid.
    subroutine list_around(backend, points, air, wall, cells, err)
        type(backend_t), intent(inout) :: backend
        real(dp), intent(in) :: points(:, :) !! (3, n) [m]
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, allocatable, intent(out) :: cells(:, :) !! (3, n)
        type(error_t), intent(inout) :: err
        integer :: around(3, 0:7, size(points, 2)), of(size(points, 2)), g, n
        integer, allocatable :: far(:)

        n = 0
        do g = 1, size(points, 2)
            if (wall%present .and. .not. has_point(air, points(:, g))) cycle
            n = n + 1
            of(n) = g
            call cells_around(air, points(:, g), around(:, :, n))
            around(:, :, n) = around(:, :, n) - spread(air%before, 2, 8)
        end do
        cells = reshape(around(:, :, :n), [3, 8*n])
        if (n == 0 .or. .not. wall%present) return
        if (backend%on_gpu) call fetch_walls(air%device, cells, wall, err)
        far = [integer ::]
        do g = 1, n
            if (.not. sees_gas(air, wall, points(:, of(g)))) far = [far, g]
        end do
        if (size(far) == 0) return
        call add_blocks(air, around(:, 0, far) - probe_reach, around(:, 7, far) + probe_reach, &
                        cells)
        if (backend%on_gpu) call fetch_walls(air%device, cells, wall, err)
    end subroutine list_around

    !> Add blocks of cells low..high, as far as the arrays have them, to a list.
    subroutine add_blocks(air, low, high, cells)
        type(air_t), intent(in) :: air
        integer, intent(in) :: low(:, :), high(:, :) !! (3, blocks)
        integer, allocatable, intent(inout) :: cells(:, :) !! (3, n)
        integer :: lo(3, size(low, 2)), hi(3, size(low, 2)), b, i, j, k, n
        integer, allocatable :: longer(:, :)

        lo = max(low, spread(1 - air%g, 2, size(low, 2)))
        hi = min(high, spread(air%n + air%g, 2, size(low, 2)))
        n = size(cells, 2)
        allocate (longer(3, n + sum(product(max(hi - lo + 1, 0), 1))))
        longer(:, :n) = cells
        do b = 1, size(lo, 2)
            do k = lo(3, b), hi(3, b)
                do j = lo(2, b), hi(2, b)
                    do i = lo(1, b), hi(1, b)
                        n = n + 1
                        longer(:, n) = [i, j, k]
                    end do
                end do
            end do
        end do
        call move_alloc(longer, cells)
    end subroutine add_blocks

    !> On several processes: give all of them the cells around some points.
    subroutine gather_cells(points, air)
        real(dp), intent(in) :: points(:, :) !! (3, n) [m]
        type(air_t), intent(inout) :: air
        real(dp) :: seen(air%n_var, 0:7, size(points, 2)), row(size(seen))
        integer :: cells(3, 0:7), at(3), g, m

        seen = 0
        do g = 1, size(points, 2)
            call cells_around(air, points(:, g), cells)
            do m = 0, 7
                at = cells(:, m) - air%before
                if (any(at < 1 .or. at > air%n)) cycle
                seen(:, m, g) = air%u(at(1), at(2), at(3), :)
            end do
        end do
        row = reshape(seen, [size(seen)])
        call bits_of_all(air%part%ranks, row)
        if (.not. allocated(air%part%seen)) &
            allocate (air%part%seen(air%n_var, 0:7, size(points, 2)))
        air%part%seen = real(reshape(row, shape(seen)), rk)
    end subroutine gather_cells
end module brz_backend_fetch
