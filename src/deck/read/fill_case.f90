! SPDX-License-Identifier: MIT
!> Components of the case from the groups of the deck, one procedure per group.
module brz_fill_case
    use brz_case, only: air_case_t, body_case_t, case_t, charge_case_t, gas_case_t, gauge_case_t, &
                        name_len, output_case_t, run_case_t, solid_case_t
    use brz_deck, only: add_error, add_warning, complain, deck_t, entry_line, place, &
                        find_group, group_t
    use brz_explosives, only: explosives, find_explosive
    use brz_fill_rollers, only: fill_rollers
    use brz_fill_shape, only: fill_shape
    use brz_get, only: count_values, get, get_box, get_boxes, get_path, is_usable
    use brz_kinds, only: dp
    use brz_layup, only: parse_layup
    use brz_text, only: to_text
    implicit none
    private
    public :: fill_run, fill_air, fill_gas, fill_charge, fill_body, fill_gauge, fill_settings, &
              name_job

contains

    subroutine fill_run(deck, run)
        type(deck_t), intent(inout) :: deck
        type(run_case_t), intent(inout) :: run
        character(200) :: title
        character(8) :: axes(3)
        integer :: g, i, n

        call name_job(deck, run%job)
        run%title = ''
        g = find_group(deck, 'run')
        if (g == 0) return
        associate (group => deck%groups(g))
            title = ''
            call get(group, 'title', title)
            run%title = trim(title)
            call get(group, 't_end', run%t_end)
            call get(group, 'symmetry', axes, n)
            do i = 1, n
                run%symmetry(index('xyz', axes(i) (1:1))) = .true.
            end do
            call get(group, 'dimension', run%dimension)
            call get(group, 'backend', run%backend)
            call get(group, 'dt_max', run%dt_max)
            call get(group, 'dt_min', run%dt_min)
            call get(group, 'energy_band', run%energy_band)
            call get(group, 'max_steps', run%max_steps)
            if (run%dt_min > run%dt_max) call add_error(deck, entry_line(group, 'dt_min'), &
                                                        '&run: dt_min is larger than dt_max')
            if (any(run%symmetry(run%dimension + 1:))) &
                call add_error(deck, entry_line(group, 'symmetry'), &
                               '&run: a plane of symmetry lies in a direction that is not '// &
                               'modelled '// &
                               '(see dimension)')
        end associate
    end subroutine fill_run

    !> The name of the deck without folder and ending.
    subroutine name_job(deck, job)
        type(deck_t), intent(inout) :: deck
        character(*), intent(inout) :: job
        integer :: first, last

        first = index(deck%file, '/', back=.true.) + 1
        last = index(deck%file(first:), '.', back=.true.) + first - 2
        if (last < first) last = len(deck%file)
        job = deck%file(first:last)
        if (last - first + 1 > len(job)) &
            call add_warning(deck, 0, "the name of the deck is long: the job is called '"// &
                             trim(job)//"'")
    end subroutine name_job

    subroutine fill_air(deck, g, case)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(inout) :: case

        associate (group => deck%groups(g), air => case%air)
            air%present = .true.
            air%place = place(deck, group%line)
            call get(group, 'geometry', air%geometry)
            call get(group, 'floor', air%floor)
            call get_box(group, air%lo, air%hi)
            call get(group, 'cells', air%cells)
            call get(group, 'density', air%density)
            call get(group, 'pressure', air%pressure)
            call get(group, 'gamma', air%gamma)
            call get(group, 'cfl', air%cfl)
            call get(group, 'ramp_steps', air%ramp_steps)
            call get(group, 'reconstruction', air%reconstruction)
            call get(group, 'flux', air%flux)
            call get(group, 'integrator', air%integrator)
            call get(group, 'activity', air%activity)
            call get(group, 'fallback', air%fallback)
        end associate
        call fill_boundaries(deck, g, case)
    end subroutine fill_air

    !> One word for all six faces, or six; planes of symmetry take the low faces.
    subroutine fill_boundaries(deck, g, case)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(case_t), intent(inout) :: case
        character(len(case%air%bc)) :: word(6)
        integer :: i, n

        associate (group => deck%groups(g), bc => case%air%bc)
            call get(group, 'bc', word, n)
            if (n == 1) word = word(1)
            if (n == 1 .or. n == 6) bc = reshape(word, [2, 3])
            if (n > 1 .and. n < 6) call complain(deck, g, 'bc', &
                                                 'give one word for all faces, or six: x low, '// &
                                                 'x high, '// &
                                                 'y low, y high, z low, z high')
            do i = 1, 3
                if (.not. case%run%symmetry(i)) cycle
                if (n == 6 .and. bc(1, i) /= 'symmetry') &
                    call complain(deck, g, 'bc', 'the low face of a plane of symmetry of &run '// &
                    'must be '// &
                                  "'symmetry', not '"//trim(bc(1, i))//"'")
                bc(1, i) = 'symmetry'
            end do
            do i = 1, 3
                if ((bc(1, i) == 'periodic') .neqv. (bc(2, i) == 'periodic')) &
                    call complain(deck, g, 'bc', "'periodic' must stand at both faces of a "// &
                    "direction")
            end do
        end associate
    end subroutine fill_boundaries

    subroutine fill_gas(deck, g, gas)
        type(deck_t), intent(in) :: deck
        integer, intent(in) :: g
        type(gas_case_t), intent(inout) :: gas

        associate (group => deck%groups(g))
            gas%id = group%id
            gas%place = place(deck, group%line)
            call get_box(group, gas%lo, gas%hi)
            call get(group, 'density', gas%density)
            call get(group, 'pressure', gas%pressure)
            call get(group, 'velocity', gas%velocity)
            call get_path(deck, g, 'file', gas%file)
            call get(group, 'move', gas%move)
            call get(group, 'at', gas%at)
        end associate
    end subroutine fill_gas

    subroutine fill_charge(deck, group, charge)
        type(deck_t), intent(in) :: deck
        type(group_t), intent(in) :: group
        type(charge_case_t), intent(inout) :: charge
        character(name_len) :: burst
        integer :: row

        charge%id = group%id
        charge%place = place(deck, group%line)
        call get(group, 'mass', charge%mass)
        burst = 'air'
        call get(group, 'burst', burst)
        charge%on_ground = burst == 'surface'
        if (charge%on_ground) charge%mass = 2*charge%mass
        call get(group, 'explosive', charge%explosive)
        call get(group, 'start', charge%start)
        call get(group, 'eos', charge%eos)
        call get(group, 'burn', charge%burn)
        row = find_explosive(charge%explosive)
        if (row > 0) then
            charge%density = explosives(row)%density
            charge%energy = explosives(row)%energy/explosives(row)%density
            charge%velocity = explosives(row)%velocity
            if (charge%eos == 'jwl') charge%gamma = 1 + explosives(row)%omega
        end if
        call get(group, 'shape', charge%shape)
        call get(group, 'at', charge%at)
        call get(group, 'density', charge%density)
        call get(group, 'energy', charge%energy)
        call get(group, 'velocity', charge%velocity)
        call get(group, 'gamma', charge%gamma)
        call get(group, 'radial_cells', charge%radial_cells)
        call get(group, 'plane_cells', charge%plane_cells)
        charge%ignition = charge%at
        call get(group, 'ignition', charge%ignition)
        call get(group, 'afterburn', charge%afterburn)
        call get(group, 'afterburn_time', charge%afterburn_time)
        call get(group, 'aspect', charge%aspect)
        call get(group, 'sides', charge%sides)
        call get(group, 'axis', charge%axis)
    end subroutine fill_charge

    subroutine fill_body(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(inout) :: body
        integer :: n

        call fill_shape(deck, g, body)
        associate (group => deck%groups(g))
            body%id = group%id
            body%place = place(deck, group%line)
            call get(group, 'material', body%material)
            call get(group, 'ply_axis', body%ply_axis)
            call get(group, 'fix', body%fix, n)
            call get(group, 'fix_layers', body%fix_layers)
            call get(group, 'fix_width', body%fix_width)
            call get(group, 'velocity', body%velocity)
            call get(group, 'spin', body%spin)
            call get(group, 'spin_centre', body%spin_centre)
            call get_path(deck, g, 'start_file', body%start_file)
            call get(group, 'start_stress', body%start_stress)
            body%about_point = is_usable(group, 'spin_centre')
            call get(group, 'formulation', body%formulation)
            call get(group, 'alpha', body%alpha)
            call get(group, 'beta', body%beta)
            call get(group, 'limiter', body%limiter)
            call get(group, 'crack_band', body%crack_band)
            call get(group, 'artificial_stress', body%artificial_stress)
            call get(group, 'artificial_strength', body%artificial_strength)
            call get(group, 'zeta', body%zeta)
            call get(group, 'hourglass_axes', body%hourglass_axes)
            call get(group, 'variable_h', body%variable_h)
            call get(group, 'h_range', body%h_range)
            call get(group, 'zeta_viscous', body%zeta_viscous)
            call get(group, 'tensile_control', body%tensile_control)
            call get(group, 'plate_axis', body%plate_axis)
            call get(group, 'smoothing', body%smoothing)
            call get(group, 'cfl', body%cfl)
        end associate
        call fill_plies(deck, g, body)
        call get_boxes(deck, g, 'fix_box', body%fix_box, body%n_fix_boxes)
        call fill_motion(deck, g, body)
        call fill_rollers(deck, g, body)
    end subroutine fill_body

    !> Points of a prescribed velocity: times that grow, three numbers for each.
    subroutine fill_motion(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(inout) :: body
        real(dp) :: v(size(body%motion_velocity))
        integer :: n, m

        n = count_values(deck%groups(g), 'motion_time')
        m = count_values(deck%groups(g), 'motion_velocity')
        if (m /= 3*n) call complain(deck, g, merge('motion_time    ', 'motion_velocity', m > 3*n), &
            'motion_velocity has '//to_text(m)//' numbers for '//to_text(n)// &
            ' times of motion_time; give three numbers for each time')
        if (n == 0 .or. m /= 3*n) return
        call get(deck%groups(g), 'motion_time', body%motion_time)
        if (any(body%motion_time(2:n) <= body%motion_time(:n - 1))) &
            call complain(deck, g, 'motion_time', 'the times of motion_time must grow')
        v = 0
        call get(deck%groups(g), 'motion_velocity', v)
        body%motion_velocity = reshape(v, shape(body%motion_velocity))
        body%n_motion = n
        if (body%formulation /= 'rigid' .and. all(body%fix == '') .and. body%n_fix_boxes == 0) &
            call complain(deck, g, 'motion_time', 'a prescribed velocity is that of a rigid '// &
                          "body or of held particles; add formulation='rigid', fix or fix_box")
    end subroutine fill_motion

    subroutine fill_plies(deck, g, body)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(body_case_t), intent(inout) :: body
        character(2048) :: layup
        character(:), allocatable :: message

        if (.not. is_usable(deck%groups(g), 'plies')) return
        layup = ''
        call get(deck%groups(g), 'plies', layup)
        call parse_layup(trim(layup), body%ply_angle, body%n_plies, message)
        if (message /= '') call complain(deck, g, 'plies', 'plies: '//message)
    end subroutine fill_plies

    subroutine fill_gauge(deck, group, gauge)
        type(deck_t), intent(in) :: deck
        type(group_t), intent(in) :: group
        type(gauge_case_t), intent(inout) :: gauge

        gauge%place = place(deck, group%line)
        gauge%id = group%id
        call get(group, 'at', gauge%at)
        call get(group, 'to', gauge%to)
        call get(group, 'width', gauge%width)
        if (count_values(group, 'width') == 1) gauge%width = gauge%width(1)
        call get(group, 'quantity', gauge%quantity)
        call get(group, 'body', gauge%body)
        call get(group, 'with', gauge%with)
        call get(group, 'motion', gauge%motion)
    end subroutine fill_gauge

    !> &solid, &coupling and &output; they follow the groups that they depend on.
    subroutine fill_settings(deck, case)
        type(deck_t), intent(inout) :: deck
        type(case_t), intent(inout) :: case
        integer :: g

        case%solid%present = size(case%bodies) > 0
        case%coupling%present = case%air%present .and. case%solid%present
        case%coupling%reference_pressure = case%air%pressure
        do g = 1, deck%n
            associate (group => deck%groups(g))
                select case (group%name)
                case ('solid')
                    call get(group, 'skin', case%solid%skin)
                    call get(group, 'leave', case%solid%leave)
                    call get(group, 'jitter', case%solid%jitter)
                    call get(group, 'seed', case%solid%seed)
                    call get_region(deck, g, case%run%dimension, case%solid)
                case ('coupling')
                    call get(group, 'scheme', case%coupling%scheme)
                    call get(group, 'reference_pressure', case%coupling%reference_pressure)
                case ('output')
                    call get(group, 'dump_every', case%output%dump_every)
                    call get(group, 'dump_from', case%output%dump_from)
                    call fill_dump_times(deck, g, case%output)
                    call get(group, 'history_every', case%output%history_every)
                    call get(group, 'checkpoint_every', case%output%checkpoint_every)
                    call get(group, 'report_every', case%output%report_every)
                end select
            end associate
        end do
    end subroutine fill_settings

    !> Listed times of dumps: they must grow and lie within the run.
    subroutine fill_dump_times(deck, g, output)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g
        type(output_case_t), intent(inout) :: output
        integer :: n

        n = count_values(deck%groups(g), 'dump_times')
        if (output%dump_from > 0 .and. output%dump_every > huge(1.0_dp)/2) &
            call complain(deck, g, 'dump_from', 'dump_from is the first time of dump_every, '// &
                          'which is not there; add dump_every, or take dump_times')
        allocate (output%dump_times(n), source=0.0_dp)
        call get(deck%groups(g), 'dump_times', output%dump_times)
        if (any(output%dump_times(2:) <= output%dump_times(:n - 1))) &
            call complain(deck, g, 'dump_times', 'the times of dump_times must grow')
    end subroutine fill_dump_times

    !> Corners from 'region'.
    subroutine get_region(deck, g, dimension, solid)
        type(deck_t), intent(inout) :: deck
        integer, intent(in) :: g, dimension
        type(solid_case_t), intent(inout) :: solid
        real(dp) :: box(6)

        box = 0
        call get(deck%groups(g), 'region', box)
        solid%has_region = is_usable(deck%groups(g), 'region')
        solid%region = transpose(reshape(box, [2, 3]))
        if (solid%has_region .and. any(box(2:2*dimension:2) <= box(1:2*dimension:2))) &
            call complain(deck, g, 'region', 'region has no room: it ends where it begins or '// &
                          'before; the lower corner of x, y and z comes first')
    end subroutine get_region
end module brz_fill_case
