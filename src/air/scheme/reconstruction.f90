! SPDX-License-Identifier: MIT
!> Values at faces from the values of cells, by the scheme. Point physics.
!>
!> The sweeps take the same functions line by line; this is the path for single faces.
module brz_reconstruction
    use brz_kinds, only: rk
    use brz_muscl, only: muscl
    use brz_scheme, only: first_order, muscl_cells, scheme_t, weno3_cells
    use brz_weno3, only: weno3
    use brz_weno5z, only: weno5z
    implicit none
    private
    public :: face_value, thinness

    real(rk), parameter :: part = 0.1_rk !! least density and pressure at a face over the cell's

contains

    !> Value of component c at the face between cells x(0) and x(1), seen from the side of x(0).
    !@cuf attributes(host,device) &
    pure function face_value(scheme, c, x) result(f)
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: c !! component, for the scale
        real(rk), intent(in) :: x(-2:2) !! five cells in a row
        real(rk) :: f

        if (scheme%reconstruction == first_order) then
            f = x(0)
        else if (scheme%reconstruction == muscl_cells) then
            f = muscl(x(-1), x(0), x(1))
        else if (scheme%reconstruction == weno3_cells) then
            f = weno3(x(-1), x(0), x(1), scheme%scale(c))
        else
            f = weno5z(x(-2), x(-1), x(0), x(1), x(2))
        end if
    end function face_value

    !> Positive where density or pressure at a face of a cell falls below a tenth of the cell's:
    !> then the cell counts as constant. A third- or fifth-order value may even be negative there.
    !@cuf attributes(host,device) &
    pure function thinness(cell, low, high) result(thin)
        real(rk), intent(in) :: cell !! density or pressure
        real(rk), intent(in) :: low, high !! values at its two faces
        real(rk) :: thin

        thin = part*cell - min(low, high)
    end function thinness
end module brz_reconstruction
