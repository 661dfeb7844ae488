! SPDX-License-Identifier: MIT
!> Slopes and fluxes of rows of cells, for any equation of state: van Leer's limiter and HLLC.
!>
!> Wave speeds of Einfeldt 1988 with the sound speeds of the equation of state. Mirror images give
!> mirrored fluxes to the bit, and a contact at rest gives exactly p.
module brz_axial_flux
    use brz_axial_state, only: w_energy, w_p, w_part, w_r, w_rho, w_sound, w_z
    use brz_kinds, only: dp
    implicit none
    private
    public :: limited_slopes, riemann_row

contains

    !> Harmonic mean of the slopes to both sides, zero where their signs differ.
    pure subroutine limited_slopes(n, below, here, above, down, up, factor, slope)
        integer, intent(in) :: n
        real(dp), intent(in) :: below(n), here(n), above(n) !! values of three cells in a row
        real(dp), intent(in) :: down(n), up(n) !! one over the distances of their centres
        real(dp), intent(in) :: factor(n) !! on the result
        real(dp), intent(out) :: slope(n)
        real(dp) :: a, b, ab
        integer :: i

        !$omp simd private(a, b, ab)
        do i = 1, n
            a = (here(i) - below(i))*down(i)
            b = (above(i) - here(i))*up(i)
            ab = max(a*b, 0.0_dp)
            slope(i) = factor(i)*(2*ab/merge(a + b, 1.0_dp, ab > 0))
        end do
    end subroutine limited_slopes

    !> Fluxes between pairs of states.
    !>
    !> Rows of a state: density, velocity across and along the face in the rows `normal` and 5 -
    !> `normal`, pressure, internal energy per volume, mass fraction of products, sound speed.
    pure subroutine riemann_row(n, normal, l, r, f)
        integer, intent(in) :: n
        integer, intent(in) :: normal !! row of the velocity across the face: w_r or w_z
        real(dp), intent(in) :: l(n, 7), r(n, 7) !! below and above
        real(dp), intent(out) :: f(n, 6)
        !! mass, momentum across without pressure, momentum along, energy, products; pressure
        real(dp) :: a, b, share, mean, fan, s_l, s_r, m_l, m_r, side, star, s, m, inverse
        real(dp) :: rho, u, v, p, e, y
        integer :: i, t

        t = w_r + w_z - normal
        !$omp simd private(a, b, share, mean, fan, s_l, s_r, m_l, m_r, side, star, s, m, inverse, &
        !$omp& rho, u, v, p, e, y)
        do i = 1, n
            a = sqrt(l(i, w_rho))
            b = sqrt(r(i, w_rho))
            share = 1/(a + b)
            mean = (a*l(i, normal) + b*r(i, normal))*share
            fan = sqrt((a*l(i, w_sound)**2 + b*r(i, w_sound)**2)*share &
                + 0.5_dp*(a*share)*(b*share)*(l(i, normal) - r(i, normal))**2)
            s_l = min(l(i, normal) - l(i, w_sound), mean - fan)
            s_r = max(r(i, normal) + r(i, w_sound), mean + fan)
            m_l = l(i, w_rho)*(s_l - l(i, normal))
            m_r = r(i, w_rho)*(s_r - r(i, normal))
            side = 0.5_dp*(l(i, normal) + r(i, normal)) + ((r(i, w_p) - l(i, w_p)) &
                + 0.5_dp*(m_l + m_r)*(l(i, normal) - r(i, normal)))/(m_l - m_r)
            rho = merge(l(i, w_rho), r(i, w_rho), side >= 0)
            u = merge(l(i, normal), r(i, normal), side >= 0)
            v = merge(l(i, t), r(i, t), side >= 0)
            p = merge(l(i, w_p), r(i, w_p), side >= 0)
            e = merge(l(i, w_energy), r(i, w_energy), side >= 0)
            y = merge(l(i, w_part), r(i, w_part), side >= 0)
            s = merge(s_l, s_r, side >= 0)
            m = merge(m_l, m_r, side >= 0)
            ! where all waves run to one side the star state is the state itself
            star = merge(l(i, normal), side, s_l >= 0)
            star = merge(r(i, normal), star, s_r <= 0)
            inverse = 1/(s - star)
            f(i, 1) = m*inverse*star
            f(i, 2) = f(i, 1)*star
            f(i, 3) = f(i, 1)*v
            f(i, 5) = f(i, 1)*y
            f(i, 6) = p + m*(star - u)
            f(i, 4) = star*(((s - u)*(e + 0.5_dp*rho*(u*u + v*v)) - p*u + f(i, 6)*star)*inverse &
                + f(i, 6))
        end do
    end subroutine riemann_row
end module brz_axial_flux
