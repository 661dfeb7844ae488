! SPDX-License-Identifier: MIT
!> What a run prints at its end: balances, gauges, and what it cost.
module brz_summary
    use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
    use brz_boxes, only: cells_of
    use brz_cohesive_setup, only: interface_name
    use brz_conservation_audit, only: cohesive_totals
    use brz_cut_cells, only: cut_cells_t
    use brz_errors, only: error_t, failed
    use brz_host_calls, only: counting, print_calls
    use brz_kernel_profile, only: print_profile, profiling
    use brz_kinds, only: dp, int64
    use brz_conservation_audit, only: audit_start_t, balance_t, audit_scene
    use brz_outputs, only: outputs_t
    use brz_gauge_summary, only: gauge_summary
    use brz_ranks, only: least_of_all, most_of_all, several, traffic
    use brz_saves, only: on_gpu
    use brz_simulation, only: simulation_t
    use brz_solid_owner, only: all_particles
    use brz_screen, only: say
    use brz_timer, only: wall_seconds
    implicit none
    private
    public :: print_summary, doubt_of

    real(dp), parameter :: large_error = 0.05_dp !! of the energy [-]

contains

    !> Print the summary.
    subroutine print_summary(sim, outputs, err)
        type(simulation_t), intent(inout) :: sim
        type(outputs_t), intent(in) :: outputs
        type(error_t), intent(inout) :: err
        type(balance_t) :: audit
        type(audit_start_t) :: start
        character(:), allocatable :: text

        start = sim%start
        call audit_scene(sim%clock%time, sim%backend, sim%air, sim%solid, sim%coupling, start, &
                        audit, err)
        write (output_unit, '(/, a, es12.5, a, i0, a)') 'end at t =', sim%clock%time, ' s after ', &
            sim%clock%cycle, ' steps'
        write (output_unit, '(a, es10.2)') 'energy error   ', audit%energy_error
        text = doubt_of(audit%energy_error)
        if (len(text) > 0) write (output_unit, '(a)') text
        if (sim%air%present) then
            if (sim%coupling%present) write (output_unit, '(a, es10.2, a)') 'coupling error ', &
                audit%coupling_error, ' of the energy that the air could hand to bodies'
            write (output_unit, '(a, es10.2)') 'mass error     ', audit%mass_error
            write (output_unit, '(a, es10.2)') 'momentum error ', audit%momentum_error
            write (output_unit, '(a, i0)') 'fallback faces  ', nint(audit%fallback_faces, int64)
            if (sim%coupling%wall%cells%present) call print_cut_cells(sim%coupling%wall%cells)
            if (audit%limited_cells > 0) write (output_unit, '(a, i0)') 'limited cells   ', &
                nint(audit%limited_cells, int64)
        end if
        call print_clamped(sim)
        call print_interfaces(sim)
        if (outputs%gauges%n > 0 .and. sim%ranks%rank == 0) then
            call gauge_summary(outputs%gauges, outputs%folder//'/gauges.csv', text, err)
            if (.not. failed(err)) write (output_unit, '(/, a)') text
        end if
        if (profiling) call print_profile(output_unit, sim%ranks)
        if (counting) call print_calls(output_unit, sim%ranks)
        call print_cost(sim, outputs)
        if (several(sim%ranks)) call print_share(sim)
        call say('results    '//outputs%folder)
    end subroutine print_summary

    !> What cut cells met that a rigid body never makes.
    subroutine print_cut_cells(cells)
        type(cut_cells_t), intent(in) :: cells

        write (output_unit, '(4(a, i0), a)') 'cut cells       ', cells%n, ' listed; so far ', &
            cells%slowed, ' walls slowed, ', cells%pockets, ' pockets shut, ', cells%absorbed, &
            ' cells that took their volume as it is'
    end subroutine print_cut_cells

    !> Bodies that were compressed beyond the range of their materials.
    subroutine print_clamped(sim)
        type(simulation_t), intent(in) :: sim
        integer :: b

        if (.not. sim%solid%present) return
        do b = 1, size(sim%solid%bodies)
            associate (body => sim%solid%bodies(b))
                if (body%account%clamped > 0) write (error_unit, '(3a, es8.1, a)') &
                    "warning: body '", trim(body%id), "' was compressed beyond the range of "// &
                    'its material in', body%account%clamped, ' particle steps: its pressure '// &
                    'there is continued, not measured'
            end associate
        end do
    end subroutine print_clamped

    !> How much of each cohesive interface is broken.
    subroutine print_interfaces(sim)
        type(simulation_t), intent(in) :: sim
        real(dp) :: held, spent, broken, whole
        integer :: k

        if (.not. sim%solid%cohesive%present) return
        do k = 1, size(sim%solid%cohesive%law)
            call cohesive_totals(sim%solid%cohesive, k, held, spent, broken, whole)
            write (output_unit, '(2a, 2(es10.3, a), es10.3, a)') 'interface  ', &
                interface_name(sim%solid, k)//':', broken, ' of', whole, ' m2 broken,', spent, &
                ' J spent (cracks, and what pressure held there)'
        end do
    end subroutine print_interfaces

    !> How even the boxes of the processes are, and how long they waited for each other.
    subroutine print_share(sim)
        type(simulation_t), intent(in) :: sim
        real(dp) :: seconds, waited(2), mean(1)
        integer :: r

        seconds = max(wall_seconds() - sim%progress%wall_start, 1e-9_dp)
        waited = 100*traffic%seconds/seconds*[1, -1]
        if (.not. sim%air%present) then
            call print_share_of_bodies(sim, waited)
            return
        end if
        mean = 0
        do r = 0, sim%ranks%n - 1
            mean = mean + real(cells_of(sim%air%part%boxes(r)), dp)/sim%ranks%n
        end do
        call least_of_all(sim%ranks, waited)
        write (output_unit, '(a, i0, a, f0.2, a, f0.1, a, f0.1, a)') 'processes  ', sim%ranks%n, &
            ', the largest box over the mean ', &
            maxval(real(cells_of(sim%air%part%boxes), dp))/mean, ', ', waited(1), ' to ', &
            -waited(2), ' % of the time with messages'
        if (sim%solid%present) call say(share_of_particles(sim))
    end subroutine print_share

    !> The same of the bodies.
    subroutine print_share_of_bodies(sim, waited)
        type(simulation_t), intent(in) :: sim
        real(dp), intent(inout) :: waited(2) !! % of the time, and the same negative
        character(80) :: text

        call least_of_all(sim%ranks, waited)
        write (text, '(2(a, f0.1), a)') ', ', waited(1), ' to ', -waited(2), &
            ' % of the time with messages'
        call say(share_of_particles(sim)//trim(text))
    end subroutine print_share_of_bodies

    !> How even the particles are, and the least and the most that a process has of others; all must
    !> call.
    function share_of_particles(sim) result(text)
        type(simulation_t), intent(in) :: sim
        character(:), allocatable :: text
        character(120) :: line
        integer(int64) :: most(5) !! own; of neighbours; copies: the most, and the least negative

        associate (there => sim%solid%bodies)
            most(1) = sum(int(there%last - there%first + 1, int64))
            most(2) = sum(int(there%rim - there%last, int64))
        end associate
        most(3) = -most(2)
        most(4:) = 0
        associate (come => sim%coupling%part%in)
            if (allocated(come%first)) most(4:) = (come%first(sim%ranks%n) - 1)*[1, -1]
        end associate
        call most_of_all(sim%ranks, most)
        write (line, '(a, i0, a, f0.2, 2(a, i0), a)') 'processes  ', sim%ranks%n, &
            ', the most particles over the mean ', &
            real(most(1), dp)*sim%ranks%n/all_particles(sim%solid), ', and ', -most(3), ' to ', &
            most(2), ' of neighbours'
        text = trim(line)
        if (most(4) == 0) return
        write (line, '(2(a, i0), a)') ', ', -most(5), ' to ', most(4), ' copies for the air'
        text = text//trim(line)
    end function share_of_particles

    !> Wall-clock time and throughput.
    subroutine print_cost(sim, outputs)
        type(simulation_t), intent(in) :: sim
        type(outputs_t), intent(in) :: outputs
        real(dp) :: seconds

        associate (p => sim%progress)
            seconds = max(wall_seconds() - p%wall_start, 1e-9_dp)
            write (output_unit, '(a, f0.1, a, 3(f0.1, a))') 'wall clock ', seconds, ' s (air ', &
                p%air_seconds, ', solid ', p%solid_seconds, ', coupling ', p%coupling_seconds, ')'
            if (p%cell_steps > 0) write (output_unit, '(a, f0.2, a)') 'air        ', &
                1e-6_dp*real(p%cell_steps, dp)/max(p%air_seconds, 1e-9_dp), ' Mcell-steps/s'
            if (p%particle_steps > 0) write (output_unit, '(a, f0.2, a)') 'solid      ', &
                1e-6_dp*real(p%particle_steps, dp)/max(p%solid_seconds, 1e-9_dp), &
                ' Mparticle-steps/s'
        end associate
        associate (s => outputs%saves)
            seconds = s%fetching + s%copying + s%writing
            if (on_gpu(sim)) then
                write (output_unit, '(a, 4(f0.1, a))') 'output     ', seconds, &
                    ' s (state from the GPU ', s%fetching, ', copies of the process ', s%copying, &
                    ', files ', s%writing, ')'
            else
                write (output_unit, '(a, f0.1, a)') 'output     ', seconds, ' s'
            end if
        end associate
    end subroutine print_cost

    !> A warning where energy is not conserved, else nothing.
    pure function doubt_of(error) result(text)
        real(dp), intent(in) :: error !! of the energy, relative [-]
        character(:), allocatable :: text

        text = ''
        if (.not. abs(error) <= large_error) text = 'warning: energy is not conserved, so do '// &
            'not trust this run: take a smaller cfl of air and bodies (energy_band of &run '// &
            'ends such runs)'
    end function doubt_of
end module brz_summary
