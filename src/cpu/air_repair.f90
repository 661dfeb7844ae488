! SPDX-License-Identifier: MIT
!> A-posteriori fallback: the faces of a cell that would lose nearly all its density or pressure
!> take the first-order flux. A cell that this does not save is held.
!>
!> It runs after the rates of a stage are complete and before they are used, in the order of the
!> grid and by one thread: few faces fall back, and the result must not depend on threads. A flux is
!> replaced for both its cells, on walls too, so nothing is lost.
module brz_air_repair
    use brz_kinds, only: dp, int8, rk
    use brz_air_bad_cells, only: anywhere, grow, is_beside, is_counted, is_own, join_bad
    use brz_air_lost, only: first_lost
    use brz_air_state, only: air_ok, air_t, air_unphysical, bc_inside, bc_periodic, &
        lines_per_block, wall_t
    use brz_air_faces, only: flux_at
    use brz_air_sweep, only: stage_t
    use brz_air_totals, only: show_outflow
    use brz_air_walls, only: image_of
    use brz_grid_lines, only: first_cell_of, n_blocks, n_lines, turned
    use brz_positivity, only: is_kept, is_number, is_physical, is_sound, most_holds
    use brz_runge_kutta, only: repair_passes
    use brz_running_total, only: add_to_total
    use brz_scheme, only: first_order, max_var, scheme_t
    implicit none
    private
    public :: repair

    integer, parameter :: bit_lowered = -1, bit_closed = 2 !! plus the direction, in air%lowered
    integer, parameter :: bit_held = 6 !! there too

contains

    !> Repair the rates of a stage where the sweeps found suspects. `status` is set if in vain.
    subroutine repair(air, wall, last, stage, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: last !! direction of the last sweep, whose blocks hold the suspects
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: status
        integer :: pass, m, n_bad, n_faces, before

        n_faces = 0
        call find_suspects(air, wall, last, stage, n_bad)
        if (air%fallback .and. air%scheme%reconstruction /= first_order) then
            do pass = 1, repair_passes
                before = n_faces
                call join_bad(air, last, n_bad)
                do m = 1, n_bad
                    call lower_faces(air, wall, stage, air%bad(:, m), n_faces)
                end do
                if (.not. anywhere(air, n_faces > before)) exit
                call find_bad_neighbours(air, wall, stage, n_faces, n_bad)
            end do
        end if
        do m = 1, n_faces
            if (is_counted(air, air%repair(4, m), air%repair(1:3, m))) &
                air%fallback_faces = air%fallback_faces + 1
        end do
        if (air%fallback) call hold_cells(air, wall, last, stage, n_bad, n_faces)
        do m = 1, n_bad
            if (status == air_ok) call judge(air, stage, air%bad(:, m), status)
        end do
        if (first_lost(air, last, status /= air_ok)) status = air_unphysical
        do m = 1, n_faces
            air%lowered(air%repair(1, m), air%repair(2, m), air%repair(3, m)) = 0
        end do
    end subroutine repair

    !> Close the faces of the cells that no flux of first order saves: nothing passes in this stage,
    !> and the cell keeps its state. That may leave a neighbour too little, which is then held too;
    !> a wall beside a held cell feels no push from it. What is no number is a fault and not held.
    subroutine hold_cells(air, wall, last, stage, n_bad, n_faces)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: last !! direction of the last sweep
        type(stage_t), intent(in) :: stage
        integer, intent(inout) :: n_bad !! cells that are bad
        integer, intent(inout) :: n_faces !! faces whose flux is not that of the scheme
        real(rk) :: old(max_var), new(max_var)
        integer :: m, n, pass

        do pass = 1, most_holds
            n = 0
            do m = 1, n_bad
                if (.not. is_own(air, air%bad(:, m))) cycle
                call euler_step(air, stage, air%bad(:, m), old, new)
                if (is_kept(stage%floors, old, new) .or. .not. is_number(new)) cycle
                n = n + 1
                air%bad(:, n) = air%bad(:, m)
            end do
            if (.not. anywhere(air, n > 0)) exit
            call join_bad(air, last, n)
            do m = 1, n
                call hold_cell(air, wall, stage, air%bad(:, m), n_faces)
            end do
            call find_bad_neighbours(air, wall, stage, n_faces, n_bad)
        end do
    end subroutine hold_cells

    !> List the bad gas cells in the blocks that have suspects.
    subroutine find_suspects(air, wall, last, stage, n_bad)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: last !! direction of the last sweep
        type(stage_t), intent(in) :: stage
        integer, intent(out) :: n_bad
        integer :: b, i, line, cell(3)

        n_bad = 0
        do b = 1, n_blocks(air%n, last)
            if (air%suspect(b) == 0) cycle
            do line = (b - 1)*lines_per_block + 1, min(b*lines_per_block, n_lines(air%n, last))
                call first_cell_of(air%n, last, line, cell)
                do i = 1, air%n(last)
                    cell(last) = i
                    call add_if_bad(air, wall, stage, cell, n_bad)
                end do
            end do
        end do
    end subroutine find_suspects

    !> List the bad gas cells next to the faces that are not as the scheme has them.
    subroutine find_bad_neighbours(air, wall, stage, n_faces, n_bad)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: n_faces !! their number
        integer, intent(out) :: n_bad
        integer :: d, m, s, cell(3)

        n_bad = 0
        do m = 1, n_faces
            d = air%repair(4, m)
            do s = 0, 1
                cell = air%repair(1:3, m)
                cell(d) = cell(d) + s
                if (air%bc(1, d) == bc_periodic) cell(d) = image_of(air, d, cell(d))
                if (cell(d) < 1 .or. cell(d) > air%n(d)) cycle
                call add_if_bad(air, wall, stage, cell, n_bad)
            end do
        end do
    end subroutine find_bad_neighbours

    !> Add a gas cell to the list of bad ones if its Euler step is.
    subroutine add_if_bad(air, wall, stage, cell, n_bad)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        integer, intent(inout) :: n_bad
        real(rk) :: old(max_var), new(max_var)

        if (wall%present) then
            if (wall%solid(cell(1), cell(2), cell(3)) == 1) return
        end if
        call euler_step(air, stage, cell, old, new)
        if (is_sound(air%n_var, stage%floors, old, new)) return
        n_bad = n_bad + 1
        call grow(air%bad, n_bad)
        air%bad(:, n_bad) = cell
    end subroutine add_if_bad

    !> State of a cell and its Euler step.
    pure subroutine euler_step(air, stage, cell, old, new)
        type(air_t), intent(in) :: air
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        real(rk), intent(out) :: old(max_var), new(max_var)

        old = 0
        new = 0
        old(:air%n_var) = air%u(cell(1), cell(2), cell(3), :)
        new(:air%n_var) = old(:air%n_var) + stage%dt*air%rate(cell(1), cell(2), cell(3), :)
    end subroutine euler_step

    !> Give up on a cell whose density or internal energy is still not positive, or not a number.
    subroutine judge(air, stage, cell, status)
        type(air_t), intent(inout) :: air
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        integer, intent(inout) :: status
        real(rk) :: old(max_var), new(max_var)

        if (.not. is_own(air, cell)) return
        call euler_step(air, stage, cell, old, new)
        if (is_physical(new)) return
        status = air_unphysical
        air%bad_cell = cell
        air%bad_state = new(1:5)
    end subroutine judge

    !> Give the faces of a cell the first-order flux, unless they have it already.
    subroutine lower_faces(air, wall, stage, cell, n_faces)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        integer, intent(inout) :: n_faces
        integer :: d, s, low(3)
        logical :: done

        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = -1, 0
                low = face_of(air, d, s, cell)
                if (.not. is_beside(air, d, low)) cycle
                call mark_face(air, d, low, bit_lowered, n_faces, done)
                if (.not. done) call replace_flux(air, wall, stage, d, low, .false.)
            end do
        end do
    end subroutine lower_faces

    !> Hold a cell, unless it is held: let nothing pass its faces; its rates are then exactly zero.
    !> Of a cell beside the box only the face between matters here.
    subroutine hold_cell(air, wall, stage, cell, n_faces)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: cell(3)
        integer, intent(inout) :: n_faces
        integer :: bits, d, s, low(3)
        logical :: done, own

        own = is_own(air, cell)
        if (own) then
            bits = air%lowered(cell(1), cell(2), cell(3))
            if (btest(bits, bit_held)) return
            air%lowered(cell(1), cell(2), cell(3)) = int(ibset(bits, bit_held), int8)
            air%held_cells = air%held_cells + 1
        end if
        do d = 1, 3
            if (air%n(d) == 1) cycle
            do s = -1, 0
                low = face_of(air, d, s, cell)
                if (.not. is_beside(air, d, low)) cycle
                call mark_face(air, d, low, bit_closed, n_faces, done)
                if (.not. done) call replace_flux(air, wall, stage, d, low, .true.)
            end do
        end do
        if (own) air%rate(cell(1), cell(2), cell(3), :) = 0
    end subroutine hold_cell

    !> Cell below a face of a cell: its lower (s = -1) or upper (0) one in direction d.
    pure function face_of(air, d, s, cell) result(low)
        type(air_t), intent(in) :: air
        integer, intent(in) :: d, s
        integer, intent(in) :: cell(3)
        integer :: low(3)

        low = cell
        low(d) = low(d) + s
        if (low(d) == 0 .and. air%bc(1, d) == bc_periodic) low(d) = air%n(d)
    end function face_of

    !> Note that a face is lowered or closed; `done` if it is already.
    subroutine mark_face(air, d, low, bit, n_faces, done)
        type(air_t), intent(inout) :: air
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face
        integer, intent(in) :: bit !! bit_lowered or bit_closed
        integer, intent(inout) :: n_faces
        logical, intent(out) :: done
        integer :: bits

        bits = air%lowered(low(1), low(2), low(3))
        done = btest(bits, bit + d)
        if (done) return
        air%lowered(low(1), low(2), low(3)) = int(ibset(bits, bit + d), int8)
        if (btest(bits, bit_lowered + d)) return ! it is in the list
        n_faces = n_faces + 1
        call grow(air%repair, n_faces)
        air%repair(:, n_faces) = [low, d]
    end subroutine mark_face

    !> Replace the flux through one face in the rates, the impulses and the outflow: by that of
    !> first order, or by none.
    subroutine replace_flux(air, wall, stage, d, low, shut)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face
        logical, intent(in) :: shut !! by none
        type(scheme_t) :: scheme, lower
        real(rk) :: f(max_var), df(max_var), p, dp_star, speed
        real(dp) :: area, out
        integer :: m, high(3)

        high = low
        high(d) = high(d) + 1
        if (air%bc(1, d) == bc_periodic) high(d) = image_of(air, d, high(d))
        lower = air%scheme
        lower%reconstruction = first_order
        scheme = air%scheme
        if (shut .and. btest(air%lowered(low(1), low(2), low(3)), bit_lowered + d)) scheme = lower
        call flux_at(air, wall, scheme, d, low, f, p, speed)
        df = 0
        dp_star = 0
        if (.not. shut) call flux_at(air, wall, lower, d, low, df, dp_star, speed)
        df = df - f
        dp_star = dp_star - p
        area = product(air%dx)/air%dx(d)
        call change(air, wall, d, low, -df, -dp_star, speed)
        call change(air, wall, d, high, df, dp_star, speed)
        if (wall%present) &
            call change_impulse(wall, d, low, high, real(stage%share*area, rk)*dp_star)
        if (air%bc(1, d) == bc_periodic) return
        if (low(d) > 0 .and. low(d) < air%n(d)) return
        if (air%bc(merge(1, 2, low(d) == 0), d) == bc_inside) return
        out = merge(-stage%share, stage%share, low(d) == 0)*area
        do m = 1, air%n_var
            call add_to_total(air%left(turned(m, d)), out*df(m))
        end do
        call show_outflow(air)
    end subroutine replace_flux

    !> Add a change of flux into a cell to its rate; the load of a wall is not kept in the ledger.
    subroutine change(air, wall, d, cell, df, push, speed)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: cell(3)
        real(rk), intent(in) :: df(max_var)
        !! what flows in, per area and time, normal momentum in slot 2
        real(rk), intent(in) :: push !! the part of it that is pressure on the wall [Pa]
        real(rk), intent(in) :: speed !! velocity of the wall [m/s]
        real(rk) :: f(max_var)
        integer :: m

        if (cell(d) < 1 .or. cell(d) > air%n(d)) return
        f = df
        if (wall%present) then
            if (wall%solid(cell(1), cell(2), cell(3)) == 1) then
                f(2) = f(2) - push
                f(5) = f(5) - push*speed
            end if
        end if
        do m = 1, air%n_var
            air%rate(cell(1), cell(2), cell(3), turned(m, d)) = &
                air%rate(cell(1), cell(2), cell(3), turned(m, d)) + f(m)*real(1/air%dx(d), rk)
        end do
    end subroutine change

    !> Add to the impulse of the wall face between two cells, if it is one.
    subroutine change_impulse(wall, d, low, high, impulse)
        type(wall_t), intent(inout) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3), high(3) !! cells below and above
        real(rk), intent(in) :: impulse !! [N s]
        integer :: f

        do f = 1, wall%n_faces
            if (wall%face(4, f) /= d) cycle
            if ((wall%face(5, f) > 0 .and. all(wall%face(1:3, f) == low)) &
                .or. (wall%face(5, f) < 0 .and. all(wall%face(1:3, f) == high))) then
                if (impulse /= 0) wall%impulse(f) = wall%impulse(f) + impulse
            end if
        end do
    end subroutine change_impulse
end module brz_air_repair
