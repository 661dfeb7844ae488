! SPDX-License-Identifier: MIT
!> Gas that is stored in solid cells and deferred sources of gas cells (deferred sources): flux
!> redistribution. The operations of every step, in their order, and what donors hand over.
module brz_deferred_source_driver
    use brz_air_state, only: air_t
    use brz_coupling_device, only: diag_at, diag_images, diag_low
    use brz_coupling_state, only: coupling_t
    use brz_coupling_sum_loops, only: for_each_total_deferred_source
    use brz_deferred_source_loops, only: for_each_enter_deferred_source, for_each_flag_own, &
        for_each_move_deferred_source, for_each_release_deferred_source, &
        for_each_settle_deferred_source
    use brz_donor_loops, only: for_each_choose_shell, for_each_collect_shares, for_each_fill_left, &
        for_each_flag_buried, for_each_list_buried, for_each_defer_donation
    use brz_errors, only: error_t
    use brz_kinds, only: dp
    use brz_cell_store_loops, only: for_each_record_level, for_each_copy_stored, &
        for_each_first_excess, for_each_give_excess, for_each_judge_stored, for_each_level_stored, &
        for_each_open_excess, for_each_take_excess, for_each_total_stored
    use brz_lists, only: at_least, copy_first, room_of, running_sum, swap
    use brz_scheme, only: max_var
    implicit none
    private
    public :: level_cell_stores, limit_cell_stores, release_deferred_sources, settle_covered, &
        enter_deferred_sources
    public :: fill_cleared, donate, size_deferred_sources, size_next, keep_own, stored_totals

contains

    !> Exchange parts of the cell stores of neighbours. In one dimension there are no such
    !> neighbours.
    subroutine level_cell_stores(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (.not. c%level > 0) return
        call for_each_copy_stored(c%on_gpu, c%wall%n_cells, c%box, c%cell, air%u, c%stored, err)
        if (any(c%box%mirrors)) then
            call for_each_record_level(c%on_gpu, c%wall%n_cells, c%box, c%shells, c%level, c%cell, &
                                     c%wall%solid, c%wall%index, c%wall%face_of, c%stored, &
                                     c%diagnostics%images, diag_at(c%device, diag_images), err)
        end if
        call for_each_level_stored(c%on_gpu, c%wall%n_cells, c%box, c%shells, c%level, c%cell, &
                                   c%wall%solid, c%wall%index, c%wall%face_of, c%stored, air%u, err)
    end subroutine level_cell_stores

    !> Keep each cell store in its band; the excess becomes a deferred source of the gas beside.
    subroutine limit_cell_stores(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: opened, over

        over = 0
        call for_each_judge_stored(c%on_gpu, c%wall%n_cells, c%box, c%cell, c%gas, c%wall%face_of, &
                                   air%u, c%excess, c%diagnostics%stored_low, &
                                   c%diagnostics%stored_high, over, diag_at(c%device, diag_low), &
                                   err)
        if (over == 0) return
        call for_each_take_excess(c%on_gpu, c%wall%n_cells, c%box, c%cell, c%wall%face_of, &
                                  c%excess, air%u, c%stored, err)
        call at_least(c%on_gpu, c%start, c%wall%n_faces + 1, err)
        call for_each_first_excess(c%on_gpu, c%wall%n_faces, c%box, c%gas, c%wall%face_cell, &
                                   c%wall%solid, c%wall%index, c%wall%face_of, c%excess, c%slot, &
                                   c%start, err)
        call running_sum(c%on_gpu, c%start, c%wall%n_faces, err, opened)
        call size_deferred_sources(c, c%n_deferred + opened, err)
        call for_each_open_excess(c%on_gpu, c%wall%n_faces, c%n_var, c%n_deferred, c%start, c%gas, &
                                  c%slot, c%deferred_cell, c%deferred, err)
        c%n_deferred = c%n_deferred + opened
        call for_each_give_excess(c%on_gpu, c%wall%n_faces, c%box, c%n_var, c%gas, &
                                  c%wall%face_cell, c%wall%solid, c%wall%index, c%wall%face_of, &
                                  c%excess, c%stored, c%slot, c%deferred, err)
    end subroutine limit_cell_stores

    !> Release a part of each deferred source.
    subroutine release_deferred_sources(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (c%n_deferred == 0) return
        call at_least(c%on_gpu, c%start, c%n_deferred + 1, err)
        call for_each_release_deferred_source(c%on_gpu, c%n_deferred, c%box, c%n_var, &
            c%deferred_cell, air%u, c%deferred, c%start, err)
        call drop_paid(c, err)
    end subroutine release_deferred_sources

    !> Cells that were covered take their deferred sources into their cell stores.
    subroutine settle_covered(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (c%n_deferred == 0) return
        call at_least(c%on_gpu, c%start, c%n_deferred + 1, err)
        call for_each_settle_deferred_source(c%on_gpu, c%n_deferred, c%box, c%n_var, &
                                  c%deferred_cell, c%wall%solid, air%u, c%deferred, c%start, err)
        call drop_paid(c, err)
    end subroutine settle_covered

    !> Drop the deferred sources of cells of other processes.
    subroutine keep_own(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (c%n_deferred == 0) return
        call at_least(c%on_gpu, c%start, c%n_deferred + 1, err)
        call for_each_flag_own(c%on_gpu, c%n_deferred, c%box, c%deferred_cell, c%start, err)
        call drop_paid(c, err)
    end subroutine keep_own

    !> Close the gaps in the list that released sources leave; `start` holds 1 for each that stays.
    subroutine drop_paid(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: left

        call running_sum(c%on_gpu, c%start, c%n_deferred, err, left)
        if (left == c%n_deferred) return
        call size_next(c, c%n_deferred, err)
        call for_each_move_deferred_source(c%on_gpu, c%n_deferred, c%n_var, c%start, &
                                c%deferred_cell, c%deferred, c%slot, c%next_cell, c%next_deferred, &
                                err)
        c%n_deferred = left
        call swap(c%deferred_cell, c%next_cell)
        call swap(c%deferred, c%next_deferred)
    end subroutine drop_paid

    !> Enter all deferred sources in the map of cells, which holds none.
    subroutine enter_deferred_sources(c, err)
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (c%n_deferred > 0) call for_each_enter_deferred_source(c%on_gpu, c%n_deferred, &
            c%deferred_cell, c%slot, err)
    end subroutine enter_deferred_sources

    !> Room for n deferred sources; those already listed are kept.
    subroutine size_deferred_sources(c, n, err)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err

        if (room_of(c%deferred_cell) >= max(n, 1)) return
        call size_next(c, 2*n + 64, err)
        call copy_first(c%on_gpu, c%n_deferred, c%deferred_cell, c%next_cell, err)
        call copy_first(c%on_gpu, c%n_deferred, c%n_var, c%deferred, c%next_deferred, err)
        call swap(c%deferred_cell, c%next_cell)
        call swap(c%deferred, c%next_deferred)
    end subroutine size_deferred_sources

    !> Room for a list of n deferred sources that is to take the place of the one that is there.
    subroutine size_next(c, n, err)
        type(coupling_t), intent(inout) :: c
        integer, intent(in) :: n
        type(error_t), intent(inout) :: err

        ! the two always have the same room: no buffer of a GPU is shorter than two entries of one
        call at_least(c%on_gpu, c%next_cell, max(n, 2), err)
        call at_least(c%on_gpu, c%next_deferred, c%n_var, max(n, 2), err)
    end subroutine size_next

    !> Give the cells that the solid left the state of the gas around; what is over they give away.
    subroutine fill_cleared(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: n

        n = c%wall%n_cells + c%n_covered ! most donors: these cells, and all solid ones to come
        call at_least(c%on_gpu, c%donor, n, err)
        call at_least(c%on_gpu, c%donor_shell, n, err)
        call at_least(c%on_gpu, c%donation, max_var, n, err)
        if (c%n_cleared == 0) return
        call for_each_fill_left(c%on_gpu, c%n_cleared, c%box, air%scheme, air%rho_rest, &
                                air%p_rest, c%shells, c%cleared, c%mark, c%wall%solid, &
                                c%wall%index, c%ends, c%wall%v, air%u, c%donor, c%donation, err)
    end subroutine fill_cleared

    !> Hand the gas of the donors to the cell stores nearby; what finds none is deferred, or waits.
    subroutine donate(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: buried, donors, kept, left, n, opened

        n = c%wall%n_cells
        left = c%n_cleared
        call at_least(c%on_gpu, c%start, left + n + 1, err)
        call for_each_flag_buried(c%on_gpu, n, c%box, c%cell, c%wall%face_of, air%u, c%start, err)
        call running_sum(c%on_gpu, c%start, n, err, buried)
        donors = left + buried
        if (donors == 0) return
        call for_each_list_buried(c%on_gpu, n, left, c%box, c%cell, c%start, air%u, c%mark, &
                                  c%donor, c%donation, err)
        kept = 0
        call for_each_choose_shell(c%on_gpu, donors, left, c%box, c%shells, c%donor, c%wall%solid, &
                                   c%wall%index, c%wall%face_of, air%u, c%donor_shell, c%donation, &
                                   c%start, kept, err)
        c%diagnostics%kept = c%diagnostics%kept + kept
        call running_sum(c%on_gpu, c%start, donors, err, opened)
        call size_deferred_sources(c, c%n_deferred + opened, err)
        if (opened > 0) call for_each_defer_donation(c%on_gpu, left, c%n_var, c%n_deferred, &
            c%start, c%donor, c%donation, c%slot, c%deferred_cell, c%deferred, err)
        c%n_deferred = c%n_deferred + opened
        call for_each_collect_shares(c%on_gpu, n, donors, left, c%box, c%shells, c%cell, &
                                     c%wall%face_of, c%mark, c%donor, c%donor_shell, c%donation, &
                                     air%u, err)
    end subroutine donate

    !> Totals of cell stores and deferred sources, of all processes.
    subroutine stored_totals(air, c, kept, products, err)
        type(air_t), intent(in) :: air !! read in solid cells
        type(coupling_t), intent(inout) :: c
        real(dp), intent(out) :: kept(5) !! mass [kg], momentum [kg m/s], energy [J]
        real(dp), intent(out) :: products !! mass of products of explosives [kg]
        type(error_t), intent(inout) :: err
        real(dp) :: total(6), remains(6)

        call for_each_total_stored(c%on_gpu, c%wall%n_cells, air%part%ranks, c%box, c%cell, air%u, &
                                   total, err)
        call for_each_total_deferred_source(c%on_gpu, c%n_deferred, air%part%ranks, c%box, &
                                 c%n_var, c%deferred_cell, c%deferred, remains, err)
        total = (total + remains)*product(c%box%dx)
        kept = total(1:5)
        products = total(6)
    end subroutine stored_totals
end module brz_deferred_source_driver
