! SPDX-License-Identifier: MIT
!> Wendland C2 kernel W = a (1 - q/2)^4 (2 q + 1), q = r/h, support 2 h.
!>
!> Its slope enters the pair sums as F = -W'/r >= 0, so that grad_i W = -F x_ij. The same
!> polynomial serves in 1-D, 2-D and 3-D; the normalisation differs. Point physics.
!>
!> Source: Wendland 1995; docs/theory/solids.md
module brz_kernel
    use brz_kinds, only: rk
    implicit none
    private
    public :: kernel_scale, kernel_shape, kernel_slope, kernel_value, pair_kernel, smoothing_length

contains

    !> Factor of the slope: F = scale (1 - q/2)^3, from the integral of the kernel being 1.
    !@cuf attributes(host,device) &
    pure function kernel_scale(h, dimension) result(scale)
        real(rk), intent(in) :: h !! smoothing length [m]
        integer, intent(in) :: dimension !! 1, 2 or 3
        real(rk) :: scale !! [m^-(dimension+2)]
        real(rk), parameter :: pi = 3.14159265358979324_rk

        if (dimension == 1) then
            scale = 15/(4*h**3)
        else if (dimension == 2) then
            scale = 35/(4*pi*h**4)
        else
            scale = 105/(16*pi*h**5)
        end if
    end function kernel_scale

    !> Slope F = -W'/r at the distance r; 0 beyond the support.
    !@cuf attributes(host,device) &
    pure function kernel_slope(scale, half_over_h, r) result(f)
        real(rk), intent(in) :: scale !! from kernel_scale
        real(rk), intent(in) :: half_over_h !! 1/(2 h) [1/m]
        real(rk), intent(in) :: r !! [m]
        real(rk) :: f
        real(rk) :: c

        c = max(1 - half_over_h*r, 0.0_rk)
        f = scale*c*c*c
    end function kernel_slope

    !> Kernel over its value at the centre, W(r)/W(0); 0 beyond the support.
    !@cuf attributes(host,device) &
    pure function kernel_shape(half_over_h, r) result(w)
        real(rk), intent(in) :: half_over_h !! 1/(2 h) [1/m]
        real(rk), intent(in) :: r !! [m]
        real(rk) :: w
        real(rk) :: c

        c = max(1 - half_over_h*r, 0.0_rk)
        w = c*c*c*c*(4*half_over_h*r + 1)
    end function kernel_shape

    !> The kernel itself from its slope, W = F (h^2 + 3 h r/2 - r^2)/5.
    !@cuf attributes(host,device) &
    pure function kernel_value(slope, h, r) result(w)
        real(rk), intent(in) :: slope !! from kernel_slope
        real(rk), intent(in) :: h, r !! [m]
        real(rk) :: w

        w = slope*(h*h + 1.5_rk*h*r - r*r)/5
    end function kernel_value

    !> Kernel of a pair whose smoothing lengths differ: that of their mean, the same for both.
    !@cuf attributes(host,device) &
    pure subroutine pair_kernel(dimension, depth, hi, hj, h, scale, half_over_h)
        integer, intent(in) :: dimension
        real(rk), intent(in) :: depth !! of directions that are not modelled [m or m2]
        real(rk), intent(in) :: hi, hj !! [m]
        real(rk), intent(out) :: h !! [m]
        real(rk), intent(out) :: scale, half_over_h !! of kernel_slope

        h = (hi + hj)/2
        scale = kernel_scale(h, dimension)/depth
        half_over_h = 1/(2*h)
    end subroutine pair_kernel

    !> Smoothing length that keeps the number of neighbours, h0 (rho0/rho)^(1/d), within bounds.
    !@cuf attributes(host,device) &
    pure function smoothing_length(h0, bounds, dimension, mu) result(h)
        real(rk), intent(in) :: h0 !! unloaded [m]
        real(rk), intent(in) :: bounds(2) !! of h/h0
        integer, intent(in) :: dimension
        real(rk), intent(in) :: mu !! compression rho/rho0 - 1
        real(rk) :: h

        h = h0*min(max((1 + mu)**(-1/real(dimension, rk)), bounds(1)), bounds(2))
    end function smoothing_length
end module brz_kernel
