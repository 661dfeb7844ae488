! SPDX-License-Identifier: MIT
!> Strength of the Holmquist-Johnson-Cook concrete, and the damage that its flow does.
!>
!> Source: Holmquist, Johnson & Cook 1993; tension as in docs/materials.md.
!> Point physics: compiled for the CPU and for the GPU.
module brz_hjc_strength
    use brz_hjc_pressure, only: p_a, p_b, p_c, p_d1, p_d2, p_efmin, p_fc, p_floor, p_n, p_rate, &
                                p_smax, p_t
    use brz_kinds, only: rk
    use brz_material, only: n_par
    implicit none
    private
    public :: add_damage, rate_effect, strength

contains

    !> Yield stress: by pressure, damage and rate, at most SMAX; to zero at the cut-off in tension.
    !@cuf attributes(host,device) &
    pure function strength(par, p, damage, rate) result(yield)
        real(rk), intent(in) :: par(n_par), p, damage
        real(rk), intent(in) :: rate !! of `rate_effect`
        real(rk) :: yield

        if (p > 0) then
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
