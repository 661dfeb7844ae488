! SPDX-License-Identifier: MIT
!> Mass fraction of the products of explosives at a face. Point physics.
!>
!> The products go with the mass: their flux is the mass flux times the fraction on the side that
!> it comes from (Larrouturou 1991), so that fractions stay within 0..1.
module brz_products
    use brz_kinds, only: rk
    implicit none
    private
    public :: face_fraction, limited_slope

contains

    !> Mass fraction that a mass flux carries through the face between cells b and c.
    !@cuf attributes(host,device) &
    pure function face_fraction(mass_flux, a, b, c, d) result(y)
        real(rk), intent(in) :: mass_flux !! through the face [kg/(m2 s)]
        real(rk), intent(in) :: a, b, c, d !! fractions of four cells in a row [-]
        real(rk) :: y

        y = merge(b + 0.5_rk*limited_slope(b - a, c - b), &
            c - 0.5_rk*limited_slope(c - b, d - c), mass_flux >= 0)
    end function face_fraction

    !> Van Leer's limiter: the harmonic mean of two differences, zero where their signs differ.
    !@cuf attributes(host,device) &
    pure function limited_slope(a, b) result(s)
        real(rk), intent(in) :: a, b !! differences to the two neighbours
        real(rk) :: s, ab

        ab = max(a*b, 0.0_rk)
        s = 2*ab/merge(a + b, 1.0_rk, ab > 0)
    end function limited_slope
end module brz_products
