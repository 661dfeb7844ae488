! SPDX-License-Identifier: MIT
!> Strength of the Holmquist-Johnson-Cook concrete, and the damage that its flow does.
!>
!> Source: Holmquist, Johnson & Cook 1993; surface='malvar' that of malvar_surface.f90, from which
!> damage takes what lies above rubble; tension as in docs/theory/concrete.md.
!> Point physics: compiled for the CPU and for the GPU.
module brz_hjc_strength
    use brz_hjc_pressure, only: p_a, p_b, p_c, p_d1, p_d2, p_efmin, p_fc, p_floor, p_n, &
                                p_rate, p_rate_law, p_smax, p_surface, p_t
    use brz_hjc_softening, only: tensile_strength
    use brz_kinds, only: rk
    use brz_malvar_surface, only: malvar_strength, meridian_share, tensile_share
    use brz_material, only: n_par
    implicit none
    private
    public :: add_damage, rate_effect, strength

    integer, parameter, public :: by_malvar_surface = 2 !! place of the word of `surface`
    integer, parameter :: by_fib = 2 !! of `rate_law`
    real(rk), parameter :: slow = 30e-6_rk, steep = 0.014_rk !! [1/s], -: fib Model Code 2010
    real(rk), parameter, public :: most = 0.25_rk !! largest ft/fc of the surface of Malvar et al.

contains

    !> Yield stress: by pressure, damage and rate, at most SMAX; to zero at the cut-off in tension.
    !@cuf attributes(host,device) &
    pure function strength(par, p, damage, rate, opened, mises, product) result(yield)
        real(rk), intent(in) :: par(n_par), p, damage
        real(rk), intent(in) :: rate !! of `rate_effect`
        real(rk), intent(in) :: opened !! rate at which it cracks or cracked [1/s]
        real(rk), intent(in) :: mises !! of the stress that is judged [Pa]
        real(rk), intent(in) :: product !! of its principal deviators [Pa3]
        real(rk) :: yield, x, tip, share

        if (int(par(p_surface)) == by_malvar_surface) then
            x = p/(par(p_fc)*rate) ! strength rises along the way of the stress, friction does not
            tip = min(tensile_strength(par, opened)/par(p_fc), most)
            yield = malvar_strength(x, tip, 1 - damage)
            share = tensile_share(x, tip)
            if (mises > 0) yield = yield*meridian_share(share, 13.5_rk*product/mises**3)
        else if (p > 0) then
            yield = par(p_a)*(1 - damage) + par(p_b)*exp(par(p_n)*log(p/par(p_fc)))
        else
            yield = par(p_a)*max(0.0_rk, 1 - damage + p/par(p_t))
        end if
        yield = par(p_fc)*min(yield*rate, par(p_smax))
    end function strength

    !> Factor of the strength by the rate of strain.
    !@cuf attributes(host,device) &
    pure function rate_effect(par, strain, dt) result(rate)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: strain, dt !! equivalent strain of the step, its time [s]
        real(rk) :: rate, least, factor

        if (int(par(p_rate_law)) == by_fib) then
            rate = 1
            if (strain > slow*dt) rate = exp(steep*log(strain/(slow*dt)))
            return
        end if
        least = par(p_floor)*par(p_rate)*dt
        factor = par(p_floor)
        if (strain > least) factor = strain/(par(p_rate)*dt)
        rate = max(0.0_rk, 1 + par(p_c)*log(factor))
    end function rate_effect

    !> Damage by plastic and crushing strain, over the strain to fracture at the mean pressure.
    !@cuf attributes(host,device) &
    pure subroutine add_damage(par, p, strain, damage)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: p !! mean of the step [Pa]
        real(rk), intent(in) :: strain
        real(rk), intent(inout) :: damage
        real(rk) :: reach

        if (.not. strain > 0) return
        reach = max(p + par(p_t), 0.0_rk)/par(p_fc)
        if (par(p_d2) < 1 .or. par(p_d2) > 1) reach = reach**par(p_d2)
        damage = min(1.0_rk, damage + strain/max(par(p_efmin), par(p_d1)*reach))
    end subroutine add_damage
end module brz_hjc_strength
