! SPDX-License-Identifier: MIT
!> What `--check` prints: what was discretised, whether it is resolved, and what it will cost.
module brz_check
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_air_setup, only: time_step_ramp
    use brz_body_setup, only: meeting_speed
    use brz_check_bodies, only: body_box
    use brz_errors, only: error_t
    use brz_kinds, only: dp, real32
    use brz_material_report, only: material_report
    use brz_simulation, only: simulation_t
    use brz_solid_arrays, only: bytes_per_particle
    use brz_solid_state, only: form_names
    use brz_text, only: to_text
    use brz_time_step, only: choose_time_step
    implicit none
    private
    public :: print_check

    integer, parameter :: air_dump_bytes = 30, solid_dump_bytes = 128 !! per cell, particle

contains

    !> Print the check of a scene that is set up and not run.
    subroutine print_check(sim, err)
        type(simulation_t), intent(inout) :: sim
        type(error_t), intent(inout) :: err
        real(dp) :: dt, dumps
        character(:), allocatable :: notes
        integer :: i, n

        write (output_unit, '(a)') 'check of '//trim(sim%case%run%job)//': '//sim%case%run%title
        if (sim%air%present) call check_air(sim)
        if (sim%solid%present) call check_solid(sim)
        if (sim%solid%present) call check_materials(sim)
        call choose_time_step(sim, dt, err)
        if (sim%air%present) dt = dt/time_step_ramp(0, sim%case%air%ramp_steps)
        write (output_unit, '(a, es10.3, 3a, i0, a)') 'time step    ', dt, ' s at first, limit: ', &
            trim(sim%limiter), '; about ', nint(sim%case%run%t_end/dt), &
            ' steps at this rate (a blast shortens it)'
        dumps = 1
        if (sim%case%output%dump_every < sim%case%run%t_end) &
            dumps = 1 + sim%case%run%t_end/sim%case%output%dump_every
        write (output_unit, '(a, i0, a, f0.1, a)') 'output       ', int(dumps), ' dumps, about ', &
            1e-6_dp*dumps*(merge(real(air_dump_bytes, dp)*product(real(sim%air%n, dp)), 0.0_dp, &
                                 sim%air%present) + real(solid_dump_bytes, dp)*sim%solid%n), ' MB'
        notes = 'the deck is sound'
        n = size(sim%case%warnings)
        if (sim%solid%present) &
            n = n + count([(sim%solid%notes(i:i) == new_line('a'), i=1, len(sim%solid%notes))])
        if (n > 0) notes = to_text(n)//' warning(s) on the error unit'
        write (output_unit, '(a)') 'verdict      '//notes
    end subroutine print_check

    !> Materials of the bodies; their Hugoniot where two bodies of them would meet at full speed.
    subroutine check_materials(sim)
        type(simulation_t), intent(in) :: sim
        integer :: m

        do m = 1, size(sim%case%materials)
            if (.not. any(sim%case%bodies%material == sim%case%materials(m)%id)) cycle
            write (output_unit, '(a)', advance='no') &
                material_report(sim%case%materials(m), sim%solid%materials(m), &
                                meeting_speed(sim%case)/2)
        end do
    end subroutine check_materials

    !> Memory for the air and the walls in it, ghosts and all [B].
    pure real(dp) function air_bytes(sim) result(bytes)
        type(simulation_t), intent(in) :: sim

        bytes = storage_size(sim%air%u)/8.0_dp* &
                (size(sim%air%u) + size(sim%air%u_start) + size(sim%air%rate))
        if (.not. sim%coupling%present) return
        bytes = bytes + size(sim%coupling%wall%solid) + 4.0_dp*size(sim%coupling%wall%index) + &
                size(sim%coupling%mark) + 4.0_dp*size(sim%coupling%slot)
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
                    trim(sim%case%charges(c)%id), ': ', air%charge(c)%mass, &
                    ' kg in the model, ', air%charge(c)%cells, &
                    ' cells per radius, density scaled by ', air%charge(c)%scale
            end do
        end associate
    end subroutine check_air

    !> Particles, layers and bytes of every body.
    subroutine check_solid(sim)
        type(simulation_t), intent(in) :: sim
        integer :: b

        do b = 1, size(sim%solid%bodies)
            associate (body => sim%solid%bodies(b), solid => sim%solid)
                write (output_unit, '(3a, i0, 3a, es10.3, a, f0.4)') 'body         ', &
                    trim(body%id), ': ', body%last - body%first + 1, ' particles at ', &
                    to_text(real(1e3_dp*body%spacing, real32)), ' mm,', &
                    sum(real(solid%mass(body%first:body%last), dp)), ' kg, volume scaled by ', &
                    body%volume_scale
                write (output_unit, '(3a, 2(a, f0.2), a)') '             ', &
                    trim(form_names(body%formulation)), reason(sim, b), ', viscosity alpha ', &
                    body%alpha, ', beta ', body%beta, &
                    trim(merge(', less where it shears (balsara)', repeat(' ', 32), body%balsara))
                if (body%across > 0) write (output_unit, '(a, i0, a)') '             ', &
                    body%across, ' particles per bar diameter'
                if (sim%case%bodies(b)%n_plies > 0 .and. sim%case%bodies(b)%file == '') &
                    write (output_unit, '(a, i0, a, f0.2, a)') '             ', &
                    sim%case%bodies(b)%n_plies, ' plies of ', &
                    layers_of(sim, b)/sim%case%bodies(b)%n_plies, ' layers of particles'
            end associate
        end do
        write (output_unit, '(a, i0, a, f0.1, a, f0.0, a)') 'solids       ', sim%solid%n, &
            ' particles, ', 1e-6_dp*bytes_per_particle(sim%solid)*sim%solid%n, ' MB, ', &
            bytes_per_particle(sim%solid), ' B per particle, without neighbour lists'
    end subroutine check_solid

    !> Why a body has its formulation, and how it is held.
    function reason(sim, b) result(text)
        type(simulation_t), intent(in) :: sim
        integer, intent(in) :: b !! body
        character(:), allocatable :: text
        character(44), parameter :: auto(4) = [character(44) :: &
                                               ' (auto: it springs back until it breaks)', &
                                               ' (auto: a metal flows and stays together)', &
                                               ' (auto: it crumbles)', ' (auto: it has no shape)']

        text = ''
        associate (body => sim%solid%bodies(b))
            if (sim%case%bodies(b)%formulation == 'auto') &
                text = trim(auto(sim%solid%materials(body%material)%class))
            if (body%tension_hold > 0) &
                text = text//', held by '//to_text(real(body%tension_hold, real32))// &
                       ' times its tension'
        end associate
    end function reason

    !> Layers of particles across the plies of a body.
    pure real(dp) function layers_of(sim, b) result(layers)
        type(simulation_t), intent(in) :: sim
        integer, intent(in) :: b !! body
        real(dp) :: lo(3), hi(3)
        integer :: a

        call body_box(sim%case%bodies(b), lo, hi)
        a = index('xyz', sim%case%bodies(b)%ply_axis)
        layers = max(1, nint((hi(a) - lo(a))/sim%case%bodies(b)%spacing))
    end function layers_of
end module brz_check
