! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64 and exact: they depend neither on the
!> order of the particles nor on threads and processes.
module brz_solid_totals
    use brz_exact_sum, only: add_terms, close_sums, limbs, open_sums, scale_t, widen
    use brz_kinds, only: dp, int64
    use brz_particle_sums, only: add_particle
    use brz_solid_sums, only: n_sum, solid_totals_t, totals_of_sums, velocity_at_step
    use brz_solid_state, only: is_gone, solid_t, worth_threads
    implicit none
    private
    public :: solid_totals, solid_totals_t

contains

    !> Totals of body b, or of all bodies with b = 0. All processes must call.
    subroutine solid_totals(solid, b, totals)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: b
        type(solid_totals_t), intent(out) :: totals
        type(scale_t) :: scales(n_sum)
        real(dp) :: largest(n_sum), sums(n_sum)
        integer(int64) :: limb(limbs, n_sum)
        integer :: i, k

        largest = 0
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i) &
        !$omp reduction(max: largest)
        do k = 1, size(solid%block, 2)
            if (b > 0 .and. solid%block(1, k) /= b) cycle
            do i = solid%block(2, k), solid%block(3, k)
                call widen(terms(solid, i), largest)
            end do
        end do
        call open_sums(solid%ranks, largest, scales)
        limb = 0
        !$omp parallel do if(solid%n >= worth_threads) schedule(static) private(i) &
        !$omp reduction(+: limb)
        do k = 1, size(solid%block, 2)
            if (b > 0 .and. solid%block(1, k) /= b) cycle
            do i = solid%block(2, k), solid%block(3, k)
                call add_terms(scales, terms(solid, i), limb)
            end do
        end do
        call close_sums(solid%ranks, scales, limb, sums)
        call totals_of_sums(solid, b, sums, totals)
    end subroutine solid_totals

    !> What particle i adds.
    pure function terms(solid, i) result(sums)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(dp) :: sums(n_sum)

        sums = 0
        call add_particle(real(solid%mass(i), dp), solid%x(:, i), &
                          real(velocity_at_step(solid, i), dp), real(solid%energy(i), dp), &
                          real(solid%damage(i), dp), solid%region, solid%fixed(i) == is_gone, sums)
    end function terms
end module brz_solid_totals
