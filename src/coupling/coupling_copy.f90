! SPDX-License-Identifier: MIT
!> The coupling on its way to a GPU and back, and numbers about all of it.
!>
!> Walls, bins, cell stores and deferred sources are built and held on the GPU; the host learns how
!> many there are.
module brz_coupling_copy
    use brz_air_state, only: air_t
    use brz_air_walls, only: build_walls
    use brz_coupling_device, only: diag_high, diag_low, n_diag, n_sums
    use brz_coupling_state, only: coupling_t, put_sums, sums_in
    use brz_coupling_windows, only: open_windows_of_gpus
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_start_driver, only: begin_cut_cells, enter_cut_cells
    use brz_deferred_source_driver, only: enter_deferred_sources, size_deferred_sources
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out
    use brz_device_data, only: enter_bytes, enter_data, update_device, update_host
    use brz_errors, only: error_t, failed
    use brz_reclassification_driver, only: put_up_walls
    use brz_coupling_ghost_driver, only: renew_coupling_ghosts
    use brz_kinds, only: dp, int32, int64, rk
    use brz_load_loops, only: for_each_wall_speed
    use brz_present_table, only: attach, buffer_of
    use brz_ranks, only: reduce_errors, several
    use brz_shared_driver, only: put_halos
    use brz_snapshots, only: snapshot_t
    use brz_particles, only: particles_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_tallies, only: tally_threads
    use brz_wall_driver, only: find_mean_velocity
    implicit none
    private
    public :: open_gpu_coupling, fetch_coupling, note_coupling, fetch_diagnostics, fastest_wall

contains

    !> Give the coupling memory on the GPU and put the walls up where the particles are there: it is
    !> computed there from now on. Deferred sources and diagnostics are those of the host; the cell
    !> stores are in the air.
    subroutine open_gpu_coupling(air, solid, c, err)
        type(air_t), intent(inout) :: air !! on the GPU, opened with walls
        class(listed_bodies_t), intent(inout) :: solid !! on the GPU; read
        type(coupling_t), intent(inout) :: c !! set up on the host
        type(error_t), intent(inout) :: err

        call enter_coupling(solid, c, err)
        call reduce_errors(air%part%ranks, err)
        if (failed(err)) return
        call attach(c%wall%solid, air%device%walls%solid)
        call attach(c%wall%index, air%device%walls%index)
        c%wall%n_cells = 0
        if (c%wall%cells%present) then
            air%device%grid%walls = 2
            air%grid%walls = 2
            call enter_cut_cells(c%wall%cells, err)
            if (several(air%part%ranks)) then
                call open_windows_of_gpus(air, c, err)
                call put_halos(c, err)
                call renew_coupling_ghosts(solid, c, err)
                call begin_cut_cells(air, solid, c%ghost_bodies, c%ghosts, c, err)
            else
                call begin_cut_cells(air, solid, solid, solid, c, err)
            end if
        else if (several(air%part%ranks)) then
            call open_windows_of_gpus(air, c, err)
            call put_halos(c, err)
            call renew_coupling_ghosts(solid, c, err)
            call begin_walls(air, c%ghosts, c, err)
        else
            call begin_walls(air, solid, c, err)
        end if
        if (.not. c%wall%cells%present) call put_deferred_sources(c, err)
        call put_diagnostics(c, err)
    end subroutine open_gpu_coupling

    !> Copies of what does not grow.
    subroutine enter_coupling(solid, c, err)
        class(particles_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        c%on_gpu = .true.
        allocate (c%device)
        c%rebuilds = -1
        c%bodies = size(c%driven)
        call enter_bytes(c%shells, storage_size(c%shells)/8_int64, err)
        call enter_bytes(c%driven, size(c%driven)*(storage_size(c%driven)/8_int64), err)
        call enter_data(c%mark, err)
        c%slot = 0
        call enter_data(c%slot, err)
        call allocate_buffer(c%device%diag, 8_int64*tally_threads*n_diag, err)
        call allocate_buffer(c%device%speed, 8_int64*tally_threads, err)
        if (several(solid%ranks)) return
        call enter_data(c%cell_of, err)
        call enter_data(c%place_of, err)
        call enter_data(c%binned, err)
        call enter_data(c%v_before, err)
    end subroutine enter_coupling

    !> Walls and bins from none.
    subroutine begin_walls(air, p, c, err)
        type(air_t), intent(inout) :: air
        class(particles_t), intent(in) :: p !! particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        call clear_buffer(air%device%walls%solid, err)
        call clear_buffer(air%device%walls%index, err)
        call put_up_walls(air, p, c, err)
        call find_mean_velocity(p, c, err)
    end subroutine begin_walls

    !> The deferred sources of the host.
    subroutine put_deferred_sources(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer(int32), allocatable :: cell(:)
        real(rk), allocatable :: deferred(:, :)
        integer :: n

        n = c%n_deferred
        c%n_deferred = 0
        call move_alloc(c%deferred_cell, cell)
        call move_alloc(c%deferred, deferred)
        call size_deferred_sources(c, n, err)
        c%n_deferred = n
        if (n == 0) return
        c%deferred_cell(:n) = cell(:n)
        c%deferred(:, :n) = deferred(:, :n)
        call update_device(c%deferred_cell(:n), err)
        call update_device(c%deferred(:, :n), err)
        call enter_deferred_sources(c, err)
    end subroutine put_deferred_sources

    subroutine put_diagnostics(c, err)
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err
        real(dp) :: diag(tally_threads, n_diag)

        diag = 0
        diag(1, :n_sums) = sums_in(c%diagnostics)
        diag(:, diag_low) = c%diagnostics%stored_low
        diag(:, diag_high) = c%diagnostics%stored_high
        call copy_in(diag, c%device%diag, 8_int64*size(diag), err)
    end subroutine put_diagnostics

    !> Bring work, impulse and the range of the cell stores to the host.
    subroutine fetch_diagnostics(c, err)
        type(coupling_t), intent(inout) :: c !! on the GPU
        type(error_t), intent(inout) :: err
        real(dp) :: diag(tally_threads, n_diag)

        diag = 0
        call copy_out(c%device%diag, diag, 8_int64*size(diag), err)
        if (failed(err)) return
        call put_sums(sum(diag(:, :n_sums), 1), c%diagnostics)
        c%diagnostics%stored_low = real(minval(diag(:, diag_low)), rk)
        c%diagnostics%stored_high = real(maxval(diag(:, diag_high)), rk)
    end subroutine fetch_diagnostics

    !> Bring walls, deferred sources and diagnostics to the host, for a dump or a checkpoint. Of
    !> what else the host has (bins, columns, the map of deferred sources) only the room means
    !> something.
    subroutine fetch_coupling(air, c, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c !! on the GPU
        type(error_t), intent(inout) :: err

        if (.not. c%device%walls_fetched) then
            call update_host(c%wall%solid, err)
            if (failed(err)) return
            ! as many cells and faces: all that has a copy stays
            if (.not. c%wall%cells%present) call build_walls(air, c%wall)
            c%device%walls_fetched = .true.
        end if
        if (allocated(c%v_before)) call update_host(c%v_before, err)
        if (c%wall%cells%present) then
            call fetch_cut_cells(c%wall%cells, err)
        else
            call update_host(c%wall%v(:, :c%wall%n_cells), err)
        end if
        if (c%n_deferred > 0) then
            call update_host(c%deferred_cell(:c%n_deferred), err)
            call update_host(c%deferred(:, :c%n_deferred), err)
        end if
        call fetch_diagnostics(c, err)
    end subroutine fetch_coupling

    !> What a checkpoint has of the list of cut cells.
    subroutine fetch_cut_cells(cells, err)
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err

        associate (n => cells%n)
            if (n == 0) return
            call update_host(cells%cell(:n), err)
            call update_host(cells%volume(:n), err)
            call update_host(cells%kept(:, :n), err)
            call update_host(cells%shut(:n), err)
            call update_host(cells%master(:n), err)
        end associate
    end subroutine fetch_cut_cells

    !> What fetch_coupling reads.
    subroutine note_coupling(c, snapshot)
        type(coupling_t), intent(in) :: c
        type(snapshot_t), intent(inout) :: snapshot

        call snapshot%note([buffer_of(c%wall%solid), c%device%diag%buffer_t])
        if (c%wall%cells%present) then
            associate (l => c%wall%cells)
                call snapshot%note([buffer_of(l%cell), buffer_of(l%volume), buffer_of(l%kept), &
                                    buffer_of(l%shut), buffer_of(l%master)])
            end associate
        else
            call snapshot%note([buffer_of(c%wall%v), buffer_of(c%deferred_cell), &
                                buffer_of(c%deferred)])
        end if
        if (allocated(c%v_before)) call snapshot%note([buffer_of(c%v_before)])
    end subroutine note_coupling

    !> Largest sum_d |v_d|/dx_d of the walls on the GPU [1/s].
    real(dp) function fastest_wall(air, c, err) result(fastest)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err
        real(dp) :: part(tally_threads)
        real(rk) :: nothing

        nothing = 0
        call clear_buffer(c%device%speed, err)
        if (c%wall%cells%present) then
            call for_each_wall_speed(.true., c%wall%cells%n, air%grid, c%wall%cells%v, nothing, &
                                     c%device%speed, err)
        else
            call for_each_wall_speed(.true., c%wall%n_cells, air%grid, c%wall%v, nothing, &
                                     c%device%speed, err)
        end if
        part = 0
        call copy_out(c%device%speed, part, 8_int64*size(part), err)
        fastest = maxval(part)
    end function fastest_wall
end module brz_coupling_copy
