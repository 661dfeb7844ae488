! SPDX-License-Identifier: MIT
!> What several processes tell each other of the coupling: who gets which particles. A process is
!> asked for by a box of cells; marks are a row for each box.
module brz_coupling_ghost_loop_bodies
    use brz_coupling_box, only: box_t
    use brz_kinds, only: dp, int32, rk
    use brz_particle_marks, only: is_gone
    implicit none
    private
    public :: mark_coupling_ghost, miss_coupling_ghost, take_load

contains

    !> mark = 1 for a particle of a body that is in a box, else 0; boxes may reach a layer of cells
    !> beyond the grid.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine mark_coupling_ghost(i, row, bodies, body, boxes, asks, box, wide, x, fixed, &
    mark)
        integer, intent(in) :: i !! places
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: bodies, boxes
        integer(int32), intent(in) :: body(2, *) !! first and last particle
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(inout) :: mark(*) !! (places, boxes)
        integer :: ijk(3), r

        ijk = cell_about(box, x(1, i), fixed(i))
        do r = 1, boxes
            mark((r - 1)*row + i) = 0
            if (.not. is_in(asks(1, r), ijk)) cycle
            if (is_listed(bodies, body, i)) mark((r - 1)*row + i) = 1
        end do
    end subroutine mark_coupling_ghost

    !> Count the particles of bodies that are in a box without being listed for it.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine miss_coupling_ghost(i, row, bodies, body, boxes, asks, box, wide, x, fixed, &
                               listed, missed)
        integer, intent(in) :: i !! places
        integer, intent(in) :: row !! marks of a box
        integer, intent(in) :: bodies, boxes
        integer(int32), intent(in) :: body(2, *) !! first and last particle
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer(int32), intent(in) :: listed(*) !! the marks when they were listed
        integer, intent(inout) :: missed !@count particles, once for each box
        integer :: ijk(3), r

        ijk = cell_of_grid(box, x(1, i), fixed(i))
        do r = 1, boxes
            if (listed((r - 1)*row + i) == 1) cycle
            if (.not. is_in(asks(1, r), ijk)) cycle
            if (is_listed(bodies, body, i)) missed = missed + 1
        end do
    end subroutine miss_coupling_ghost

    !> True for a particle of one of the bodies: no ghost.
    !@cuf attributes(host,device) &
    pure function is_listed(bodies, body, i) result(listed)
        integer, intent(in) :: bodies
        integer(int32), intent(in) :: body(2, bodies) !! first and last particle
        integer, intent(in) :: i
        logical :: listed
        integer :: b

        listed = .false.
        do b = 1, bodies
            listed = listed .or. (i >= body(1, b) .and. i <= body(2, b))
        end do
    end function is_listed

    !> Cell of the grid that holds a particle; 0, 0, 0 outside, or where it is gone. One in the
    !> layer beyond the grid counts to the last cell, as to cut cells.
    !@cuf attributes(host,device) &
    pure function cell_of_grid(box, x, fixed) result(ijk)
        type(box_t), intent(in) :: box
        real(dp), intent(in) :: x(3) !! [m]
        integer(int32), intent(in) :: fixed
        integer :: d, ijk(3)
        logical :: outside

        ijk = cell_about(box, x, fixed)
        outside = .false.
        do d = 1, 3
            outside = outside .or. ijk(d) < 0 .or. ijk(d) > box%whole(d) + 1
            ijk(d) = max(1, min(box%whole(d), ijk(d)))
        end do
        do d = 1, 3
            if (outside) ijk(d) = 0
        end do
    end function cell_of_grid

    !> The same of a grid that goes on beyond its ends, where cells are -1, 0, whole + 1 and
    !> whole + 2, those farther out -2 and whole + 3; -2, -2, -2 where the particle is gone.
    !@cuf attributes(host,device) &
    pure function cell_about(box, x, fixed) result(ijk)
        type(box_t), intent(in) :: box
        real(dp), intent(in) :: x(3) !! [m]
        integer(int32), intent(in) :: fixed
        real(dp) :: s
        integer :: d, ijk(3)

        do d = 1, 3
            ijk(d) = -2
        end do
        if (fixed == is_gone) return
        do d = 1, 3
            s = (x(d) - box%lo(d))/box%dx(d)
            if (box%wraps(d)) s = s - box%whole(d)*floor(s/box%whole(d))
            ijk(d) = floor(min(max(s, -3.0_dp), box%whole(d) + 2.0_dp)) + 1
            if (box%whole(d) == 1) ijk(d) = 1
        end do
    end function cell_about

    !> True for a cell of the grid that is asked for.
    !@cuf attributes(host,device) &
    pure function is_in(ask, ijk) result(inside)
        integer(int32), intent(in) :: ask(6) !! lowest and highest cell
        integer, intent(in) :: ijk(3)
        logical :: inside
        integer :: d

        inside = .true.
        do d = 1, 3
            inside = inside .and. ijk(d) >= ask(d) .and. ijk(d) <= ask(3 + d)
        end do
    end function is_in

    !> The load of a particle, or the stress of its faces, from the process in whose box it is: none
    !> comes from others.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine take_load(k, boxes, first, asks, box, wide, x, fixed, stride_d, stride_p, &
                              place, parts, came, load)
        integer, intent(in) :: k !! copies of particles that others have, box by box
        integer, intent(in) :: boxes
        integer(int32), intent(in) :: first(*)
        !! (boxes + 1, 2) first copy of each, and how far its particles are behind those in `place`
        integer(int32), intent(in) :: asks(6, *) !! lowest and highest cell of the grid
        type(box_t), intent(in) :: box
        integer, intent(in) :: wide !! rows of x
        real(dp), intent(in) :: x(wide, *) !! [m]
        integer(int32), intent(in) :: fixed(*)
        integer, intent(in) :: stride_d, stride_p !! distances of parts and particles in load
        integer(int32), intent(in) :: place(*) !! of particles, those without copies elsewhere too
        integer, intent(in) :: parts !! of a load, or of a stress
        real(rk), intent(in) :: came(parts, *) !! loads of the copies [N]
        real(rk), intent(inout) :: load(*)
        integer :: d, p, r

        do r = 1, boxes
            if (k < first(r + 1)) exit
        end do
        p = place(k + first(boxes + 1 + r))
        if (.not. is_in(asks(1, r), cell_of_grid(box, x(1, p), fixed(p)))) return
        do d = 1, parts
            load(1 + (d - 1)*stride_d + (p - 1)*stride_p) = came(d, k)
        end do
    end subroutine take_load

end module brz_coupling_ghost_loop_bodies
