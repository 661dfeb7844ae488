! SPDX-License-Identifier: MIT
!> Mie-Grueneisen equation of state on a shock Hugoniot us = c0 + s1 up + ...
!>
!> p = A(mu) + B(mu) E with E = rho0 e, energy per INITIAL volume:
!>     B = gamma0 + a mu
!>     A = rho0 c0^2 mu (1 + (1 - gamma0/2) mu - a/2 mu^2)/(1 - (s1 - 1 + s2 x + s3 x^2) mu)^2
!> with x = mu/(1 + mu), and A = rho0 c0^2 mu in tension. The Hugoniot state (rho, e = up^2/2)
!> gives us = c0 + s1 up exactly. Point physics: compiled for the CPU and for the GPU.
module brz_mie_gruneisen
    use brz_kinds, only: rk
    implicit none
    private
    public :: mie_gruneisen, hugoniot_excess, warming_range, pressure_step, hugoniot_limit
    public :: n_eos, eos_density, eos_c0, eos_s1, eos_s2, eos_s3, eos_gamma, eos_a, eos_mu_max

    ! Slots of the block of parameters that this equation of state reads.
    integer, parameter :: eos_density = 1 !! rho0 [kg/m3]
    integer, parameter :: eos_c0 = 2 !! [m/s]
    integer, parameter :: eos_s1 = 3, eos_s2 = 4, eos_s3 = 5
    integer, parameter :: eos_gamma = 6, eos_a = 7 !! Grueneisen's gamma0, and its first correction
    integer, parameter :: eos_mu_max = 8 !! end of the range: A goes on straight beyond
    integer, parameter :: n_eos = 8

contains

    !> The terms A and B, and the slope dA/dmu. Beyond its range A follows its tangent, or is held
    !> where that would fall: the pressure of heated material rises on.
    !@cuf attributes(host,device) &
    pure subroutine mie_gruneisen(eos, mu, a, b, slope, clamped)
        real(rk), intent(in) :: eos(n_eos) !! slots above
        real(rk), intent(in) :: mu !! rho/rho0 - 1
        real(rk), intent(out) :: a !! cold and reference part of the pressure [Pa]
        real(rk), intent(out) :: b !! factor of rho0 e [-]
        real(rk), intent(out) :: slope !! dA/dmu [Pa]
        logical, intent(out) :: clamped !! mu beyond eos_mu_max
        real(rk) :: k, m, x, num, den, d_num, d_den

        k = eos(eos_density)*eos(eos_c0)**2
        clamped = mu > eos(eos_mu_max)
        b = eos(eos_gamma) + eos(eos_a)*mu
        a = k*mu
        slope = k
        if (mu > 0) then
            m = min(mu, eos(eos_mu_max))
            x = m/(1 + m)
            num = 1 + m*(1 - eos(eos_gamma)/2 - eos(eos_a)/2*m)
            d_num = 1 - eos(eos_gamma)/2 - eos(eos_a)*m
            den = 1 - m*(eos(eos_s1) - 1 + x*(eos(eos_s2) + x*eos(eos_s3)))
            d_den = -(eos(eos_s1) - 1 + x*(eos(eos_s2) + x*eos(eos_s3))) &
                    - m*(eos(eos_s2) + 2*x*eos(eos_s3))/(1 + m)**2
            a = k*m*num/den**2
            slope = k*(num + m*d_num - 2*m*num*d_den/den)/den**2
            if (clamped) then
                slope = max(slope, 0.0_rk)
                a = a + slope*(mu - m)
            end if
        end if
    end subroutine mie_gruneisen

    !> Excess a + b rho0 e of the shock pressure over a linear law in the volume strain.
    !>
    !> The linear law is rho0 c0^2 ln(1 + mu). The excess acts in compression only; heat counts
    !> from a compression of `warm` on, and less below, so that nothing jumps at mu = 0.
    !@cuf attributes(host,device) &
    pure subroutine hugoniot_excess(eos, mu, warm, a, b, slope, b_slope, clamped)
        real(rk), intent(in) :: eos(n_eos) !! slots above
        real(rk), intent(in) :: mu
        real(rk), intent(in) :: warm !! see warming_range
        real(rk), intent(out) :: a, b !! [Pa], [-]
        real(rk), intent(out) :: slope, b_slope !! da/dmu [Pa], db/dmu [-]
        logical, intent(out) :: clamped
        real(rk) :: bulk

        a = 0
        b = 0
        slope = 0
        b_slope = 0
        clamped = .false.
        if (.not. mu > 0) return
        bulk = eos(eos_density)*eos(eos_c0)**2
        call mie_gruneisen(eos, mu, a, b, slope, clamped)
        a = a - bulk*log(1 + mu)
        b_slope = eos(eos_a)
        if (mu < warm) then
            b_slope = (b + mu*b_slope)/warm
            b = b*mu/warm
        end if
        slope = slope - bulk/(1 + mu)
    end subroutine hugoniot_excess

    !> Compression from which heat counts fully: 1 %, and more in hot material, so that the pressure
    !> of its heat rises no faster than the material is stiff. A state on the Hugoniot lies above
    !> it as long as its pressure is below 2 stiff/gamma.
    !@cuf attributes(host,device) &
    pure real(rk) function warming_range(eos, heat, stiff) result(warm)
        real(rk), intent(in) :: eos(n_eos) !! slots above
        real(rk), intent(in) :: heat !! rho0 e [Pa]
        real(rk), intent(in) :: stiff !! unloaded, along the stiffest axis [Pa]

        warm = max(0.01_rk, eos(eos_gamma)*heat/stiff)
    end function warming_range

    !> Pressure and energy at the end of a step, implicit and in closed form.
    !>
    !> Solves e = e_star - dv/2 (p_old + p) together with p = max(a + b_rho e, least).
    !@cuf attributes(host,device) &
    pure subroutine pressure_step(a, b_rho, least, dv, p_old, energy, p, ok)
        real(rk), intent(in) :: a, b_rho !! A [Pa] and B rho0 [kg/m3]
        real(rk), intent(in) :: least !! the pressure never falls below this [Pa]
        real(rk), intent(in) :: dv !! change of specific volume in the step [m3/kg]
        real(rk), intent(in) :: p_old !! [Pa]
        real(rk), intent(inout) :: energy !! after all other work in, final out [J/kg]
        real(rk), intent(out) :: p !! [Pa]
        logical, intent(out) :: ok !! false: the expansion is too large for one step; nothing done
        real(rk) :: denominator

        denominator = 1 + b_rho*dv/2
        ok = denominator > 0.1_rk
        p = p_old
        if (.not. ok) return
        p = max((a + b_rho*(energy - dv/2*p_old))/denominator, least)
        energy = energy - dv/2*(p_old + p)
    end subroutine pressure_step

    !> Compression up to which the pressure rises along the isentrope of the unloaded material.
    !>
    !> A falls from some compression on, since gamma does not follow mu/(1 + mu) there, and no heat
    !> of the isentrope outweighs it further on. At most 95 % of the first pole of A, or 10.
    pure function hugoniot_limit(eos) result(mu)
        real(rk), intent(in) :: eos(n_eos) !! slots above; eos_mu_max is not read
        real(rk) :: mu, m, a, b, slope, energy, p, p_old, wide(n_eos)
        integer :: i
        logical :: clamped, ok
        real(rk), parameter :: most = 10
        integer, parameter :: steps = 10000

        wide = eos
        wide(eos_mu_max) = 2*most
        energy = 0
        p = 0
        mu = 0
        do i = 1, steps
            m = most*real(i, rk)/steps
            if (m >= 0.95_rk*first_pole(eos)) return
            call mie_gruneisen(wide, m, a, b, slope, clamped)
            p_old = p
            call pressure_step(a, b*eos(eos_density), -huge(p), &
                               (mu - m)/(eos(eos_density)*(1 + m)*(1 + mu)), p_old, energy, p, ok)
            if (.not. slope + eos(eos_a)*eos(eos_density)*energy + b*p/(1 + m)**2 > 0) return
            mu = m
        end do
    end function hugoniot_limit

    !> First compression at which A is infinite, or more than anything.
    pure function first_pole(eos) result(mu)
        real(rk), intent(in) :: eos(n_eos)
        real(rk) :: mu, x
        integer :: i
        integer, parameter :: steps = 2000

        do i = 1, steps
            mu = 11*real(i, rk)/steps
            x = mu/(1 + mu)
            if (1 - mu*(eos(eos_s1) - 1 + x*(eos(eos_s2) + x*eos(eos_s3))) <= 0) return
        end do
        mu = huge(mu)
    end function first_pole
end module brz_mie_gruneisen
