! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid, on the GPU: the same list of operations as in
!> brz_coupling_events.
module brz_gpu_coupling_events
    use brz_air_state, only: air_t
    use brz_buffers, only: from
    use brz_coupling_box, only: is_left
    use brz_coupling_state, only: coupling_t
    use brz_device, only: copy_out, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_gpu_coupling_debts, only: make_room, settle_gpu_debts
    use brz_gpu_coupling_layout, only: count_covered, count_kept, count_uncovered, n_count
    use brz_gpu_coupling_state, only: gpu_coupling_t
    use brz_gpu_coupling_walls, only: build_gpu_walls, list_cells_of_kind
    use brz_kinds, only: int64
    use brz_scheme, only: max_var
    implicit none
    private
    public :: change_gpu_hands

contains

    !> Fill what the solid left, put the new walls up, pass the rest on.
    subroutine change_gpu_hands(gpu, there, air, coupling, counts, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(inout) :: there
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: counts(n_count) !! from look_at_particles
        type(error_t), intent(inout) :: err
        integer :: left, n

        left = counts(count_uncovered)
        n = gpu%n_cells + counts(count_covered) - left
        coupling%n_covered = counts(count_covered)
        coupling%n_uncovered = left
        coupling%covered_total = coupling%covered_total + counts(count_covered)
        coupling%uncovered_total = coupling%uncovered_total + left
        call reserve_buffer(gpu%left, 4_int64*left, err)
        call reserve_buffer(gpu%donor, 4_int64*(left + n), err)
        call reserve_buffer(gpu%shell, 4_int64*(left + n), err)
        call reserve_buffer(gpu%donation, max_var*bytes_of_real*(left + n), err)
        call reserve_buffer(gpu%start, 4_int64*(left + n + 1), err)
        call list_cells_of_kind(gpu, is_left, err, list=gpu%left)
        if (left > 0) &
            call gpu%donors%fill_left(left, gpu%box, air%scheme, air%rho_rest, air%p_rest, &
                                      gpu%shells, gpu%left, gpu%mark, there%walls%solid, &
                                      there%walls%cell_of, there%walls%v, there%u, gpu%donor, &
                                      gpu%donation, err)
        call build_gpu_walls(gpu, there, air, n, err)
        call settle_gpu_debts(gpu, there, err)
        call donate(gpu, there, coupling, left, err)
    end subroutine change_gpu_hands

    !> Hand the gas of the donors to the ledgers nearby; what finds none is owed, or waits.
    subroutine donate(gpu, there, coupling, left, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: left !! cells that the solid left
        type(error_t), intent(inout) :: err
        integer :: buried, counts(n_count), donors, opened

        call gpu%donors%flag_buried(gpu%n_cells, gpu%box, gpu%cell, there%walls%face_of, there%u, &
                                    gpu%start, err)
        call gpu%common%running_sum(gpu%start, gpu%n_cells, err, buried)
        donors = left + buried
        if (donors == 0) return
        call gpu%donors%list_buried(gpu%n_cells, left, gpu%box, gpu%cell, gpu%start, there%u, &
                                    gpu%mark, gpu%donor, gpu%donation, err)
        call gpu%donors%choose_shell(donors, left, gpu%box, gpu%shells, gpu%donor, &
                                     there%walls%solid, there%walls%cell_of, there%walls%face_of, &
                                     there%u, gpu%shell, gpu%donation, gpu%start, &
                                     from(gpu%counts, int(count_kept, int64)), err)
        call gpu%common%running_sum(gpu%start, donors, err, opened)
        counts = 0
        call copy_out(gpu%counts, counts, 4_int64*n_count, err)
        coupling%kept = coupling%kept + counts(count_kept)
        if (failed(err)) return
        if (opened > 0) then
            call make_room(gpu, gpu%n_debts + opened, err)
            call gpu%donors%owe_donation(left, gpu%box%n_var, gpu%n_debts, gpu%start, gpu%donor, &
                                         gpu%donation, gpu%slot, gpu%debt_cell(1), gpu%debt(1), err)
            gpu%n_debts = gpu%n_debts + opened
        end if
        call gpu%donors%collect_shares(gpu%n_cells, donors, left, gpu%box, gpu%shells, gpu%cell, &
                                       there%walls%face_of, gpu%mark, gpu%donor, gpu%shell, &
                                       gpu%donation, there%u, err)
    end subroutine donate
end module brz_gpu_coupling_events
