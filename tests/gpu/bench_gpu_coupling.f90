! SPDX-License-Identifier: MIT
!> Speed of the coupling on the GPU: time of each operation of a step.
!>
!> usage: BRISANCE_PTX=bin/brisance.ptx bench_gpu_coupling [cells of the plate [particles a side]]
!>
!> A rigid plate of seven layers of cells in a box of air, 27 particles a cell: 120 cells a side
!> give 2.7 million particles in three million cells. First it stands still, then it is driven along
!> its normal, so that cells close and open.
program bench_gpu_coupling
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_bench_floors, only: argument
    use brz_coupling_copy, only: fastest_wall
    use brz_errors, only: failed
    use brz_exchange_driver, only: reclassify, set_wall_velocity, spread_load
    use brz_kinds, only: dp
    use brz_solid_driver, only: solid_step
    use brz_text, only: to_text
    use gpu_cut_scene, only: begin, cut_pair_t, join
    use gpu_tools, only: start_timer, stop_timer
    implicit none

    integer, parameter :: layers = 7
    real(dp), parameter :: dt = 1e-5_dp !! [s]
    type(cut_pair_t), allocatable :: s
    integer :: along

    along = argument(1, 120)
    allocate (s)
    call begin([4*along/3, 4*along/3, along], s)
    call join("&material id='m', model='linear_elastic', density=7800, youngs_modulus=2e11, "// &
              "poisson_ratio=0.3 /&body id='plate', box="//along_axis(1)//along_axis(2)// &
              to_text(along/2)//','//to_text(along/2 + layers)//', spacing='// &
              to_text(1.0_dp/argument(2, 3))//", material='m', formulation='rigid', "// &
              'motion_time=0,1, motion_velocity=0,0,0, 0,0,0 /', s)
    write (output_unit, '(3(i0, a))') s%solid%n, ' particles, ', s%far%wall%cells%n, &
        ' listed cells, ', product(s%air%n), ' cells of air'
    call time_step('at rest', 0.0_dp)
    call time_step('0.02 cells a step', 0.02_dp)
    call time_step('0.1 cells a step', 0.1_dp)
    if (failed(s%err)) then
        print '(a)', s%err%text
        error stop 5
    end if

contains

    !> The plate lies in the middle of a box that is wider by a third.
    function along_axis(d) result(text)
        integer, intent(in) :: d !! direction
        character(:), allocatable :: text

        associate (low => (s%air%n(d) - along)/2)
            text = to_text(low)//','//to_text(low + along)//','
        end associate
    end function along_axis

    !> Ten steps, in which the plate goes so far.
    subroutine time_step(what, by)
        character(*), intent(in) :: what
        real(dp), intent(in) :: by !! cells a step
        real(dp) :: ms(4), speed
        integer :: m
        integer, parameter :: steps = 10

        s%twin%bodies(1)%motion%v(3, :) = by/dt
        ms = 0
        do m = 1, steps
            call start_timer(s%err)
            call set_wall_velocity(s%other, s%twin, s%far, dt, s%err)
            ms(1) = ms(1) + 1e3_dp*stop_timer(s%err)/steps
            call start_timer(s%err)
            call spread_load(s%twin, s%far, dt, s%err)
            ms(2) = ms(2) + 1e3_dp*stop_timer(s%err)/steps
            call solid_step(s%twin, dt, s%err)
            call start_timer(s%err)
            call reclassify(s%other, s%twin, s%far, s%err)
            ms(3) = ms(3) + 1e3_dp*stop_timer(s%err)/steps
            call start_timer(s%err)
            speed = fastest_wall(s%other, s%far, s%err)
            ms(4) = ms(4) + 1e3_dp*stop_timer(s%err)/steps
        end do
        write (output_unit, '(2a, 4(a, f8.3))') what, '; ms each step', ': wall velocity', ms(1), &
            ', load', ms(2), ', exchange', ms(3), ', fastest wall', ms(4)
    end subroutine time_step
end program bench_gpu_coupling
