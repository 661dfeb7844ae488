! SPDX-License-Identifier: MIT
!> Time of one update of one material point, for every model, on one thread.
!>
!> usage: bench_material [steps]   updates of each of 256 points, 2000 by default
!> Columns: strains of 1e-6 per step, which keep the points elastic, and of 1e-3, to and fro over
!> 2 %, which yield, crush or break where the model can.
program bench_material
    use brz_build_point, only: build_point
    use brz_case, only: point_case_t
    use brz_deck, only: deck_t
    use brz_errors, only: error_t, failed
    use brz_key, only: key_t
    use brz_key_table, only: all_keys
    use brz_kinds, only: dp, rk
    use brz_material, only: material_t, point_t
    use brz_materials, only: make_material, start_point, update_material
    use brz_scanner, only: read_deck_text
    use brz_text, only: string_t
    use omp_lib, only: omp_get_wtime
    use brz_bench_floors, only: argument
    implicit none

    integer, parameter :: points = 256, chunk = 20
    character(*), parameter :: metal = "model='johnson_cook', density=7830, "// &
        'shear_modulus=77e9, a=792e6, b=510e6, n=0.26, c=0.014, m=1.03, '// &
        'melt_temperature=1793, specific_heat=477, '// &
        'sound_speed=4569, s1=1.49, gruneisen_gamma=2.17, gruneisen_a=0.46'
    character(*), parameter :: copper = "model='zerilli_armstrong', density=8960, "// &
        'shear_modulus=46e9, melt_temperature=1356, specific_heat=383, sound_speed=3940, '// &
        's1=1.489, gruneisen_gamma=2.02, gruneisen_a=0.47, c0=65e6, '
    character(*), parameter :: ply = "model='orthotropic_ply', density=1500, e1=55e9, e2=55e9, "// &
        'e3=7e9, nu12=0.25, nu13=0.25, nu23=0.25, g12=4.5e9, g13=1.8e9, g23=1.8e9, '// &
        'xt=680e6, xc=240e6, yt=680e6, yc=240e6, zt=60e6, s12=140e6, s13=140e6, s23=112e6'
    type(key_t), allocatable :: keys(:)
    integer :: steps

    steps = argument(1, 2000)
    call all_keys(keys)
    print '(a)', 'material update            elastic  working   [ns, one thread]'
    call measure('linear_elastic', "model='linear_elastic', density=7800, "// &
                 'youngs_modulus=2e11, poisson_ratio=0.3')
    call measure('gruneisen', "model='gruneisen', density=2785, sound_speed=5328, s1=1.338, "// &
                 'gruneisen_gamma=2.0, shear_modulus=27.6e9, yield_stress=265e6')
    call measure('polynomial', "model='polynomial', density=1e3, bulk_modulus=2.2e9, "// &
                 'a2=9.5e9, a3=14.6e9, b0=0.28')
    call measure('ideal_gas', "model='ideal_gas', density=1630, gamma=1.3, energy=4.29e6")
    call measure('jwl', "model='jwl', density=1630, a=371.2e9, b=3.231e9, r1=4.15, r2=0.95, "// &
                 'omega=0.3, energy_density=7e9')
    call measure('bilinear_j2', "model='bilinear_j2', density=7850, youngs_modulus=2e11, "// &
                 'poisson_ratio=0.3, yield_stress=5e8, tangent_modulus=2e9')
    call measure('bilinear_j2, rate', "model='bilinear_j2', density=7850, youngs_modulus=2e11, "// &
                 'poisson_ratio=0.3, yield_stress=5e8, tangent_modulus=2e9, cowper_symonds_d=40.4')
    call measure('cowper_symonds', "model='cowper_symonds', density=7850, "// &
                 'youngs_modulus=2e11, poisson_ratio=0.3, yield_stress=5e8, '// &
                 'tangent_modulus=2e9, d=40.4, q=5')
    call measure('zerilli_armstrong', copper//'c2=890e6, c3=0.0028, c4=0.000115')
    call measure('zerilli_armstrong, c1 c5', copper//'c1=1033e6, c3=0.00698, c4=0.000415, '// &
                 'c5=266e6, n=0.289')
    call measure('johnson_cook', metal)
    call measure('johnson_cook, rate=total', metal//", rate='total'")
    call measure('johnson_cook, failure', metal//', d1=50, d2=3.44, d3=-2.12, d4=0.002, d5=0.61')
    call measure('johnson_cook, energy', metal//", heating='energy'")
    call measure('hjc', "model='hjc', density=2440, shear_modulus=14.86e9, a=0.79, b=1.6, "// &
                 'n=0.61, c=0.007, fc=48e6, t=4e6, efmin=0.01, smax=7, p_crush=16e6, '// &
                 'mu_crush=1e-3, p_lock=0.8e9, mu_lock=0.1, d1=0.04, d2=1, k1=85e9, '// &
                 'k2=-171e9, k3=208e9')
    call measure('orthotropic_ply', ply)
    call measure('orthotropic_ply, spin', ply//", axes='spin'")
    call measure('orthotropic_ply, anderson', ply//", pressure='anderson'")

contains

    subroutine measure(label, text)
        character(*), intent(in) :: label, text !! text: keys as a deck has them
        type(material_t) :: material
        real(dp) :: seconds(2)

        call read_material(text, material)
        call run(material, 1e-6_rk, seconds(1))
        call run(material, 1e-3_rk, seconds(2))
        print '(a25, 2f9.0)', label, 1e9_dp*seconds
    end subroutine measure

    subroutine read_material(text, material)
        character(*), intent(in) :: text
        type(material_t), intent(out) :: material
        type(deck_t) :: deck
        type(point_case_t) :: point
        type(error_t) :: err
        character(*), parameter :: lf = new_line('a')

        call read_deck_text('bench', "&material id='m', "//text//' /'//lf// &
                            "&point material='m' /"//lf//'&segment duration=1, l=9*0.0 /', keys, &
                            [string_t::], deck, err)
        call build_point(deck, keys, point, err)
        if (.not. failed(err)) call make_material(point%material, material, err)
        if (failed(err)) error stop err%text
    end subroutine read_material

    !> Seconds per update, the best of all chunks of steps.
    subroutine run(material, strain, best)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: strain !! of a step
        real(dp), intent(out) :: best
        type(point_t) :: point(points)
        real(rk) :: l(3, 3, points)
        integer :: i, k, status
        real(dp) :: t

        call start_point(material, 0.3_rk, 'z', point(1))
        point = point(1)
        call random_number(l)
        l = 1e3_rk*(l - 0.5_rk)
        best = huge(best)
        do k = 1, steps, chunk
            t = omp_get_wtime()
            do i = k, k + chunk - 1
                call step_all(material, strain/1e3_rk, l, point, status)
            end do
            if (k > chunk) best = min(best, (omp_get_wtime() - t)/(chunk*points))
            l = -l
        end do
        if (status > 0) print '(a)', 'a step was refused: the times are not those of an update'
    end subroutine run

    subroutine step_all(material, dt, l, point, status)
        type(material_t), intent(in) :: material
        real(rk), intent(in) :: dt, l(3, 3, points)
        type(point_t), intent(inout) :: point(points)
        integer, intent(out) :: status
        integer :: i, one

        status = 0
        do i = 1, points
            call update_material(material, dt, 1e-3_rk, l(:, :, i), point(i), one)
            status = max(status, one)
        end do
    end subroutine step_all
end program bench_material
