! SPDX-License-Identifier: MIT
!> A charge that starts in the plane through its axis: run its blast until the front nears what is
!> not round about the axis, keep what the gauges see meanwhile, and put it into the grid.
module brz_start_2d
    use brz_air_state, only: air_t, charge_report_t
    use brz_axial_inside, only: inside_t, sums_inside
    use brz_axial_remap, only: map_axial
    use brz_axial_start, only: axial_at, axial_input, charge_gap, find_obstacles, frame_t, &
        free_gap, make_frame, obstacle_t
    use brz_axial_state, only: axial_input_t, axial_t, start_axial, top_of, v_products, v_rho, &
        w_energy, w_p
    use brz_axial_step, only: advance_axial
    use brz_case, only: case_t, label
    use brz_early, only: early_t, grid_totals, keep_row, lose_blast, next_due, watch_blast
    use brz_errors, only: error_t, exit_deck, exit_numerical, failed, raise
    use brz_gauge_box, only: points_of_gauges
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: start_from_2d, free_way

    real(dp), parameter :: margin = 3 !! cells between the front and an obstacle
    real(dp), parameter :: least_run = 0.5_dp
    !! radii of the charge (half lengths if smaller) that the front must run freely

contains

    !> How far the front may run from the charge [m].
    pure real(dp) function free_way(input, obstacles, cell)
        type(axial_input_t), intent(in) :: input
        type(obstacle_t), intent(in) :: obstacles(:)
        real(dp), intent(in) :: cell !! largest side of a cell [m]

        free_way = charge_gap(input, obstacles) - margin*cell
    end function free_way

    !> Run the only charge of the case, and fill the air with its blast.
    subroutine start_from_2d(case, air, early, err, watch)
        type(case_t), intent(in) :: case
        type(air_t), intent(inout) :: air !! undisturbed
        type(early_t), intent(inout) :: early
        type(error_t), intent(inout) :: err
        procedure(watch_blast), optional :: watch
        type(axial_input_t) :: input
        type(axial_t) :: blast
        type(frame_t) :: frame
        type(obstacle_t), allocatable :: obstacles(:)
        type(inside_t) :: inside
        character(:), allocatable :: head
        real(dp) :: rest(6), room, part, off
        logical :: ok

        head = label('charge', case%charges(1)%id, case%charges(1)%place)
        frame = make_frame(case)
        call axial_input(case, frame, input, err)
        if (failed(err)) return
        call find_obstacles(case, frame, obstacles)
        room = free_way(input, obstacles, maxval(air%dx))
        if (room < least_run*min(input%radius, input%half)) then
            call raise(err, exit_deck, head//"start='2d' needs room: the front may run "// &
                to_text(room)//' m from the charge (to the nearest obstacle less 3 cells), '// &
                'whose smallest half side is '//to_text(min(input%radius, input%half))// &
                " m; use smaller cells or start='3d'")
            return
        end if
        early%present = .true.
        early%dimensions = 2
        early%products = air%n_var == 6
        part = 0.5_dp**count(frame%mirrored)
        call start_axial(input, blast)
        call run_free(case, frame, obstacles, margin*maxval(air%dx), blast, early, err, watch)
        if (failed(err)) return
        if (blast%burning) then
            call raise(err, exit_deck, head//"start='2d' needs room: the charge still burns "// &
                "when the front nears an obstacle; use smaller cells, or burn='instant'")
            return
        end if
        air%charge(1) = charge_report_t(radius=min(input%radius, input%half), &
            cells=real(nint(min(input%radius/blast%dr, input%half/blast%dz)*2**blast%merged), dp), &
            mass=part*case%charges(1)%mass)
        call grid_totals(air, rest)
        inside = sums_inside(blast, frame, air%lo, air%lo + air%whole*air%dx)
        call map_axial(blast, frame, inside, part, air, off, ok)
        if (.not. ok) call raise(err, exit_numerical, head//'a cell lost its pressure when the '// &
            'blast was put into the grid, whose points miss its sums by '//to_text(off)// &
            '; use smaller cells')
        call grid_totals(air, early%after)
        early%after = early%after - rest
        early%off = off
        early%before = [inside%mass, inside%momentum, inside%energy, inside%products, &
            inside%radial]
        early%beyond = inside%beyond
        call compare_products(blast, air, early)
    end subroutine start_from_2d

    !> Step until the front nears an obstacle, or the run ends.
    subroutine run_free(case, frame, obstacles, near, blast, early, err, watch)
        type(case_t), intent(in) :: case
        type(frame_t), intent(in) :: frame
        type(obstacle_t), intent(in) :: obstacles(:)
        real(dp), intent(in) :: near !! [m]
        type(axial_t), intent(inout) :: blast
        type(early_t), intent(inout) :: early
        type(error_t), intent(inout) :: err
        procedure(watch_blast), optional :: watch
        real(dp) :: due, gap, room
        real(dp), allocatable :: points(:, :), seen(:, :)
        integer :: m
        logical :: ok

        call points_of_gauges(case, points)
        allocate (seen(5, size(points, 2)))
        due = 0
        room = charge_gap(blast%input, obstacles) - near
        do
            call advance_axial(blast, case%run%t_end - blast%time, ok)
            if (.not. ok) then
                call lose_blast('two dimensions', blast%time, err)
                return
            end if
            gap = free_gap(blast, obstacles) - near
            if (present(watch)) call watch(2, blast%time, gap, room)
            if (blast%time >= due) then
                do m = 1, size(points, 2)
                    seen(:, m) = axial_at(blast, frame, points(:, m))
                end do
                call keep_row(early, blast%time, seen)
                due = next_due(blast%time, case%output%history_every)
            end if
            if (gap <= 0 .or. blast%time >= case%run%t_end) exit
        end do
        early%time = blast%time
        early%radius = max(blast%reach*blast%dr, top_of(blast, blast%last), &
            -top_of(blast, blast%first))
        early%steps = blast%cycle
    end subroutine run_free

    !> How the pressure of the products changes when they become an ideal gas of the same density
    !> and energy.
    subroutine compare_products(blast, air, early)
        type(axial_t), intent(in) :: blast
        type(air_t), intent(in) :: air
        type(early_t), intent(inout) :: early
        real(dp) :: gamma, heat, y, change, weight, total
        integer :: i, j

        gamma = merge(air%scheme%gamma_products, air%scheme%gamma, air%scheme%mixture)
        total = 0
        do j = blast%first, blast%last
            do i = 1, blast%reach
                weight = (i - 0.5_dp)*blast%u(i, v_products, j)
                y = blast%u(i, v_products, j)/blast%u(i, v_rho, j)
                if (y < 0.5_dp) cycle ! else most of it is air
                heat = y/(gamma - 1) + (1 - y)/(blast%input%gamma - 1)
                change = abs(blast%w(i, w_energy, j)/heat/blast%w(i, w_p, j) - 1)
                early%pressure_change = max(early%pressure_change, change)
                early%pressure_mean = early%pressure_mean + change*weight
                total = total + weight
            end do
        end do
        early%pressure_mean = early%pressure_mean/max(total, tiny(total))
    end subroutine compare_products
end module brz_start_2d
