! SPDX-License-Identifier: MIT
!> The cells that hold particles, for the coupling of Chen et al. as printed: which they are, their
!> particles, and the mean velocity of these. Of one process, on the CPU.
!>
!> A cell without particles that such cells enclose on all sides is one as well; one beside a plane
!> of symmetry has its image there, which is gas.
module brz_paper_cells
    use brz_air_state, only: air_t, bc_periodic, bc_wall, filled_t
    use brz_bodies, only: bodies_t
    use brz_cell_place, only: cell_middle, cell_number
    use brz_cell_shells, only: cell_at, next_along
    use brz_coupling_state, only: coupling_t
    use brz_driven_body_motion, only: read_driven_bodies
    use brz_driven_body_rules, only: add_force, carried_velocity, carries_all, carries_none, &
        driven_body_at, is_carried
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, int32, rk
    use brz_particle_marks, only: is_fixed, is_gone
    implicit none
    private
    public :: move_filled_cells, find_filled_velocities, load_filled_carriers

contains

    !> The cells that hold particles now. They are listed anew where a particle has left its cell,
    !> or particles lie elsewhere.
    subroutine move_filled_cells(air, solid, c)
        type(air_t), intent(in) :: air
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        integer(int32) :: cell
        integer :: p
        logical :: moved

        moved = solid%rebuilds /= c%wall%filled%rebuilds
        associate (box => c%box)
            do p = 1, solid%n
                cell = cell_number(solid%x(:3, p), box%lo, box%dx, box%whole, box%wraps, &
                                   box%before, box%n)
                if (solid%fixed(p) == is_gone) cell = 0
                moved = moved .or. cell /= c%cell_of(p)
                c%cell_of(p) = cell
            end do
        end associate
        c%wall%filled%rebuilds = solid%rebuilds
        if (.not. moved) return
        call list_filled(air, c)
        call bin_particles(solid%id(:solid%n), c%cell_of, c%wall%filled)
    end subroutine move_filled_cells

    !> List the cells in memory order, and mark them in the map of the air.
    subroutine list_filled(air, c)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: c
        integer :: i, ijk(3), n, p

        associate (filled => c%wall%filled, map => c%wall%solid)
            if (.not. allocated(filled%place)) allocate (filled%place(product(air%n)))
            filled%place = 0
            do p = 1, size(c%cell_of)
                if (c%cell_of(p) > 0) filled%place(c%cell_of(p)) = 1
            end do
            ! no other cell sees the difference: of two neighbours one is not enclosed
            do i = 1, size(filled%place)
                if (filled%place(i) == 0 .and. is_enclosed(air, i, filled%place)) &
                    filled%place(i) = 1
            end do
            filled%n = sum(filled%place)
            if (allocated(filled%cell)) deallocate (filled%cell, filled%touches)
            allocate (filled%cell(3, filled%n), filled%touches(filled%n))
            map = 0
            n = 0
            do i = 1, size(filled%place)
                if (filled%place(i) == 0) cycle
                n = n + 1
                ijk = cell_at(air%n, i)
                filled%cell(:, n) = ijk
                filled%touches(n) = touches_gas(air, i, filled%place)
                map(ijk(1), ijk(2), ijk(3)) = 1
            end do
            n = 0
            do i = 1, size(filled%place)
                if (filled%place(i) == 0) cycle
                n = n + 1
                filled%place(i) = n
            end do
        end associate
    end subroutine list_filled

    !> Do such cells stand on all sides of a cell, walls included? Never in one dimension, where a
    !> gap of one cell between two bodies is a gap.
    pure logical function is_enclosed(air, number, mark)
        type(air_t), intent(in) :: air
        integer, intent(in) :: number !! of the cell
        integer, intent(in) :: mark(:) !! not 0 in such cells
        integer(int32) :: next
        integer :: d, side

        is_enclosed = .false.
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do side = 1, 2
                next = next_along(air%n, air%bc(1, :) == bc_periodic, number, d, 2*side - 3)
                if (next == 0) then
                    if (air%outer(side, d) /= bc_wall) return
                else if (mark(next) == 0) then
                    return
                end if
            end do
        end do
        is_enclosed = count(air%n > 1) > 1
    end function is_enclosed

    !> Is there gas on a side of a cell? Beyond an end of the box it is in a periodic one alone.
    pure logical function touches_gas(air, number, mark)
        type(air_t), intent(in) :: air
        integer, intent(in) :: number !! of the cell
        integer, intent(in) :: mark(:) !! 0 in cells of gas
        integer(int32) :: next
        integer :: d, s

        touches_gas = .false.
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = -1, 1, 2
                next = next_along(air%n, air%bc(1, :) == bc_periodic, number, d, s)
                if (next == 0) cycle
                touches_gas = touches_gas .or. mark(next) == 0
            end do
        end do
    end function touches_gas

    !> Particles cell by cell, in the order of their numbers.
    subroutine bin_particles(id, cell, filled)
        integer(int32), intent(in) :: id(:), cell(:) !! (particles) number, cell or 0
        type(filled_t), intent(inout) :: filled
        integer :: at(size(id)), next(filled%n), c, i, p

        at(id) = [(p, p=1, size(id))]
        next = 0
        do p = 1, size(id)
            if (cell(p) > 0) next(filled%place(cell(p))) = next(filled%place(cell(p))) + 1
        end do
        if (allocated(filled%ends)) deallocate (filled%ends)
        allocate (filled%ends(filled%n + 1))
        filled%ends(1) = 0
        do c = 1, filled%n
            filled%ends(c + 1) = filled%ends(c) + next(c)
        end do
        if (.not. allocated(filled%binned)) allocate (filled%binned(size(id)))
        next = filled%ends(:filled%n)
        do i = 1, size(id)
            if (cell(at(i)) == 0) cycle
            c = filled%place(cell(at(i)))
            next(c) = next(c) + 1
            filled%binned(next(c)) = at(i)
        end do
    end subroutine bin_particles

    !> Give each such cell the mean velocity by mass of its particles: at the step where a body
    !> carries them, else as it is kept, half a step before. One that has none is at rest.
    subroutine find_filled_velocities(solid, c)
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        real(rk) :: momentum(3), total, v(3)
        integer :: b, i, k, p

        call see_bodies(solid, c)
        associate (filled => c%wall%filled)
            if (allocated(filled%v)) deallocate (filled%v)
            allocate (filled%v(3, filled%n))
            do k = 1, filled%n
                total = 0
                momentum = 0
                do i = filled%ends(k) + 1, filled%ends(k + 1)
                    p = filled%binned(i)
                    v = solid%v(:3, p)
                    b = driven_body_at(size(c%driven), c%driven, p)
                    if (is_carried(c%driven(b)%carries, solid%fixed(p) == is_fixed)) &
                        v = carried_velocity(c%driven(b), &
                                             cell_middle(solid%x(:3, p), c%box%lo, c%box%dx))
                    total = total + solid%mass(p)
                    momentum = momentum + solid%mass(p)*v
                end do
                filled%v(:, k) = momentum/max(total, tiny(total))
            end do
        end associate
    end subroutine find_filled_velocities

    !> Motion of the bodies at the step. A rigid body turns about the middle of its cells.
    subroutine see_bodies(solid, c)
        class(bodies_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: c
        real(dp), allocatable :: shifts(:, :)
        real(dp) :: shift(3)
        integer :: b, p

        call read_driven_bodies(solid, c%driven)
        c%bodies = size(c%driven)
        do b = 1, c%bodies
            if (c%driven(b)%carries /= carries_all) cycle
            associate (first => c%driven(b)%first, last => c%driven(b)%last)
                allocate (shifts(3, first:last))
                do p = first, last
                    shifts(:, p) = solid%mass(p)*(cell_middle(solid%x(:3, p), c%box%lo, &
                                                              c%box%dx) - solid%x(:3, p))
                end do
            end associate
            call exact_sums(solid%ranks, shifts, shift)
            deallocate (shifts)
            c%driven(b)%centre = c%driven(b)%centre + shift/solid%bodies(b)%rigid%mass
        end do
    end subroutine see_bodies

    !> Force and torque of the air on the bodies that carry particles, from the loads of these.
    subroutine load_filled_carriers(solid, c)
        class(bodies_t), intent(inout) :: solid
        type(coupling_t), intent(in) :: c
        real(dp), allocatable :: loads(:, :)
        real(dp) :: load(6)
        integer :: b, p

        do b = 1, c%bodies
            associate (body => c%driven(b))
                load = 0
                if (body%carries /= carries_none) then
                    allocate (loads(6, body%first:body%last), source=0.0_dp)
                    do p = body%first, body%last
                        if (.not. is_carried(body%carries, solid%fixed(p) == is_fixed)) cycle
                        call add_force(cell_middle(solid%x(:3, p), c%box%lo, c%box%dx) &
                                       - body%centre, solid%load(:, p), loads(:, p))
                    end do
                    call exact_sums(solid%ranks, loads, load)
                    deallocate (loads)
                end if
            end associate
            solid%bodies(b)%rigid%load = load
        end do
    end subroutine load_filled_carriers
end module brz_paper_cells
