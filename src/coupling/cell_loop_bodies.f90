! SPDX-License-Identifier: MIT
!> Which cells of the air hold particles, the solid cells of the immersed boundary, and which have
!> changed hands. Cells go by their number in memory order, ghosts left out.
!>
!> A cell without particles that solid encloses on all sides is solid as well; one beside a plane
!> of symmetry has its image there, which is gas.
module brz_cell_loop_bodies
    use brz_cell_place, only: cell_number
    use brz_cell_shells, only: next_along
    use brz_coupling_box, only: box_t, is_gas, is_left, is_own, is_solid, place_at
    use brz_kinds, only: dp, int32, int64, int8
    use brz_particle_marks, only: is_gone
    implicit none
    private
    public :: find_cell, mark_cell, compare_row, count_kind, list_kind, cells_of_a_chunk

    integer, parameter :: cells_of_a_chunk = 64 !! that one thread looks through

contains

    !> Find the cell of each particle.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine find_cell(p, box, wide, x, fixed, cell, moved, outside)
        integer, intent(in) :: p !! particles
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(inout) :: cell(*) !! 0: outside
        integer, intent(inout) :: moved !@count particles that have changed their cell
        integer, intent(inout) :: outside !@count particles outside the box
        real(dp) :: y(3)
        integer(int32) :: c
        integer :: d

        do d = 1, 3
            y(d) = x(d, p)
        end do
        c = cell_number(y, box%lo, box%dx, box%whole, box%wraps, box%before, box%n)
        if (fixed(p) == is_gone) c = 0
        if (c /= cell(p)) moved = moved + 1
        if (c == 0) outside = outside + 1
        cell(p) = c
    end subroutine find_cell

    !> Mark the cells of the particles; all that lie in a cell write the same.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_cell(p, cell, mark)
        integer, intent(in) :: p !! particles
        integer(int32), intent(in) :: cell(*) !! 0: outside
        integer(int8), intent(inout) :: mark(*) !! all cells are marked as gas before

        if (cell(p) > 0) mark(cell(p)) = is_solid
    end subroutine mark_cell

    !> Count the cells of a row that have changed between gas and solid, and mark those that solid
    !> encloses and those that it left.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine compare_row(t, box, solid, mark, covered, cleared, own, left)
        integer, intent(in) :: t !! rows of cells along x
        type(box_t), intent(in) :: box
        integer(int8), intent(in) :: solid(*) !! the present walls, ghosts included
        integer(int8), intent(inout) :: mark(*)
        integer, intent(inout) :: covered !@count cells that hold solid now
        integer, intent(inout) :: cleared !@count cells that held solid
        integer, intent(inout) :: own, left !@count the same of this process
        integer(int64) :: at
        integer :: c, change, i

        c = (t - 1)*box%n(1) + 1
        at = place_at(box, int(c, int32))
        do i = 0, box%n(1) - 1
            if (mark(c + i) == is_gas) then
                ! no other row sees the difference: of two neighbours one is not enclosed
                if (is_enclosed(box, c + i, mark)) mark(c + i) = is_solid
            end if
            change = merge(1, 0, mark(c + i) /= is_gas) - solid(at + i)
            if (change == 0) cycle
            if (change < 0) mark(c + i) = is_left
            if (change > 0) covered = covered + 1
            if (change < 0) cleared = cleared + 1
            if (.not. is_own(box, int(c + i, int32))) cycle
            if (change > 0) own = own + 1
            if (change < 0) left = left + 1
        end do
    end subroutine compare_row

    !> Does solid stand on all sides of a cell, walls included? Never in one dimension, where a gap
    !> of one cell between two bodies is a gap.
    !@cuf attributes(host,device) &
    pure function is_enclosed(box, number, mark) result(enclosed)
        type(box_t), intent(in) :: box
        integer, intent(in) :: number !! of the cell
        integer(int8), intent(in) :: mark(*)
        logical :: enclosed
        integer(int32) :: next
        integer :: d, directions, side

        enclosed = .false.
        directions = 0
        do d = 1, 3
            if (box%whole(d) == 1) cycle
            directions = directions + 1
            do side = 1, 2
                next = next_along(box%n, box%wraps, int(number, int32), d, 2*side - 3)
                if (next == 0) then
                    if (.not. box%closed(side, d)) return
                else if (mark(next) /= is_solid) then
                    return
                end if
            end do
        end do
        enclosed = directions > 1
    end function is_enclosed

    !> Count the cells of a kind in each chunk of the map.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine count_kind(t, cells, kind, mark, top)
        integer, intent(in) :: t !! chunks
        integer, intent(in) :: cells, kind
        integer(int8), intent(in) :: mark(*)
        integer(int32), intent(inout) :: top(*)
        integer :: i, total

        total = 0
        do i = (t - 1)*cells_of_a_chunk + 1, min(t*cells_of_a_chunk, cells)
            if (mark(i) == kind) total = total + 1
        end do
        top(t) = total
    end subroutine count_kind

    !> List the cells of a kind in order; `top` holds how many are before each chunk.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine list_kind(t, cells, kind, mark, top, list)
        integer, intent(in) :: t !! chunks
        integer, intent(in) :: cells, kind
        integer(int8), intent(in) :: mark(*)
        integer(int32), intent(in) :: top(*)
        integer(int32), intent(inout) :: list(*)
        integer :: at, i

        at = top(t)
        if (top(t + 1) == at) return
        do i = (t - 1)*cells_of_a_chunk + 1, min(t*cells_of_a_chunk, cells)
            if (mark(i) /= kind) cycle
            at = at + 1
            list(at) = i
        end do
    end subroutine list_kind
end module brz_cell_loop_bodies
