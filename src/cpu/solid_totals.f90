! SPDX-License-Identifier: MIT
!> Sums over a body: mass, momentum, energy, all in real64 and in a fixed order.
module brz_solid_totals
    use brz_kinds, only: dp
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
        integer :: k

        !$omp parallel do if(solid%n >= worth_threads) schedule(static)
        do k = 1, size(solid%block, 2)
            part(:, k) = 0
            if (b == 0 .or. solid%block(1, k) == b) &
                call sum_block(solid, solid%block(2, k), solid%block(3, k), part(:, k))
        end do
        call totals_of_sums(solid, b, sum(part, dim=2), totals)
    end subroutine solid_totals

    subroutine sum_block(solid, first, last, part)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: first, last
        real(dp), intent(out) :: part(n_sum)
        real(dp) :: x(3), v(3), m
        integer :: i

        part = 0
        do i = first, last
            m = solid%mass(i)
            x = solid%x(:, i)
            v = velocity_at_step(solid, i)
            part(1) = part(1) + m
            part(2:4) = part(2:4) + m*x
            part(5:7) = part(5:7) + m*v
            part(8) = part(8) + m*(x(2)*v(3) - x(3)*v(2))
            part(9) = part(9) + m*(x(3)*v(1) - x(1)*v(3))
            part(10) = part(10) + m*(x(1)*v(2) - x(2)*v(1))
            part(11) = part(11) + m*dot_product(v, v)/2
            part(12) = part(12) + m*solid%energy(i)
            part(13) = part(13) + m*solid%damage(i)
            if (any(x < solid%region(:, 1) .or. x > solid%region(:, 2))) part(14) = part(14) + m
            if (solid%fixed(i) == is_gone) &
                part(15:16) = part(15:16) + m*[1.0_dp, dot_product(v, v)/2 + solid%energy(i)]
        end do
    end subroutine sum_block
end module brz_solid_totals
