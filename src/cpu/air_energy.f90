! SPDX-License-Identifier: MIT
!> Kinetic energy of the gas, for the ledger.
module brz_air_energy
    use brz_air_state, only: air_t, wall_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: air_kinetic

contains

    !> Kinetic energy of all gas cells [J]. Row sums are added in a fixed order.
    real(dp) function air_kinetic(air, wall)
        type(air_t), intent(inout) :: air !! its row sums are overwritten
        type(wall_t), intent(in) :: wall
        integer :: i, j, k, row

        !$omp parallel do collapse(2) schedule(static) private(i, row)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                row = (k - 1)*air%n(2) + j
                air%row_sum(1, row) = 0
                do i = 1, air%n(1)
                    if (wall%present) then
                        if (wall%solid(i, j, k) /= 0) cycle
                    end if
                    air%row_sum(1, row) = air%row_sum(1, row) + &
                                          sum(air%u(i, j, k, 2:4)**2)/(2*air%u(i, j, k, 1))
                end do
            end do
        end do
        !$omp end parallel do
        air_kinetic = 0
        do row = 1, air%n(2)*air%n(3)
            air_kinetic = air_kinetic + air%row_sum(1, row)
        end do
        air_kinetic = air_kinetic*product(air%dx)
    end function air_kinetic
end module brz_air_energy
