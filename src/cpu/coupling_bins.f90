! SPDX-License-Identifier: MIT
!> Particles by air cell: which cells hold solid, and which particles a cell holds.
module brz_coupling_bins
    use brz_air_state, only: air_t
    use brz_bin_loops, only: each_find_home, each_sort_bin
    use brz_cell_loops, only: each_find_cell, each_mark_cell
    use brz_cell_shells, only: number_of
    use brz_column_loops, only: each_find_above
    use brz_boxes, only: box_t, widened
    use brz_coupling_box, only: is_gas
    use brz_coupling_state, only: coupling_t, side_of
    use brz_lists, only: at_least, running_sum
    use brz_ranks, only: several
    use brz_solid_part, only: parcels_t
    use brz_solid_state, only: solid_t, worth_threads
    implicit none
    private
    public :: find_cells, mark_cells, index_faces, fill_bins

contains

    !> Find the air cell of each particle. `moved` is false when none has changed its cell.
    subroutine find_cells(solid, coupling, moved)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        logical, intent(out) :: moved
        integer :: changes

        changes = 0
        coupling%outside = 0
        call each_find_cell(solid%n, coupling%box, size(solid%x, 1), solid%x, solid%fixed, &
                            coupling%cell_of, changes, coupling%outside)
        ! where they were sorted anew, so are the particles of a cell
        moved = changes > 0 .or. solid%rebuilds /= coupling%rebuilds
        coupling%rebuilds = solid%rebuilds
    end subroutine find_cells

    !> Map of the cells that hold particles, in coupling%mark.
    subroutine mark_cells(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: j, k

        !$omp parallel do if(size(coupling%mark) >= worth_threads) schedule(static) collapse(2)
        do k = 1, size(coupling%mark, 3)
            do j = 1, size(coupling%mark, 2)
                coupling%mark(:, j, k) = is_gas
            end do
        end do
        call each_mark_cell(solid%n, coupling%cell_of, coupling%mark)
    end subroutine mark_cells

    !> Wall faces by solid cell and side, from the lists of build_walls.
    subroutine index_faces(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        integer :: f, c, n

        n = coupling%wall%n_cells
        call at_least(coupling%cell, n)
        call at_least(coupling%gas, coupling%wall%n_faces)
        call at_least(coupling%rows, coupling%wall%n_faces)
        if (allocated(coupling%above)) then
            if (size(coupling%above, 2) < n) deallocate (coupling%above)
        end if
        if (.not. allocated(coupling%above)) allocate (coupling%above(6, n + n/4))
        !$omp parallel do if(n >= worth_threads) schedule(static)
        do c = 1, n
            coupling%cell(c) = number_of(coupling%box%n, in_window(coupling, &
                                                                   coupling%wall%cell(:, c)))
        end do
        !$omp parallel do if(n >= worth_threads) schedule(static)
        do f = 1, coupling%wall%n_faces
            coupling%gas(f) = number_of(coupling%box%n, in_window(coupling, &
                                                                  coupling%wall%face(1:3, f)))
            coupling%rows(f) = side_of(coupling%wall%face(4, f), coupling%wall%face(5, f))
        end do
        call each_find_above(n, coupling%box, coupling%cell, coupling%wall%solid, &
                             coupling%wall%index, coupling%wall%face_of, coupling%above)
        if (several(air%part%ranks)) call list_shared_faces(air, coupling)
    end subroutine index_faces

    !> Cell of the window from that of the box.
    pure function in_window(coupling, cell) result(ijk)
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: cell(3)
        integer :: ijk(3)

        ijk = cell - coupling%wall%lo + 1
    end function in_window

    !> List the faces whose gas is in the box of one process and whose columns may reach into that
    !> of another, in the order of the grid.
    subroutine list_shared_faces(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        type(box_t) :: near(0:air%part%ranks%n - 1) !! boxes and what loads them
        integer :: r, layers

        layers = coupling%box%layers + 2
        do r = 0, ubound(near, 1)
            near(r) = widened(air%part%boxes(r), [layers, layers, layers])
        end do
        associate (boxes => air%part%boxes, me => air%part%ranks%rank, part => coupling%part)
            call list_faces(spread(boxes(me), 1, size(near)), near, part%faces_out)
            call list_faces(boxes, spread(near(me), 1, size(near)), part%faces_in)
        end associate

    contains

        !> Faces with gas in a box and near another, for all processes but this one.
        subroutine list_faces(has, wants, parcels)
            type(box_t), intent(in) :: has(0:), wants(0:)
            type(parcels_t), intent(inout) :: parcels
            integer :: f, n, round, gas(3)

            if (.not. allocated(parcels%first)) allocate (parcels%first(0:size(has)))
            if (.not. allocated(parcels%place)) allocate (parcels%place(0))
            do round = 1, 2 ! count, then list
                n = 0
                do r = 0, ubound(has, 1)
                    parcels%first(r) = n + 1
                    if (r == air%part%ranks%rank) cycle
                    do f = 1, coupling%wall%n_faces
                        gas = air%before + coupling%wall%face(1:3, f)
                        if (any(gas < has(r)%lo .or. gas > has(r)%hi)) cycle
                        if (any(gas < wants(r)%lo .or. gas > wants(r)%hi)) cycle
                        n = n + 1
                        if (round == 2) parcels%place(n) = f
                    end do
                end do
                parcels%first(size(has)) = n + 1
                if (round == 2 .or. size(parcels%place) >= n) cycle
                deallocate (parcels%place)
                allocate (parcels%place(n + n/4))
            end do
        end subroutine list_faces
    end subroutine list_shared_faces

    !> Sort the particles by solid cell.
    subroutine fill_bins(solid, coupling)
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: p, c, n

        n = coupling%wall%n_cells
        call at_least(coupling%ends, n + 2)
        call each_find_home(solid%n, coupling%box, coupling%cell_of, coupling%wall%index, &
                            coupling%place_of)
        ! ends(c+1) counts cell c, then is its start, which the fill moves to its end
        coupling%ends(1:n + 2) = 0
        do p = 1, solid%n
            c = coupling%place_of(p)
            if (c > 0) coupling%ends(c + 1) = coupling%ends(c + 1) + 1
        end do
        call running_sum(coupling%ends(2:), n, p)
        do p = 1, solid%n
            c = coupling%place_of(p)
            if (c == 0) cycle
            coupling%ends(c + 1) = coupling%ends(c + 1) + 1
            coupling%binned(coupling%ends(c + 1)) = p
        end do
        call each_sort_bin(n, solid%id, coupling%ends, coupling%binned)
    end subroutine fill_bins
end module brz_coupling_bins
