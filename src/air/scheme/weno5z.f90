! SPDX-License-Identifier: MIT
!> Fifth-order weighted essentially non-oscillatory reconstruction on five cells, WENO-Z.
!>
!> Source: Borges, Carmona, Costa & Don 2008, with the power 2. Written in differences, exact on
!> constants, mirror images to the bit, and with two divisions. Point physics.
module brz_weno5z
    use brz_kinds, only: rk
    implicit none
    private
    public :: weno5z

    real(rk), parameter :: relative = 1e-12_rk !! smallest smoothness, as a part of the largest f^2
    real(rk), parameter :: least = 16*tiny(1.0_rk) !! it can still be divided by

contains

    !> Value at the face between cells c and d, seen from the side of c.
    !>
    !> The smoothness indicators count relative to their sum, which leaves the weights as they are
    !> and their sixth powers inside the range of real32. The weights d (1 + (tau/IS)^2) are
    !> multiplied by all denominators.
    !@cuf attributes(host,device) &
    pure function weno5z(a, b, c, d, e) result(f)
        real(rk), intent(in) :: a, b, c, d, e !! values of five cells in a row
        real(rk) :: f
        real(rk) :: d1, d2, d3, d4, s0, s1, s2, floor, tau, w0, w1, w2

        d1 = b - a
        d2 = c - b
        d3 = d - c
        d4 = e - d
        floor = relative*max(max(a*a, e*e), max(b*b, max(c*c, d*d))) + least
        s0 = 13*(d2 - d1)**2 + 3*(3*d2 - d1)**2 + floor ! 12 times the usual ones
        s1 = 13*(d3 - d2)**2 + 3*(d3 + d2)**2 + floor
        s2 = 13*(d4 - d3)**2 + 3*(3*d3 - d4)**2 + floor
        w0 = 1/(s0 + s1 + s2)
        tau = (s0 - s2)*w0
        tau = tau*tau
        s0 = (s0*w0)**2
        s1 = (s1*w0)**2
        s2 = (s2*w0)**2
        w0 = (s0 + tau)*(s1*s2)
        w1 = 6*(s1 + tau)*(s0*s2)
        w2 = 3*(s2 + tau)*(s0*s1)
        f = c + (w0*(5*d2 - 2*d1) + w1*(d2 + 2*d3) + w2*(4*d3 - d4))/(6*(w0 + w1 + w2))
    end function weno5z
end module brz_weno5z
