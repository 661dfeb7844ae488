! SPDX-License-Identifier: MIT
!> Concrete that grows as it is sheared: a share of the volume that associated flow would make.
!>
!> What has grown is a volume of its own, as open as pores: per mass V = V_c + V_g with V_c that of
!> the concrete, which has the pressure of its compression. A plastic strain e makes the volume
!>     dV_g = V omega (1 - D) dY/dp de,   0 <= omega <= 1
!> which is the flow that belongs to the yield stress Y(p) where omega = 1, fades as the concrete
!> turns to rubble, and never makes energy: p dY/dp <= Y. Source: Malvar et al. 1997 (omega, its
!> fractional dilatancy). Point physics: compiled for the CPU and for the GPU.
module brz_hjc_growth
    use brz_deviator, only: mises_stress, third_invariant
    use brz_hjc_pressure, only: hjc_pressure, p_dilatancy, p_fc, p_shear
    use brz_hjc_softening, only: h_eroded, h_grown, h_mu_max, h_rate
    use brz_hjc_strength, only: strength
    use brz_kinds, only: rk
    use brz_material, only: n_hist, n_par
    implicit none
    private
    public :: concrete_alone, flow_t, grow

    real(rk), parameter :: least = 0.1_rk !! of the volume is concrete
    real(rk), parameter :: apart = 0.02_rk !! pressures of a slope, over fc

    !> The flow of a step.
    type :: flow_t
        real(rk) :: keep !! what stays of the deviator of the trial
        real(rk) :: strain !! equivalent, plastic
        real(rk) :: lost !! energy that flow beside cracks takes, less what makes pressure [J/m3]
        real(rk) :: more !! volume that grows, over that of the unloaded concrete
        real(rk) :: p, stiffest !! pressure, and of `hjc_pressure`, at the end [Pa]
    end type flow_t

contains

    !> Compression of the concrete from that of a point that has grown.
    !@cuf attributes(host,device) &
    pure function concrete_alone(mu, grown) result(alone)
        real(rk), intent(in) :: mu !! rho/rho0 - 1 of the point
        real(rk), intent(in) :: grown !! volume that has grown, over that of the unloaded concrete
        real(rk) :: alone, open

        open = grown*(1 + mu)
        alone = (mu + open)/max(1 - open, least)
    end function concrete_alone

    !> What grows in a step by a flow under pressure: the pressure rises with it.
    !>
    !> The return is that of a surface as straight as at the trial: 3 G e + (dY/dp) dp = q - Y, with
    !> dp from the curve of the pressure between both ends (two passes), and then to the surface at
    !> the pressure of the end. Concrete that has cracked is not for this: its cracks take it.
    !@cuf attributes(host,device) &
    pure subroutine grow(par, mu, damage, rate, trial, hist, flow)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: mu !! rho/rho0 - 1 of the point at the end of the step
        real(rk), intent(in) :: damage, rate !! for `strength`
        real(rk), intent(in) :: trial(6) !! deviator [Pa]
        real(rk), intent(inout) :: hist(n_hist) !! its `h_grown` rises
        type(flow_t), intent(inout) :: flow !! at one volume in, with what has grown out
        real(rk) :: share, mises, third, slope, beyond, harder, before
        integer :: pass

        flow%more = 0
        share = par(p_dilatancy)*(1 - damage)/(1 + mu)
        if (.not. (share > 0 .and. flow%p > 0) .or. hist(h_eroded) > 0) return
        mises = mises_stress(trial)
        third = third_invariant(trial)
        before = flow%p
        slope = strength(par, before + apart*par(p_fc), damage, rate, hist(h_rate), mises, third)
        slope = (slope - flow%keep*mises)/(apart*par(p_fc))
        if (.not. slope > 0) return
        share = share*slope
        beyond = 3*par(p_shear)*flow%strain
        harder = slope*share*flow%stiffest
        do pass = 1, 2
            flow%strain = beyond/(3*par(p_shear) + harder)
            flow%more = share*flow%strain
            call hjc_pressure(par, concrete_alone(mu, hist(h_grown) + flow%more), &
                              max(hist(h_mu_max), 0.0_rk), flow%p, flow%stiffest)
            harder = slope*(flow%p - before)/flow%strain
        end do
        hist(h_grown) = hist(h_grown) + flow%more
        flow%keep = strength(par, flow%p, damage, rate, hist(h_rate), mises, third)/mises
        flow%keep = min(flow%keep, 1.0_rk)
        flow%strain = (1 - flow%keep)*mises/(3*par(p_shear))
    end subroutine grow
end module brz_hjc_growth
