! SPDX-License-Identifier: MIT
!> What `--check` prints: what was discretised, whether it is resolved, and what it will cost.
module brz_check
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_advice, only: print_advice
    use brz_air_setup, only: time_step_ramp
    use brz_body, only: body_t
    use brz_formulation_names, only: form_bending, form_names, form_rigid, form_total
    use brz_approach_speed, only: approach_speed
    use brz_case, only: body_case_t, case_t
    use brz_body_geometries, only: body_box
    use brz_print_interactions, only: print_interactions
    use brz_print_walls, only: print_wall
    use brz_cohesive_setup, only: interface_name, zone_over_spacing
    use brz_conservation_audit, only: cohesive_totals
    use brz_crack_band, only: crack_report
    use brz_cut_cells, only: list_bytes
    use brz_early, only: early_t
    use brz_errors, only: error_t, failed
    use brz_face_load, only: first_arrival
    use brz_gauges, only: gauges_t, set_up_gauges
    use brz_kinds, only: dp, real32, rk
    use brz_material_report, only: material_report
    use brz_particle_marks, only: is_fixed
    use brz_print_early, only: is_too_early
    use brz_run_ranks, only: print_ranks, print_regions
    use brz_scene_size, only: count_text, memory_text, scene_size_t
    use brz_screen, only: say
    use brz_simulation, only: simulation_t
    use brz_solid_arrays, only: bytes_per_particle
    use brz_bodies, only: bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_tensile_control, only: kappa_of
    use brz_solid_start, only: solid_time_step
    use brz_text, only: to_text
    use brz_time_step, only: choose_time_step
    use brz_whole_step, only: whole_step
    use brz_work, only: particle_costs, print_work, work_t
    implicit none
    private
    public :: print_check, print_outline

    !> What 1, 2, 3 and more particles across a bar do.
    character(48), parameter :: of_bars(3) = [character(48) :: &
        'stretched by the body around it alone', 'stiff as it is along, too soft in bending', &
        'stiff as it is along and in bending']
    integer, parameter :: air_dump_bytes = 30, solid_dump_bytes = 140 !! per cell, particle

    character(38), parameter :: limiter_notes(0:3) = [character(38) :: '', &
        ', less where it shears (balsara)', ', where it is compressed (compression)', &
        ', where the flow is not smooth (slope)']

contains

    !> Print the check of a scene that is set up and not run.
    subroutine print_check(sim, size_of, n, err)
        type(simulation_t), intent(inout) :: sim
        type(scene_size_t), intent(in) :: size_of
        integer, intent(in) :: n !! processes that are thought of
        type(error_t), intent(inout) :: err
        type(scene_size_t) :: exact
        type(gauges_t) :: gauges
        real(dp) :: dt
        logical :: gpus

        call set_up_gauges(sim%case, sim%solid, gauges, err) ! for what a run would refuse
        if (failed(err)) return
        write (output_unit, '(a)') 'check of '//trim(sim%case%run%job)//': '//sim%case%run%title
        if (sim%air%present) call check_air(sim)
        if (sim%solid%present) call check_solid(sim)
        if (sim%solid%present) call print_interactions(sim%case)
        if (sim%solid%present) call check_materials(sim%case, sim%solid)
        exact = size_of
        exact%particles = sim%solid%n
        gpus = sim%backend%on_gpu .or. sim%backend%bodies_on_gpu
        if (sim%solid%present) exact%of_body = sim%solid%bodies%last - sim%solid%bodies%first + 1
        sim%backend%on_gpu = .false. ! nothing has been brought there
        call choose_time_step(sim, dt, err)
        if (sim%air%present) exact%dt_air = &
            min(dt/time_step_ramp(0, sim%case%air%ramp_steps), sim%case%run%dt_max)
        if (sim%solid%present) exact%dt_solid = solid_time_step(sim%solid)
        if (sim%solid%present .and. .not. sim%air%present) then
            if (all(sim%solid%bodies%inactive)) exact%quiet = &
                min(max(first_arrival(sim%solid%loads), 0.0_dp), sim%case%run%t_end)
        end if
        call print_cost(sim%case, exact, sim%solid, gpus, sim%early)
        call print_ranks(sim%case, size_of, n)
        call print_regions(sim%case, size_of, sim%solid, n)
        call print_verdict(sim%case, sim%solid, 'the deck is sound', &
                           merge(1, 0, is_too_early(sim%early)))
    end subroutine print_check

    !> Print what the deck alone says of a scene that is too large to look at it in seconds.
    subroutine print_outline(case, size_of, gpus)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(in) :: size_of
        logical, intent(in) :: gpus !! a GPU will compute it
        integer :: b

        if (allocated(size_of%solid%notes)) &
            write (error_unit, '(a)', advance='no') size_of%solid%notes
        write (output_unit, '(a)') 'check of '//trim(case%run%job)//': '//case%run%title
        if (case%air%present) write (output_unit, '(3a, 3(1x, i0), a)') 'air          ', &
            count_text(size_of%cells), ' cells (', case%air%cells, ' )'
        do b = 1, size(case%bodies)
            associate (body => size_of%solid%bodies(b))
                write (output_unit, '(7a)') 'body         ', trim(body%id), ': about ', &
                    count_text(size_of%of_body(b)), ' particles at ', &
                    width_of(body), ' mm'
                call print_settings(case, size_of%solid, b)
            end associate
        end do
        if (size_of%solid%present) call print_interactions(case)
        if (size_of%solid%present) call check_materials(case, size_of%solid)
        call print_cost(case, size_of, size_of%solid, gpus, early_t())
        call print_verdict(case, size_of%solid, 'sound as far as it can be read; a run builds '// &
                           'it and looks for bodies that overlap and charges inside them')
    end subroutine print_outline

    !> Memory, steps, output and time, and what would be cheaper.
    subroutine print_cost(case, size_of, solid, gpus, early)
        type(case_t), intent(in) :: case
        type(scene_size_t), intent(in) :: size_of
        class(bodies_t), intent(in) :: solid !! its bodies and materials
        logical, intent(in) :: gpus !! a GPU will compute it
        type(early_t), intent(in) :: early !! a blast before the run, if it is known
        real(dp), parameter :: slack = 1e-9_dp !! rounding of a time, in intervals
        type(work_t) :: work
        real(dp) :: dt, dumps, steps, substeps
        logical :: deform !! some body is not rigid

        write (output_unit, '(2a)') 'memory       ', memory_text(size_of)
        dt = min(case%run%dt_max, merge(size_of%dt_air, size_of%dt_solid, case%air%present), &
                 case%run%t_end)
        substeps = 1
        deform = .false.
        if (size_of%particles > 0) deform = any(solid%bodies%formulation /= form_rigid)
        if (case%air%present .and. deform) then
            dt = whole_step(dt, size_of%dt_solid, size_of%cells, size_of%particles)
            substeps = max(1.0_dp, real(ceiling(dt/size_of%dt_solid), dp))
        end if
        steps = max(1.0_dp, anint((case%run%t_end - early%time - size_of%quiet)/dt))
        if (size_of%quiet > 0) write (output_unit, '(a, es10.3, a)') 'wait         ', &
            size_of%quiet, ' s until the first load: one step, and one for each output'
        write (output_unit, '(a, es10.3, 3a)') 'time step    ', dt, ' s at first, about ', &
            count_text(steps), ' steps at this rate (a blast or a fracture shortens it)'
        if (case%air%present .and. deform) write (output_unit, '(a, es10.3, 5a)') &
            'solid steps  ', size_of%dt_solid, ' s at first: ', count_text(substeps), &
            ' in each step of the air, about ', count_text(steps*substeps), ' while active'
        associate (out => case%output, t_end => case%run%t_end)
            dumps = 2 + max(aint(t_end/out%dump_every - slack) &
                            - aint(max(out%dump_from/out%dump_every - slack, 0.0_dp)), 0.0_dp)
            if (allocated(out%dump_times)) dumps = dumps + count(out%dump_times < t_end)
        end associate
        write (output_unit, '(3a, f0.1, a)') 'output       ', count_text(dumps), &
            ' dumps, about ', 1e-6_dp*dumps*(air_dump_bytes*size_of%cells + &
                                             solid_dump_bytes*size_of%particles), ' MB'
        work = work_t(steps, substeps, size_of%cells, size_of%particles)
        if (size_of%particles > 0) work%of_body = size_of%of_body
        if (size_of%particles > 0) work%costs = particle_costs(solid)
        call print_work(work, gpus)
        call print_advice(case, size_of%solid, work, early)
    end subroutine print_cost

    !> What all of it comes to; warnings have been written on the error unit.
    subroutine print_verdict(case, solid, sound, more)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        character(*), intent(in) :: sound
        integer, intent(in), optional :: more !! warnings besides those of both
        character(:), allocatable :: verdict
        integer :: i, n

        verdict = sound
        n = size(case%warnings)
        if (present(more)) n = n + more
        if (allocated(solid%notes)) &
            n = n + count([(solid%notes(i:i) == new_line('a'), i=1, len(solid%notes))])
        if (n > 0) verdict = to_text(n)//' warning(s) on the error unit'
        call say('verdict      '//verdict)
    end subroutine print_verdict

    !> Materials of the bodies; their Hugoniot where two bodies of them would meet at full speed.
    subroutine check_materials(case, solid)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        integer :: m

        do m = 1, size(case%materials)
            if (.not. any(case%bodies%material == case%materials(m)%id)) cycle
            write (output_unit, '(a)', advance='no') &
                material_report(case%materials(m), solid%materials(m), approach_speed(case)/2)
        end do
    end subroutine check_materials

    !> Memory for the air and the walls in it, ghosts and all [B].
    pure real(dp) function air_bytes(sim) result(bytes)
        type(simulation_t), intent(in) :: sim

        bytes = storage_size(sim%air%u)/8.0_dp* &
                (size(sim%air%u) + size(sim%air%u_start) + size(sim%air%rate))
        if (.not. sim%coupling%present) return
        bytes = bytes + size(sim%coupling%wall%solid)
        if (sim%coupling%paper) return
        associate (cells => sim%coupling%wall%cells)
            bytes = bytes + 4.0_dp*size(cells%slot) + size(cells%mark) + size(cells%next_mark) &
                    + list_bytes(real(cells%n, dp))
        end associate
    end function air_bytes

    !> Cells, bytes, and the charges as they lie on the grid.
    subroutine check_air(sim)
        type(simulation_t), intent(in) :: sim
        integer :: c

        associate (air => sim%air, cells => product(real(sim%air%n, dp)))
            write (output_unit, '(a, i0, a, 3(1x, i0), a, 3(1x, a), a, f0.1, a, f0.0, a)') &
                'air          ', nint(cells), ' cells (', air%n, ' ) of', &
                (to_text(real(1e3_dp*air%dx(c), real32)), c=1, 3), ' mm, ', &
                1e-6_dp*air_bytes(sim), ' MB, ', air_bytes(sim)/cells, ' B per cell'
            do c = 1, size(sim%case%charges)
                write (output_unit, '(3a, es10.3, a, f0.1, a, f6.4)') 'charge       ', &
                    trim(sim%case%charges(c)%id), ': ', air%charge(c)%mass - air%charge(c)%lost, &
                    ' kg in the model, ', air%charge(c)%cells, &
                    ' cells per radius, density scaled by ', air%charge(c)%scale
            end do
        end associate
    end subroutine check_air

    !> Particles, layers and bytes of every body.
    subroutine check_solid(sim)
        type(simulation_t), intent(inout) :: sim
        integer :: b, held

        do b = 1, size(sim%solid%bodies)
            associate (body => sim%solid%bodies(b), solid => sim%solid)
                write (output_unit, '(3a, i0, 3a, es10.3, a, f0.4)') 'body         ', &
                    trim(body%id), ': ', body%last - body%first + 1, ' particles at ', &
                    width_of(body), ' mm,', &
                    sum(real(solid%mass(body%first:body%last), dp)), ' kg, volume scaled by ', &
                    body%volume_scale
                call print_settings(sim%case, solid, b)
                held = count(solid%fixed(body%first:body%last) == is_fixed)
                if (held > 0) call print_more(to_text(held)//' particles are fixed')
                call print_more(crack_report(body, solid%materials(body%material)))
            end associate
        end do
        if (sim%solid%cohesive%present) call check_interfaces(sim%solid)
        write (output_unit, '(a, i0, a, f0.1, a, f0.0, a)') 'solids       ', sim%solid%n, &
            ' particles, ', 1e-6_dp*bytes_per_particle(sim%solid)*sim%solid%n, ' MB, ', &
            bytes_per_particle(sim%solid), ' B per particle, without neighbour lists'
    end subroutine check_solid

    !> Points, zones, stiffness and stable step of every cohesive interface.
    subroutine check_interfaces(solid)
        class(interacting_bodies_t), intent(in) :: solid
        real(dp) :: sums(4)
        integer :: k

        do k = 1, size(solid%cohesive%law)
            call cohesive_totals(solid%cohesive, k, sums(1), sums(2), sums(3), sums(4))
            associate (cohesive => solid%cohesive)
                write (output_unit, '(3a, i0, 5a)') 'interface    ', interface_name(solid, k), &
                    ': ', count(cohesive%of == k), ' points, ', number(sums(4)), &
                    ' m2, zone E G/T^2 of ', number(zone_over_spacing(solid, k, 1)), &
                    ' (opening), '//number(zone_over_spacing(solid, k, 2))//' (sliding) spacings'
                call print_more('stiffness '//number(cohesive%law(k)%stiffness)//' Pa/m'// &
                                trim(merge(' (less than usual, for the time step)', &
                                           '                                     ', &
                                           cohesive%softened(k)))// &
                                ', time step up to '//number(cohesive%limit(k))//' s')
            end associate
        end do
    end subroutine check_interfaces

    function number(x) result(text)
        real(dp), intent(in) :: x
        character(:), allocatable :: text
        character(12) :: digits

        write (digits, '(es10.3)') x
        if (x >= 0.01_dp .and. x < 1e4_dp) write (digits, '(f0.2)') x
        text = trim(adjustl(digits))
        if (text(1:1) == '.') text = '0'//text
    end function number

    !> A line beneath that of a body, unless it is empty.
    subroutine print_more(text)
        character(*), intent(in) :: text

        if (text /= '') write (output_unit, '(a)') '             '//text
    end subroutine print_more

    !> Distance of the particles of a body, along each axis where they are wide [mm].
    function width_of(body) result(text)
        type(body_t), intent(in) :: body
        character(:), allocatable :: text
        integer :: a

        text = to_text(real(1e3_dp*body%spacing/body%stretch(1), real32))
        if (.not. any(abs(body%stretch - 1) > 0)) return
        do a = 2, 3
            text = text//' x '//to_text(real(1e3_dp*body%spacing/body%stretch(a), real32))
        end do
    end function width_of

    !> Why a body has its formulation, and how it is held.
    function reason(case, solid, b) result(text)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b !! body
        character(:), allocatable :: text
        character(1), parameter :: axis_names(3) = ['x', 'y', 'z']
        character(44), parameter :: auto(4) = [character(44) :: &
                                               ' (auto: elastic-brittle)', &
                                               ' (auto: ductile metal)', &
                                               ' (auto: granular, softens by damage)', &
                                               ' (auto: fluid)']

        text = ''
        associate (body => solid%bodies(b))
            if (case%bodies(b)%formulation == 'auto' .and. body%formulation == form_total) then
                text = ' (auto: anisotropic spacing)'
            else if (case%bodies(b)%formulation == 'auto') then
                text = trim(auto(solid%materials(body%material)%class))
            end if
            if (body%tensile_control > 0) &
                text = text//', tensile control '//to_text(real(body%tensile_control, real32))
            if (body%tensile_control > 0 .and. body%lift > 0) text = text//' (free faces '// &
                to_text(real(kappa_of(body%tensile_control, body%lift, 1.0_rk), real32))//')'
            if (body%curved) text = text//', a wall round '//axis_names(minloc(body%normal, dim=1))
            if (body%formulation /= form_bending .and. count(body%normal > 0) == 1) &
                text = text//', a plate across '//axis_names(maxloc(body%normal, dim=1))
            if (body%tensile_control > 0 .and. count(body%normal > 0) == 2 .and. &
                .not. body%curved) text = text//', a bar along '//axis_names(minloc(body%normal, &
                dim=1))
            if (body%formulation == form_total) &
                text = text//', time step in proportion to its compression'
        end associate
    end function reason

    !> Formulation and viscosity of body b, its bars or plies.
    subroutine print_settings(case, solid, b)
        type(case_t), intent(in) :: case
        class(bodies_t), intent(in) :: solid
        integer, intent(in) :: b

        associate (body => solid%bodies(b))
            write (output_unit, '(3a, 2(a, f0.2), a)') '             ', &
                trim(form_names(body%formulation)), reason(case, solid, b), &
                ', viscosity alpha ', body%alpha, ', beta ', body%beta, &
                trim(limiter_notes(body%limiter))
            if (body%across > 0) write (output_unit, '(a, i0, 2a)') '             ', &
                body%across, ' particles per bar diameter: ', trim(of_bars(min(body%across, 3)))
            if (case%bodies(b)%n_plies > 0 .and. case%bodies(b)%file == '') &
                write (output_unit, '(a, i0, a, f0.2, a)') '             ', &
                case%bodies(b)%n_plies, ' plies of ', &
                layers_of(case%bodies(b))/case%bodies(b)%n_plies, ' layers of particles'
        end associate
        if (case%coupling%present) call print_wall(case, b)
    end subroutine print_settings

    !> Layers of particles across the plies of a body.
    real(dp) function layers_of(body) result(layers)
        type(body_case_t), intent(in) :: body
        real(dp) :: lo(3), hi(3)
        integer :: a

        call body_box(body, lo, hi)
        a = index('xyz', body%ply_axis)
        layers = max(1, nint((hi(a) - lo(a) + body%below(a))/body%spacing))
    end function layers_of
end module brz_check
