! SPDX-License-Identifier: MIT
!> Third-order weighted essentially non-oscillatory reconstruction on three cells.
!>
!> Source: Jiang & Shu 1996. Written in differences: exact on constants, and one division.
!> Point physics.
module brz_weno3
    use brz_kinds, only: rk
    implicit none
    private
    public :: weno3

    real(rk), parameter :: relative = 1e-6_rk !! smallest smoothness, as a part of the largest f^2
    real(rk), parameter :: least = 16*sqrt(tiny(1.0_rk)) !! its square can still be divided by

contains

    !> Value at the face between cells b and c, seen from the side of a and b.
    !>
    !> The weights (1/3)/(e + IS0)^2 and (2/3)/(e + IS1)^2 are multiplied by both denominators. The
    !> result does not depend on `scale`, which keeps fourth powers inside the range of real32:
    !> values up to 1e9 times the typical one pass.
    !@cuf attributes(host,device) &
    pure function weno3(a, b, c, scale) result(f)
        real(rk), intent(in) :: a, b, c !! values of three cells in a row
        real(rk), intent(in) :: scale !! 1/(typical value)^2
        real(rk) :: f
        real(rk) :: d0, d1, e, r0, r1

        d0 = b - a
        d1 = c - b
        e = max(abs(a), max(abs(b), abs(c)))
        e = relative*(e*e)
        r0 = (d0*d0 + e)*scale + least
        r1 = (d1*d1 + e)*scale + least
        r0 = 2*(r0*r0)
        r1 = r1*r1
        f = b + 0.5_rk*(d1 + r1/(r1 + r0)*(d0 - d1))
    end function weno3
end module brz_weno3
