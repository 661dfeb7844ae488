! SPDX-License-Identifier: MIT
!> The work of a run, estimated with measured times of one core (docs/evidence/performance.md).
module brz_work
    use, intrinsic :: iso_fortran_env, only: output_unit
    use brz_advice_text, only: time_text
    use brz_body, only: body_t
    use brz_formulation_names, only: form_bending, form_corrected, form_rigid, form_total, &
        form_uncorrected
    use brz_kinds, only: dp
    use brz_material, only: material_t
    use brz_bodies, only: bodies_t
    use omp_lib, only: omp_get_max_threads
    implicit none
    private
    public :: work_t, core_seconds, cell_seconds, particle_costs, particle_seconds, print_work

    ! Seconds of one core for a step of a cell, and of a particle by formulation; what materials of
    ! many operations add; share of it in fewer dimensions, where a particle has fewer neighbours.
    real(dp), parameter :: of_cell = 3.5e-7_dp, of_wall_cell = 1.5e-7_dp
    real(dp), parameter :: of_rigid = 5e-8_dp, of_plain = 7e-7_dp, of_hourglass = 1.15e-6_dp
    real(dp), parameter :: of_bending = 1.0e-6_dp, of_total = 9.5e-7_dp
    real(dp), parameter :: of_ply = 5e-7_dp, of_cracks = 3e-7_dp, of_control = 3e-7_dp
    real(dp), parameter :: of_dimension(3) = [0.3_dp, 0.5_dp, 1.0_dp]
    ! Steps of one GPU [1/s]: an H200 in real64
    real(dp), parameter :: gpu_cells = 2e9_dp, gpu_particles = 1.1e8_dp

    type :: work_t
        real(dp) :: steps = 0 !! of the air, or of the bodies alone
        real(dp) :: substeps = 1 !! of the bodies in each
        real(dp) :: cells = 0, particles = 0
        real(dp), allocatable :: of_body(:) !! particles of each body
        real(dp), allocatable :: costs(:) !! seconds of one core for a step of one of them
    end type work_t

contains

    !> The time that one core would take [s].
    pure real(dp) function core_seconds(work)
        type(work_t), intent(in) :: work

        core_seconds = cell_seconds(work)
        if (allocated(work%of_body)) core_seconds = core_seconds + &
            work%steps*work%substeps*sum(work%of_body*work%costs)
    end function core_seconds

    !> That of the cells [s].
    pure real(dp) function cell_seconds(work)
        type(work_t), intent(in) :: work

        cell_seconds = work%steps*work%cells*of_cell
        if (work%particles > 0) cell_seconds = cell_seconds + work%steps*work%cells*of_wall_cell
    end function cell_seconds

    !> That of the particles of a body [s].
    pure real(dp) function particle_seconds(work, b)
        type(work_t), intent(in) :: work
        integer, intent(in) :: b !! body

        particle_seconds = work%steps*work%substeps*work%of_body(b)*work%costs(b)
    end function particle_seconds

    !> Seconds of one core for a step of a particle, by body.
    pure function particle_costs(solid) result(costs)
        class(bodies_t), intent(in) :: solid !! its bodies and materials
        real(dp), allocatable :: costs(:) !! (bodies) [s]
        integer :: b

        allocate (costs(size(solid%bodies)))
        do b = 1, size(costs)
            costs(b) = particle_cost(solid%bodies(b), solid%materials(solid%bodies(b)%material)) &
                       *of_dimension(solid%dimension)
        end do
    end function particle_costs

    pure real(dp) function particle_cost(body, material) result(cost)
        type(body_t), intent(in) :: body
        type(material_t), intent(in) :: material

        select case (body%formulation)
        case (form_rigid)
            cost = of_rigid
            return
        case (form_uncorrected, form_corrected)
            cost = of_plain
        case (form_bending)
            cost = of_bending
        case (form_total)
            cost = of_total
        case default
            cost = of_hourglass
        end select
        if (body%tensile_control > 0) cost = cost + of_control
        if (any(material%axial > 0)) then
            cost = cost + of_ply
        else if (material%crack > 0) then
            cost = cost + of_cracks
        end if
    end function particle_cost

    !> How long a run will take here, about.
    subroutine print_work(work, gpus)
        type(work_t), intent(in) :: work
        logical, intent(in) :: gpus !! a GPU will compute it
        integer :: threads
        real(dp) :: seconds

        threads = omp_get_max_threads()
        seconds = core_seconds(work)
        if (gpus) then
            write (output_unit, '(5a)') 'time         about ', &
                time_text(work%steps*(work%cells/gpu_cells + &
                                      work%substeps*work%particles/gpu_particles)), &
                ' and dumps, on a GPU like an H200 (on the CPU ', time_text(seconds), &
                ' of one core), if all is active'
        else
            write (output_unit, '(5a, i0, a)') 'time         about ', time_text(seconds), &
                ' of one core, ', time_text(seconds/threads), ' on ', threads, &
                ' here, if all is active; twice that on a busy machine'
        end if
    end subroutine print_work
end module brz_work
