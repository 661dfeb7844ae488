! SPDX-License-Identifier: MIT
!> Rates of the gas in cut cells: the fluxes of the scheme through the open shares of faces, the
!> pressure at the wall on its area, and one state for all cells of a cluster.
!>
!> A face is that of the plain scheme where all faces of its stencil are open. Else it is MUSCL, in
!> which a cell that is shut on one side has no slope. Both cells of a face compute the same flux.
!>
!> With W the gas volume that is integrated and U the state, content W U and volume follow
!> d(WU)/dt = -sum n a A F - (0, p* A, p* v.A) and dW/dt = v.A, which keep a uniform stream with
!> walls that move with it (the geometric conservation law). The rate of a cluster is such that the
!> plain update of a stage, u0 + b (u - u0 + dt rate), is that of its content over its volume.
module brz_cut_loop_bodies
    use brz_air_boundary, only: beyond_wall
    use brz_air_grid, only: brick_of, cell_at, is_between, stage_t, variable_in_slot
    use brz_boundary_codes, only: bc_outflow
    use brz_cut_cells, only: node_grid_t
    use brz_cut_wall_loop_bodies, only: meet_wall, state_at
    use brz_face_flux, only: end_face, end_fraction
    use brz_fallback_loop_bodies, only: is_touched, mark_cell, neighbour, put_edge, to_lose, to_redo
    use brz_kinds, only: int32, int64, int8, rk
    use brz_positivity, only: is_fixed, is_lowered, lost_mark
    use brz_scheme, only: first_order, max_var, mixture_gamma, muscl_cells, reach_of, scheme_t, &
        weno3_cells
    implicit none
    private
    public :: cut_rate, cut_join, cut_finish, cut_count_moving, cut_reach

contains

    !> Rates of the content of a listed cell through its faces and at its wall.
    !@loop_body if(27*n >= worth_threads) schedule(dynamic, 64)
    !@cuf attributes(host,device) &
    pure subroutine cut_rate(s, nodes, scheme, stage, pass, cell, place, beside, shut, aperture, &
        area, &
                             middle, curvature, v, master, bad, u, edge, rate, push)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks of `bad` up to this one count
        integer(int32), intent(in) :: cell(*), place(*), beside(6, *)
        integer(int32), intent(in) :: shut(*)
        real(rk), intent(in) :: aperture(6, *), area(3, *), middle(3, *), curvature(6, *), v(3, *)
        integer(int32), intent(in) :: master(*)
        integer(int8), intent(in) :: bad(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(inout) :: edge(*) !! (lines, n_var, 2) fluxes through the outer faces
        real(rk), intent(inout) :: rate(max_var, *), push(3, *)
        real(rk) :: f(max_var), p, w(5), gamma
        integer(int64) :: at
        integer :: c, d, ijk(3), mark, row, side
        logical :: held

        do c = 1, max_var
            rate(c, s) = 0
            f(c) = 0
        end do
        do d = 1, 3
            push(d, s) = 0
        end do
        if (place(s) == 0 .or. .not. is_between(nodes%n, nodes%own, cell(s))) return
        ijk = cell_at(nodes%n, cell(s))
        if (shut(s) /= 0) then
            do d = 1, 3
                do side = 0, 1
                    if (nodes%n(d) > 1) call keep_edge(d, nodes, ijk, side, 0.0_rk, f, edge)
                end do
            end do
            return
        end if
        at = place(s)
        mark = bad(at)
        held = is_fixed(pass, mark)
        call state_at(nodes, scheme, at, u, gamma, w)
        p = w(5)
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            do side = 0, 1
                row = 2*d - 1 + side
                if (.not. aperture(row, s) > 0) then
                    call keep_edge(d, nodes, ijk, side, 0.0_rk, f, edge)
                    cycle
                end if
                call flux_at(d, side, nodes, scheme, pass, s, at, ijk(d), beside, aperture, bad, &
                    u, f)
                call keep_edge(d, nodes, ijk, side, aperture(row, s), f, edge)
                if (.not. held) f(2) = f(2) - p
                do c = 1, nodes%grid%n_var
                    rate(variable_in_slot(c, d), s) = rate(variable_in_slot(c, d), s) &
                        + (1 - 2*side)*aperture(row, s)*f(c)*nodes%grid%inverse_dx(d)
                end do
            end do
        end do
        if (held) return
        call push_wall(s, nodes, scheme, stage, ijk, beside, aperture, area, middle, curvature, v, &
                       master, cell, place, is_lowered(pass, mark), u, w, gamma, rate, push)
    end subroutine cut_rate

    !> Flux through the low or high face of a listed cell, as if all of it were open.
    !@cuf attributes(host,device) &
    pure subroutine flux_at(d, side, nodes, scheme, pass, s, at, index, beside, aperture, bad, u, f)
        integer, intent(in) :: d, side !! direction; 0: low, 1: high
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: pass, s
        integer(int64), intent(in) :: at !! place of the cell
        integer, intent(in) :: index !! of the cell along d
        integer(int32), intent(in) :: beside(6, *)
        real(rk), intent(in) :: aperture(6, *)
        integer(int8), intent(in) :: bad(*)
        real(rk), intent(in) :: u(*)
        real(rk), intent(out) :: f(max_var)
        type(scheme_t) :: this
        real(rk) :: q(5, -2:3), gamma(-2:3), y(-2:3)
        real(rk) :: apart(-2:2) ! open share of the face above each cell of the stencil
        integer(int64) :: below, from
        integer :: c, held(-2:3), low, m, mark(2)

        below = at - merge(nodes%grid%step(d), 0, side == 0)
        low = index - merge(1, 0, side == 0)
        mark(1) = bad(at)
        mark(2) = bad(neighbour(d, 2*side - 1, nodes%grid, at, index))
        do c = 1, max_var
            f(c) = 0
        end do
        if (is_fixed(pass, mark(1)) .or. is_fixed(pass, mark(2))) return
        call shares_along(d, side, nodes, s, low, beside, aperture, apart)
        this = scheme
        call choose_scheme(is_lowered(pass, mark(1)) .or. is_lowered(pass, mark(2)), apart, this)
        do m = -2, 3
            from = below + m*nodes%grid%step(d)
            ! a cell that is shut on one side takes itself for its neighbour there
            if (m == -1 .and. .not. apart(-1) > 0) from = below
            if (m == 2 .and. .not. apart(1) > 0) from = below + nodes%grid%step(d)
            do c = 1, 5
                q(c, m) = u(from + (variable_in_slot(c, d) - 1)*nodes%grid%apart)
            end do
            y(m) = 0
            gamma(m) = scheme%gamma
            held(m) = 0
            if (beyond_wall(scheme, nodes%grid%bc(1, d), nodes%grid%bc(2, d), nodes%grid%n(d), &
                            low + m)) held(m) = 1
            if (nodes%grid%n_var < 6 .or. held(m) == 1) cycle
            y(m) = u(from + 5*nodes%grid%apart)/q(1, m)
            gamma(m) = mixture_gamma(scheme, y(m))
        end do
        call end_face(this, gamma, held, q, f)
        f(6) = 0
        if (nodes%grid%n_var == 6) f(6) = f(1)*end_fraction(this, held, f(1), y)
    end subroutine flux_at

    !> Open shares of the five faces of the stencil of a face of a listed cell.
    !@cuf attributes(host,device) &
    pure subroutine shares_along(d, side, nodes, s, low, beside, aperture, apart)
        integer, intent(in) :: d, side !! direction; 0: low, 1: high
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: s
        integer, intent(in) :: low !! index of the cell below the face
        integer(int32), intent(in) :: beside(6, *)
        real(rk), intent(in) :: aperture(6, *)
        real(rk), intent(out) :: apart(-2:2)
        integer :: entry, first, from, index, m, row
        logical :: turned, wraps

        do m = -2, 2
            apart(m) = 1
        end do
        wraps = nodes%wraps(d)
        ! beside a cell that is not listed, whose sweep knows of no shares
        if (beside(2*d - 1 + side, s) == 0 &
            .and. (wraps .or. (low >= 1 .and. low < nodes%cells(d)))) return
        do m = -2, 2
            ! the face above cell index; beyond a mirror that of its image, while a periodic
            ! direction goes on
            index = low + m
            turned = .not. wraps .and. (index < 0 .or. index > nodes%cells(d))
            if (turned) then
                if (nodes%grid%bc(merge(1, 2, index < 0), d) == bc_outflow) cycle
                index = merge(-index, 2*nodes%cells(d) - index, index < 0)
                if (index < 0 .or. index > nodes%cells(d)) cycle
            end if
            ! walk from this cell to the one below that face or, at the low end, above it
            from = low + merge(1, 0, side == 0)
            row = 2*d
            first = index
            if (index == 0 .and. .not. wraps) then
                first = 1
                row = 2*d - 1
            end if
            entry = walk(d, s, from, first, beside)
            if (entry == 0 .and. (wraps .or. (index >= 1 .and. index < nodes%cells(d)))) then
                entry = walk(d, s, from, index + 1, beside)
                row = 2*d - 1
            end if
            if (entry > 0) apart(m) = aperture(row, entry)
        end do
    end subroutine shares_along

    !> Entry of the cell with an index on the line of a listed cell; 0 where the way there leads
    !> through one that is not listed.
    !@cuf attributes(host,device) &
    pure function walk(d, s, from, to, beside) result(entry)
        integer, intent(in) :: d !! direction
        integer, intent(in) :: s, from !! entry, and its index along d
        integer, intent(in) :: to !! index that is looked for
        integer(int32), intent(in) :: beside(6, *)
        integer :: entry, i

        entry = s
        do i = 1, abs(to - from)
            if (entry == 0) return
            entry = beside(merge(2*d, 2*d - 1, to > from), entry)
        end do
    end function walk

    !> The reconstruction of a face: that of the scheme where all faces of the stencil are open.
    !@cuf attributes(host,device) &
    pure subroutine choose_scheme(lowered, apart, scheme)
        logical, intent(in) :: lowered !! to first order
        real(rk), intent(in) :: apart(-2:2)
        type(scheme_t), intent(inout) :: scheme
        integer :: m, reach
        logical :: whole

        if (lowered) scheme%reconstruction = first_order
        if (scheme%reconstruction < weno3_cells) return
        reach = reach_of(scheme) - 1
        whole = .true.
        do m = -reach, reach
            whole = whole .and. apart(m) >= 1
        end do
        if (.not. whole) scheme%reconstruction = muscl_cells
    end subroutine choose_scheme

    !> Keep what passes an outer face of the grid, if this is one.
    !@cuf attributes(host,device) &
    pure subroutine keep_edge(d, nodes, ijk, side, share, f, edge)
        integer, intent(in) :: d, side !! direction; 0: low, 1: high
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: ijk(3) !! cell
        real(rk), intent(in) :: share !! of the face that is open
        real(rk), intent(in) :: f(max_var) !! flux, normal momentum in slot 2
        real(rk), intent(inout) :: edge(*) !! (lines, n_var, 2) fluxes through the outer faces
        real(rk) :: passes(max_var)
        integer :: at(3), c, e, line

        if (ijk(d) /= nodes%own(d, 1 + side)) return
        do e = 1, 3
            at(e) = ijk(e) - nodes%own(e, 1) + 1
        end do
        e = merge(2, 1, d == 1)
        line = merge(at(2), at(1), d == 1) &
               + (merge(at(2), at(3), d == 3) - 1)*(nodes%own(e, 2) - nodes%own(e, 1) + 1)
        do c = 1, max_var
            passes(c) = share*f(c)
        end do
        call put_edge(d, nodes%grid, line, side*nodes%grid%n(d), passes, edge)
    end subroutine keep_edge

    !> Pressure at the wall on its area, and its work.
    !@cuf attributes(host,device) &
    pure subroutine push_wall(s, nodes, scheme, stage, ijk, beside, aperture, area, middle, &
                              curvature, v, master, cell, place, lowered, u, w, gamma, rate, push)
        integer, intent(in) :: s
        type(node_grid_t), intent(in) :: nodes
        type(scheme_t), intent(in) :: scheme
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: ijk(3)
        integer(int32), intent(in) :: beside(6, *)
        real(rk), intent(in) :: aperture(6, *), area(3, *), middle(3, *), curvature(6, *), v(3, *)
        integer(int32), intent(in) :: master(*), cell(*), place(*)
        logical, intent(in) :: lowered !! to first order
        real(rk), intent(in) :: u(*), w(5), gamma
        real(rk), intent(inout) :: rate(max_var, *), push(3, *)
        real(rk) :: n(3), p_star, rho_star, share, whole
        integer :: d

        call meet_wall(s, nodes, scheme, ijk, beside, aperture, area, middle, curvature, v, &
                       master, cell, place, lowered, u, w, gamma, whole, n, p_star, rho_star)
        if (.not. whole > 0) return
        do d = 1, 3
            if (nodes%n(d) == 1) cycle
            share = stage%push(d)/nodes%area(d) ! of the stage in the step [s]
            push(d, s) = share*p_star*area(d, s)
            rate(1 + d, s) = rate(1 + d, s) - (p_star - w(5))*area(d, s)/nodes%volume
            rate(5, s) = rate(5, s) - p_star*v(d, s)*area(d, s)/nodes%volume
        end do
    end subroutine push_wall

    !> Rate of a cluster, for all its members: from the rates of their contents; and the Euler step
    !> of its content, over the volume before, by which it is judged: what the walls sweep is no
    !> change of the content, and changes no sign.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_join(s, nodes, stage, place, master, ends, member, volume, swept, rate, u, &
                             u_start, joined, euler)
        integer, intent(in) :: s !! entries; masters alone do something
        type(node_grid_t), intent(in) :: nodes
        type(stage_t), intent(in) :: stage
        integer(int32), intent(in) :: place(*), master(*), ends(*), member(*)
        real(rk), intent(in) :: volume(*), swept(*), rate(max_var, *)
        real(rk), intent(in) :: u(*), u_start(*) !! the latter from the second stage on
        real(rk), intent(inout) :: joined(max_var, *)
        real(rk), intent(inout) :: euler(max_var, *)
        real(rk) :: change, gain, next, now, old, total
        integer(int64) :: at
        integer :: c, q

        if (master(s) /= s .or. place(s) == 0) return
        now = 0
        gain = 0
        do q = ends(s) + 1, ends(s + 1)
            now = now + volume(member(q))
            gain = gain + swept(member(q))
        end do
        if (.not. now > 0) then ! shut
            do c = 1, nodes%grid%n_var
                joined(c, s) = 0
            end do
            return
        end if
        old = now + stage%passed*gain
        next = now + stage%weight*(old + gain - now)
        do c = 1, nodes%grid%n_var
            total = 0
            do q = ends(s) + 1, ends(s + 1)
                total = total + rate(c, member(q))
            end do
            at = place(s) + (c - 1)*nodes%grid%apart
            ! at the first stage u is the start
            change = 0
            if (stage%first == 0) change = u(at) - u_start(at)
            do q = ends(s) + 1, ends(s + 1)
                euler(c, member(q)) = u(at) + stage%dt*total/old
            end do
            total = ((old - next)*change + stage%dt*total - gain*(u(at) - change))/(next*stage%dt)
            do q = ends(s) + 1, ends(s + 1)
                joined(c, member(q)) = total
            end do
        end do
    end subroutine cut_join

    !> Put the rates of a listed cell where the cells of the air have theirs or, with `ahead`, its
    !> next state; and mark the cell as its Euler step says, see mark_cell.
    !@loop_body if(27*n >= worth_threads) schedule(static)
    !@cuf attributes(host,device) &
    pure subroutine cut_finish(s, nodes, stage, pass, task, ahead, cell, place, shut, joined, &
                               euler, u, u_start, to, bad, found)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        type(stage_t), intent(in) :: stage
        integer, intent(in) :: pass !! marks up to this one count
        integer, intent(in) :: task !! to_redo: all cells; else those that it looks at
        integer, intent(in) :: ahead !! 1: `to` gets the next state, 0: rates
        integer(int32), intent(in) :: cell(*), place(*), shut(*)
        real(rk), intent(in) :: joined(max_var, *), euler(max_var, *)
        real(rk), intent(in) :: u(*), u_start(*) !! the latter for the next state
        real(rk), intent(inout) :: to(*)
        integer(int8), intent(inout) :: bad(*)
        integer, intent(inout) :: found(1) !! 1 is set where a cell is bad; all set the same
        real(rk) :: new(max_var), old(max_var)
        integer(int64) :: at, p
        integer :: c, ijk(3)

        if (place(s) == 0 .or. .not. is_between(nodes%n, nodes%own, cell(s))) return
        at = place(s)
        ijk = cell_at(nodes%n, cell(s))
        if (task /= to_redo) then
            if (.not. is_touched(pass, task, nodes%grid, ijk(1), ijk(2), ijk(3), bad)) return
        end if
        do c = 1, max_var
            old(c) = 0
            new(c) = 0
            if (c > nodes%grid%n_var) cycle
            p = at + (c - 1)*nodes%grid%apart
            old(c) = u(p)
            new(c) = euler(c, s)
            if (task /= to_redo) cycle
            if (ahead == 0) to(p) = joined(c, s)
            if (ahead == 1) to(p) = u_start(p) + stage%weight*(u(p) - u_start(p) &
                                                               + stage%dt*joined(c, s))
        end do
        if (shut(s) /= 0) return
        call mark_cell(nodes%grid%n_var, stage%floors, pass, task, at, old, new, bad, found)
        if (ahead == 0 .or. task /= to_lose .or. bad(at) /= lost_mark) return
        do c = 1, nodes%grid%n_var ! what it would have become
            to(at + (c - 1)*nodes%grid%apart) = new(c)
        end do
    end subroutine cut_finish

    !> Count the cells whose wall moves.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_count_moving(s, v, moving)
        integer, intent(in) :: s !! entries
        real(rk), intent(in) :: v(3, *)
        integer, intent(inout) :: moving !@count cells

        if (max(abs(v(1, s)), abs(v(2, s)), abs(v(3, s))) > 0) moving = moving + 1
    end subroutine cut_count_moving

    !> The brick of a listed cell is reached; all that lie in a brick write the same.
    !@loop_body
    !@cuf attributes(host,device) &
    pure subroutine cut_reach(s, nodes, cell, place, reached)
        integer, intent(in) :: s !! entries
        type(node_grid_t), intent(in) :: nodes
        integer(int32), intent(in) :: cell(*), place(*)
        integer(int8), intent(inout) :: reached(*) !! (bricks)
        integer :: d, ijk(3)

        if (place(s) == 0 .or. .not. is_between(nodes%n, nodes%own, cell(s))) return
        ijk = cell_at(nodes%n, cell(s))
        do d = 1, 3
            ijk(d) = ijk(d) - nodes%own(d, 1) + 1
        end do
        reached(brick_of(nodes%grid, ijk(1), ijk(2), ijk(3))) = 1_int8
    end subroutine cut_reach
end module brz_cut_loop_bodies
