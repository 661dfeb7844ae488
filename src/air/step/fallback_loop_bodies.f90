! SPDX-License-Identifier: MIT
!> A-posteriori limiting (MOOD), called the fallback, cell by cell: marked cells and their
!> neighbours are computed again from all their faces, of which those of marked cells take the
!> first-order flux. Point physics.
!>
!> A cell that this does not save is held: nothing passes its faces, and it keeps its state. That
!> may leave a neighbour too little, which is then held too. What is no number is a fault and not
!> held. A cell carries the numbers of the passes that found it bad and held it, so that the marks
!> made in a pass do not change the faces of that pass, whatever the order of the cells. Both cells
!> of a face see the same marks: nothing is lost.
module brz_fallback_loop_bodies
    use brz_air_grid, only: grid_t, place_of, variable_in_slot
    use brz_boundary_codes, only: bc_inside
    use brz_face_loop_bodies, only: face_at
    use brz_kinds, only: int64, int8, rk
    use brz_positivity, only: limit_step, is_fixed, is_kept, is_lowered, is_number, is_physical, &
        is_sound, lost_mark, new_mark
    use brz_scheme, only: first_order, max_var, scheme_t
    implicit none
    private
    public :: is_touched, redo_rates, mark_cell, put_edge, count_marked, to_redo, to_lose, to_hold
    public :: neighbour

    ! what a pass over the cells is for: compute marked cells and their neighbours again; or look at
    ! marked cells alone: is the Euler step a state at all, must they be held?
    integer, parameter :: to_redo = 0, to_lose = 1, to_hold = 2

contains

    !> True if the flux through the faces of a cell is not that of the scheme.
    !@cuf attributes(host,device) &
    pure function is_bad(pass, at, bad) result(found)
        integer, intent(in) :: pass !! marks up to this one count
        integer(int64), intent(in) :: at !! place of the cell
        integer(int8), intent(in) :: bad(*)
        logical :: found
        integer :: mark

        mark = bad(at)
        found = is_lowered(pass, mark) .or. is_fixed(pass, mark)
    end function is_bad

    !> Place of the neighbour below (s = -1) or above (1) in direction d, across a periodic boundary
    !> too.
    !@cuf attributes(host,device) &
    pure function neighbour(d, s, grid, at, index) result(place)
        integer, intent(in) :: d, s
        type(grid_t), intent(in) :: grid
        integer(int64), intent(in) :: at !! place of the cell
        integer, intent(in) :: index !! of the cell along d
        integer(int64) :: place
        integer :: m

        m = s
        if (index + s < 1) m = s + grid%around(d)
        if (index + s > grid%n(d)) m = s - grid%around(d)
        place = at + m*grid%step(d)
    end function neighbour

    !> True if a pass looks at a cell.
    !@cuf attributes(host,device) &
    pure function is_touched(pass, task, grid, i, j, k, bad) result(touched)
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: i, j, k !! cell
        integer(int8), intent(in) :: bad(*)
        logical :: touched
        integer(int64) :: at
        integer :: d, index

        at = place_of(grid, i, j, k)
        touched = is_bad(pass, at, bad) .or. (task /= to_redo .and. bad(at) /= 0)
        do d = 1, 3
            if (grid%n(d) == 1 .or. task /= to_redo) cycle
            index = merge(i, merge(j, k, d == 2), d == 1)
            touched = touched .or. is_bad(pass, neighbour(d, -1, grid, at, index), bad) &
                .or. is_bad(pass, neighbour(d, 1, grid, at, index), bad)
        end do
    end function is_touched

    !> Rates of a cell from all its faces.
    !@cuf attributes(host,device) &
    pure subroutine redo_rates(pass, grid, scheme, i, j, k, u, rate, bad, edge)
        integer, intent(in) :: pass !! marks up to this one count
        type(grid_t), intent(in) :: grid
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: i, j, k !! cell
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: rate(*) !! where u has the cell
        integer(int8), intent(in) :: bad(*)
        real(rk), intent(inout) :: edge(*) !! (lines, n_var, 2) fluxes through the outer faces
        integer :: c, d

        do c = 1, max_var
            if (c <= grid%n_var) rate(place_of(grid, i, j, k) + (c - 1)*grid%apart) = 0
        end do
        !dir$ nounroll
        do d = 1, 3
            if (grid%n(d) > 1) call add_faces(d, pass, grid, scheme, i, j, k, u, rate, bad, edge)
        end do
    end subroutine redo_rates

    !> Add the rates by the two faces of direction d.
    !@cuf attributes(host,device) &
    pure subroutine add_faces(d, pass, grid, scheme, i, j, k, u, rate, bad, edge)
        integer, intent(in) :: d, pass
        type(grid_t), intent(in) :: grid
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: i, j, k !! cell
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: rate(*), edge(*)
        integer(int8), intent(in) :: bad(*)
        type(scheme_t) :: this
        real(rk) :: below(max_var), f(max_var)
        integer(int64) :: at, p
        integer :: c, index, line, mark(2), s

        at = place_of(grid, i, j, k)
        index = merge(i, merge(j, k, d == 2), d == 1)
        line = merge(j, i, d == 1) + (merge(j, k, d == 3) - 1)*grid%n(merge(2, 1, d == 1))
        this = scheme
        !dir$ nounroll
        do s = -1, 1, 2
            mark(1) = bad(at)
            mark(2) = bad(neighbour(d, s, grid, at, index))
            this%reconstruction = scheme%reconstruction
            if (is_lowered(pass, mark(1)) .or. is_lowered(pass, mark(2))) &
                this%reconstruction = first_order
            call face_at(d, grid, this, at + merge(-grid%step(d), 0, s == -1), &
                index + merge(-1, 0, s == -1), u, f)
            if (is_fixed(pass, mark(1)) .or. is_fixed(pass, mark(2))) then
                do c = 1, max_var
                    f(c) = 0
                end do
            end if
            call put_edge(d, grid, line, index + merge(-1, 0, s == -1), f, edge)
            do c = 1, max_var
                p = at + (variable_in_slot(c, d) - 1)*grid%apart
                if (s == 1 .and. c <= grid%n_var) &
                    rate(p) = rate(p) + (below(c) - f(c))*grid%inverse_dx(d)
                below(c) = f(c)
            end do
        end do
    end subroutine add_faces

    !> Keep the flux through an outer face, if this is one.
    !@cuf attributes(host,device) &
    pure subroutine put_edge(d, grid, line, face, f, edge)
        integer, intent(in) :: d !! direction
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: line !! of the direction, from 1
        integer, intent(in) :: face !! above the cell with this index
        real(rk), intent(in) :: f(max_var) !! flux, normal momentum in slot 2
        real(rk), intent(inout) :: edge(*) !! (lines, n_var, 2)
        integer(int64) :: at
        integer :: c

        if (face /= 0 .and. face /= grid%n(d)) return
        at = grid%before(d) + line
        if (face /= 0) at = at + int(grid%lines, int64)*grid%n_var
        do c = 1, max_var
            if (c <= grid%n_var) &
                edge(at + int(variable_in_slot(c, d) - 1, int64)*grid%lines) = f(c)
        end do
    end subroutine put_edge

    !> Mark a cell as bad where its Euler step leaves too little density or pressure, or is no
    !> number; as held, or lost, where that is asked.
    !@cuf attributes(host,device) &
    pure subroutine mark_cell(n_var, floors, pass, task, at, old, euler, bad, found)
        integer, intent(in) :: n_var !! conserved variables
        real(rk), intent(in) :: floors(3) !! see floors_of
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo, ...
        integer(int64), intent(in) :: at !! place of the cell
        real(rk), intent(in) :: old(max_var), euler(max_var)
        integer(int8), intent(inout) :: bad(*)
        integer, intent(inout) :: found(1) !! 1 is set where there is such a cell
        integer :: mark

        if (task == to_redo) then
            if (is_sound(n_var, floors, old, euler)) return
            if (bad(at) /= 0) return
            mark = merge(new_mark, pass + 1, pass >= limit_step)
        else if (task == to_hold) then
            if (is_kept(floors, old, euler) .or. .not. is_number(euler)) return
            if (bad(at) >= limit_step) return
            mark = bad(at) + limit_step*(pass/limit_step + 1)
        else
            if (is_physical(euler)) return
            mark = lost_mark
        end if
        bad(at) = int(mark, int8)
        found(1) = 1
    end subroutine mark_cell

    !> Count the faces that took the first-order flux, or, in a pass that holds, the cells held. A
    !> face between the boxes of two processes counts below it.
    !@loop_body if(n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine count_marked(t, pass, grid, bad, number)
        integer, intent(in) :: t !! cells
        integer, intent(in) :: pass !! marks up to this one count; those that hold count if it does
        type(grid_t), intent(in) :: grid
        integer(int8), intent(in) :: bad(*)
        integer, intent(inout) :: number !@count of them
        integer(int64) :: at
        integer :: d, i, index, j, k
        logical :: here

        i = mod(t - 1, grid%n(1)) + 1
        j = mod((t - 1)/grid%n(1), grid%n(2)) + 1
        k = (t - 1)/grid%n(1)/grid%n(2) + 1
        at = place_of(grid, i, j, k)
        if (pass >= limit_step) then
            if (bad(at) >= limit_step) number = number + 1
            return
        end if
        here = is_bad(pass, at, bad)
        do d = 1, 3
            if (grid%n(d) == 1) cycle
            index = merge(i, merge(j, k, d == 2), d == 1)
            if (here .or. is_bad(pass, neighbour(d, 1, grid, at, index), bad)) number = number + 1
            if (here .and. index == 1 .and. grid%around(d) == 0 &
                .and. grid%bc(1, d) /= bc_inside) number = number + 1
        end do
    end subroutine count_marked
end module brz_fallback_loop_bodies
