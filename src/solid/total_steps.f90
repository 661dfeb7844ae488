! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64 and exact: they depend neither on the
!> order of the particles nor on threads and processes. scripts/steps.py writes the same for the
!> GPU.
module brz_total_steps
    use brz_force_loops, only: each_sum_state
    use brz_kinds, only: dp, rk
    use brz_solid_sums, only: n_sum, solid_totals_t, totals_of_sums
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: solid_totals, solid_totals_t

contains

    !> Totals of body b, or with b = 0 of all bodies, which are added in their order. Ledgers must
    !> be up to date. All processes must call.
    subroutine solid_totals(solid, b, totals)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        real(dp) :: all_of_them(n_sum), sums(n_sum)
        integer :: k

        all_of_them = 0
        do k = 1, size(solid%bodies)
            if (b /= 0 .and. b /= k) cycle
            associate (there => solid%bodies(k))
                call each_sum_state(there%last - there%first + 1, solid%ranks, there%first, &
                    solid%wide, solid%step_d, solid%step_p, real(solid%dt_last/2, rk), &
                    solid%region, solid%x, solid%v, solid%mass, solid%a, solid%energy, &
                    solid%damage, solid%fixed, sums) !@gpu solid%region => gpu%region
            end associate
            all_of_them = all_of_them + sums
        end do
        call totals_of_sums(solid, b, all_of_them, totals) !@host
    end subroutine solid_totals
end module brz_total_steps
