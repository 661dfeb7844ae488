! SPDX-License-Identifier: MIT
!> Throughput of the solid: particle-steps per second, time of each pass, memory per particle.
!>
!> usage: bench_solid [layers [steps]]   a cube of layers^3 particles, 60 by default
program bench_solid
    use brz_body_setup, only: set_up_solid
    use brz_case, only: case_t, material_case_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, int64
    use brz_solid_arrays, only: bytes_per_particle
    use brz_solid_forces, only: force_pass
    use brz_solid_gradients, only: gradient_pass
    use brz_solid_neighbours, only: build_neighbours
    use brz_solid_state, only: solid_t
    use brz_solid_step, only: solid_step, solid_time_step, start_solid
    use omp_lib, only: omp_get_max_threads, omp_get_wtime, omp_set_num_threads
    implicit none

    character(20), parameter :: forms(3) = [character(20) :: 'corrected', 'corrected_hourglass', &
                                            'bending']
    integer :: layers, steps, most, f, threads

    layers = argument(1, 60)
    steps = argument(2, 6)
    most = omp_get_max_threads()
    print '(a)', 'model            formulation         threads  pass 1  pass 2    list'// &
        '    step  '// &
        'M particle-steps/s'
    print '(a)', '                                                 [us per particle]'
    do f = 1, size(forms)
        do threads = 1, most
            call omp_set_num_threads(threads)
            call measure('linear_elastic', forms(f), threads)
            if (f == 3) call measure('orthotropic_ply', forms(f), threads)
        end do
    end do

contains

    integer function argument(k, default)
        integer, intent(in) :: k, default
        character(20) :: text

        argument = default
        call get_command_argument(k, text)
        if (len_trim(text) > 0) read (text, *) argument
    end function argument

    !> One line of the table: the best of a few repetitions of each part.
    subroutine measure(model, formulation, threads)
        character(*), intent(in) :: model, formulation
        integer, intent(in) :: threads
        type(case_t) :: case
        type(solid_t) :: solid
        type(error_t) :: err
        real(dp) :: best(4), dt
        integer :: k

        allocate (case%materials(1), case%bodies(1))
        case%solid%present = .true.
        call choose(model, case%materials(1))
        case%bodies(1)%material_index = 1
        case%bodies(1)%hi = layers*1e-3_dp
        case%bodies(1)%spacing = 1e-3_dp
        case%bodies(1)%formulation = formulation
        case%bodies(1)%spin = [10.0_dp, 20.0_dp, 30.0_dp]
        call set_up_solid(case, solid, err)
        call start_solid(solid, err)
        best = huge(1.0_dp)
        do k = 1, steps
            dt = solid_time_step(solid)
            call time_one(1, best, dt, solid, err)
            call time_one(2, best, dt, solid, err)
            if (k <= 2) call time_one(3, best, dt, solid, err)
            call time_one(4, best, dt, solid, err)
        end do
        if (failed(err)) print '(a)', err%text
        best = best/solid%n*1e6_dp
        print '(a17, a20, i7, 4f8.3, f12.3)', model, formulation, threads, best, 1/best(4)
        if (threads == 1 .and. formulation == 'bending') print '(f24.1, a, f8.1, a, f8.1, a)', &
            real(solid%first(solid%n + 1) - 1, dp)/solid%n, ' entries in a list,', &
            bytes_per_particle(solid), ' B per particle and', &
            real(solid%first(solid%n + 1) - 1, dp)/solid%n*5, ' B for its list'
    end subroutine measure

    subroutine time_one(part, best, dt, solid, err)
        integer, intent(in) :: part
        real(dp), intent(inout) :: best(4)
        real(dp), intent(in) :: dt
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp) :: t

        t = omp_get_wtime()
        select case (part)
        case (1)
            call gradient_pass(solid, dt*1e-6_dp)
        case (2)
            call force_pass(solid, dt*1e-6_dp)
        case (3)
            call build_neighbours(solid, sort=.true.)
        case (4)
            call solid_step(solid, dt, err)
        end select
        best(part) = min(best(part), omp_get_wtime() - t)
    end subroutine time_one

    !> Steel, or the woven laminate of the paper's plate.
    subroutine choose(model, m)
        character(*), intent(in) :: model
        type(material_case_t), intent(inout) :: m

        m%model = model
        if (model == 'linear_elastic') then
            m%key = [character(24) :: 'density', 'youngs_modulus', 'poisson_ratio']
            m%value = [7800.0_dp, 200e9_dp, 0.3_dp]
        else
            m%key = [character(24) :: 'density', 'e1', 'e2', 'e3', 'nu12', 'nu13', 'nu23', 'g12', &
                     'g13', 'g23', 'xt', 'yt', 'zt', 'yc', 's12', 's13', 's23']
            m%value = [1500.0_dp, 55e9_dp, 55e9_dp, 7e9_dp, 0.25_dp, 0.25_dp, 0.25_dp, 4.5e9_dp, &
                       1.8e9_dp, 1.8e9_dp, 680e6_dp, 680e6_dp, 680e6_dp, 240e6_dp, 140e6_dp, &
                       140e6_dp, 112e6_dp]
        end if
        m%n = size(m%key)
        allocate (m%word(m%n), m%given(m%n))
        m%word = ''
        m%given = .true.
    end subroutine choose
end program bench_solid
