! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid, on the GPU: the same list of operations as in
!> brz_coupling_events.
module brz_gpu_coupling_events
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_device, only: arguments_t, copy_out, launch, reserve_buffer
    use brz_errors, only: error_t, failed
    use brz_gpu_air_state, only: bytes_of_real, gpu_air_t
    use brz_gpu_coupling_debts, only: make_room, settle_gpu_debts
    use brz_gpu_coupling_layout, only: count_covered, count_kept, count_uncovered, is_uncovered, &
        n_count
    use brz_gpu_coupling_state, only: add_grid, gpu_coupling_t
    use brz_gpu_coupling_walls, only: build_gpu_walls, list_cells_of_kind
    use brz_gpu_scan, only: running_sum
    use brz_kinds, only: int64
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
        integer :: left, n, donors

        left = counts(count_uncovered)
        n = gpu%n_cells + counts(count_covered) - left
        coupling%n_covered = counts(count_covered)
        coupling%n_uncovered = left
        coupling%covered_total = coupling%covered_total + counts(count_covered)
        coupling%uncovered_total = coupling%uncovered_total + left
        call reserve_buffer(gpu%left, 4_int64*left, err)
        call reserve_buffer(gpu%donor, 4_int64*(left + n), err)
        call reserve_buffer(gpu%shell, 4_int64*(left + n), err)
        call reserve_buffer(gpu%donation, gpu%box%n_var*bytes_of_real*(left + n), err)
        call reserve_buffer(gpu%start, 4_int64*(left + n + 1), err)
        call list_cells_of_kind(gpu, is_uncovered, err, list=gpu%left)
        call fill_left(gpu, there, air, left, err)
        call build_gpu_walls(gpu, there, air, n, err)
        call settle_gpu_debts(gpu, there, err)
        call list_buried(gpu, there, left, donors, err)
        if (donors > 0) call donate(gpu, there, coupling, left, donors, err)
    end subroutine change_gpu_hands

    !> Fill the cells that the solid left.
    subroutine fill_left(gpu, there, air, left, err)
        type(gpu_coupling_t), intent(in) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(air_t), intent(in) :: air
        integer, intent(in) :: left
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments

        if (left == 0) return
        call arguments%add(left)
        call arguments%add(gpu%box%n_var)
        call add_grid(gpu, there, arguments)
        call arguments%add_structure(air%scheme, storage_size(air%scheme)/8)
        call arguments%add(gpu%shells)
        call arguments%add(air%rho_rest)
        call arguments%add(air%p_rest)
        call arguments%add_all(gpu%left, gpu%mark, there%walls%solid, there%walls%cell_of, &
                               there%walls%v, there%u, gpu%donor)
        call arguments%add_all(gpu%donation)
        call launch(gpu%fresh, [left, 1, 1], arguments, err)
    end subroutine fill_left

    !> Solid cells that no longer touch gas but have a ledger: donors too.
    subroutine list_buried(gpu, there, left, donors, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        integer, intent(in) :: left
        integer, intent(out) :: donors !! with those that the solid left
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: buried

        call arguments%add(gpu%n_cells)
        call arguments%add(gpu%box%n_var)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%cell, there%walls%face_of, there%u, gpu%start)
        call launch(gpu%buried, [gpu%n_cells, 1, 1], arguments, err)
        call running_sum(gpu%scan, gpu%start, gpu%n_cells, err, buried)
        donors = left + buried
        if (buried == 0) return
        arguments%n = 0
        call arguments%add(gpu%n_cells)
        call arguments%add(gpu%box%n_var)
        call arguments%add(left)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%cell, gpu%start, there%u, gpu%mark, gpu%donor, gpu%donation)
        call launch(gpu%list_buried, [gpu%n_cells, 1, 1], arguments, err)
    end subroutine list_buried

    !> Hand the gas of the donors to the ledgers nearby; what finds none is owed, or waits.
    subroutine donate(gpu, there, coupling, left, donors, err)
        type(gpu_coupling_t), intent(inout) :: gpu
        type(gpu_air_t), intent(in) :: there
        type(coupling_t), intent(inout) :: coupling
        integer, intent(in) :: left, donors
        type(error_t), intent(inout) :: err
        type(arguments_t) :: arguments
        integer :: counts(n_count), opened

        call arguments%add(donors)
        call arguments%add(left)
        call arguments%add(gpu%box%n_var)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%shells, gpu%donor, there%walls%solid, there%walls%cell_of, &
                               there%walls%face_of, there%u, gpu%shell)
        call arguments%add_all(gpu%donation, gpu%start, gpu%counts)
        call launch(gpu%shells_of, [donors, 1, 1], arguments, err)
        call running_sum(gpu%scan, gpu%start, donors, err, opened)
        counts = 0
        call copy_out(gpu%counts, counts, 4_int64*n_count, err)
        coupling%kept = coupling%kept + counts(count_kept)
        if (failed(err)) return
        if (opened > 0) then
            call make_room(gpu, gpu%n_debts + opened, err)
            arguments%n = 0
            call arguments%add(left)
            call arguments%add(gpu%box%n_var)
            call arguments%add(gpu%n_debts)
            call arguments%add_all(gpu%start, gpu%donor, gpu%donation, gpu%slot, &
                                   gpu%debt_cell(1), gpu%debt(1))
            call launch(gpu%owe, [left, 1, 1], arguments, err)
            gpu%n_debts = gpu%n_debts + opened
        end if
        arguments%n = 0
        call arguments%add(gpu%n_cells)
        call arguments%add(donors)
        call arguments%add(left)
        call arguments%add(gpu%box%n_var)
        call add_grid(gpu, there, arguments)
        call arguments%add_all(gpu%shells, gpu%cell, there%walls%face_of, gpu%mark, gpu%donor, &
                               gpu%shell, gpu%donation)
        call arguments%add_all(there%u)
        call launch(gpu%collect, [gpu%n_cells, 1, 1], arguments, err)
    end subroutine donate
end module brz_gpu_coupling_events
