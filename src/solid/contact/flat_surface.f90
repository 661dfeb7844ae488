! SPDX-License-Identifier: MIT
!> The kernel sum over a body with a flat surface: the measure of the contact between bodies.
module brz_flat_surface
    use brz_interaction, only: interaction_t
    use brz_kernel, only: kernel_slope, kernel_value
    use brz_kinds, only: dp, rk
    implicit none
    private
    public :: flat_sum

contains

    !> Kernel sum over a flat surface of a lattice whose first layer is at a distance, and how fast
    !> it falls with that [1/m].
    pure subroutine flat_sum(dimension, spacing, m, distance, touch, slope)
        integer, intent(in) :: dimension
        real(dp), intent(in) :: spacing !! of that lattice [m]
        type(interaction_t), intent(in) :: m !! its kernel
        real(dp), intent(in) :: distance !! [m]
        real(dp), intent(out) :: touch, slope
        real(dp) :: r, z, f
        integer :: i, j, k, n, most(2)

        n = ceiling(2*m%h/spacing)
        most = 0
        most(:dimension - 1) = n
        touch = 0
        slope = 0
        do k = 0, n
            do j = -most(2), most(2)
                do i = -most(1), most(1)
                    z = distance + k*spacing
                    r = sqrt((i*spacing)**2 + (j*spacing)**2 + z**2)
                    f = spacing**dimension*kernel_slope(m%scale, m%half_over_h, real(r, rk))
                    touch = touch + kernel_value(real(f, rk), m%h, real(r, rk))
                    slope = slope + f*z
                end do
            end do
        end do
    end subroutine flat_sum
end module brz_flat_surface
