! SPDX-License-Identifier: MIT
!> Approximate Riemann solver HLLC, which keeps contacts and shears. Point physics.
!>
!> Source: Toro, Spruce & Speares 1994; wave speeds of Einfeldt 1988 as Batten et al. 1997 take
!> them, which keep density and pressure positive. Written so that mirror images give mirrored
!> fluxes to the bit: two mirrored states let exactly nothing through, and a contact at rest gives
!> exactly p.
module brz_hllc
    use brz_kinds, only: rk
    implicit none
    private
    public :: hllc_flux

    real(rk), parameter :: least = 1e6_rk*tiny(1.0_rk) !! pressure that counts as none
    ! its square of a Mach number: without it the waves of cold gas that moves fall together
    real(rk), parameter :: cold = (1e3_rk*epsilon(1.0_rk))**2

contains

    !> Flux between two states, each with its own ratio of specific heats.
    !>
    !> With a = sqrt(rho), t = (a_l - a_r)/(a_l + a_r) is the weight of Roe's averages.
    !@cuf attributes(host,device) &
    pure subroutine hllc_flux(gamma_l, l, gamma_r, r, f)
        real(rk), intent(in) :: gamma_l, gamma_r !! ratios of specific heats [-]
        real(rk), intent(in) :: l(5), r(5)
        !! below and above: density, velocity with the normal component first, pressure
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk) :: vol_l, vol_r, c2_l, c2_r, t, mean, fan, s_l, s_r, m_l, m_r, side, star
        real(rk) :: heat, volume, u, v, w, p, s, m, inverse, density, p_star

        vol_l = 1/l(1)
        vol_r = 1/r(1)
        c2_l = gamma_l*max(l(5), least, cold*l(1)*l(2)**2)*vol_l
        c2_r = gamma_r*max(r(5), least, cold*r(1)*r(2)**2)*vol_r
        t = sqrt(l(1))
        s = sqrt(r(1))
        t = (t - s)/(t + s)
        mean = 0.5_rk*((l(2) + r(2)) + t*(l(2) - r(2)))
        fan = sqrt(0.5_rk*((c2_l + c2_r) + t*(c2_l - c2_r)) &
            + 0.125_rk*(1 - t*t)*(l(2) - r(2))**2)
        s_l = min(l(2) - sqrt(c2_l), mean - fan)
        s_r = max(r(2) + sqrt(c2_r), mean + fan)
        m_l = l(1)*(s_l - l(2))
        m_r = r(1)*(s_r - r(2))
        side = 0.5_rk*(l(2) + r(2)) &
            + ((r(5) - l(5)) + 0.5_rk*(m_l + m_r)*(l(2) - r(2)))/(m_l - m_r)

        ! tests of a number, not of a logical: gcc vectorises these
        heat = merge(1/(gamma_l - 1), 1/(gamma_r - 1), side >= 0)
        volume = merge(vol_l, vol_r, side >= 0)
        u = merge(l(2), r(2), side >= 0)
        v = merge(l(3), r(3), side >= 0)
        w = merge(l(4), r(4), side >= 0)
        p = merge(l(5), r(5), side >= 0)
        s = merge(s_l, s_r, side >= 0)
        m = merge(m_l, m_r, side >= 0)
        ! where all waves run to one side the star state is the state itself
        star = merge(l(2), side, s_l >= 0)
        star = merge(r(2), star, s_r <= 0)
        inverse = 1/(s - star)
        density = m*inverse
        p_star = p + m*(star - u)
        f(1) = density*star
        f(2) = f(1)*star + p_star
        f(3) = f(1)*v
        f(4) = f(1)*w
        f(5) = f(1)*(p*volume*heat + 0.5_rk*(u*u + v*v + w*w) + (star - u)*star) &
            + star*((star - u)*p*inverse + p_star)
    end subroutine hllc_flux
end module brz_hllc
