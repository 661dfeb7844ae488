! SPDX-License-Identifier: MIT
!> Cracks in concrete under tension: strength in a bar, fracture energy, cracks that close.
!>
!> Cracks add the strain D/((1 - D) E) sigma+ to that of uncracked concrete, with sigma+ the tensile
!> part of the stress by principal values. At constant D the stress has an energy (the compliance
!> of principal directions in tension is divided by 1 - D), so no cycle makes any, and a bar keeps
!> 1 - D of its modulus. D follows the largest kappa = sigma_1/((1 - D) E) so far (Rankine):
!>     1 - D = (k0/kappa) exp(-(kappa - k0)/ks),   k0 = ft/E,   ks = Gf/(l ft) - k0/2
!> which spends Gf over the width l of the smeared crack. Source: Bazant & Oh 1983 (crack band);
!> strength by rate after Malvar & Ross 1998. Point physics: compiled for the CPU and for the GPU.
module brz_hjc_cracks
    use brz_algebra, only: double_dot, to_matrix, to_voigt
    use brz_eigen, only: diagonalise
    use brz_hjc_pressure, only: p_crack_rate, p_density, p_fc, p_ft, p_gf, p_k_el, p_shear, &
                                p_young
    use brz_kinds, only: rk
    use brz_material, only: n_hist, n_par
    implicit none
    private
    public :: follow_rate, open_cracks, widest_crack

    !> History: damage of the cracks, damage of the rest, rate at which they open [1/s].
    integer, parameter, public :: h_tension = 4, h_damage = 5, h_rate = 6
    integer, parameter, public :: by_malvar = 2 !! place of the word of `rate_tension`
    real(rk), parameter :: thinnest = 1e-3_rk !! least density over that of the unloaded concrete
    real(rk), parameter :: steepest = 0.55_rk !! least Gf/(l ft) over k0
    !> What is left of the stiffness of an open crack, and of its strength: small, and enough to
    !> find the uncracked stress again, which with s beside the crack errs by epsilon s/(faint ft)
    !> of itself. The first rules in real64; the second leaves faint (1 - log(faint)/2) of gf.
    real(rk), parameter :: least_left = 1e-6_rk, faint = 4*sqrt(epsilon(1.0_rk))

contains

    !> The trial stress of a step with cracks, and what their growth lets go.
    !>
    !> The stress that uncracked concrete would have is found back from the one at the start, moves
    !> on with the strain, and gives the stress with cracks again. (No kappa is kept: D rises with
    !> it and never falls.) That of the cracks is large beside the stress when they are wide: it
    !> stands by itself, so that no difference of large numbers is taken.
    !@cuf attributes(host,device) &
    pure subroutine open_cracks(par, crack, s, p_old, trial, p, hist, released)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: crack !! width of the smeared crack [m]
        real(rk), intent(in) :: s(6) !! deviator at the start, in the axes of mid-step [Pa]
        real(rk), intent(in) :: p_old(2) !! pressure at the start with cracks, uncracked [Pa]
        real(rk), intent(inout) :: trial(6) !! deviator, elastic in, with cracks out [Pa]
        real(rk), intent(inout) :: p !! pressure at the end, uncracked in, with cracks out [Pa]
        real(rk), intent(inout) :: hist(n_hist)
        real(rk), intent(out) :: released !! [J/m3]
        real(rk) :: old(6), parted(6), start(6), rise(6), change(6), values(3, 3), axes(3, 3)
        real(rk) :: damage, before, kappa, volume, shift, total
        integer :: i

        released = 0
        before = hist(h_tension)
        do i = 1, 6
            old(i) = s(i)
            if (i <= 3) old(i) = s(i) - p_old(1)
            parted(i) = 0
        end do
        volume = 0
        if (before > 0) &
            call find_open(par, before, old, logarithmic(par, p_old(2)), parted, volume)
        do i = 1, 6
            start(i) = old(i) + parted(i)
            if (i <= 3) start(i) = start(i) + volume
        end do
        shift = mean_pressure(start) - logarithmic(par, p)
        do i = 1, 6
            rise(i) = trial(i) - s(i)
            if (i <= 3) rise(i) = rise(i) + shift
            change(i) = old(i) + rise(i)
            parted(i) = parted(i) + change(i)
        end do
        total = -3*mean_pressure(change)
        call principal(parted, values, axes)
        call carry(par, before, total, values)
        kappa = max(values(1, 1), values(2, 2), values(3, 3))/((1 - before)*par(p_young))
        damage = max(before, crack_damage(par, crack, kappa, hist(h_rate)))
        if (.not. damage > 0) return
        if (damage > before) then
            call principal(parted, values, axes)
            call carry(par, damage, total, values)
        end if
        call compose(values, axes, trial)
        if (damage > before) then
            do i = 1, 6
                change(i) = trial(i) - old(i)
            end do
            released = max(0.0_rk, elastic(par, old, rise) - elastic(par, change, start))
        end if
        hist(h_tension) = damage
        p = mean_pressure(trial)
        do i = 1, 3
            trial(i) = trial(i) + p
        end do
    end subroutine open_cracks

    !> Tension K mu as that of the logarithmic strain, to which the deviator belongs: the sides of a
    !> crack that opens wide are neither pressed nor pulled.
    !@cuf attributes(host,device) &
    pure function logarithmic(par, p) result(pressure)
        real(rk), intent(in) :: par(n_par), p !! [Pa]
        real(rk) :: pressure

        pressure = p
        if (p < 0) pressure = par(p_k_el)*log(max(1 + p/par(p_k_el), thinnest))
    end function logarithmic

    !> What the strain of open cracks adds to the stress that uncracked concrete would have.
    !>
    !> It errs by rounding, step after step. The volume does not: what of the difference can be
    !> rounding is the crack's, not a strain of the concrete beside it.
    !@cuf attributes(host,device) &
    pure subroutine find_open(par, damage, stress, pressure, parted, volume)
        real(rk), intent(in) :: par(n_par), damage
        real(rk), intent(in) :: stress(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(in) :: pressure !! of uncracked concrete of the same volume [Pa]
        real(rk), intent(out) :: parted(6) !! by shear stiffness, along the axes of the cracks [Pa]
        real(rk), intent(out) :: volume !! on every axis, for their trace [Pa]
        real(rk), parameter :: rounding = 4*epsilon(1.0_rk) !! of an opening in a step
        real(rk) :: values(3, 3), axes(3, 3), nu, total, rest
        integer :: i

        call to_matrix(stress, values)
        call diagonalise(values, axes)
        nu = par(p_young)/(2*par(p_shear)) - 1
        total = 0
        do i = 1, 3
            values(i, i) = damage/(1 - damage)/(1 + nu)*max(values(i, i), 0.0_rk)
            total = total + values(i, i)
        end do
        call compose(values, axes, parted)
        volume = nu/(1 - 2*nu)*total
        rest = 3*(mean_pressure(stress) - pressure)*(1 - 2*nu)/(1 + nu) - total
        rest = 1 + min(max(rest, -rounding*total), rounding*total)/max(total, tiny(1.0_rk))
        do i = 1, 6
            parted(i) = rest*parted(i)
        end do
        volume = rest*volume
    end subroutine find_open

    !> Principal stresses with cracks from those without, at the same strain.
    !>
    !> With S the sum of the stresses and w the uncracked ones, sigma_i (1/f_i + nu) = (1 + nu) w_i
    !> + nu (S - W): linear in S once it is known which f_i are 1 - D and which are 1. That depends
    !> on the sign of the left side; the line is that of a convex energy, so few passes find it.
    !> The part of the uncracked stress that is the same on every axis for the volume of the cracks
    !> may be left out of w: W is then the sum less that of the part left out.
    !@cuf attributes(host,device) &
    pure subroutine carry(par, damage, trace, values)
        real(rk), intent(in) :: par(n_par), damage
        real(rk), intent(in) :: trace !! W [Pa]
        real(rk), intent(inout) :: values(3, 3) !! principal stresses on the diagonal [Pa]
        real(rk) :: nu, open, total, rest, slope, share
        integer :: i, pass
        integer, parameter :: passes = 4

        if (.not. damage > 0) return
        nu = par(p_young)/(2*par(p_shear)) - 1
        open = (1 - damage)/(1 + nu*(1 - damage))
        total = 0 ! S - W
        do pass = 1, passes
            rest = -trace
            slope = 1
            do i = 1, 3
                share = merge(open, 1/(1 + nu), (1 + nu)*values(i, i) + nu*total > 0)
                rest = rest + share*(1 + nu)*values(i, i)
                slope = slope - share*nu
            end do
            total = rest/slope
        end do
        do i = 1, 3
            share = merge(open, 1/(1 + nu), (1 + nu)*values(i, i) + nu*total > 0)
            values(i, i) = share*((1 + nu)*values(i, i) + nu*total)
        end do
    end subroutine carry

    !> Half of a stress times the elastic strain of another [J/m3].
    !@cuf attributes(host,device) &
    pure function elastic(par, a, b) result(energy)
        real(rk), intent(in) :: par(n_par), a(6), b(6)
        real(rk) :: energy, pa, pb

        pa = mean_pressure(a)
        pb = mean_pressure(b)
        energy = (double_dot(a, b) - 3*pa*pb)/(4*par(p_shear)) + pa*pb/(2*par(p_k_el))
    end function elastic

    !@cuf attributes(host,device) &
    pure function mean_pressure(stress) result(p)
        real(rk), intent(in) :: stress(6)
        real(rk) :: p

        p = -(stress(1) + stress(2) + stress(3))/3
    end function mean_pressure

    !> Principal values, on the diagonal, and their axes, column by column.
    !@cuf attributes(host,device) &
    pure subroutine principal(tensor, values, axes)
        real(rk), intent(in) :: tensor(6) !! xx, yy, zz, xy, yz, xz
        real(rk), intent(out) :: values(3, 3), axes(3, 3)

        call to_matrix(tensor, values)
        call diagonalise(values, axes)
    end subroutine principal

    !> The tensor of principal values and axes.
    !@cuf attributes(host,device) &
    pure subroutine compose(values, axes, tensor)
        real(rk), intent(in) :: values(3, 3), axes(3, 3) !! see `principal`
        real(rk), intent(out) :: tensor(6) !! xx, yy, zz, xy, yz, xz
        integer :: k

        do k = 1, 6
            tensor(k) = 0
        end do
        do k = 1, 3
            tensor(1) = tensor(1) + values(k, k)*axes(1, k)*axes(1, k)
            tensor(2) = tensor(2) + values(k, k)*axes(2, k)*axes(2, k)
            tensor(3) = tensor(3) + values(k, k)*axes(3, k)*axes(3, k)
            tensor(4) = tensor(4) + values(k, k)*axes(1, k)*axes(2, k)
            tensor(5) = tensor(5) + values(k, k)*axes(2, k)*axes(3, k)
            tensor(6) = tensor(6) + values(k, k)*axes(1, k)*axes(3, k)
        end do
    end subroutine compose

    !> Damage at an equivalent strain. A crack too wide for its energy opens at a lower strength.
    !@cuf attributes(host,device) &
    pure function crack_damage(par, crack, kappa, rate) result(damage)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: crack !! width of the smeared crack [m]
        real(rk), intent(in) :: kappa, rate !! equivalent strain; rate at which it cracked [1/s]
        real(rk) :: damage, ft, k0, ks, spent, least

        ft = par(p_ft)
        if (int(par(p_crack_rate)) == by_malvar) ft = ft*rate_factor(par(p_fc), rate)
        spent = par(p_gf)/max(crack, tiny(crack)*1e10_rk)
        ft = min(ft, sqrt(par(p_young)*spent/steepest))
        k0 = ft/par(p_young)
        ks = spent/ft - k0/2
        damage = 0
        if (.not. kappa > k0) return
        least = max(least_left, faint*k0/(k0 - ks*log(faint)))
        damage = 1 - max(least, k0/kappa*exp(-(kappa - k0)/ks))
    end function crack_damage

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

    !> Rate of the largest principal strain, filtered over the time of a wave across the crack; it
    !> rests once a crack has opened.
    !@cuf attributes(host,device) &
    pure subroutine follow_rate(par, crack, dt, l, hist)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: crack, dt !! width of the crack [m], time step [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j [1/s]
        real(rk), intent(inout) :: hist(n_hist)
        real(rk) :: share, d(6), values(3, 3), axes(3, 3)

        if (int(par(p_crack_rate)) /= by_malvar .or. hist(h_tension) > 0) return
        call to_voigt(l, d)
        call principal(d, values, axes)
        share = dt*sqrt(par(p_young)/par(p_density))
        share = share/(share + crack)
        hist(h_rate) = hist(h_rate) + share*( &
            max(values(1, 1), values(2, 2), values(3, 3), 0.0_rk) - hist(h_rate))
    end subroutine follow_rate

    !> Widest crack that can spend its energy without a fall of the strength [m].
    pure function widest_crack(par) result(width)
        real(rk), intent(in) :: par(n_par)
        real(rk) :: width

        width = par(p_young)*par(p_gf)/(steepest*par(p_ft)**2)
    end function widest_crack
end module brz_hjc_cracks
