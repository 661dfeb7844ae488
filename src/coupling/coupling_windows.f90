! SPDX-License-Identifier: MIT
!> The coupling halo of processes: gas and cell stores of others in the halo of the air that each
!> one sees. GPUs fetch of it what lies around walls.
module brz_coupling_windows
    use brz_air_state, only: air_t
    use brz_boxes, only: cells_t
    use brz_buffers, only: integers_t
    use brz_cell_lists, only: list_cells
    use brz_coupling_part, only: coupling_part_t
    use brz_coupling_state, only: coupling_t
    use brz_cut_share, only: open_share_of_gpus
    use brz_device, only: clear_buffer, copy_in, reserve_buffer
    use brz_errors, only: error_t
    use brz_fetch, only: fetch, fetch_t
    use brz_coupling_ghost_loop_bodies, only: always_near, block_at, blocks_of
    use brz_coupling_ghost_launches, only: coupling_ghost_kernels
    use brz_kinds, only: int64, int8
    use brz_lists, only: put_list
    use brz_places, only: message_buffers_t
    use brz_present_table, only: on_device
    use brz_record_rules, only: w => words_of_real
    implicit none
    private
    public :: offer_window, see_halo, see_beside, mark_blocks, open_windows_of_gpus

contains

    !> Others may read what they see of this process, once all have met: the first half of
    !> see_halo between GPUs.
    subroutine offer_window(air, c, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err

        if (c%on_gpu) call c%device%coupling_halo%offer_reals(air%grid%apart, air%device%u, err)
    end subroutine offer_window

    !> Bring the gas and the cell stores in the halo of this process up to date.
    subroutine see_halo(air, c, met, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(inout) :: c
        logical, intent(in) :: met !! all have met since offer_window
        type(error_t), intent(inout) :: err

        if (.not. c%on_gpu) then
            call fetch(air%part%ranks, air%part%coupling_halo, air%n_var, air%before + 1 - air%g, &
                       air%before + air%n + air%g, air%u)
        else if (met) then
            call c%device%coupling_halo%take_reals(air%grid%apart, air%device%u, .true., err)
        else
            call c%device%coupling_halo%reals_of_others(air%grid%apart, air%device%u, err)
        end if
    end subroutine see_halo

    !> Bring the gas beside the box up to date, as far as stencils and gauges reach. Of cut cells
    !> farther away listed ones alone are read, see brz_cut_share.
    subroutine see_beside(air, c, err)
        type(air_t), intent(inout) :: air
        type(coupling_t), intent(in) :: c
        type(error_t), intent(inout) :: err

        if (c%on_gpu) then
            call air%device%halo%reals_of_others(air%grid%apart, air%device%u, err)
        else
            call fetch(air%part%ranks, air%part%halo, air%n_var, air%before + 1 - air%g, &
                       air%before + air%n + air%g, air%u)
        end if
    end subroutine see_beside

    !> Get ready to speak between GPUs with the other processes, whose halos are known. No ghosts
    !> are listed then.
    subroutine open_windows_of_gpus(air, c, err)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        type(error_t), intent(inout) :: err
        integer, parameter :: most = 6 + 11*w + 2 !! words of a ghost, with its volume
        type(coupling_part_t) :: part
        type(message_buffers_t) :: nothing
        type(cells_t) :: held

        part%boxes = c%part%boxes
        part%halos = c%part%halos
        part%near = c%part%near
        part%messages%ranks = air%part%ranks
        part%messages%on_gpu = .true.
        c%part = part
        deallocate (c%ghosts)
        allocate (c%ghosts, source=c%ghost_bodies)
        c%ghosts%on_gpu = .true.
        c%ghosts%wide = 4
        c%ghosts%stride_p = 1
        c%ghosts%stride_t = 1
        held = cells_t(air%before + 1 - air%g, air%before + air%n + air%g)
        if (c%wall%cells%present) then
            call open_share_of_gpus(c%wall%share, c%wall%cells, err)
        else
            call c%device%coupling_halo%open(air%part%ranks, air%part%coupling_halo, held, &
                air%n_var, err)
            if (.not. any(c%box%wraps)) call map_blocks(c, air%part%coupling_halo, held, err)
        end if
        allocate (nothing%place(0), nothing%first(0:air%part%ranks%n))
        nothing%first = 1
        call c%part%messages%device%open(air%part%ranks, nothing, nothing, max(most, 1 + 6*w), err)
    end subroutine open_windows_of_gpus

    !> Of the halo what lies around walls is fetched, and three layers around the box for gauges:
    !> say in which block of the map that mark_blocks keeps each cell is.
    subroutine map_blocks(c, plan, held, err)
        type(coupling_t), intent(inout) :: c
        type(fetch_t), intent(in) :: plan
        type(cells_t), intent(in) :: held !! cells of the arrays of the air
        type(error_t), intent(inout) :: err

        associate (window => c%device%coupling_halo, n => c%ranks%n)
            call reserve_buffer(window%near, int(always_near + n*blocks_of(c%box), int64), err)
            call clear_buffer(window%near, err)
            call put_list(.true., blocks(list_cells(n, plan%out, held), .true.), &
                          window%out_block, err)
            call put_list(.true., blocks(list_cells(n, plan%in, held), .false.), &
                          window%in_block, err)
        end associate

    contains

        !> Blocks of listed cells, process by process.
        function blocks(list, goes) result(block)
            type(message_buffers_t), intent(in) :: list !! in the arrays
            logical, intent(in) :: goes !! to the process
            integer :: at, block(size(list%place)), cell(3), r, t
            type(cells_t) :: box

            associate (n => held%hi - held%lo + 1)
                do r = 0, ubound(list%first, 1) - 1
                    box = c%part%boxes(merge(r, c%ranks%rank, goes))
                    do t = list%first(r), list%first(r + 1) - 1
                        at = list%place(t) - 1
                        cell = held%lo + [mod(at, n(1)), mod(at/n(1), n(2)), at/n(1)/n(2)]
                        block(t) = block_at(c%box, r + 1, cell - c%box%before)
                        if (all(cell >= box%lo - 3 .and. cell <= box%hi + 3)) &
                            block(t) = always_near
                    end do
                end do
            end associate
        end function blocks
    end subroutine map_blocks

    !> Mark where gas is fetched: around the solid cells that both processes see.
    subroutine mark_blocks(c, err)
        type(coupling_t), intent(in) :: c !! on a GPU
        type(error_t), intent(inout) :: err

        associate (part => c%part, near => c%device%coupling_halo%near)
            if (any(c%box%wraps)) return
            call clear_buffer(near, err)
            call copy_in([1_int8], near, 1_int64, err) ! always_near
            if (c%wall%n_cells > 0) call coupling_ghost_kernels%mark_around(c%wall%n_cells, &
                size(part%halos), integers_t(address=on_device(part%halos_at)), c%box, &
                integers_t(address=on_device(c%cell)), near, err)
        end associate
    end subroutine mark_blocks
end module brz_coupling_windows
