! SPDX-License-Identifier: MIT
!> Mass fraction of detonation products at a face. Point physics.
!>
!> The products go with the mass: their flux is the mass flux times the fraction on the side that
!> it comes from (Larrouturou 1991), so that fractions stay within 0..1.
module brz_products
    use brz_kinds, only: rk
    use brz_muscl, only: muscl
    implicit none
    private
    public :: face_fraction

contains

    !> Mass fraction that a mass flux carries through the face between cells b and c.
    !@cuf attributes(host,device) &
    pure function face_fraction(mass_flux, a, b, c, d) result(y)
        real(rk), intent(in) :: mass_flux !! through the face [kg/(m2 s)]
        real(rk), intent(in) :: a, b, c, d !! fractions of four cells in a row [-]
        real(rk) :: y

        y = merge(muscl(a, b, c), muscl(d, c, b), mass_flux >= 0)
    end function face_fraction
end module brz_products
