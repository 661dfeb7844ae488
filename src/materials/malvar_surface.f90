! SPDX-License-Identifier: MIT
!> Strength of concrete after Malvar, Crawford, Wesevich and Simons: a cylinder carries fc.
!>
!> Compressive meridians of concrete as it fails and of rubble, and how much of them is left towards
!> the tensile meridian, all over fc:
!>     fails   3 (x + ft)                 x <= 0,   x = p/fc
!>             1.5 (x + ft)/psi           x <= 1/3
!>             a0 + x/(a1 + a2 x)         beyond: 1 at x = 1/3, the cylinder
!>     rubble  x/(a1f + a2f x)            x > 0
!>     psi     1/2 at x = 0, 1/2 + 1.5 ft at 1/3, what makes the biaxial strength 1.15 at 2.3/3,
!>             0.753 at 3, 1 from 8.45 on, straight between
!> and between the meridians the ellipse of Willam and Warnke. Source: Malvar et al. 1997 (Int. J.
!> Impact Engng 19, 847-873); its constants as generated from fc (Karagozian & Case, release III).
!> Point physics: compiled for the CPU and for the GPU.
module brz_malvar_surface
    use brz_kinds, only: rk
    implicit none
    private
    public :: malvar_strength, meridian_share, tensile_share

    real(rk), parameter :: a0 = 0.2956_rk, a1 = 0.4463_rk, a2 = 0.0808_rk
    real(rk), parameter :: a1f = 0.4417_rk, a2f = 0.1183_rk
    real(rk), parameter :: cylinder = 1/3.0_rk !! p/fc at which a cylinder fails
    real(rk), parameter :: biaxial = 1.15_rk !! strength in two directions
    real(rk), parameter :: pressed = 2*biaxial/3 !! p/fc there
    real(rk), parameter :: at_pressed = biaxial/(a0 + pressed/(a1 + a2*pressed))

contains

    !> Strength on the compressive meridian over fc.
    !@cuf attributes(host,device) &
    pure function malvar_strength(x, ft, left) result(strength)
        real(rk), intent(in) :: x !! pressure over fc
        real(rk), intent(in) :: ft !! tensile strength over fc
        real(rk), intent(in) :: left !! 1: whole, 0: rubble
        real(rk) :: strength, whole

        if (x <= 0) then
            strength = 3*max(0.0_rk, x + ft*left)
            return
        end if
        strength = x/(a1f + a2f*x)
        if (x < cylinder) then
            whole = 1.5_rk*(x + ft)/tensile_share(x, ft)
        else
            whole = a0 + x/(a1 + a2*x)
        end if
        strength = strength + left*max(0.0_rk, whole - strength)
    end function malvar_strength

    !> Strength on the tensile meridian over that on the compressive one.
    !@cuf attributes(host,device) &
    pure function tensile_share(x, ft) result(share)
        real(rk), intent(in) :: x, ft !! as in `malvar_strength`
        real(rk) :: share

        if (x < cylinder) then
            share = 0.5_rk + 1.5_rk*ft*max(x, 0.0_rk)/cylinder
        else if (x < pressed) then
            share = between(x, cylinder, pressed, 0.5_rk + 1.5_rk*ft, at_pressed)
        else if (x < 3) then
            share = between(x, pressed, 3.0_rk, at_pressed, 0.753_rk)
        else
            share = min(1.0_rk, between(x, 3.0_rk, 8.45_rk, 0.753_rk, 1.0_rk))
        end if
    end function tensile_share

    !> Value at x on the line from (x0, y0) to (x1, y1).
    !@cuf attributes(host,device) &
    pure function between(x, x0, x1, y0, y1) result(y)
        real(rk), intent(in) :: x, x0, x1, y0, y1
        real(rk) :: y

        y = y0 + (x - x0)*((y1 - y0)/(x1 - x0))
    end function between

    !> Strength at an angle of Lode over that on the compressive meridian (Willam & Warnke 1975).
    !@cuf attributes(host,device) &
    pure function meridian_share(share, lode) result(radius)
        real(rk), intent(in) :: share !! of `tensile_share`, 1/2 to 1
        real(rk), intent(in) :: lode !! cos of three times the angle: 1 in tension, -1 in pressure
        real(rk) :: radius, c, w

        c = cos(acos(max(-1.0_rk, min(1.0_rk, lode)))/3)
        w = 4*(1 - share**2)*c**2
        radius = 2*(1 - share**2)*c + (2*share - 1)*sqrt(max(0.0_rk, w + share*(5*share - 4)))
        radius = radius/(w + (1 - 2*share)**2)
    end function meridian_share
end module brz_malvar_surface
