! SPDX-License-Identifier: MIT
!> What a deck asks for but a run of it never does: motions and waves after its end, velocities of
!> bodies that are held, outputs that never come, bodies that never meet, scenes at rest.
module brz_check_idle
    use brz_case, only: body_case_t, case_t, inflow_case_t, interaction_case_t, is_from_file, &
                        is_held_whole
    use brz_check_start, only: is_radial
    use brz_deck, only: add_warning, deck_t, entry_line, find_group, group_label
    use brz_get, only: is_given
    use brz_kinds, only: dp, real32
    use brz_body_geometries, only: body_box
    use brz_text, only: to_text
    implicit none
    private
    public :: check_idle

    character(*), parameter :: in_seconds = '; are its times in seconds?'

contains

    !> Warn of all that. A deck with errors has its messages already.
    subroutine check_idle(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: b, g, k

        if (deck%n_errors > 0) return
        b = 0
        k = 0
        do g = 1, deck%n
            select case (deck%groups(g)%name)
            case ('body')
                b = b + 1
                call judge_motion(deck, g, case, case%bodies(b))
            case ('inflow')
                k = k + 1
                call judge_inflow(deck, g, case, case%inflows(k))
            case ('motion')
                call judge_region_motion(deck, g, case)
            case ('output')
                call judge_output(deck, g, case)
            case ('solid')
                call judge_region(deck, g, case)
            end select
        end do
        call judge_interactions(deck, case)
        if (is_at_rest(case)) then
            call warn(deck, find_group(deck, 'run'), 'nothing happens: nothing moves, and no '// &
                      'load, charge, gas or inflow sets anything in motion')
        else
            call judge_paths(deck, case)
        end if
    end subroutine check_idle

    subroutine warn(deck, g, text, key)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        character(*), intent(in) :: text
        character(*), intent(in), optional :: key

        if (present(key)) then
            call add_warning(deck, entry_line(deck%groups(g), key), &
                             group_label(deck%groups(g))//text)
        else
            call add_warning(deck, deck%groups(g)%line, group_label(deck%groups(g))//text)
        end if
    end subroutine warn

    function seconds(t) result(text)
        real(dp), intent(in) :: t
        character(:), allocatable :: text

        text = to_text(real(t, real32))//' s'
    end function seconds

    !> A velocity that a body starts with and cannot keep, and one that it is given too late.
    subroutine judge_motion(deck, g, case, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        logical :: moves
        integer :: n

        n = body%n_motion
        moves = any(abs(body%velocity) > 0) .or. any(abs(body%spin) > 0)
        if (n > 0) then
            if (body%formulation == 'rigid' .and. moves) call warn(deck, g, 'velocity and spin '// &
                'have no effect: motion_velocity moves all of it from the start')
            call judge_begin(deck, g, case%run%t_end, body%motion_time(:n), &
                             maxval(abs(body%motion_velocity(:, :n)), dim=1))
        else if (is_held_whole(body) .and. moves) then
            call warn(deck, g, "velocity and spin have no effect: fix='all' holds all of it; "// &
                      'take one of them out, or give motion_time and motion_velocity')
        else if (moves) then
            if (is_in_fix_box(case, body)) call warn(deck, g, 'velocity and spin have no '// &
                'effect: a fix_box holds all of it; take one of them out')
        end if
    end subroutine judge_motion

    logical function is_in_fix_box(case, body)
        type(case_t), intent(in) :: case
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3)
        integer :: d, i

        is_in_fix_box = .false.
        if (is_from_file(body)) return
        call body_box(body, lo, hi)
        d = case%run%dimension
        do i = 1, body%n_fix_boxes
            is_in_fix_box = is_in_fix_box .or. (all(body%fix_box(1:2*d:2, i) <= lo(:d)) .and. &
                                                all(body%fix_box(2:2*d:2, i) >= hi(:d)))
        end do
    end function is_in_fix_box

    subroutine judge_region_motion(deck, g, case)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        integer :: b, m

        do b = 1, size(case%bodies)
            if (.not. allocated(case%bodies(b)%regions)) cycle
            do m = 1, size(case%bodies(b)%regions)
                associate (region => case%bodies(b)%regions(m))
                    if (region%id == deck%groups(g)%id) call judge_begin(deck, g, &
                        case%run%t_end, region%time, maxval(abs(region%velocity), dim=1))
                end associate
            end do
        end do
    end subroutine judge_region_motion

    !> Warn of a history of straight lines that is 0 until the end of the run, but not for ever.
    subroutine judge_begin(deck, g, t_end, time, value)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        real(dp), intent(in) :: t_end
        real(dp), intent(in) :: time(:), value(:) !! magnitudes
        integer :: first

        first = findloc(value > 0, .true., 1)
        if (first < 2) return
        if (time(first - 1) >= t_end) call warn(deck, g, 'it begins at '// &
            seconds(time(first - 1))//', after the end of the run at '//seconds(t_end)//in_seconds)
    end subroutine judge_begin

    !> A wave after the end, and gas that leaves the box faster than its sound comes in.
    subroutine judge_inflow(deck, g, case, inflow)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        type(inflow_case_t), intent(in) :: inflow
        real(dp), allocatable :: inwards(:)

        if (inflow%wave) then
            if (size(inflow%time) < 2) return
            if (inflow%time(1) >= case%run%t_end) then ! 0 before
                call warn(deck, g, 'it begins at '//seconds(inflow%time(1))// &
                          ', after the end of the run at '//seconds(case%run%t_end)//in_seconds)
            else
                call judge_begin(deck, g, case%run%t_end, inflow%time, abs(inflow%overpressure))
            end if
            return
        end if
        inwards = inflow%state(:, 1 + inflow%axis)
        if (inflow%side == 2) inwards = -inwards
        if (all(inwards**2 >= case%air%gamma*inflow%state(:, 5)/inflow%state(:, 1) &
                .and. inwards < 0)) &
            call warn(deck, g, 'nothing comes in: the gas there leaves the box faster than '// &
                      'sound; mach counts into the box, velocity along x, y, z')
    end subroutine judge_inflow

    !> Times of outputs that lie after the end of the run.
    subroutine judge_output(deck, g, case)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        character(:), allocatable :: late

        if (deck%groups(g)%line == 0) return
        late = ', after the end of the run at '//seconds(case%run%t_end)//in_seconds
        associate (out => case%output, t_end => case%run%t_end)
            if (is_given(deck%groups(g), 'dump_every') .and. out%dump_from + out%dump_every > &
                t_end .and. out%dump_every > t_end) call warn(deck, g, 'no dump between start '// &
                'and end: the first is that of '//seconds(out%dump_every)//late, 'dump_every')
            if (out%history_every > t_end) call warn(deck, g, 'no row of the histories between '// &
                'start and end: the first is that of '//seconds(out%history_every)//late, &
                'history_every')
            if (.not. allocated(out%dump_times)) return
            if (size(out%dump_times) == 0) return
            if (maxval(out%dump_times) > t_end*(1 + 1e-9_dp)) call warn(deck, g, 'a dump is '// &
                'asked for at '//seconds(maxval(out%dump_times))//late, 'dump_times')
        end associate
    end subroutine judge_output

    !> A region that watches nothing: there is none, or a body lies outside of it.
    subroutine judge_region(deck, g, case)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(in) :: case
        real(dp) :: lo(3), hi(3)
        integer :: b, d

        if (is_given(deck%groups(g), 'leave') .and. .not. (case%solid%has_region .or. &
                                                           case%air%present)) &
            call warn(deck, g, 'leave has no effect: there is no region and no air; give region')
        if (.not. case%solid%has_region) return
        d = case%run%dimension
        do b = 1, size(case%bodies)
            if (is_from_file(case%bodies(b))) cycle
            call body_box(case%bodies(b), lo, hi)
            if (all(hi(:d) > case%solid%region(:d, 1) .and. lo(:d) < case%solid%region(:d, 2))) &
                cycle
            call warn(deck, g, "the body '"//trim(case%bodies(b)%id)//"' lies outside of the "// &
                      'region from the start, so it is neither stopped nor removed', 'region')
        end do
    end subroutine judge_region

    !> Interactions all of whose pairs are those of a later one.
    subroutine judge_interactions(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        integer :: g, i, k

        i = 0
        do g = 1, deck%n
            if (deck%groups(g)%name /= 'interaction') cycle
            i = i + 1
            do k = i + 1, size(case%interactions)
                if (.not. covers(case%interactions(k), case%interactions(i))) cycle
                call warn(deck, g, 'has no effect: a later &interaction covers it; put the '// &
                          'general one first')
                exit
            end do
        end do
    end subroutine judge_interactions

    !> Are all pairs of an earlier interaction those of a later one?
    pure logical function covers(later, earlier)
        type(interaction_case_t), intent(in) :: later, earlier

        covers = all(later%body == 0) .or. same([1, 2]) .or. same([2, 1])

    contains

        pure logical function same(order)
            integer, intent(in) :: order(2)

            same = all(later%body == earlier%body(order) .and. later%last == earlier%last(order))
        end function same
    end function covers

    !> Is there nothing that moves or sets in motion?
    pure logical function is_at_rest(case)
        type(case_t), intent(in) :: case
        integer :: b

        is_at_rest = size(case%charges) + size(case%gas) + size(case%inflows) &
                     + size(case%loads) == 0 .and. .not. is_radial(case)
        if (case%air%present .and. case%coupling%present) is_at_rest = is_at_rest .and. &
            abs(case%coupling%reference_pressure - case%air%pressure) <= 1e-9_dp*case%air%pressure
        do b = 1, size(case%bodies)
            is_at_rest = is_at_rest .and. .not. (moves(case, b) .or. pushes(case, b))
        end do
    end function is_at_rest

    !> Does a body start with a velocity, or is it given one?
    pure logical function moves(case, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b

        associate (body => case%bodies(b))
            moves = any(abs(body%velocity) > 0) .or. any(abs(body%spin) > 0) .or. is_driven(case, b)
        end associate
    end function moves

    pure logical function is_driven(case, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b

        is_driven = case%bodies(b)%n_motion > 0
        if (allocated(case%bodies(b)%regions)) is_driven = .true.
    end function is_driven

    !> May a body start under stress, or moving as its file says?
    pure logical function pushes(case, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b

        pushes = case%bodies(b)%start_file /= '' .or. case%bodies(b)%shape == 'particles'
        if (case%bodies(b)%material_index == 0) return
        associate (model => case%materials(case%bodies(b)%material_index)%model)
            pushes = pushes .or. any(model == ['ideal_gas', 'jwl      '])
        end associate
    end function pushes

    !> Bodies that fly straight on, and of which no two meet until the end of the run.
    subroutine judge_paths(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(in) :: case
        real(dp) :: gap, least
        integer :: a, b, pair(2)

        if (case%air%present .or. size(case%loads) > 0 .or. size(case%bodies) < 2) return
        least = huge(least)
        pair = 0
        do b = 1, size(case%bodies)
            if (is_from_file(case%bodies(b)) .or. is_driven(case, b) .or. pushes(case, b)) return
            if (any(abs(case%bodies(b)%spin) > 0)) return
            if (meets_image(case, b)) return
            do a = 1, b - 1
                gap = least_gap(case, a, b)
                if (gap <= max(case%bodies(a)%spacing, case%bodies(b)%spacing)) return
                if (gap < least) pair = [a, b]
                least = min(least, gap)
            end do
        end do
        call warn(deck, find_group(deck, 'run'), "no two bodies meet until t_end: '"// &
                  trim(case%bodies(pair(1))%id)//"' and '"//trim(case%bodies(pair(2))%id)// &
                  "' come no nearer than "//to_text(real(least, real32))//' m; look at their '// &
                  'places, at their velocities in m/s and at t_end in s')
    end subroutine judge_paths

    !> Does a body reach a plane of symmetry until the end of the run?
    logical function meets_image(case, b)
        type(case_t), intent(in) :: case
        integer, intent(in) :: b
        real(dp) :: lo(3), hi(3)

        call body_box(case%bodies(b), lo, hi)
        meets_image = any(case%run%symmetry .and. case%bodies(b)%velocity < 0 .and. &
                          lo + case%run%t_end*case%bodies(b)%velocity <= 0)
    end function meets_image

    !> Least distance of the boxes around two bodies that fly straight on until t_end [m]. It is a
    !> convex function of time.
    real(dp) function least_gap(case, a, b) result(gap)
        type(case_t), intent(in) :: case
        integer, intent(in) :: a, b
        real(dp) :: lo(3, 2), hi(3, 2), t(4)
        integer :: d, i
        integer, parameter :: rounds = 100

        call body_box(case%bodies(a), lo(:, 1), hi(:, 1))
        call body_box(case%bodies(b), lo(:, 2), hi(:, 2))
        d = case%run%dimension
        t([1, 4]) = [0.0_dp, case%run%t_end]
        do i = 1, rounds
            t(2:3) = t(1) + (t(4) - t(1))*[1, 2]/3
            if (gap_at(t(2)) <= gap_at(t(3))) then
                t(4) = t(3)
            else
                t(1) = t(2)
            end if
        end do
        gap = min(gap_at(t(1)), gap_at(t(4)))

    contains

        pure real(dp) function gap_at(time)
            real(dp), intent(in) :: time
            real(dp) :: shift(d)

            shift = time*(case%bodies(a)%velocity(:d) - case%bodies(b)%velocity(:d))
            gap_at = norm2(max(lo(:d, 1) + shift - hi(:d, 2), &
                               lo(:d, 2) - hi(:d, 1) - shift, 0.0_dp))
        end function gap_at
    end function least_gap
end module brz_check_idle
