! SPDX-License-Identifier: MIT
!> The coupling on its way to a GPU and back, and numbers about all of it.
!>
!> Cut cells are listed and held on the GPU; the host learns how many there are.
module brz_coupling_copy
    use brz_air_state, only: air_t
    use brz_coupling_device, only: n_diag
    use brz_coupling_state, only: coupling_t, put_sums, sums_in
    use brz_coupling_windows, only: open_windows_of_gpus, put_halos
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_start_driver, only: begin_cut_cells, enter_cut_cells
    use brz_device, only: allocate_buffer, clear_buffer, copy_in, copy_out
    use brz_device_data, only: enter_bytes, enter_data, update_device, update_host
    use brz_errors, only: error_t, failed
    use brz_coupling_ghost_driver, only: renew_coupling_ghosts
    use brz_kinds, only: dp, int32, int64, rk
    use brz_load_loops, only: for_each_wall_speed
    use brz_present_table, only: attach, buffer_of
    use brz_ranks, only: reduce_errors, several
    use brz_snapshots, only: snapshot_t
    use brz_particles, only: particles_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_tallies, only: tally_threads
    implicit none
    private
    public :: open_gpu_coupling, fetch_coupling, note_coupling, fetch_diagnostics, fastest_wall

contains

    !> Give the coupling memory on the GPU and put the walls up where the particles are there: it is
    !> computed there from now on. Diagnostics are those of the host.
    subroutine open_gpu_coupling(air, solid, c, err)
        type(air_t), intent(inout) :: air !! on the GPU, opened with walls
        class(listed_bodies_t), intent(inout) :: solid !! on the GPU; read
        type(coupling_t), intent(inout) :: c !! set up on the host
        type(error_t), intent(inout) :: err

        call enter_coupling(solid, c, err)
        call reduce_errors(air%part%ranks, err)
        if (failed(err)) return
        call attach(c%wall%solid, air%device%walls%solid)
        call enter_cut_cells(c%wall%cells, err)
        if (several(air%part%ranks)) then
            call open_windows_of_gpus(air, c, err)
            call put_halos(c, err)
            call renew_coupling_ghosts(solid, c, err)
            call begin_cut_cells(air, solid, c%ghost_bodies, c%ghosts, c, err)
        else
            call begin_cut_cells(air, solid, solid, solid, c, err)
        end if
        call put_diagnostics(c, err)
    end subroutine open_gpu_coupling

    !> Copies of what does not grow.
    subroutine enter_coupling(solid, c, err)
        class(particles_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        c%on_gpu = .true.
        allocate (c%device)
        c%bodies = size(c%driven)
        call enter_bytes(c%driven, size(c%driven)*(storage_size(c%driven)/8_int64), err)
        call allocate_buffer(c%device%diag, 8_int64*tally_threads*n_diag, err)
        call allocate_buffer(c%device%speed, 8_int64*tally_threads, err)
        if (several(solid%ranks)) return
        call enter_data(c%cell_of, err)
        call enter_data(c%v_before, err)
    end subroutine enter_coupling

    subroutine put_diagnostics(c, err)
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err
        real(dp) :: diag(tally_threads, n_diag)

        diag = 0
        diag(1, :) = sums_in(c%diagnostics)
        call copy_in(diag, c%device%diag, 8_int64*size(diag), err)
    end subroutine put_diagnostics

    !> Bring work and impulse to the host.
    subroutine fetch_diagnostics(c, err)
        type(coupling_t), intent(inout) :: c !! on the GPU
        type(error_t), intent(inout) :: err
        real(dp) :: diag(tally_threads, n_diag)

        diag = 0
        call copy_out(c%device%diag, diag, 8_int64*size(diag), err)
        if (failed(err)) return
        call put_sums(sum(diag, 1), c%diagnostics)
    end subroutine fetch_diagnostics

    !> Bring cut cells and diagnostics to the host, for a dump or a checkpoint.
    subroutine fetch_coupling(c, err)
        type(coupling_t), intent(inout) :: c !! on the GPU
        type(error_t), intent(inout) :: err

        if (.not. c%device%walls_fetched) then
            call update_host(c%wall%solid, err)
            if (failed(err)) return
            c%device%walls_fetched = .true.
        end if
        if (allocated(c%v_before)) call update_host(c%v_before, err)
        call fetch_cut_cells(c%wall%cells, err)
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
        associate (l => c%wall%cells)
            call snapshot%note([buffer_of(l%cell), buffer_of(l%volume), buffer_of(l%kept), &
                                buffer_of(l%shut), buffer_of(l%master)])
        end associate
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
        call for_each_wall_speed(.true., c%wall%cells%n, air%grid, c%wall%cells%v, nothing, &
                                 c%device%speed, err)
        part = 0
        call copy_out(c%device%speed, part, 8_int64*size(part), err)
        fastest = maxval(part)
    end function fastest_wall
end module brz_coupling_copy
