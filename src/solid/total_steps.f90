! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64. On the CPU they are exact and depend
!> neither on the order of the particles nor on threads and processes; on the GPU they are folded in
!> a fixed order, as exact sums there took 3 ms more for each row of the histories.
!> scripts/steps.py writes the same for the GPU.
module brz_total_steps
    use brz_force_loops, only: each_sum_state !@cpu
    !@gpu use brz_gpu_solid_books, only: sum_states
    use brz_kinds, only: dp, rk
    use brz_solid_sums, only: n_sum, solid_totals_t, totals_of_sums
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: solid_totals, sums_of_bodies, solid_totals_t

contains

    !> Totals of body b, or with b = 0 of all bodies. Ledgers must be up to date. All processes must
    !> call.
    subroutine solid_totals(solid, b, totals)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        real(dp), allocatable :: sums(:, :)

        allocate (sums(n_sum, size(solid%bodies)))
        call sums_of_bodies(solid, sums)
        call totals_of_sums(solid, b, sums, totals) !@host
    end subroutine solid_totals

    !> Sums over the particles of each body. All processes must call.
    subroutine sums_of_bodies(solid, sums)
        type(solid_t), intent(in) :: solid
        real(dp), intent(out) :: sums(n_sum, size(solid%bodies)) !! see sum_state
        real(dp) :: one(n_sum) !@cpu
        integer :: k !@cpu

        !@gpu call sum_states(gpu, solid, sums)
        do k = 1, size(solid%bodies) !@cpu
            associate (there => solid%bodies(k)) !@cpu
                call each_sum_state(there%last - there%first + 1, solid%ranks, there%first, &
                    solid%wide, solid%step_d, solid%step_p, real(solid%dt_last/2, rk), &
                    solid%region, solid%x, solid%v, solid%mass, solid%a, solid%energy, &
                    solid%damage, solid%fixed, one) !@cpu
            end associate !@cpu
            sums(:, k) = one !@cpu
        end do !@cpu
    end subroutine sums_of_bodies
end module brz_total_steps
