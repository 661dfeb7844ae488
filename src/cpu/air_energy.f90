! SPDX-License-Identifier: MIT
!> Kinetic energy of the gas, for the ledger.
module brz_air_energy
    use brz_air_state, only: air_t, brick, wall_t
    use brz_air_totals, only: first_of_brick, sum_bricks
    use brz_kinds, only: dp
    implicit none
    private
    public :: air_kinetic

contains

    !> Kinetic energy of all gas cells of all processes [J]. See brz_air_totals.
    real(dp) function air_kinetic(air, wall)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(wall_t), intent(in) :: wall
        integer :: i, j, k, b, at(3)
        real(dp) :: total

        !$omp parallel do schedule(static) private(i, j, k, at, total)
        do b = 1, size(air%brick_sum, 2)
            at = first_of_brick(air, b)
            total = 0
            do k = at(3), min(at(3) + brick - 1, air%n(3))
                do j = at(2), min(at(2) + brick - 1, air%n(2))
                    do i = at(1), min(at(1) + brick - 1, air%n(1))
                        if (wall%present) then
                            if (wall%solid(i, j, k) /= 0) cycle
                        end if
                        total = total + sum(air%u(i, j, k, 2:4)**2)/(2*air%u(i, j, k, 1))
                    end do
                end do
            end do
            air%brick_sum(1, b) = total
        end do
        !$omp end parallel do
        air_kinetic = sum_bricks(air)*product(air%dx)
    end function air_kinetic
end module brz_air_energy
