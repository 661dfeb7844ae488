! SPDX-License-Identifier: MIT
!> What the accuracy of the schemes of the air costs, and where they fail, as CSV.
!>
!> usage: study_air charts|stability|sedov
program study_air
    use air_problems, only: balloon_box, entropy_wave, free_air_blast, n_schemes, scheme_name, &
                            sedov, air_result_t, sod, vortex
    use brz_kinds, only: dp
    use omp_lib, only: omp_set_num_threads
    implicit none

    character(20) :: what

    call omp_set_num_threads(1)
    call get_command_argument(1, what)
    select case (what)
    case ('charts')
        call charts()
    case ('stability')
        call stability()
    case ('sedov')
        call point_blast()
    case default
        error stop 'usage: study_air charts|stability|sedov'
    end select

contains

    !> Error against seconds of one core.
    subroutine charts()
        type(air_result_t) :: seen
        integer :: m, k
        integer, parameter :: sides(3) = [16, 24, 36]

        print '(a)', 'problem,scheme,cells,error,shock radius,seconds,cell steps,fallback faces'
        do m = 1, n_schemes
            do k = 1, 4
                call sod(m, 50*2**k, seen)
                call report('sod', m, 50*2**k, seen)
            end do
            do k = 1, 4
                call entropy_wave(m, 25*2**(k - 1), seen)
                call report('entropy wave', m, 25*2**(k - 1), seen)
            end do
            do k = 1, 3
                call vortex(m, 20*2**(k - 1), 2.0_dp, seen)
                call report('vortex', m, 20*2**(k - 1), seen)
            end do
            do k = 1, size(sides)
                call sedov(m, sides(k), seen)
                call report('sedov', m, sides(k), seen)
                call free_air_blast(m, sides(k), seen)
                call report('free-air blast', m, sides(k), seen)
            end do
        end do
    end subroutine charts

    !> The point blast with the default scheme of decks: some minutes.
    subroutine point_blast()
        type(air_result_t) :: seen
        integer :: k
        integer, parameter :: sides(4) = [16, 32, 64, 128]

        print '(a)', 'problem,scheme,cells,error,shock radius,seconds,cell steps,fallback faces'
        do k = 1, size(sides)
            call sedov(6, sides(k), seen)
            call report('sedov', 6, sides(k), seen)
        end do
    end subroutine point_blast

    !> Balloons in a box of 16 x 16 x 16 cells: which Courant number, pressure ratio and scheme
    !> survives, with and without fallback.
    subroutine stability()
        type(air_result_t) :: seen
        integer :: m, k, c, f
        real(dp), parameter :: cfl(5) = [0.5_dp, 1.0_dp, 1.6_dp, 2.4_dp, 3.2_dp]
        character(*), parameter :: verdict(3) = ['survived ', 'fell back', 'failed   ']
        integer :: v

        print '(a)', 'scheme,fallback,pressure ratio,cfl,seen,fallback faces'
        do m = 1, n_schemes
            do f = 1, 2
                do k = 2, 6
                    do c = 1, size(cfl)
                        call balloon_box(m, 16, 10.0_dp**k, cfl(c), f == 1, seen)
                        v = 1
                        if (seen%fallback_faces > 0) v = 2
                        if (seen%status /= 0) v = 3
                        print '(4a, es7.1, a, f3.1, 3a, i0)', &
                            trim(scheme_name(m)), ',', merge('with   ', 'without', f == 1), ',', &
                            10.0_dp**k, ',', cfl(c), ',', trim(verdict(v)), ',', &
                            seen%fallback_faces
                    end do
                end do
            end do
        end do
    end subroutine stability

    subroutine report(problem, m, cells, seen)
        character(*), intent(in) :: problem
        integer, intent(in) :: m, cells !! scheme, cells along a side
        type(air_result_t), intent(in) :: seen

        print '(4a, i0, 3(a, es10.3), 2(a, i0))', problem, ',', trim(scheme_name(m)), ',', cells, &
            ',', merge(seen%error, -1.0_dp, seen%status == 0), ',', seen%radius, ',', &
            seen%seconds, ',', seen%cell_steps, ',', seen%fallback_faces
    end subroutine report
end program study_air
