! SPDX-License-Identifier: MIT
!> The gas at a point, for gauges.
module brz_air_probe
    use brz_kinds, only: dp, rk
    use brz_air_state, only: air_t, bc_symmetry, bc_wall, cell_gamma, wall_t
    use brz_gas, only: to_primitive
    use brz_scheme, only: mixture_gamma
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: gas_state_at, cells_around, has_point, sees_gas

    integer, parameter, public :: probe_reach = 2
    !! cells to look around if those beside a point hold only solid

contains

    !> Density, velocity and pressure at a point, trilinear between the gas cells around it.
    !>
    !> Cells without gas are left out and the weights of the others made to sum to one. Where all
    !> eight hold none the gas cell nearest to the point counts, within two cells; zero if there is
    !> none. A cut cell counts with the state at its wall (wall%met), so that within half a cell of
    !> a body and in it a gauge has the pressure that the body feels. Within half a cell of the
    !> boundary, and beyond it, the value of the last cell continues; towards a wall it goes over to
    !> the state at the wall, which bears what the gas that hits it brings, at a plane of symmetry
    !> the normal velocity to nothing.
    !>
    !> On several processes `around` holds the eight cells, which may be those of others. Without it
    !> this one must have the point (has_point).
    subroutine gas_state_at(air, wall, point, state, around)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(in) :: point(3) !! [m]
        real(dp), intent(out) :: state(5) !! density, velocity, pressure
        real(rk), intent(in), optional :: around(:, 0:)
        !! (n_var, 0:7) conserved variables of the cells as cells_around has them; no walls
        real(rk) :: gamma
        real(dp) :: x(3), total, weight
        integer :: low(3), cell(3), m

        call place_between(air, point, low, x)
        if (present(around)) then
            state = 0
            total = 0
            do m = 0, 7
                weight = weight_of(corner(m), x)
                if (.not. weight > 0) cycle
                state = state + weight*primitive_of(air, around(:, m))
                total = total + weight
            end do
        else
            call mix_cells(air, wall, point, low, x, state, total)
        end if
        cell = low + nint(x) - air%before ! nearest
        if (total > 0) then
            state = state/total
        else
            call nearest_gas(air, wall, cell, low + x - air%before, state)
        end if
        if (present(around)) then
            gamma = gamma_of(air, around(:, sum(nint(x)*[1, 2, 4])))
        else
            gamma = cell_gamma(air, cell(1), cell(2), cell(3))
        end if
        call meet_walls(air, point, gamma, total > 0, state)
    end subroutine gas_state_at

    !> Between the last cell and a wall at the boundary: a part of the state at the wall. In a
    !> corner each wall changes density and pressure of the gas in the ratio in which it would
    !> alone. At a plane of symmetry, where the gas beyond is the image of this, the normal velocity
    !> is nothing; not that of the nearest gas, which is on one side of it.
    subroutine meet_walls(air, point, gamma, between, state)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: point(3) !! [m]
        real(rk), intent(in) :: gamma !! of the gas in the nearest cell
        logical, intent(in) :: between !! the point is between cells of gas
        real(dp), intent(inout) :: state(5) !! density, velocity, pressure
        real(dp) :: beyond(2), gas(5)
        real(rk) :: p_star, rho_star
        integer :: d, s

        if (.not. state(1) > 0) return
        gas = state
        do d = 1, 3
            if (air%n(d) == 1) cycle
            beyond = [air%lo(d) - point(d), point(d) - air%lo(d)]/air%dx(d) &
                + [0.5_dp, 0.5_dp - air%whole(d)] ! the last centre, in cells
            do s = 1, 2
                if (beyond(s) <= 0) cycle
                beyond(s) = min(2*beyond(s), 1.0_dp)
                if (air%outer(s, d) == bc_symmetry .and. between) &
                    state(1 + d) = (1 - beyond(s))*gas(1 + d)
                if (air%outer(s, d) /= bc_wall) cycle
                call wall_star(gamma, real(gas(1), rk), real(gas(5), rk), &
                               real((2*s - 3)*gas(1 + d), rk), p_star, rho_star)
                state(1) = (gas(1) + beyond(s)*(rho_star - gas(1)))*ratio(state(1), gas(1))
                state(1 + d) = (1 - beyond(s))*gas(1 + d)
                state(5) = (gas(5) + beyond(s)*(p_star - gas(5)))*ratio(state(5), gas(5))
            end do
        end do
    end subroutine meet_walls

    !> What walls met before have made of a number; 1 where there was nothing.
    elemental real(dp) function ratio(now, before)
        real(dp), intent(in) :: now, before

        ratio = 1
        if (before > 0) ratio = now/before
    end function ratio

    !> The eight cells of the grid that a point lies between; the last continue at the boundary.
    pure subroutine cells_around(air, point, cells)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: point(3) !! [m]
        integer, intent(out) :: cells(3, 0:7) !! bit d-1 of the number: the upper one in direction d
        real(dp) :: x(3)
        integer :: low(3), m

        call place_between(air, point, low, x)
        do m = 0, 7
            cells(:, m) = min(low + corner(m), air%whole)
        end do
    end subroutine cells_around

    !> True in the process that has the cell nearest to a point.
    pure logical function has_point(air, point)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: point(3) !! [m]
        real(dp) :: x(3)
        integer :: low(3), nearest(3)

        call place_between(air, point, low, x)
        nearest = low + nint(x) - air%before
        has_point = all(nearest >= 1 .and. nearest <= air%n)
    end function has_point

    !> False where all cells that count at a point hold solid: gas_state_at then takes the nearest
    !> that does not. The process must have the point (has_point).
    pure logical function sees_gas(air, wall, point)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(in) :: point(3) !! [m]
        real(dp) :: x(3)
        integer :: low(3), m

        call place_between(air, point, low, x)
        sees_gas = .false.
        do m = 0, 7
            if (weight_of(corner(m), x) > 0) &
                sees_gas = sees_gas .or. .not. holds_solid(wall, low + corner(m) - air%before)
        end do
    end function sees_gas

    !> Which of the eight cells m is: 1 for the upper one in a direction, 0 for the lower.
    pure function corner(m)
        integer, intent(in) :: m !! bit d-1: the upper one in direction d
        integer :: corner(3)

        corner = ibits(m, [0, 1, 2], 1)
    end function corner

    !> What one of the eight cells counts at a place between them.
    pure real(dp) function weight_of(corner, x)
        integer, intent(in) :: corner(3)
        real(dp), intent(in) :: x(3) !! see place_between

        weight_of = product(merge(x, 1 - x, corner == 1))
    end function weight_of

    !> Lowest of the eight cells around a point, and its place between them.
    pure subroutine place_between(air, point, low, x)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: point(3) !! [m]
        integer, intent(out) :: low(3)
        real(dp), intent(out) :: x(3) !! 0: at the centre of the lower cell, 1: of the upper

        x = min(max((point - air%lo)/air%dx + 0.5_dp, 1.0_dp), real(air%whole, dp))
        low = min(floor(x), max(air%whole - 1, 1))
        x = x - low
    end subroutine place_between

    !> True if a cell holds solid.
    pure logical function holds_solid(wall, cell)
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: cell(3)

        holds_solid = .false.
        if (wall%present) holds_solid = wall%solid(cell(1), cell(2), cell(3)) /= 0
    end function holds_solid

    !> Place of a cell in the list of those that touch walls, 0: it does not.
    pure integer function wall_of(wall, cell) result(k)
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: cell(3)

        k = 0
        if (wall%met%n == 0 .or. .not. allocated(wall%met%state)) return
        k = wall%met%place(cell(1), cell(2), cell(3))
        if (k > 0) then
            if (.not. wall%met%state(6, k) > 0) k = 0
        end if
    end function wall_of

    !> Cells of gas around a point: their mean, by the weights of these.
    !>
    !> Those that touch a wall count with the state there. Where the point is within half a cell of
    !> that the others do not count, and from there to a whole cell by part: a wave is at them some
    !> time before or after it is at the wall, which in a history of the pressure is much. Between a
    !> plane of symmetry and the cell beside it the image of that cell counts as well.
    subroutine mix_cells(air, wall, point, low, x, state, total)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(in) :: point(3) !! [m]
        integer, intent(in) :: low(3)
        real(dp), intent(in) :: x(3) !! see place_between
        real(dp), intent(out) :: state(5)
        real(dp), intent(out) :: total !! sum of the weights; 0: no gas
        real(dp) :: away, gas(5), part, seen, weight, y(3)
        integer :: cell(3), k, m

        y = x + shift_by_image(air, point)
        state = 0
        total = 0
        gas = 0
        seen = 0
        away = 0
        do m = 0, 7
            weight = weight_of(corner(m), x)
            cell = low + corner(m) - air%before
            if (.not. weight > 0) cycle
            if (holds_solid(wall, cell)) cycle
            k = wall_of(wall, cell)
            if (k == 0) then
                gas = gas + weight*primitive_of(air, air%u(cell(1), cell(2), cell(3), :))
                seen = seen + weight
            else
                state = state + weight*wall%met%state(1:5, k)
                total = total + weight
                away = away + weight*(wall%met%state(7, k) &
                                      - sum(wall%met%state(8:10, k)*(y - corner(m))))
            end if
        end do
        part = 1
        if (total > 0) part = min(max(2*away/total - 1, 0.0_dp), 1.0_dp)
        state = state + part*gas
        total = total + part*seen
    end subroutine mix_cells

    !> Where the wall beside the last cell before a plane of symmetry, and that beside its image,
    !> are on the mean from a point between the two, as seen from the centre of the cell [cells].
    pure function shift_by_image(air, point) result(shift)
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: point(3) !! [m]
        real(dp) :: shift(3)
        real(dp) :: beyond
        integer :: d, s

        shift = 0
        do d = 1, 3
            do s = 1, 2
                if (air%whole(d) == 1 .or. air%outer(s, d) /= bc_symmetry) cycle
                beyond = (point(d) - air%lo(d))/air%dx(d) - air%whole(d) + 0.5_dp
                if (s == 1) beyond = 0.5_dp - (point(d) - air%lo(d))/air%dx(d)
                beyond = min(beyond, 0.5_dp)
                if (beyond > 0) shift(d) = (2*s - 3)*2*beyond*(1 - beyond)
            end do
        end do
    end function shift_by_image

    !> Primitive state of a cell.
    pure function primitive_of(air, u) result(state)
        type(air_t), intent(in) :: air
        real(rk), intent(in) :: u(:) !! (n_var) its conserved variables
        real(dp) :: state(5)
        real(rk) :: q(5), w(5)

        q = u(1:5)
        call to_primitive(gamma_of(air, u), q, w)
        state = w
    end function primitive_of

    !> Ratio of specific heats of the gas in a cell [-].
    pure real(rk) function gamma_of(air, u)
        type(air_t), intent(in) :: air
        real(rk), intent(in) :: u(:) !! (n_var) its conserved variables

        gamma_of = air%scheme%gamma
        if (air%scheme%mixture) gamma_of = mixture_gamma(air%scheme, u(6)/u(1))
    end function gamma_of

    !> State of the gas cell nearest to a place in solid; zero if none is in reach.
    subroutine nearest_gas(air, wall, centre, place, state)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: centre(3) !! cell of the place
        real(dp), intent(in) :: place(3) !! in cells, whole numbers at their centres
        real(dp), intent(out) :: state(5)
        integer :: i, j, k, cell(3), lo(3), hi(3), of
        real(dp) :: distance, least

        state = 0
        least = huge(least)
        lo = max(1 - air%before, centre - probe_reach)
        hi = min(air%whole - air%before, centre + probe_reach)
        do k = lo(3), hi(3)
            do j = lo(2), hi(2)
                do i = lo(1), hi(1)
                    cell = [i, j, k]
                    if (holds_solid(wall, cell)) cycle
                    distance = sum(((cell - place)*air%dx)**2)
                    if (distance >= least) cycle
                    least = distance
                    of = wall_of(wall, cell)
                    if (of > 0) then
                        state = wall%met%state(1:5, of)
                    else
                        state = primitive_of(air, air%u(i, j, k, :))
                    end if
                end do
            end do
        end do
    end subroutine nearest_gas
end module brz_air_probe
