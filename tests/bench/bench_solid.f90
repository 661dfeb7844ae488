! SPDX-License-Identifier: MIT
!> Speed of the solid: particle-steps per second, time of each part of a step, nanoseconds per pair
!> beside what arithmetic and memory would allow, memory per particle.
!>
!> usage: bench_solid [layers [steps]]   a cube of layers^3 particles, 40 by default
!>
!> Times are those of the cores (on a busy machine the clock says little), the best of all steps.
!> The metal yields: the cube is sheared at 2e4/s. A pair is counted once for each of its particles.
!> Flops are counted in the sources: +, -, *, min, max, a choice are one each, division and root
!> apart. What a particle moves to and from memory is every array that a pass reads or writes, once.
program bench_solid
    use brz_bench_floors, only: argument, core_time, floors_t, measure_floors
    use brz_body_setup, only: set_up_solid
    use brz_case, only: case_t, material_case_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp, int64, rk
    use brz_particle_groups, only: lanes
    use brz_solid_arrays, only: bytes_per_particle
    use brz_solid_forces, only: force_pass
    use brz_solid_gradients, only: gradient_pass
    use brz_solid_arrays, only: group_of
    use brz_solid_list_driver, only: build_neighbours
    use brz_particles, only: particles_t
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    use brz_solid_state, only: solid_t
    use brz_solid_start, only: solid_time_step, start_solid
    use brz_solid_driver, only: solid_step
    use omp_lib, only: omp_get_max_threads, omp_get_wtime, omp_set_num_threads
    implicit none

    !> A body and what its loops compute.
    type :: bench_scene_t
        character(16) :: model = ''
        character(20) :: formulation = ''
        real(dp) :: smoothing = 1.3_dp !! h in spacings: 80 neighbours; 1.2: 56
        integer :: flops(2) = 0 !! per pair, in pass 1 and 2; besides a root each, a division in 2
    end type bench_scene_t

    integer, parameter :: gradients = 1, material = 2, forces = 3, list = 4, whole = 5, by_clock = 6
    integer, parameter :: n_part = 6
    type(bench_scene_t), parameter :: scenes(5) = [ &
                                bench_scene_t('johnson_cook', 'corrected_hourglass', 1.3_dp, &
                                [55, 132]), &
                                bench_scene_t('johnson_cook', 'corrected_hourglass', 1.2_dp, &
                                [55, 132]), &
                                bench_scene_t('linear_elastic', 'corrected', 1.2_dp, [55, 72]), &
                                bench_scene_t('linear_elastic', 'bending', 1.2_dp, [78, 138]), &
                                bench_scene_t('orthotropic_ply', 'bending', 1.2_dp, [78, 141])]
    type(floors_t) :: floors
    integer :: layers, steps, most, s, threads

    layers = argument(1, 40)
    steps = argument(2, 20)
    most = min(2, omp_get_max_threads())
    do threads = 1, most
        call omp_set_num_threads(threads)
        call measure_floors(floors)
        print '(a, i0, a, f6.1, a, f6.1, a)', 'solid: ', threads, ' thread(s): triad', &
            1e-9_dp*floors%bytes, ' GB/s, multiply-add', 1e-9_dp*floors%flops, &
            ' Gflop/s, both per core'
        print '(a)', 'material         formulation         h/dx   pass 1 material  pass 2'// &
            '    list    step  [us per particle and core]'
        do s = 1, size(scenes)
            call measure(scenes(s))
        end do
    end do

contains

    subroutine measure(scene)
        type(bench_scene_t), intent(in) :: scene
        type(solid_t) :: solid
        type(error_t) :: err
        real(dp) :: best(n_part), dt
        integer :: k

        call make_cube(scene, solid, err)
        call start_solid(solid, err)
        best = huge(1.0_dp)
        do k = 1, steps
            dt = solid_time_step(solid)
            if (k <= 3) call time_one(list, dt, solid, err, best)
            call time_one(gradients, dt, solid, err, best)
            call time_one(material, dt, solid, err, best)
            call time_one(forces, dt, solid, err, best)
            call time_one(whole, dt, solid, err, best)
        end do
        if (failed(err)) error stop err%text
        if (scene%model == 'johnson_cook' .and. .not. solid%bodies(1)%account%plastic > 0) &
            error stop 'the metal did not yield'
        best = best/solid%n
        best(material) = best(material) - best(gradients)
        print '(a16, 1x, a20, f4.1, 5f9.3)', scene%model, scene%formulation, scene%smoothing, &
            1e6_dp*best(:whole)
        call compare(scene, solid, best)
    end subroutine measure

    !> What these times mean: throughput, and each pass beside its floors.
    subroutine compare(scene, solid, best)
        type(bench_scene_t), intent(in) :: scene
        class(listed_bodies_t), intent(inout) :: solid
        real(dp), intent(in) :: best(n_part) !! per particle [s]
        real(dp) :: pairs, turns, bytes

        pairs = count_pairs(solid)
        turns = real(solid%first(size(solid%first)) - 1, dp)/solid%n
        bytes = 2*turns*storage_size(solid%list)/8 + moved(solid)
        print '(4x, f6.3, a, f6.3, a)', 1e-6_dp/best(whole), ' M particle-steps/s per core,', &
            1e-6_dp/best(by_clock), ' by the clock'
        print '(4x, f6.1, a, f5.1, a, f6.1, a)', pairs, ' pairs (', lanes*turns, ' lanes), ', &
            1e-6_dp*pairs/(best(gradients) + best(forces)), ' M pairs/s through both passes'
        print '(4x, a, f5.2, a, f5.2, a, f5.2, a, f5.2, a, i0, a, i0, a)', 'ns per pair: pass 1 ', &
            1e9_dp*best(gradients)/pairs, ' (arithmetic ', 1e9_dp*scene%flops(1)/floors%flops, &
            '), pass 2 ', 1e9_dp*best(forces)/pairs, ' (', 1e9_dp*scene%flops(2)/floors%flops, &
            '); ', scene%flops(1), ' and ', scene%flops(2), ' flops'
        print '(4x, a, f6.3, a, i0, a, f5.1, a)', 'memory: ', 1e6_dp*bytes/floors%bytes, &
            ' us per step for ', nint(bytes), ' B; ', bytes_per_particle(solid), &
            ' B stored per particle, besides its list'
    end subroutine compare

    !> Pairs within the support of the kernel, per particle.
    real(dp) function count_pairs(solid)
        class(listed_bodies_t), intent(in) :: solid
        real(dp) :: d(3)
        integer(int64) :: k, n
        integer :: g, i

        n = 0
        do i = 1, solid%n
            g = group_of(solid%bodies(1), i)
            do k = solid%first(g), solid%first(g + 1) - 1
                d = solid%x(:, i) - solid%x(:, solid%list(k))
                if (solid%list(k) /= i .and. sum(d*d) < (2*solid%bodies(1)%h)**2) n = n + 1
            end do
        end do
        count_pairs = real(n, dp)/solid%n
    end function count_pairs

    !> Bytes of state that both passes and the kick read and write, per particle.
    real(dp) function moved(solid)
        class(particles_t), intent(in) :: solid
        integer :: wide, working

        wide = 2*3 + 2*3 ! x in both passes; x in the kick
        working = 2*(3 + 1) + 2*(6 + 3 + solid%n_hist) + 2*size(solid%pair, 1) & ! pass 1
                  + 3 + 3 + 2 ! pass 2: v, a, mass, energy
        working = working + 2*3 + 3 + 3 + 1 ! kick: v, a, load, mass
        if (allocated(solid%k_axes)) wide = wide + 2*3 + 6
        moved = 8.0_dp*wide + working*storage_size(1.0_rk)/8.0_dp
    end function moved

    subroutine time_one(part, dt, solid, err, best)
        integer, intent(in) :: part
        real(dp), intent(in) :: dt
        type(solid_t), intent(inout) :: solid
        type(error_t), intent(inout) :: err
        real(dp), intent(inout) :: best(n_part)
        real(dp) :: core, clock

        core = core_time()
        clock = omp_get_wtime()
        select case (part)
        case (gradients)
            call gradient_pass(solid, 0.0_dp)
        case (material)
            call gradient_pass(solid, dt*1e-6_dp)
        case (forces)
            call force_pass(solid, dt*1e-6_dp)
        case (list)
            solid%bodies%cells%renewals = -1 ! as a whole
            call build_neighbours(solid, .true., err)
        case (whole)
            call solid_step(solid, dt, err)
        end select
        best(part) = min(best(part), core_time() - core)
        if (part == whole) best(by_clock) = min(best(by_clock), omp_get_wtime() - clock)
    end subroutine time_one

    !> A cube with a spacing of 1 mm that is sheared and turns.
    subroutine make_cube(scene, solid, err)
        type(bench_scene_t), intent(in) :: scene
        class(interacting_bodies_t), intent(out) :: solid
        type(error_t), intent(inout) :: err
        type(case_t) :: case

        allocate (case%materials(1), case%bodies(1))
        case%solid%present = .true.
        call choose(scene%model, case%materials(1))
        case%bodies(1)%material_index = 1
        case%bodies(1)%hi = layers*1e-3_dp
        case%bodies(1)%spacing = 1e-3_dp
        case%bodies(1)%smoothing = scene%smoothing
        case%bodies(1)%formulation = scene%formulation
        case%bodies(1)%spin = [10.0_dp, 20.0_dp, 30.0_dp]
        call set_up_solid(case, solid, err)
        if (scene%model == 'johnson_cook') &
            solid%v(1, :) = solid%v(1, :) + real(2e4_dp*solid%x(2, :), rk)
    end subroutine make_cube

    !> Steel, elastic or by Johnson and Cook, or the woven laminate of the paper's plate.
    subroutine choose(model, m)
        character(*), intent(in) :: model
        type(material_case_t), intent(inout) :: m

        m%model = model
        select case (model)
        case ('linear_elastic')
            m%key = [character(24) :: 'density', 'youngs_modulus', 'poisson_ratio']
            m%value = [7800.0_dp, 200e9_dp, 0.3_dp]
        case ('johnson_cook')
            m%key = [character(24) :: 'density', 'shear_modulus', 'a', 'b', 'n', 'c', 'm', &
                     'melt_temperature', 'specific_heat', 'sound_speed', 's1', 'gruneisen_gamma']
            m%value = [7830.0_dp, 77e9_dp, 792e6_dp, 510e6_dp, 0.26_dp, 0.014_dp, 1.03_dp, &
                       1793.0_dp, 477.0_dp, 4569.0_dp, 1.49_dp, 2.17_dp]
        case default
            m%key = [character(24) :: 'density', 'e1', 'e2', 'e3', 'nu12', 'nu13', 'nu23', 'g12', &
                     'g13', 'g23', 'xt', 'yt', 'zt', 'yc', 's12', 's13', 's23']
            m%value = [1500.0_dp, 55e9_dp, 55e9_dp, 7e9_dp, 0.25_dp, 0.25_dp, 0.25_dp, 4.5e9_dp, &
                       1.8e9_dp, 1.8e9_dp, 680e6_dp, 680e6_dp, 680e6_dp, 240e6_dp, 140e6_dp, &
                       140e6_dp, 112e6_dp]
        end select
        m%n = size(m%key)
        allocate (m%word(m%n), m%given(m%n))
        m%word = ''
        m%given = .true.
    end subroutine choose
end program bench_solid
