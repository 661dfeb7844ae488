! SPDX-License-Identifier: MIT
!> Flux vector splitting after Steger and Warming: F = F+ + F-, by the sign of u, u + c, u - c.
!>
!> Source: Steger & Warming 1981, written so that a gas at rest gives mass and energy fluxes that
!> cancel exactly and a momentum flux of exactly p. Point physics.
module brz_steger_warming
    use brz_kinds, only: rk
    implicit none
    private
    public :: split_flux

contains

    !> Flux of one state in direction 1, split into what moves up and what moves down.
    !>
    !> A negative pressure counts as zero. Slot 2 holds the normal component of vectors. The
    !> clamped velocity s = min(max(u, -c), c) stands for half the difference of the acoustic
    !> eigenvalues: (l2 - l3)+/- = c +/- s.
    !@cuf attributes(host,device) &
    pure subroutine split_flux(gamma, q, plus, minus)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: q(5) !! conserved variables, density positive
        real(rk), intent(out) :: plus(5) !! flux carried by positive eigenvalues
        real(rk), intent(out) :: minus(5) !! flux carried by negative eigenvalues
        real(rk) :: volume, u, t1, t2, kinetic, half_p, c, a, k, up, down, heat

        volume = 1/q(1)
        u = q(2)*volume
        t1 = q(3)*volume
        t2 = q(4)*volume
        kinetic = 0.5_rk*(u*q(2) + t1*q(3) + t2*q(4))
        half_p = 0.5_rk*max((gamma - 1)*(q(5) - kinetic), 0.0_rk)
        kinetic = kinetic*volume
        c = sqrt((2*gamma)*half_p*volume)
        a = q(1)*(0.5_rk/gamma)
        k = a*c*max(-c, min(u, c))
        heat = half_p*(1/(gamma - 1))

        up = max(u + c, 0.0_rk) + max(u - c, 0.0_rk)
        plus(1) = a*((2*(gamma - 1))*max(u, 0.0_rk) + up)
        plus(2) = u*plus(1) + (half_p + k)
        plus(3) = t1*plus(1)
        plus(4) = t2*plus(1)
        plus(5) = kinetic*plus(1) + u*(half_p + k) + heat*up

        down = min(u + c, 0.0_rk) + min(u - c, 0.0_rk)
        minus(1) = a*((2*(gamma - 1))*min(u, 0.0_rk) + down)
        minus(2) = u*minus(1) + (half_p - k)
        minus(3) = t1*minus(1)
        minus(4) = t2*minus(1)
        minus(5) = kinetic*minus(1) + u*(half_p - k) + heat*down
    end subroutine split_flux
end module brz_steger_warming
