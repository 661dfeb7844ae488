! SPDX-License-Identifier: MIT
!> Cut cells once bodies have moved: new shapes, and the gas that goes over to them, from cells that
!> are newly covered and into those that are freshly cleared.
module brz_cut_exchange_driver
    use brz_air_state, only: air_t
    use brz_coupling_state, only: coupling_t
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_driver, only: find_clusters, find_cut_cells, find_shapes, mix_clusters, &
        move_cut_walls, open_faces
    use brz_cut_exchange_loops, only: for_each_cut_apply, for_each_cut_find_band, &
        for_each_cut_find_off, for_each_cut_find_takers, for_each_cut_forget, &
        for_each_cut_hand_on, for_each_cut_leave, for_each_cut_level, for_each_cut_remap, &
        for_each_cut_settle, for_each_cut_take
    use brz_cut_share, only: pick_states, put_states, share_rows, share_states, states_in
    use brz_errors, only: error_t
    use brz_kinds, only: dp
    use brz_lists, only: at_least, copy_first, swap
    use brz_ranks, only: several
    use brz_record_rules, only: w => words_of_real
    use brz_rows, only: rows_of
    use brz_scheme, only: max_var
    use brz_bodies, only: bodies_t
    implicit none
    private
    public :: renew_cut_cells

    integer, parameter :: sweeps = 2 !! exchanges of volume between neighbours in a step

contains

    !> Bring shapes, gas and wall velocities up to date with the particles, once per step of the
    !> air.
    !>
    !> Mass, momentum and energy of gas and waiting content together do not change.
    subroutine renew_cut_cells(air, solid, bodies, p, c, err)
        type(air_t), intent(inout) :: air
        class(bodies_t), intent(in) :: solid !! particles of this process
        class(bodies_t), intent(in) :: bodies !! bodies of those that it sees
        class(bodies_t), intent(in) :: p !! these particles
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer :: m, pockets

        call keep_list(c%on_gpu, c%wall%cells, err)
        call find_cut_cells(air, solid, p, c, err)
        call share_states(c%wall%share, c%wall%cells, air%u, err)
        call find_shapes(p, c, err)
        associate (g => c%on_gpu, l => c%wall%cells, nodes => c%wall%cells%nodes)
            call size_exchange(g, l, err)
            call take_over(air, c, err)
            call find_clusters(c, err)
            pockets = 0
            call for_each_cut_settle(g, l%n, nodes, l%place, l%master, l%ends, l%member, &
                                     l%content, l%volume, l%gas, l%shut, l%kept, air%u, pockets, &
                                     err)
            l%pockets = l%pockets + pockets
            if (several(c%ranks)) call share_contents(air, c, err)
            if (pockets > 0 .or. several(c%ranks)) call open_faces(c, 0, err)
            call for_each_cut_find_band(g, l%n, nodes, l%cell, l%place, l%slot, l%shut, l%master, &
                                        l%gas, l%band, err)
            do m = 0, sweeps
                call for_each_cut_find_off(g, l%n, l%place, l%shut, l%master, l%beside, &
                    l%aperture, &
                                           l%band, l%gas, l%volume, l%off, l%takers, err)
                if (m == 0) then
                    call for_each_cut_leave(g, l%n, nodes, l%place, l%beside, l%aperture, l%band, &
                                            l%off, l%takers, l%gas, l%volume, air%u, l%flow, &
                                            l%absorbed, err)
                else
                    call for_each_cut_level(g, l%n, nodes, l%place, l%beside, l%aperture, l%band, &
                                            l%off, l%volume, air%u, l%flow, err)
                end if
                call for_each_cut_apply(g, l%n, nodes, l%place, l%flow, l%volume, air%u, err)
            end do
        end associate
        if (several(c%ranks)) call share_contents(air, c, err)
        call mix_clusters(air, c, err)
        call move_cut_walls(air, bodies, p, c, 0.0_dp, err)
    end subroutine renew_cut_cells

    !> Gas, volumes and what waits in the boxes of others.
    subroutine share_contents(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout), target :: c
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells, share => c%wall%share)
            call pick_states(share, l, air%u, err)
            call share_rows(share, [rows_of(g, l%volume, w), rows_of(g, l%gas, w), &
                rows_of(g, l%shut, 1), rows_of(g, l%kept, (max_var + 1)*w), states_in(share)], err)
            call put_states(share, l, air%u, err)
        end associate
    end subroutine share_contents

    !> Keep what the gas needs of the list before: what is found anew changes places with it.
    subroutine keep_list(on_gpu, cells, err)
        logical, intent(in) :: on_gpu
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err

        associate (n => cells%n, before => cells%before)
            before%n = n
            call at_least(on_gpu, before%cell, n, err)
            call at_least(on_gpu, before%shut, n, err)
            call at_least(on_gpu, before%aperture, 6, n, err)
            call at_least(on_gpu, before%volume, n, err)
            call at_least(on_gpu, before%swept, n, err)
            call at_least(on_gpu, before%kept, max_var + 1, n, err)
            call copy_first(on_gpu, n, cells%cell, before%cell, err)
            call swap(cells%shut, before%shut)
            call swap(cells%aperture, before%aperture)
            call swap(cells%volume, before%volume)
            call swap(cells%swept, before%swept)
            call swap(cells%kept, before%kept)
        end associate
    end subroutine keep_list

    !> Room for the exchange.
    subroutine size_exchange(on_gpu, cells, err)
        logical, intent(in) :: on_gpu
        type(cut_cells_t), intent(inout) :: cells
        type(error_t), intent(inout) :: err
        integer :: n

        n = cells%n
        call at_least(on_gpu, cells%from, n, err)
        call at_least(on_gpu, cells%band, n, err)
        call at_least(on_gpu, cells%takers, n, err)
        call at_least(on_gpu, cells%content, max_var, n, err)
        call at_least(on_gpu, cells%was_open, 6, n, err)
        call at_least(on_gpu, cells%opening, n, err)
        call at_least(on_gpu, cells%off, n, err)
        call at_least(on_gpu, cells%flow, max_var + 1, n, err)
    end subroutine size_exchange

    !> Content and volumes in the new list; what is in cells that closed goes to those beside them
    !> through the faces that were open, or waits.
    subroutine take_over(air, c, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        associate (g => c%on_gpu, l => c%wall%cells, old => c%wall%cells%before)
            call for_each_cut_remap(g, l%n, old%n, l%cell, old%cell, l%from, err)
            call for_each_cut_take(g, l%n, l%nodes, l%from, l%place, l%shut, &
                                   l%beside, l%aperture, old%shut, old%aperture, old%volume, &
                                   old%swept, old%kept, air%u, l%content, l%volume, l%kept, &
                                   l%was_open, err)
            call for_each_cut_find_takers(g, l%n, l%place, l%shut, l%beside, l%aperture, &
                                          l%was_open, l%kept, l%opening, err)
            call for_each_cut_hand_on(g, l%n, l%place, l%shut, l%beside, l%aperture, l%was_open, &
                                      l%kept, l%opening, l%content, l%volume, err)
            call for_each_cut_forget(g, l%n, l%opening, l%kept, err)
        end associate
    end subroutine take_over
end module brz_cut_exchange_driver
