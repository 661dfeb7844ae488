! SPDX-License-Identifier: MIT
!> The work of a run, estimated with the rates of one core in docs/performance.md.
module brz_work
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_advice_text, only: time_text
    use brz_kinds, only: dp
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: work_t, core_seconds, cell_seconds, particle_seconds, print_work, whole_step

    real(dp), parameter :: cell_rate = 4e6_dp, particle_rate = 1.3e6_dp !! steps of one core [1/s]

    real(dp), parameter :: most_ratio = 1e6_dp !! of steps beyond which a part of one is nothing

    type :: work_t
        real(dp) :: steps = 0 !! of the air, or of the bodies alone
        real(dp) :: substeps = 1 !! of the bodies in each
        real(dp) :: cells = 0, particles = 0
        real(dp), allocatable :: of_body(:) !! particles of each body
    end type work_t

contains

    !> The time that one core would take [s].
    pure real(dp) function core_seconds(work)
        type(work_t), intent(in) :: work

        core_seconds = cell_seconds(work) &
                       + work%steps*work%substeps*work%particles/particle_rate
    end function core_seconds

    !> That of the cells [s].
    pure real(dp) function cell_seconds(work)
        type(work_t), intent(in) :: work

        cell_seconds = work%steps*work%cells/cell_rate
    end function cell_seconds

    !> That of the particles of a body [s].
    pure real(dp) function particle_seconds(work, b)
        type(work_t), intent(in) :: work
        integer, intent(in) :: b !! body

        particle_seconds = work%steps*work%substeps*work%of_body(b)/particle_rate
    end function particle_seconds

    !> A step of the air that is a whole number of the bodies' own steps, or as it was, whichever
    !> carries a scene on for less work: 2.2 steps of the bodies would have to be made as three.
    pure real(dp) function whole_step(dt, dt_solid, cells, particles) result(step)
        real(dp), intent(in) :: dt, dt_solid !! largest steps of the air and the bodies [s]
        real(dp), intent(in) :: cells, particles !! of them all
        real(dp) :: air, body, ratio

        step = dt
        ratio = dt/dt_solid
        if (.not. ratio > 1 .or. ratio > most_ratio) return
        air = cells/cell_rate
        body = particles/particle_rate
        if ((air + aint(ratio)*body)*ratio > (air + real(ceiling(ratio), dp)*body)*aint(ratio)) &
            return
        step = aint(ratio)*dt_solid*(1 - 4*epsilon(dt)) ! does not round to one step more
    end function whole_step

    !> How long a run will take here, about.
    subroutine print_work(work)
        type(work_t), intent(in) :: work
        integer :: threads

        threads = omp_get_max_threads()
        write (output_unit, '(3a, i0, a)') 'time         about ', &
            time_text(core_seconds(work)/threads), ' on ', threads, &
            ' cores of 4 M cell-steps or 1.3 M particle-steps a second, if all is awake'
    end subroutine print_work
end module brz_work
