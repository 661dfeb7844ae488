! SPDX-License-Identifier: MIT
!> How the tension of a crack in concrete falls as it opens, its strength by rate, its width.
!>
!> Source: Bazant & Oh 1983 (crack band); strength by rate after Malvar & Ross 1998.
!> Point physics: compiled for the CPU and for the GPU.
module brz_hjc_softening
    use brz_hjc_pressure, only: p_crack_rate, p_fc, p_ft, p_gf, p_young
    use brz_kinds, only: rk
    use brz_material, only: n_par
    implicit none
    private
    public :: crack_damage, rate_factor, tensile_strength, widest_crack

    !> History: plastic strain, largest compression, eroded (0 or 1), damage of the cracks, damage
    !> of the rest, rate at which cracks open [1/s], volume that has grown over the unloaded one.
    integer, parameter, public :: h_plastic = 1, h_mu_max = 2, h_eroded = 3
    integer, parameter, public :: h_tension = 4, h_damage = 5, h_rate = 6, h_grown = 7
    integer, parameter, public :: by_malvar = 2 !! place of the word of `rate_tension`
    real(rk), parameter :: steepest = 0.55_rk !! least Gf/(l ft) over k0
    !> What is left of the stiffness of an open crack, and of its strength: small, and enough to
    !> find the uncracked stress again, which with s beside the crack errs by epsilon s/(faint ft)
    !> of itself. The first rules in real64; the second leaves faint (1 - log(faint)/2) of gf.
    real(rk), parameter :: least_left = 1e-6_rk
    real(rk), parameter, public :: faint = 4*sqrt(epsilon(1.0_rk))

contains

    !> Damage at an equivalent strain. A crack too wide for its energy opens at a lower strength.
    !@cuf attributes(host,device) &
    pure function crack_damage(par, crack, kappa, rate) result(damage)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: crack !! width of the smeared crack [m]
        real(rk), intent(in) :: kappa, rate !! equivalent strain; rate at which it cracked [1/s]
        real(rk) :: damage, ft, k0, ks, spent, least

        ft = tensile_strength(par, rate)
        spent = par(p_gf)/max(crack, tiny(crack)*1e10_rk)
        ft = min(ft, sqrt(par(p_young)*spent/steepest))
        k0 = ft/par(p_young)
        ks = spent/ft - k0/2
        damage = 0
        if (.not. kappa > k0) return
        least = max(least_left, faint*k0/(k0 - ks*log(faint)))
        damage = 1 - max(least, k0/kappa*exp(-(kappa - k0)/ks))
    end function crack_damage

    !> Strength of a bar at a rate [Pa].
    !@cuf attributes(host,device) &
    pure function tensile_strength(par, rate) result(ft)
        real(rk), intent(in) :: par(n_par), rate !! rate at which it cracks or cracked [1/s]
        real(rk) :: ft

        ft = par(p_ft)
        if (int(par(p_crack_rate)) == by_malvar) ft = ft*rate_factor(par(p_fc), rate)
    end function tensile_strength

    !> Strength at a rate over that at 1e-6 1/s, after Malvar and Ross.
    !@cuf attributes(host,device) &
    pure function rate_factor(fc, rate) result(factor)
        real(rk), intent(in) :: fc !! [Pa]
        real(rk), intent(in) :: rate !! [1/s]
        real(rk) :: factor, delta
        real(rk), parameter :: slow = 1e-6_rk, third = 1/3.0_rk

        factor = 1
        if (.not. rate > slow) return
        delta = 1/(1 + 8*fc/10e6_rk)
        if (rate <= 1) then
            factor = (rate/slow)**delta
        else
            factor = 10**(6*delta - 2)*(rate/slow)**third
        end if
    end function rate_factor

    !> Widest crack that can spend its energy without a fall of the strength [m].
    pure function widest_crack(par) result(width)
        real(rk), intent(in) :: par(n_par)
        real(rk) :: width

        width = par(p_young)*par(p_gf)/(steepest*par(p_ft)**2)
    end function widest_crack
end module brz_hjc_softening
