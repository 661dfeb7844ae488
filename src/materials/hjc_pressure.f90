! SPDX-License-Identifier: MIT
!> Pressure of the Holmquist-Johnson-Cook concrete: elastic, crushing, dense; loading and back.
!>
!> The pressure is a total function of the compression mu and of its largest value so far. Source:
!> Holmquist, Johnson & Cook 1993, with mu_lock as the compression of the fully crushed material
!> at zero pressure, as that report has it.
!> Point physics: compiled for the CPU and for the GPU.
module brz_hjc_pressure
    use brz_kinds, only: rk
    use brz_material, only: n_par
    implicit none
    private
    public :: hjc_pressure, loading_curve, dense_curve, unloading_modulus, crushing_strain, &
              full_modulus, crushing_work, opening

    ! Slots of `material%par`. First the keys of the deck ...
    integer, parameter, public :: p_density = 1, p_shear = 2, p_a = 3, p_b = 4, p_n = 5, p_c = 6, &
                                  p_fc = 7, p_t = 8, p_rate = 9, p_efmin = 10, p_smax = 11, &
                                  p_p_crush = 12, p_mu_crush = 13, p_p_lock = 14, p_mu_lock = 15, &
                                  p_d1 = 16, p_d2 = 17, p_k1 = 18, p_k2 = 19, p_k3 = 20, &
                                  p_floor = 21, p_unload = 22, p_erosion = 23, p_limit = 24, &
                                  p_ft = 25, p_gf = 26, p_crack_rate = 27, p_surface = 28, &
                                  p_rate_law = 29, p_dilatancy = 30
    integer, parameter, public :: n_keys = 30
    ! ... then what is derived from them.
    integer, parameter, public :: p_k_el = 31, p_k_tran = 32 !! slopes of the loading curve [Pa]
    integer, parameter, public :: p_mu_plock = 33 !! compression at p_lock on the loading curve
    integer, parameter, public :: p_full = 34 !! unloading slope where crushing is complete [Pa]

    integer, parameter, public :: p_young = 35 !! Young's modulus [Pa]

    ! Values of the option `unload`, the places of its words in the deck.
    integer, parameter, public :: unload_paper = 1, unload_reversible = 2

    real(rk), parameter, public :: densest = 1 !! x up to which the cubic holds; straight beyond

contains

    !> Pressure at a compression, given the largest one so far.
    !@cuf attributes(host,device) &
    pure subroutine hjc_pressure(par, mu, mu_max, p, stiffest)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: mu !! rho/rho0 - 1
        real(rk), intent(in) :: mu_max !! before this step, >= 0
        real(rk), intent(out) :: p !! without the cut-off in tension [Pa]
        real(rk), intent(out) :: stiffest !! slope dp/dmu of the stiffest branch near by [Pa]
        real(rk) :: slope, p_max

        if (mu >= mu_max) then
            call loading_curve(par, mu, p, slope)
            stiffest = max(slope, unloading_modulus(par, mu))
            return
        end if
        stiffest = unloading_modulus(par, mu_max)
        if (mu_max <= par(p_mu_crush)) then
            p = par(p_k_el)*mu
        else if (mu_max >= par(p_mu_plock) .and. int(par(p_unload)) == unload_reversible) then
            if (mu > par(p_mu_lock)) then
                call dense_curve(par, mu, p, slope)
                stiffest = max(slope, stiffest)
            else
                p = par(p_k1)*(mu - par(p_mu_lock))/(1 + par(p_mu_lock))
            end if
        else
            call loading_curve(par, mu_max, p_max, slope)
            p = p_max + stiffest*(mu - mu_max)
        end if
    end subroutine hjc_pressure

    !> The curve of first loading and its slope.
    !@cuf attributes(host,device) &
    pure subroutine loading_curve(par, mu, p, slope)
        real(rk), intent(in) :: par(n_par), mu
        real(rk), intent(out) :: p, slope !! [Pa]

        if (mu <= par(p_mu_crush)) then
            slope = par(p_k_el)
            p = slope*mu
        else if (mu <= par(p_mu_plock)) then
            slope = par(p_k_tran)
            p = par(p_p_crush) + slope*(mu - par(p_mu_crush))
        else
            call dense_curve(par, mu, p, slope)
        end if
    end subroutine loading_curve

    !> K1 x + K2 x^2 + K3 x^3 of the fully crushed material, x = (mu - mu_lock)/(1 + mu_lock).
    !@cuf attributes(host,device) &
    pure subroutine dense_curve(par, mu, p, slope)
        real(rk), intent(in) :: par(n_par), mu
        real(rk), intent(out) :: p, slope !! [Pa]
        real(rk) :: x, y

        x = (mu - par(p_mu_lock))/(1 + par(p_mu_lock))
        y = min(x, densest)
        slope = par(p_k1) + y*(2*par(p_k2) + 3*y*par(p_k3))
        p = y*(par(p_k1) + y*(par(p_k2) + y*par(p_k3))) + slope*(x - y)
        slope = slope/(1 + par(p_mu_lock))
    end subroutine dense_curve

    !> Slope of the way back from the largest compression.
    !>
    !> 'paper': from K_el to K1 with the crushed part F, and never softer than the loading curve.
    !> 'reversible': straight to the compression F mu_lock that stays, then the dense curve.
    !@cuf attributes(host,device) &
    pure function unloading_modulus(par, mu_max) result(k)
        real(rk), intent(in) :: par(n_par), mu_max
        real(rk) :: k, f, p, slope

        k = par(p_k_el)
        if (mu_max <= par(p_mu_crush)) return
        if (mu_max >= par(p_mu_plock)) then
            call dense_curve(par, mu_max, p, slope)
            k = max(par(p_full), slope)
            return
        end if
        f = (mu_max - par(p_mu_crush))/(par(p_mu_plock) - par(p_mu_crush))
        if (int(par(p_unload)) == unload_reversible) then
            call loading_curve(par, mu_max, p, slope)
            k = p/(mu_max - f*par(p_mu_lock))
        else
            k = (1 - f)*par(p_k_el) + f*par(p_full)
        end if
    end function unloading_modulus

    !> Compression that stays behind by crushing; it counts as damage.
    !@cuf attributes(host,device) &
    pure function crushing_strain(par, mu_max) result(mu_p)
        real(rk), intent(in) :: par(n_par), mu_max
        real(rk) :: mu_p, m, p, slope

        mu_p = 0
        if (mu_max <= par(p_mu_crush)) return
        if (mu_max >= par(p_mu_plock)) then
            m = par(p_mu_plock)
            mu_p = m - par(p_p_lock)/par(p_full)
            if (int(par(p_unload)) == unload_reversible) mu_p = par(p_mu_lock)
        else
            call loading_curve(par, mu_max, p, slope)
            mu_p = mu_max - p/unloading_modulus(par, mu_max)
        end if
    end function crushing_strain

    !> Work that crushing from one largest compression to another takes and does not give back.
    !>
    !> On the way there p d(mu) goes into the elastic energy p^2/(2 K_u) of the way back, and the
    !> rest is lost: the mean of p times the change of what stays behind, and p^2/2 times that of
    !> 1/K_u. Along straight lines this is exact for steps of any size.
    !@cuf attributes(host,device) &
    pure function crushing_work(par, mu_old, mu_new) result(work)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: mu_old, mu_new !! largest compression at the start, at the end
        real(rk) :: work !! [J/m3], over (1 + mu) at both ends of the step
        real(rk) :: m, p0, p1, c0, c1, rest0, rest1

        work = 0
        if (.not. mu_new > max(mu_old, par(p_mu_crush))) return
        call way_back(par, max(mu_old, par(p_mu_crush)), p0, c0, rest0)
        m = mu_new
        if (int(par(p_unload)) == unload_reversible) m = min(m, par(p_mu_plock))
        call way_back(par, m, p1, c1, rest1)
        work = max(0.0_rk, (p0 + p1)/2*(rest1 - rest0) + p0*p1/2*(c1 - c0))
    end function crushing_work

    !> The line on which a point unloads: pressure and compliance at its top, and where it ends.
    !@cuf attributes(host,device) &
    pure subroutine way_back(par, mu_max, p, compliance, rest)
        real(rk), intent(in) :: par(n_par), mu_max
        real(rk), intent(out) :: p, compliance !! [Pa], [1/Pa]
        real(rk), intent(out) :: rest !! compression that stays
        real(rk) :: slope, m

        m = mu_max
        if (int(par(p_unload)) == unload_reversible .and. m >= par(p_mu_plock)) then
            p = par(p_p_lock)
            rest = par(p_mu_lock)
            compliance = (par(p_mu_plock) - rest)/p
            return
        end if
        call loading_curve(par, m, p, slope)
        compliance = 1/unloading_modulus(par, m)
        rest = m - p*compliance
    end subroutine way_back

    !> Volume per mass by which a point is open beyond its elastic expansion in tension [m3/kg].
    !@cuf attributes(host,device) &
    pure function opening(par, mu, mu_max, p_eos, p) result(volume)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: mu, mu_max
        real(rk), intent(in) :: p_eos, p !! pressure of the curve, and as it is cut off [Pa]
        real(rk) :: volume, excess

        volume = 0
        if (.not. p > p_eos) return
        excess = unloading_modulus(par, mu_max)
        if (int(par(p_unload)) == unload_reversible .and. mu_max >= par(p_mu_plock)) &
            excess = par(p_k1)/(1 + par(p_mu_lock))
        excess = (p - p_eos)/excess
        volume = excess/(par(p_density)*(1 + mu)*(1 + mu + excess))
    end function opening

    !> K1, or the slope of the dense curve at p_lock where that is steeper.
    pure function full_modulus(par) result(k)
        real(rk), intent(in) :: par(n_par)
        real(rk) :: k, p

        call dense_curve(par, par(p_mu_plock), p, k)
        k = max(par(p_k1), k)
    end function full_modulus
end module brz_hjc_pressure
