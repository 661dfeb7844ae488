! SPDX-License-Identifier: MIT
!> Second-order reconstruction with van Leer's limiter. Point physics.
!>
!> Source: van Leer 1974. The value at a face lies between those of the two cells beside it, so
!> densities and pressures stay positive.
module brz_muscl
    use brz_kinds, only: rk
    implicit none
    private
    public :: muscl, limited_slope

contains

    !> Value at the face between cells b and c, seen from the side of a and b.
    !@cuf attributes(host,device) &
    pure function muscl(a, b, c) result(f)
        real(rk), intent(in) :: a, b, c !! values of three cells in a row
        real(rk) :: f

        f = b + 0.5_rk*limited_slope(b - a, c - b)
    end function muscl

    !> The harmonic mean of two differences, zero where their signs differ.
    !@cuf attributes(host,device) &
    pure function limited_slope(a, b) result(s)
        real(rk), intent(in) :: a, b !! differences to the two neighbours
        real(rk) :: s, ab

        ab = max(a*b, 0.0_rk)
        s = 2*ab/merge(a + b, 1.0_rk, ab > 0)
    end function limited_slope
end module brz_muscl
