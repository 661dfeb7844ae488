! SPDX-License-Identifier: MIT
!> Where the cells of a Cartesian grid lie in memory, and what a stage needs: plain data for
!> kernels. Point physics.
module brz_air_grid
    use brz_kinds, only: dp, int32, int64, rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: grid_t, stage_t, grid_of, place_of, variable_in_slot, cell_at, number_of, is_between
    public :: first_cell, line_start, lines_along, faces_of_bricks
    public :: rate_none, rate_in_flux, rate_in_new, near_cut
    public :: faces_of_a_thread
    public :: brick, column, rest_t, brick_of, brick_start, layers_around, nodes_along

    integer, parameter :: rate_none = 0, rate_in_flux = 1, rate_in_new = 2
    !! where the rates of the directions before one are: nowhere, the x fluxes, the next state
    integer, parameter :: near_cut = 2 !! what cut cells have more in the map of cells near walls
    integer, parameter :: brick = 8 !! cells per side of a brick, which is active or not as a whole
    integer, parameter :: column = 8*brick !! cells along z that a thread of a GPU looks through
    integer, parameter :: longest = 8 !! bricks along a line for one thread
    integer, parameter :: faces_of_a_thread = 2 !! of direction x, side by side
    integer, parameter :: threads_wanted = 200000 !! to fill a GPU a few times

    !> Arrays run over (1-g1:n1+g1, 1-g2:n2+g2, 1-g3:n3+g3, n_var). What belongs to the two ends of
    !> lines, of all directions one after the other, is kept in arrays (lines, n_var, 2).
    type :: grid_t
        integer :: n(3) !! cells
        integer :: g(3) !! ghost layers
        integer :: n_var !! conserved variables
        integer :: step(3) !! distance of neighbours in memory
        integer(int64) :: apart !! distance of two variables in memory
        real(rk) :: inverse_dx(3) !! 1/side of a cell, 0 in directions that are not modelled [1/m]
        integer :: bc(2, 3) !! boundary conditions, as in air_t
        integer :: around(3) !! cells around a periodic direction, else 0
        integer :: before(3) !! lines of the directions before
        integer :: lines !! of all directions
        integer :: segment(3) !! cells along a line that one thread takes, whole bricks
        integer :: bricks(3) !! of cells, see brz_brick_loop_bodies
        integer :: brick_step(3) !! distance of neighbouring bricks in the map of all
        integer :: prior(3) !! rates of the directions before: rate_none, ...
        integer :: last !! the last direction that is modelled
        integer :: walls !! 1: at ends of lines are some that need their flux, 2: bodies are there
    end type grid_t

    !> Gas that nothing has reached.
    type :: rest_t
        real(rk) :: u(max_var) !! its conserved variables
        real(rk) :: momentum !! what counts as rounding [kg/(m2 s)]
    end type rest_t

    !> What the kernels must know of a stage of the time integration.
    type :: stage_t
        real(rk) :: dt !! time step [s]
        real(rk) :: weight !! of the new state
        real(rk) :: passed !! part of the step that the state before the stage has made
        integer :: first !! 1: the first stage
        real(rk) :: floors(3) !! of the Euler step, see floors_of
        real(dp) :: leaves(3) !! area of a face times its share of dt, by direction [m2 s]
        real(rk) :: push(3) !! the same, for the impulse on walls
    end type stage_t

contains

    !> Grid of an array.
    pure function grid_of(n, g, n_var, dx, bc, periodic) result(grid)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: g(3) !! ghost layers
        integer, intent(in) :: n_var !! conserved variables
        real(rk), intent(in) :: dx(3) !! sides of a cell [m]
        integer, intent(in) :: bc(2, 3) !! boundary conditions
        integer, intent(in) :: periodic !! the one that goes on from the other end
        type(grid_t) :: grid
        integer :: d

        grid%n = n
        grid%g = g
        grid%n_var = n_var
        grid%step = [1, n(1) + 2*g(1), (n(1) + 2*g(1))*(n(2) + 2*g(2))]
        grid%apart = int(grid%step(3), int64)*(n(3) + 2*g(3))
        grid%bricks = (n - 1)/brick + 1
        grid%brick_step = [1, grid%bricks(1), grid%bricks(1)*grid%bricks(2)]
        grid%inverse_dx = merge(1/dx, 0.0_rk, n > 1)
        grid%bc = bc
        grid%around = merge(n, 0, bc(1, :) == periodic)
        grid%lines = 0
        grid%walls = 0
        grid%prior = rate_none
        grid%last = 1
        do d = 1, 3
            grid%before(d) = grid%lines
            grid%segment(d) = brick*min(longest, max(1, &
                int(product(int(n, int64))/(brick*threads_wanted))))
            if (n(d) == 1) cycle
            grid%lines = grid%lines + lines_along(grid, d)
            if (d > 1) grid%prior(d) = merge(rate_in_flux, rate_none, n(1) > 1)
            grid%last = d
        end do
        if (n(2) > 1 .and. n(3) > 1) grid%prior(3) = rate_in_new
    end function grid_of

    !> Place of a cell among the values of a variable, from 1.
    !@cuf attributes(host,device) &
    pure function place_of(grid, i, j, k) result(place)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: i, j, k !! cell
        integer(int64) :: place

        place = i + grid%g(1) + int(j + grid%g(2) - 1, int64)*grid%step(2) &
            + int(k + grid%g(3) - 1, int64)*grid%step(3)
    end function place_of

    !> Indices of a cell from its number.
    !@cuf attributes(host,device) &
    pure function cell_at(n, number) result(ijk)
        integer, intent(in) :: n(3)
        integer(int32), intent(in) :: number
        integer :: ijk(3), rest

        rest = number - 1
        ijk(1) = mod(rest, n(1)) + 1
        rest = rest/n(1)
        ijk(2) = mod(rest, n(2)) + 1
        ijk(3) = rest/n(2) + 1
    end function cell_at

    !> Number of a cell from its indices, counted from 1 in memory order.
    !@cuf attributes(host,device) &
    pure function number_of(n, ijk) result(number)
        integer, intent(in) :: n(3), ijk(3)
        integer(int32) :: number

        number = ijk(1) + n(1)*((ijk(2) - 1) + n(2)*(ijk(3) - 1))
    end function number_of

    !> True for a cell in a range, from its number.
    !@cuf attributes(host,device) &
    pure function is_between(n, range, number) result(between)
        integer, intent(in) :: n(3)
        integer, intent(in) :: range(3, 2) !! first and last cell
        integer(int32), intent(in) :: number
        logical :: between
        integer :: d, ijk(3)

        ijk = cell_at(n, number)
        between = .true.
        do d = 1, 3
            between = between .and. ijk(d) >= range(d, 1) .and. ijk(d) <= range(d, 2)
        end do
    end function is_between

    !> Number of lines of cells along direction d.
    !@cuf attributes(host,device) &
    pure function lines_along(grid, d) result(lines)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer :: lines

        lines = grid%n(merge(2, 1, d == 1))*grid%n(merge(2, 3, d == 3))
    end function lines_along

    !> Faces of bricks at the two ends of the lines, of one of the ends.
    pure function faces_of_bricks(n, bricks) result(faces)
        integer, intent(in) :: n(3), bricks(3) !! cells and bricks in each direction
        integer :: faces

        faces = sum(product(bricks)/bricks, n > 1)
    end function faces_of_bricks

    !> Place of the first cell of a line; the faster transverse index runs first.
    !@cuf attributes(host,device) &
    pure function line_start(grid, d, line) result(place)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer, intent(in) :: line !! from 1
        integer(int64) :: place
        integer :: at(3)

        call first_cell(grid, d, line, at)
        place = place_of(grid, at(1), at(2), at(3))
    end function line_start

    !> First cell of a line.
    !@cuf attributes(host,device) &
    pure subroutine first_cell(grid, d, line, at)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer, intent(in) :: line !! from 1
        integer, intent(out) :: at(3)
        integer :: a, b, n

        n = grid%n(merge(2, 1, d == 1))
        b = (line - 1)/n + 1
        a = line - (b - 1)*n
        at(1) = merge(1, a, d == 1)
        at(2) = merge(a, merge(1, b, d == 2), d == 1)
        at(3) = merge(1, b, d == 3)
    end subroutine first_cell

    !> Place of the brick of a cell in the map of all.
    !@cuf attributes(host,device) &
    pure function brick_of(grid, i, j, k) result(place)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: i, j, k !! cell
        integer :: place

        place = (i - 1)/brick + 1 + (j - 1)/brick*grid%brick_step(2) &
            + (k - 1)/brick*grid%brick_step(3)
    end function brick_of

    !> Place of the first brick of a line of cells.
    !@cuf attributes(host,device) &
    pure function brick_start(grid, d, line) result(place)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: d !! direction
        integer, intent(in) :: line !! from 1
        integer :: place, at(3)

        call first_cell(grid, d, line, at)
        place = brick_of(grid, at(1), at(2), at(3))
    end function brick_start

    !> Bricks on each side of one that a step can carry something into.
    !>
    !> Round a periodic direction the last brick may hold fewer cells than the others.
    pure function layers_around(n, periodic, reach) result(layers)
        integer, intent(in) :: n(3) !! cells
        logical, intent(in) :: periodic(3) !! directions that go on from the other end
        integer, intent(in) :: reach !! cells that a step reaches
        integer :: layers(3)

        layers = merge((reach - 1)/brick + 1, 0, n > 1)
        where (n > 1 .and. periodic .and. mod(n, brick) > 0) layers = layers + 1
    end function layers_around

    !> Corners of cells along a direction: round a periodic one those at both ends are the same.
    elemental integer function nodes_along(cells, periodic) result(nodes)
        integer, intent(in) :: cells
        logical, intent(in) :: periodic

        nodes = cells
        if (cells > 1 .and. .not. periodic) nodes = cells + 1
    end function nodes_along

    !> Variable in a slot of a state turned into direction d, as the table `turned` has it.
    !@cuf attributes(host,device) &
    pure function variable_in_slot(slot, d) result(variable)
        integer, intent(in) :: slot !! 1: density, 2..4: momentum, normal first, 5, 6
        integer, intent(in) :: d !! direction
        integer :: variable

        variable = slot
        if (slot >= 2 .and. slot <= 4) variable = 2 + mod(slot + d - 3, 3)
    end function variable_in_slot
end module brz_air_grid
