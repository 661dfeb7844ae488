! SPDX-License-Identifier: MIT
!> Gas as a file has it, at the start of a run: a dump of a box, or a table of points.
!>
!> A dump is cells: each cell of the grid takes the shares of those that it overlaps, so mass,
!> momentum, energy and products of what lies in the box are kept, whatever the spacings. A table
!> with one coordinate is a profile, along an axis or a radius, with straight lines between its
!> rows, of which a cell takes the mean over some points. Of any other table a cell takes the
!> nearest point. What no file covers stays as it is.
module brz_gas_file
    use brz_bisection, only: count_up_to
    use brz_case, only: gas_case_t, label
    use brz_csv_table, only: read_columns
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_gas_box, only: gas_box_t, read_gas_box
    use brz_kinds, only: dp, rk
    use brz_air_state, only: air_t, cell_centre
    use brz_nearest_point, only: nearest_point
    use brz_row_order, only: order_rows
    implicit none
    private
    public :: pour_gas_file

    integer, parameter :: per_side = 4 !! points of a cell along a direction, for profiles
    character(10), parameter :: names(11) = [character(10) :: 'x', 'y', 'z', 'r', 'radius', &
        'density', 'velocity_x', 'velocity_y', 'velocity_z', 'velocity', 'pressure']

    !> Points of a table, in the order of its rows or of the one coordinate.
    type :: table_t
        integer :: axis = 0 !! of a profile; 4: along the radius, 0: none
        real(dp), allocatable :: at(:, :) !! (3, points) places; profiles: (1, points) [m]
        real(dp), allocatable :: w(:, :) !! (5, points) density, velocity, pressure
    end type table_t

contains

    !> Put the gas of a file into the air.
    subroutine pour_gas_file(input, air, err)
        type(gas_case_t), intent(in) :: input
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err !! exit_deck with line and remedy
        type(error_t) :: bad
        type(gas_box_t) :: box
        type(table_t) :: table

        if (failed(err)) return
        if (index(input%file, '.csv') > 0) then
            call read_table(trim(input%file), air%n > 1, table, bad)
            call judge_shift(input, table%axis, bad)
            if (.not. failed(bad)) then
                if (table%axis > 0) then
                    call pour_profile(table, input%at, air)
                else
                    call pour_points(table, input%move, air)
                end if
            end if
        else
            call read_gas_box(trim(input%file), real(air%scheme%gamma, dp), air%n_var == 6, &
                              air%n > 1, box, bad)
            call judge_shift(input, 0, bad)
            if (.not. failed(bad)) call pour_box(box, input%move, air)
        end if
        if (failed(bad)) call raise(err, exit_deck, label('gas', input%id, input%place)//bad%text)
    end subroutine pour_gas_file

    !> A shift that goes with what the file holds.
    subroutine judge_shift(input, axis, err)
        type(gas_case_t), intent(in) :: input
        integer, intent(in) :: axis !! of a profile, 4: a radius; 0: points or a dump
        type(error_t), intent(inout) :: err

        if (axis /= 4 .and. any(abs(input%at) > 0)) then
            call raise(err, exit_deck, trim(input%file)//': at is the centre of a profile '// &
                       'along a radius r, which this is not; take it out')
        else if (axis > 0 .and. any(abs(input%move) > 0)) then
            call raise(err, exit_deck, trim(input%file)//': move shifts points and dumps; '// &
                       'place a profile along r by at, one along x, y or z by its coordinates')
        end if
    end subroutine judge_shift

    !> Read and judge a table.
    subroutine read_table(path, active, table, err)
        character(*), intent(in) :: path
        logical, intent(in) :: active(3) !! directions that are modelled
        type(table_t), intent(out) :: table
        type(error_t), intent(inout) :: err
        real(dp), allocatable :: values(:, :)
        logical :: found(size(names))
        integer :: a, k

        call read_columns(path, names, values, found, err)
        if (failed(err)) return
        found(4) = found(4) .or. found(5)
        if (.not. (found(6) .and. found(11) .and. any(found(:4)))) then
            call raise(err, exit_deck, path//': its first row must name the columns density, '// &
                       'pressure and x, y, z, or one of x, y, z, r')
        else if (found(4) .and. any(found([1, 2, 3, 7, 8, 9]))) then
            call raise(err, exit_deck, path//': along a radius r there is one velocity; take '// &
                       'the columns of x, y, z out')
        else if (.not. found(4) .and. found(10)) then
            call raise(err, exit_deck, path//': velocity is that along a radius r; name '// &
                       'velocity_x, ...')
        else if (size(values, 2) < 2) then
            call raise(err, exit_deck, path//': holds fewer than two rows')
        else if (.not. all(values([6, 11], :) > 0)) then
            call raise(err, exit_deck, path//': a density or pressure is not positive')
        end if
        if (failed(err)) return
        allocate (table%w(5, size(values, 2)))
        table%w([1, 2, 3, 4, 5], :) = values([6, 7, 8, 9, 11], :)
        if (found(4)) then
            table%axis = 4
            table%at = values(4:4, :) + values(5:5, :)
            table%w(2, :) = values(10, :)
        else if (count(found(:3)) == 1) then
            table%axis = findloc(found(:3), .true., 1)
            table%at = values(table%axis:table%axis, :)
        else
            table%at = values(:3, :)
            do a = 1, 3
                if (active(a) .and. .not. found(a)) call raise(err, exit_deck, path//': has no '// &
                    'column '//trim(names(a))//'; name one coordinate, or all that are modelled')
            end do
            return
        end if
        do k = 2, size(table%at, 2)
            if (table%at(1, k) > table%at(1, k - 1)) cycle
            call raise(err, exit_deck, path//': the coordinate of a profile must grow')
            return
        end do
    end subroutine read_table

    !> Cells overlap those of a dump. A direction in which the dump has one cell goes on for ever.
    subroutine pour_box(box, move, air)
        type(gas_box_t), intent(in) :: box
        real(dp), intent(in) :: move(3) !! [m]
        type(air_t), intent(inout) :: air
        integer :: j, k

        !$omp parallel do collapse(2) schedule(static)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                call pour_row(box, move, [1, j, k], air)
            end do
        end do
        !$omp end parallel do
    end subroutine pour_box

    !> The same for a row of cells along x.
    subroutine pour_row(box, move, row, air)
        type(gas_box_t), intent(in) :: box
        real(dp), intent(in) :: move(3) !! [m]
        integer, intent(in) :: row(3) !! its first cell
        type(air_t), intent(inout) :: air
        real(dp) :: share(maxval(box%n), 3), mean(6), part(3), low
        integer :: first(3), last(3), a, at, i

        do i = 1, air%n(1)
            do a = 3, 1, -1
                if (a > 1 .and. i > 1) cycle ! that of the cell before
                at = air%before(a) + row(a) - 1
                if (a == 1) at = at + i - 1
                low = air%lo(a) + at*air%dx(a)
                call overlap(box%n(a), box%lo(a) + move(a), box%dx(a), low, air%dx(a), first(a), &
                             last(a), share(:, a))
                part(a) = sum(share(first(a):last(a), a))
            end do
            if (.not. product(part) > 0) cycle
            call add_up(box, first, last, share, mean)
            call blend(mean, min(product(part), 1.0_dp), air%u(i, row(2), row(3), :))
        end do
    end subroutine pour_row

    !> Shares of a cell that the cells of a row fill.
    pure subroutine overlap(n, low, side, from, width, first, last, share)
        integer, intent(in) :: n !! cells of the row; 1: it has no ends
        real(dp), intent(in) :: low, side !! its low end, its cells [m]
        real(dp), intent(in) :: from, width !! of the cell of the grid [m]
        integer, intent(out) :: first, last !! none if last < first
        real(dp), intent(inout) :: share(:)
        integer :: m

        first = 1
        last = 1
        share(1) = 1
        if (n == 1) return
        first = max(1, floor((from - low)/side) + 1)
        last = min(n, ceiling((from + width - low)/side))
        do m = first, last
            share(m) = max(0.0_dp, (min(from + width, low + m*side) &
                                    - max(from, low + (m - 1)*side))/width)
        end do
    end subroutine overlap

    !> Sum of the conserved variables of cells, by their shares.
    pure subroutine add_up(box, first, last, share, mean)
        type(gas_box_t), intent(in) :: box
        integer, intent(in) :: first(3), last(3)
        real(dp), intent(in) :: share(:, :)
        real(dp), intent(out) :: mean(6)
        integer :: i, j, k

        mean = 0
        do k = first(3), last(3)
            do j = first(2), last(2)
                do i = first(1), last(1)
                    mean = mean + share(i, 1)*share(j, 2)*share(k, 3)*box%u(:, i, j, k)
                end do
            end do
        end do
    end subroutine add_up

    !> A cell keeps what nothing covers.
    pure subroutine blend(mean, covered, u)
        real(dp), intent(in) :: mean(6) !! of what is covered, times its share
        real(dp), intent(in) :: covered
        real(rk), intent(inout) :: u(:)
        real(dp), parameter :: rounding = 1e-12_dp

        if (covered < 1 - rounding) then
            u = real((1 - covered)*u + mean(:size(u)), rk)
        else
            u = real(mean(:size(u)), rk)
        end if
    end subroutine blend

    !> Means over points of a profile.
    subroutine pour_profile(table, centre, air)
        type(table_t), intent(in) :: table
        real(dp), intent(in) :: centre(3) !! of a radius [m]
        type(air_t), intent(inout) :: air
        real(dp) :: x(3), mean(6), q(6)
        integer :: m(3), a, b, c, i, j, k, inside
        logical :: hit

        m = merge(per_side, 1, air%n > 1 .and. (table%axis == 4 .or. [1, 2, 3] == table%axis))
        !$omp parallel do collapse(2) schedule(static) private(x, mean, q, a, b, c, i, inside, hit)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    mean = 0
                    inside = 0
                    do c = 1, m(3)
                        do b = 1, m(2)
                            do a = 1, m(1)
                                x = cell_centre(air, i, j, k) &
                                    + (([a, b, c] - 0.5_dp)/m - 0.5_dp)*air%dx
                                call probe(table, merge(x - centre, 0.0_dp, air%n > 1), x, &
                                           real(air%scheme%gamma, dp), q, hit)
                                if (.not. hit) cycle
                                inside = inside + 1
                                mean = mean + q/product(m)
                            end do
                        end do
                    end do
                    if (inside > 0) call blend(mean, real(inside, dp)/product(m), air%u(i, j, k, :))
                end do
            end do
        end do
        !$omp end parallel do
    end subroutine pour_profile

    !> State of a profile at a place; not `hit` beyond its ends. Inside the first radius it is that
    !> of the first row.
    pure subroutine probe(table, arm, x, gamma, q, hit)
        type(table_t), intent(in) :: table
        real(dp), intent(in) :: arm(3) !! from the centre, in the directions that are modelled [m]
        real(dp), intent(in) :: x(3), gamma
        real(dp), intent(out) :: q(6)
        logical, intent(out) :: hit
        real(dp) :: at, t, w(5), speed
        integer :: high, low

        if (table%axis == 4) then
            at = max(norm2(arm), table%at(1, 1))
        else
            at = x(table%axis)
        end if
        associate (row => table%at(1, :), n => size(table%at, 2))
            hit = at >= row(1) .and. at <= row(n)
            q = 0
            if (.not. hit) return
            low = 1 + count_up_to(row(2:n - 1), at)
            high = low + 1
            t = (at - row(low))/(row(high) - row(low))
        end associate
        w = (1 - t)*table%w(:, low) + t*table%w(:, high)
        if (table%axis == 4) then
            speed = w(2)
            w(2:4) = 0
            if (norm2(arm) > 0) w(2:4) = speed*arm/norm2(arm)
        end if
        q(:5) = conserved(gamma, w)
    end subroutine probe

    !> The nearest point of a table, within its box and half the distance of its points around it.
    subroutine pour_points(table, move, air)
        type(table_t), intent(in) :: table
        real(dp), intent(in) :: move(3) !! [m]
        type(air_t), intent(inout) :: air
        integer, allocatable :: order(:), active(:)
        real(dp) :: low(3), high(3), x(3), margin, q(6)
        integer :: a, d, i, j, k

        active = pack([1, 2, 3], air%n > 1)
        d = size(active)
        low = minval(table%at, 2) + move
        high = maxval(table%at, 2) + move
        margin = 0.5_dp*(product(max((high - low), air%dx), air%n > 1)/size(table%at, 2)) &
                 **(1.0_dp/d)
        allocate (order(size(table%at, 2)))
        call order_rows(table%at(active(1):active(1), :), order)
        !$omp parallel do collapse(2) schedule(static) private(x, q, i)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    x = cell_centre(air, i, j, k)
                    if (any((x < low - margin .or. x > high + margin) .and. air%n > 1)) cycle
                    a = nearest_point(table%at(active, :), order, x(active) - move(active))
                    q = 0
                    q(:5) = conserved(real(air%scheme%gamma, dp), table%w(:, a))
                    air%u(i, j, k, :) = real(q(:air%n_var), rk)
                end do
            end do
        end do
        !$omp end parallel do
    end subroutine pour_points

    !> Conserved variables in double precision.
    pure function conserved(gamma, w) result(q)
        real(dp), intent(in) :: gamma, w(5) !! [-]; density, velocity, pressure
        real(dp) :: q(5)

        q(1) = w(1)
        q(2:4) = w(1)*w(2:4)
        q(5) = w(5)/(gamma - 1) + w(1)/2*dot_product(w(2:4), w(2:4))
    end function conserved
end module brz_gas_file
