! SPDX-License-Identifier: MIT
!> What stands at the walls of cut cells near gauges, wherever the air is.
module brz_cut_meet_driver
    use brz_air_grid, only: number_of
    use brz_air_state, only: air_t, met_t, wall_t
    use brz_cut_cells, only: n_met, node_grid_t
    use brz_cut_wall_loops, only: for_each_cut_meet
    use brz_device_data, only: update_host
    use brz_errors, only: error_t
    use brz_kinds, only: int32
    use brz_lists, only: at_least, put_list
    implicit none
    private
    public :: meet_cut_walls

contains

    !> Find the states at the walls of a list of cells: wall%met, on the host.
    subroutine meet_cut_walls(air, cell, wall, err)
        type(air_t), intent(in) :: air
        integer, intent(in) :: cell(:, :) !! (3, n) indices in the box of this process
        type(wall_t), intent(inout) :: wall
        type(error_t), intent(inout) :: err

        call ask_for(air, cell, wall%met)
        if (wall%met%n == 0 .or. wall%cells%n == 0) return
        associate (met => wall%met, c => wall%cells)
            call put_list(air%on_gpu, numbers_of(air, c%nodes, met%cell(:, :met%n)), met%number, &
                          err)
            call at_least(air%on_gpu, met%state, n_met, met%n, err)
            call for_each_cut_meet(air%on_gpu, met%n, c%nodes, air%scheme, met%number, c%slot, &
                c%cell, c%place, c%shut, c%beside, c%aperture, c%area, c%middle, c%curvature, &
                c%v, c%master, c%ends, c%member, air%u, met%state, err)
            if (air%on_gpu) call update_host(met%state, err)
        end associate
    end subroutine meet_cut_walls

    !> List cells in place of those before, each once.
    pure subroutine ask_for(air, cell, met)
        type(air_t), intent(in) :: air
        integer, intent(in) :: cell(:, :) !! (3, n) indices in the box of this process
        type(met_t), intent(inout) :: met
        integer :: k

        if (.not. allocated(met%place)) then
            associate (lo => 1 - air%g, hi => air%n + air%g)
                allocate (met%place(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)), source=0_int32)
            end associate
        end if
        do k = 1, met%n
            met%place(met%cell(1, k), met%cell(2, k), met%cell(3, k)) = 0
        end do
        met%cell = cell
        met%n = 0
        do k = 1, size(cell, 2)
            if (any(cell(:, k) < 1 - air%g .or. cell(:, k) > air%n + air%g)) cycle
            associate (place => met%place(cell(1, k), cell(2, k), cell(3, k)))
                if (place > 0) cycle
                met%n = met%n + 1
                met%cell(:, met%n) = cell(:, k)
                place = met%n
            end associate
        end do
    end subroutine ask_for

    !> Numbers of cells in the grid of nodes, 0 beyond it.
    pure function numbers_of(air, nodes, cell) result(number)
        type(air_t), intent(in) :: air
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: cell(:, :) !! (3, n) indices in the box of this process
        integer :: number(size(cell, 2))
        integer :: ijk(3), k

        do k = 1, size(cell, 2)
            ijk = cell(:, k) + air%before - nodes%before
            number(k) = 0
            if (all(ijk >= 1 .and. ijk <= nodes%cells)) number(k) = number_of(nodes%n, ijk)
        end do
    end function numbers_of
end module brz_cut_meet_driver
