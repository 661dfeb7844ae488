! SPDX-License-Identifier: MIT
!> Ledgers and debts on the GPU: the operations of every step.
module brz_gpu_coupling_debts
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_buffers, only: from, integers_t, reals_t
    use brz_device, only: allocate_buffer, copy_out, copy_within, free_buffers, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_gpu_coupling_layout, only: book_low, book_threads, count_over, n_count
    use brz_gpu_coupling_state, only: gpu_coupling_t
    use brz_kinds, only: int64, rk
    implicit none
    private
    public :: level_gpu_ledgers, limit_gpu_ledgers, release_gpu_debts, settle_gpu_debts, make_room

contains

    !> Exchange parts of the ledgers of neighbours, as level_ledgers does.
    subroutine level_gpu_ledgers(gpu, there, air, coupling, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling
        type(error_t), intent(inout) :: err

        if (coupling%shells%n < 3 .or. count(air%n > 1) == 1) return
        call gpu%ledgers%copy_ledger(gpu%n_cells, gpu%box, gpu%cell, there%u, gpu%ledger, err)
        call gpu%ledgers%level_ledger(gpu%n_cells, gpu%box, gpu%shells, &
                                      1/3.0_rk**count(air%n > 1), gpu%cell, there%walls%solid, &
                                      there%walls%cell_of, there%walls%face_of, gpu%ledger, &
                                      there%u, err)
    end subroutine level_gpu_ledgers

    !> Keep each ledger in its band; the excess becomes debt of the gas beside.
    subroutine limit_gpu_ledgers(gpu, there, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(error_t), intent(inout) :: err
        integer :: counts(n_count), opened

        call gpu%ledgers%judge_ledger( &
            gpu%n_cells, gpu%box, gpu%cell, gpu%gas, there%walls%face_of, there%u, gpu%excess, &
            from(gpu%book, book_threads*(book_low - 1_int64) + 1), &
            from(gpu%counts, int(count_over, int64)), err)
        counts = 0
        call copy_out(gpu%counts, counts, 4_int64*n_count, err)
        if (counts(count_over) == 0 .or. failed(err)) return
        call gpu%ledgers%take_excess(gpu%n_cells, gpu%box, gpu%cell, there%walls%face_of, &
                                     gpu%excess, there%u, gpu%ledger, err)
        call gpu%ledgers%first_excess(gpu%n_faces, gpu%box, gpu%gas, gpu%owner, &
                                      there%walls%solid, there%walls%cell_of, &
                                      there%walls%face_of, gpu%excess, gpu%slot, gpu%start, err)
        call gpu%common%running_sum(gpu%start, gpu%n_faces, err, opened)
        call make_room(gpu, gpu%n_debts + opened, err)
        call gpu%ledgers%open_excess(gpu%n_faces, gpu%box%n_var, gpu%n_debts, gpu%start, gpu%gas, &
                                     gpu%slot, gpu%debt_cell(1), gpu%debt(1), err)
        gpu%n_debts = gpu%n_debts + opened
        call gpu%ledgers%give_excess(gpu%n_faces, gpu%box, gpu%box%n_var, gpu%gas, gpu%owner, &
                                     there%walls%solid, there%walls%cell_of, there%walls%face_of, &
                                     gpu%excess, gpu%ledger, gpu%slot, gpu%debt(1), err)
    end subroutine limit_gpu_ledgers

    !> Pay a part of each debt.
    subroutine release_gpu_debts(gpu, there, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(error_t), intent(inout) :: err

        if (gpu%n_debts == 0) return
        call reserve_buffer(gpu%start, 4_int64*(gpu%n_debts + 1), err)
        call gpu%debts%pay_debt(gpu%n_debts, gpu%box, gpu%box%n_var, gpu%debt_cell(1), there%u, &
                                gpu%debt(1), gpu%start, err)
        call drop_paid(gpu, err)
    end subroutine release_gpu_debts

    !> Cells that were covered take their debts into their ledgers.
    subroutine settle_gpu_debts(gpu, there, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(error_t), intent(inout) :: err

        if (gpu%n_debts == 0) return
        call reserve_buffer(gpu%start, 4_int64*(gpu%n_debts + 1), err)
        call gpu%debts%settle_debt(gpu%n_debts, gpu%box, gpu%box%n_var, gpu%debt_cell(1), &
                                   there%walls%solid, there%u, gpu%debt(1), gpu%start, err)
        call drop_paid(gpu, err)
    end subroutine settle_gpu_debts

    !> Close the gaps in the list that paid debts leave; `start` holds 1 for each that stays.
    subroutine drop_paid(gpu, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: left

        call gpu%common%running_sum(gpu%start, gpu%n_debts, err, left)
        if (left == gpu%n_debts) return
        call gpu%debts%move_debt(gpu%n_debts, gpu%box%n_var, gpu%start, gpu%debt_cell(1), &
                                 gpu%debt(1), gpu%slot, gpu%debt_cell(2), gpu%debt(2), err)
        gpu%debt_cell = gpu%debt_cell([2, 1])
        gpu%debt = gpu%debt([2, 1])
        gpu%n_debts = left
    end subroutine drop_paid

    !> Room for n debts; those already listed are kept.
    subroutine make_room(gpu, n, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err
        type(integers_t) :: cell
        type(reals_t) :: debt
        integer(int64) :: bytes

        if (n <= gpu%room_debts) return
        gpu%room_debts = 2*n + 64
        bytes = gpu%box%n_var*bytes_of_real
        call allocate_buffer(cell, 4_int64*gpu%room_debts, err)
        call allocate_buffer(debt, bytes*gpu%room_debts, err)
        call copy_within(gpu%debt_cell(1), cell, 4_int64*gpu%n_debts, err)
        call copy_within(gpu%debt(1), debt, bytes*gpu%n_debts, err)
        call free_buffers(gpu%debt_cell(1), gpu%debt_cell(2), gpu%debt(1), gpu%debt(2))
        gpu%debt_cell(1) = cell
        gpu%debt(1) = debt
        call allocate_buffer(gpu%debt_cell(2), 4_int64*gpu%room_debts, err)
        call allocate_buffer(gpu%debt(2), bytes*gpu%room_debts, err)
    end subroutine make_room
end module brz_gpu_coupling_debts
