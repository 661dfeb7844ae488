! SPDX-License-Identifier: MIT
!> A charge that starts in one dimension: run its blast until the shock nears an obstacle, keep what
!> the gauges see meanwhile, and put it into the grid.
module brz_start_1d
    use brz_air_state, only: air_t, charge_report_t
    use brz_blast1d_profile, only: blast1d_at
    use brz_blast1d_reconstruct, only: prepare
    use brz_blast1d_state, only: blast1d_t, blast1d_totals, start_blast1d, whole_angle
    use brz_blast1d_step, only: advance_blast1d
    use brz_blast_remap, only: map_blast, outward
    use brz_blast_start, only: centred_input, free_radius
    use brz_case, only: case_t, label
    use brz_charge_shape, only: make_shape, charge_shape_t
    use brz_early, only: along_arm, early_t, grid_totals, keep_row, lose_blast, next_due, &
                         watch_blast
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_gauge_box, only: points_of_gauges
    use brz_kinds, only: dp
    use brz_text, only: to_text
    implicit none
    private
    public :: start_from_1d, free_way

    real(dp), parameter :: margin = 3 !! cells between the shock and the obstacle
    real(dp), parameter :: least_run = 1.5_dp !! radii of the charge that the shock must run freely

contains

    !> Radius to which the shock may run [m].
    real(dp) function free_way(case, cell)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: cell !! largest side of a cell [m]

        free_way = free_radius(case) - margin*cell
    end function free_way

    !> Run the only charge of the case, and fill the air with its blast.
    subroutine start_from_1d(case, air, early, err, watch)
        type(case_t), intent(in) :: case
        type(air_t), intent(inout) :: air !! undisturbed
        type(early_t), intent(inout) :: early
        type(error_t), intent(inout) :: err
        procedure(watch_blast), optional :: watch
        type(charge_shape_t) :: shape
        type(blast1d_t) :: blast
        real(dp) :: limit, rest(6), radius, share(3), part

        call make_shape(case%charges(1), air%n > 1, product(air%dx, mask=air%n == 1), shape, err)
        if (failed(err)) return
        radius = minval(shape%half, mask=air%n > 1)
        limit = free_way(case, maxval(air%dx, mask=air%n > 1))
        if (limit < least_run*radius) then
            call raise(err, exit_deck, label('charge', case%charges(1)%id, &
                case%charges(1)%place)//"start='1d' needs room: the shock may run to "// &
                to_text(limit)// &
                ' m (the nearest obstacle less 3 cells), the radius of the charge is '// &
                to_text(radius)//' m; '//remedy(case, limit, maxval(air%dx, mask=air%n > 1)))
            return
        end if
        early%present = .true.
        early%products = air%n_var == 6
        share = outward(air, case%charges(1)%at)
        part = 0.5_dp**count(abs(share) > 0) ! what planes of symmetry leave of the charge
        call start_blast1d(centred_input(case, radius), blast)
        call run_free(case, limit, blast, early, err, watch)
        if (failed(err)) return
        air%charge(1) = charge_report_t(radius=radius, cells=real(blast%n_in, dp), &
            mass=part*case%charges(1)%mass)
        call grid_totals(air, rest)
        call map_blast(blast, case%charges(1)%at, part, air)
        call grid_totals(air, early%after)
        early%after = early%after - rest
        call report(blast, air, part*product(air%dx, mask=air%n == 1), early)
        early%before(2:4) = share*early%before(7)
    end subroutine start_from_1d

    !> What helps where the shock has no room.
    function remedy(case, limit, cell) result(text)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: limit !! radius to which the shock may run [m]
        real(dp), intent(in) :: cell !! [m]
        character(:), allocatable :: text
        real(dp) :: depth
        integer :: d, s

        do d = 1, 3
            do s = 1, 2
                if (case%air%cells(d) == 1 .or. case%air%bc(s, d) == 'outflow') cycle
                depth = abs(case%charges(1)%at(d) &
                    - merge(case%air%lo(d), case%air%hi(d), s == 1))
                if (depth - margin*cell > limit*(1 + sign(1e-9_dp, limit))) cycle
                text = 'the '//trim(case%air%bc(s, d))//" '"//'xyz' (d:d)// &
                    merge('-', '+', s == 1)//"' stops it: "
                if (.not. depth > 1e-6_dp*cell) text = text//"a charge on a floor needs "// &
                    "bc='symmetry' there, with burst='surface', or start='2d'"
                if (depth > 1e-6_dp*cell) text = text//"a sphere over a floor needs start='2d' "// &
                    "with axis='"//'xyz' (d:d)//"'"
                return
            end do
        end do
        text = "use smaller cells or start='3d'"
        if (limit < 0 .and. size(case%bodies) > 0) text = 'it lies within 3 cells of a body, '// &
            'or inside the box around one; '//text
    end function remedy

    !> Step until the front passes a radius, or the run ends.
    subroutine run_free(case, limit, blast, early, err, watch)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: limit !! [m]
        type(blast1d_t), intent(inout) :: blast
        type(early_t), intent(inout) :: early
        type(error_t), intent(inout) :: err
        procedure(watch_blast), optional :: watch
        real(dp), allocatable :: points(:, :)
        real(dp) :: due
        logical :: ok

        call points_of_gauges(case, points)
        due = 0
        do
            call prepare(blast, blast%time)
            if (blast%r(blast%front) >= limit .or. blast%time >= case%run%t_end) exit
            if (blast%time >= due) then
                call look(case, points, blast, early)
                due = next_due(blast%time, case%output%history_every)
            end if
            call advance_blast1d(blast, case%run%t_end - blast%time, ok)
            if (ok .and. present(watch)) call watch(1, blast%time, blast%r(blast%front), limit)
            if (ok) cycle
            call lose_blast('one dimension', blast%time, err)
            return
        end do
        early%time = blast%time
        early%radius = blast%r(blast%front)
        early%steps = blast%cycle
        early%contact = blast%r(blast%n_in)
        early%fastest = maxval(blast%state(2, blast%n_in:) + blast%state(5, blast%n_in:))
    end subroutine run_free

    !> Keep what the gauges of the air see.
    subroutine look(case, points, blast, early)
        type(case_t), intent(in) :: case
        real(dp), intent(in) :: points(:, :) !! (3, n) of the gauges [m]
        type(blast1d_t), intent(in) :: blast
        type(early_t), intent(inout) :: early
        real(dp) :: seen(5, size(points, 2)), arm(3), state(3)
        integer :: m

        do m = 1, size(points, 2)
            arm = merge(points(:, m) - case%charges(1)%at, 0.0_dp, case%air%cells > 1)
            call blast1d_at(blast, norm2(arm), state)
            seen(:, m) = along_arm(state, arm)
        end do
        call keep_row(early, blast%time, seen)
    end subroutine look

    !> What the blast held, and how the pressure of its products changes when they become an ideal
    !> gas of the same density and energy.
    subroutine report(blast, air, part, early)
        type(blast1d_t), intent(in) :: blast
        type(air_t), intent(in) :: air
        real(dp), intent(in) :: part !! modelled part, times the depth of a box in two dimensions
        type(early_t), intent(inout) :: early
        real(dp) :: sums(4), change, gamma
        integer :: i

        gamma = merge(air%scheme%gamma_products, air%scheme%gamma, air%scheme%mixture)
        sums = part*whole_angle(blast%input%power)*blast1d_totals(blast)
        early%before = [sums(1) + sums(2), 0.0_dp, 0.0_dp, 0.0_dp, sums(4), sums(1), sums(3)]
        do i = 1, blast%n_in
            change = abs((gamma - 1)*blast%state(4, i)/blast%state(3, i) - 1)
            early%pressure_change = max(early%pressure_change, change)
            early%pressure_mean = early%pressure_mean + change*blast%q(1, i)/sum( &
                blast%q(1, :blast%n_in))
        end do
    end subroutine report
end module brz_start_1d
