! SPDX-License-Identifier: MIT
!> The thinnest and the coldest gas of a scene.
module gas_tools
    use brz_air_state, only: air_t, wall_t
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: least_gas

contains

    !> Least density over that of the air at rest, and least internal over total energy, of all gas
    !> cells, both as the working precision sees them; minus one if one of them is no number.
    pure subroutine least_gas(air, wall, density, warmth)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(out) :: density, warmth
        real(rk) :: part, u(5)
        integer :: i, j, k

        density = huge(density)
        warmth = huge(warmth)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    if (wall%present) then
                        if (wall%solid(i, j, k) == 1) cycle
                    end if
                    u = air%u(i, j, k, 1:5)
                    part = 1 - (u(2)*u(2) + u(3)*u(3) + u(4)*u(4))/(2*u(1)*u(5))
                    if (.not. all(abs(u) <= huge(u)) .or. .not. u(5) > 0) part = -1
                    density = min(density, real(u(1)/air%rho_rest, dp))
                    warmth = min(warmth, real(part, dp))
                end do
            end do
        end do
    end subroutine least_gas
end module gas_tools
