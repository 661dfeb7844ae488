! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64 and in a fixed order.
module brz_solid_totals
    use brz_kinds, only: dp
    use brz_particle_sums, only: add_particle
    use brz_solid_sums, only: n_sum, solid_totals_t, totals_of_sums
    use brz_solid_state, only: is_gone, solid_t, worth_threads
    use brz_solid_step, only: velocity_at_step
    implicit none
    private
    public :: solid_totals, solid_totals_t

contains

    !> Totals of body b, or of all bodies with b = 0.
    subroutine solid_totals(solid, b, totals)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        real(dp) :: part(n_sum, size(solid%block, 2))
        integer :: i, k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i)
        do k = 1, size(solid%block, 2)
            part(:, k) = 0
            if (b > 0 .and. solid%block(1, k) /= b) cycle
            do i = solid%block(2, k), solid%block(3, k)
                call add_particle(real(solid%mass(i), dp), solid%x(:, i), &
                                  real(velocity_at_step(solid, i), dp), real(solid%energy(i), dp), &
                                  real(solid%damage(i), dp), solid%region, &
                                  solid%fixed(i) == is_gone, part(:, k))
            end do
        end do
        call totals_of_sums(solid, b, sum(part, dim=2), totals)
    end subroutine solid_totals
end module brz_solid_totals
