! SPDX-License-Identifier: MIT
!> The coupling on its way to the GPU and back, and numbers about all of it.
module brz_gpu_coupling_copy
    use brz_air_device, only: air_device_t
    use brz_air_state, only: air_t
    use brz_air_walls, only: build_walls
    use brz_coupling_state, only: coupling_t, n_sums, put_sums, sums_in
    use brz_debt_steps, only: enter_host_debts => enter_debts
    use brz_device, only: clear_buffer, copy_in, copy_out
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: bytes_of_real
    use brz_gpu_coupling_guests, only: open_gpu_windows
    use brz_gpu_coupling_state, only: book_high, book_low, book_threads, gpu_coupling_t, n_book, &
        open_memory, seen_t
    use brz_gpu_debt_steps, only: enter_debts, size_debts
    use brz_gpu_event_steps, only: put_up_walls
    use brz_gpu_guest_steps, only: invite_guests
    use brz_gpu_shared_steps, only: put_windows
    use brz_gpu_wall_steps, only: find_mean_velocity
    use brz_kinds, only: dp, int64, rk
    use brz_load_launches, only: load_kernels
    use brz_ranks, only: agree, several
    use brz_snapshots, only: snapshot_t
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_gpu_coupling, fetch_coupling, note_coupling, fetch_books, gpu_fastest_wall

contains

    !> Reserve memory on the GPU and put the walls up where the particles are there. Debts and books
    !> are those of the host; the ledgers are in the air.
    subroutine open_gpu_coupling(air, solid, coupling, particles, there, gpu, err)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid !! its bodies
        type(coupling_t), intent(inout) :: coupling !! its guests are those on the GPU
        type(seen_t), intent(in) :: particles
        type(air_device_t), intent(inout) :: there !! opened with walls
        type(gpu_coupling_t), intent(out) :: gpu
        type(error_t), intent(inout) :: err
        type(seen_t) :: p

        call open_memory(air%part%ranks, coupling, particles%n, gpu, err)
        call agree(air%part%ranks, err)
        if (failed(err)) return
        p = particles
        if (several(air%part%ranks)) then
            call open_gpu_windows(air, coupling, gpu, err)
            call put_windows(gpu, err)
            call invite_guests(solid, p, gpu, err)
            p = gpu%guests
        end if
        gpu%wall = there%walls
        gpu%wall%n_cells = 0
        call clear_buffer(gpu%wall%solid, err)
        call clear_buffer(gpu%wall%index, err)
        call put_up_walls(there, p, gpu, err)
        call find_mean_velocity(p, gpu, err)
        if (allocated(coupling%v_before)) &
            call copy_in(coupling%v_before, gpu%v_before, 3*bytes_of_real*particles%n, err)
        call put_debts(gpu, coupling, err)
        call put_books(gpu, coupling, err)
    end subroutine open_gpu_coupling

    subroutine put_debts(gpu, coupling, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err

        call size_debts(gpu, coupling%n_debts, err)
        gpu%n_debts = coupling%n_debts
        if (gpu%n_debts == 0) return
        call copy_in(coupling%debt_cell, gpu%debt_cell, 4_int64*gpu%n_debts, err)
        call copy_in(coupling%debt, gpu%debt, gpu%box%n_var*bytes_of_real*gpu%n_debts, err)
        call enter_debts(gpu, err)
    end subroutine put_debts

    subroutine put_books(gpu, coupling, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err
        real(dp) :: book(book_threads, n_book)

        book = 0
        book(1, :n_sums) = sums_in(coupling%books)
        book(:, book_low) = coupling%books%ledger_low
        book(:, book_high) = coupling%books%ledger_high
        call copy_in(book, gpu%book, 8_int64*size(book), err)
    end subroutine put_books

    !> Bring work, impulse and the range of the ledgers to the host.
    subroutine fetch_books(gpu, coupling, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err
        real(dp) :: book(book_threads, n_book)

        book = 0
        call copy_out(gpu%book, book, 8_int64*size(book), err)
        if (failed(err)) return
        call put_sums(sum(book(:, :n_sums), 1), gpu%books)
        gpu%books%ledger_low = real(minval(book(:, book_low)), rk)
        gpu%books%ledger_high = real(maxval(book(:, book_high)), rk)
        coupling%books = gpu%books
    end subroutine fetch_books

    !> Bring walls, debts and books to the host, for a dump or a checkpoint. What else the host has
    !> of the coupling (face_of, bins, columns) is not touched: the CPU alone uses it.
    subroutine fetch_coupling(gpu, there, air, coupling, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(air_device_t), intent(in) :: there
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err

        coupling%coupling_known_t = gpu%coupling_known_t
        if (.not. gpu%walls_fetched) then
            call copy_out(there%walls%solid, coupling%wall%solid, &
                          size(coupling%wall%solid, kind=int64), err)
            if (failed(err)) return
            call build_walls(air, coupling%wall)
            gpu%walls_fetched = .true.
        end if
        call copy_out(there%walls%v, coupling%wall%v, 3*bytes_of_real*gpu%wall%n_cells, err)
        if (allocated(coupling%v_before)) call copy_out(gpu%v_before, coupling%v_before, &
                      size(coupling%v_before, kind=int64)*bytes_of_real, err)
        call fetch_debts(gpu, coupling, err)
        call fetch_books(gpu, coupling, err)
    end subroutine fetch_coupling

    !> What fetch_coupling reads.
    subroutine note_coupling(gpu, there, snapshot)
        type(gpu_coupling_t), intent(in) :: gpu
        type(air_device_t), intent(in) :: there
        type(snapshot_t), intent(inout) :: snapshot

        call snapshot%note([there%walls%solid%buffer_t, there%walls%v%buffer_t, &
            gpu%v_before%buffer_t, gpu%debt_cell%buffer_t, gpu%debt%buffer_t, gpu%book%buffer_t])
    end subroutine note_coupling

    subroutine fetch_debts(gpu, coupling, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(coupling_t), intent(inout) :: coupling
        type(error_t), intent(inout) :: err

        if (allocated(coupling%debt_cell)) deallocate (coupling%debt_cell, coupling%debt)
        allocate (coupling%debt_cell(gpu%n_debts), coupling%debt(gpu%box%n_var, gpu%n_debts))
        call copy_out(gpu%debt_cell, coupling%debt_cell, 4_int64*gpu%n_debts, err)
        call copy_out(gpu%debt, coupling%debt, gpu%box%n_var*bytes_of_real*gpu%n_debts, err)
        if (failed(err)) return
        coupling%slot = 0
        call enter_host_debts(coupling)
    end subroutine fetch_debts

    !> Largest sum_d |v_d|/dx_d of the walls [1/s].
    real(dp) function gpu_fastest_wall(gpu, there, err) result(fastest)
        type(gpu_coupling_t), intent(in) :: gpu
        type(air_device_t), intent(in) :: there
        type(error_t), intent(inout) :: err
        real(dp) :: part(book_threads)

        call clear_buffer(gpu%common%part, err, 8_int64*size(part))
        call load_kernels%wall_speed(gpu%wall%n_cells, there%grid, there%walls%v, &
                                     gpu%common%part, err)
        part = 0
        call copy_out(gpu%common%part, part, 8_int64*size(part), err)
        fastest = maxval(part)
    end function gpu_fastest_wall
end module brz_gpu_coupling_copy
