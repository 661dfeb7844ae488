! SPDX-License-Identifier: MIT
!> Speed of the solids on the GPU: time of each kernel, and of the whole step.
!>
!> usage: BRISANCE_PTX=bin/brisance.ptx bench_gpu_solid [particles [smoothing [case ...]]]
!>
!> A spinning cube; smoothing length in spacings, 1.2 gives 80 neighbours in a list; cases by
!> number, see below.
program bench_gpu_solid
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_bench_floors, only: argument
    use brz_device, only: copy_out, device_t, free_all, wait_for_device
    use brz_errors, only: error_t, failed
    use brz_gpu_solid_forces, only: force_pass
    use brz_gpu_solid_gradients, only: fill_rows, find_gradients, gradient_pass, sum_moments, &
        update_material
    use brz_gpu_solid_diagnostics, only: fetch_limit
    use brz_kinds, only: dp, int64, rk
    use brz_particles, only: particles_t
    use brz_solid_state, only: solid_t
    use brz_solid_start, only: solid_time_step
    use gpu_scenes, only: make_solid
    use gpu_tools, only: get_device, start_timer, stop_timer
    use brz_motion_driver, only: kick_bodies
    use brz_solid_device, only: solid_device_t
    use brz_solid_list_driver, only: build_neighbours
    use brz_solid_driver, only: solid_step
    use brz_solid_to_gpu, only: move_solid_to_gpu
    implicit none

    character(90), parameter :: cases(5) = [character(90) :: &
        "preset='al6061' /, formulation='corrected_hourglass'", &
        "preset='cfrp_woven' /, formulation='corrected_hourglass'", &
        "preset='cfrp_woven' /, formulation='bending'", &
        "preset='hjc_48' /, formulation='corrected_hourglass'", &
        "preset='al6061' /, formulation='corrected'"]
    type(device_t) :: device
    type(error_t) :: err
    integer :: a

    call get_device(device, err)
    if (failed(err)) error stop 5
    if (command_argument_count() < 3) then
        call measure(cases(1))
        call measure(cases(3))
    end if
    do a = 3, command_argument_count()
        call measure(cases(argument(a, 1)))
    end do

contains

    !> One case: set up, time the parts, time whole steps.
    subroutine measure(what)
        character(*), intent(in) :: what !! material, formulation
        type(solid_t) :: solid
        character(400) :: text
        real(dp) :: side

        side = 1e-3_dp*nint(argument(1, 1e6_dp)**(1/3.0_dp))
        write (text, '(2a, f0.6, a, f0.6, a, f0.6, a, f0.3, 2a)') "&material id='m', ", &
            what(:index(what, '/'))//" &body id='b', shape='box', spacing=1e-3, "// &
            "material='m', spin=10,20,30, box=0,", side, ',0,', side, ',0,', side, ', smoothing=', &
            argument(2, 1.2_dp), trim(what(index(what, '/') + 1:)), ' /'
        call make_solid(trim(text), solid, inactive=.true.)
        call move_solid_to_gpu(device, solid, .false., err)
        call check()
        write (output_unit, '(3a, i0, a, i0, 2a)') trim(what(index(what, '/') + 3:)), ', ', &
            what(:index(what, '/') - 2)//', real', storage_size(1.0_rk), ', ', solid%n, &
            ' particles, ', words_of(solid%device, solid)
        call time_parts(solid%device, solid)
        call time_steps(solid%device, solid)
        call free_all()
    end subroutine measure

    subroutine check()
        if (.not. failed(err)) return
        write (output_unit, '(a)') err%text
        error stop 5
    end subroutine check

    !> Neighbours and memory, in words.
    function words_of(gpu, solid) result(text)
        type(solid_device_t), intent(in) :: gpu
        class(particles_t), intent(inout) :: solid
        character(80) :: text
        integer, allocatable :: count(:)

        allocate (count(solid%n), source=0)
        call copy_out(gpu%count, count, 4_int64*solid%n, err)
        write (text, '(f5.1, a, f5.0, a, f5.0, a)') sum(real(count, dp))/solid%n, ' neighbours, ', &
            real(own_bytes(gpu), dp)/solid%n, ' B per particle and ', &
            real(gpu%bodies(1)%list%bytes, dp)/solid%n, ' B for its list'
    end function words_of

    pure integer(int64) function own_bytes(gpu)
        type(solid_device_t), intent(in) :: gpu

        own_bytes = gpu%place%bytes + gpu%reference%bytes + gpu%built%bytes + gpu%motion%bytes &
            + gpu%state%bytes + gpu%tag%bytes + gpu%diag%bytes + gpu%row%bytes + gpu%grad%bytes &
            + gpu%k_axes%bytes + gpu%rate%bytes + gpu%count%bytes + gpu%cell%bytes &
            + gpu%order%bytes + gpu%chosen%bytes + gpu%bodies(1)%start%bytes
    end function own_bytes

    !> Milliseconds of each part, the best of a few.
    subroutine time_parts(gpu, solid)
        type(solid_device_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        character(12), parameter :: names(8) = [character(12) :: 'drift', 'moments', 'gradients', &
            'material', 'rows', 'forces', 'limit', 'lists']
        real(dp) :: best(size(names))
        integer :: k, m

        call build_neighbours(solid, .true., err, [.true.])
        call gradient_pass(gpu, solid, 0.0_dp, err)
        call force_pass(gpu, solid, 0.0_dp, err)
        best = huge(1.0_dp)
        do m = 1, 4
            do k = 1, size(names)
                if (k == 8 .and. m > 2) cycle
                call wait_for_device(err)
                solid%bodies%cells%renewals = -1 ! lists are built as a whole
                call start_timer(err)
                select case (k)
                case (1); call kick_bodies(solid, 0.0_dp, err)
                case (2); call sum_moments(gpu, gpu%kinds(1), err)
                case (3); call find_gradients(gpu, gpu%kinds(1), 0.0_rk, err)
                case (4); call update_material(gpu, gpu%kinds(1), 1e-12_rk, err)
                case (5); call fill_rows(gpu, gpu%kinds(1), 1e-12_rk, err)
                case (6); call force_pass(gpu, solid, 1e-12_dp, err)
                case (7); call fetch_limit(gpu, solid, err)
                case (8); call build_neighbours(solid, .true., err, [.true.])
                end select
                best(k) = min(best(k), stop_timer(err))
            end do
        end do
        call check()
        write (output_unit, '(*(a, f9.3))') ('  '//trim(names(k))//' [ms]', 1e3_dp*best(k), &
            k=1, size(names))
        flush (output_unit)
    end subroutine time_parts

    !> Whole steps at the stable time step, lists as they are due.
    subroutine time_steps(gpu, solid)
        type(solid_device_t), intent(inout) :: gpu
        type(solid_t), intent(inout) :: solid
        integer, parameter :: steps = 20
        real(dp) :: seconds
        integer :: m

        solid%steps = 1
        call fetch_limit(gpu, solid, err)
        call solid_step(solid, 0.5_dp*solid_time_step(solid), err)
        call wait_for_device(err)
        call start_timer(err)
        do m = 1, steps
            call solid_step(solid, solid_time_step(solid), err)
        end do
        seconds = stop_timer(err)/steps
        call check()
        write (output_unit, '(a, f9.3, a, f9.2, a, i0, a)') '  step', 1e3_dp*seconds, ' ms: ', &
            1e-6_dp*solid%n/seconds, ' M particle-steps/s, lists built ', solid%rebuilds, ' times'
        flush (output_unit)
    end subroutine time_steps
end program bench_gpu_solid
