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
    use brz_hjc_pressure, only: p_crack_rate, p_density, p_k_el, p_shear, p_young
    use brz_hjc_softening, only: by_malvar, crack_damage, h_rate, h_tension
    use brz_kinds, only: rk
    use brz_material, only: n_hist, n_par
    implicit none
    private
    public :: carry, compose, cracks_t, follow_rate, open_cracks

    real(rk), parameter :: thinnest = 1e-3_rk !! least density over that of the unloaded concrete

    !> What the flow of a cracked point is found from.
    type :: cracks_t
        real(rk) :: axes(3, 3) !! principal axes, column by column
        real(rk) :: uncracked(3) !! stress of uncracked concrete along them, w of `carry` [Pa]
        real(rk) :: trace !! W of `carry` [Pa]
        real(rk) :: old(3) !! stress at the start of the step along them [Pa]
        real(rk) :: damage !! of the cracks; 0: there are none, and nothing else is set
        real(rk) :: rate !! at which it cracked [1/s]
        real(rk) :: released !! energy that their growth lets go [J/m3]
        real(rk) :: beyond !! volume beyond that of the stress there: the mean tension was cut [Pa]
    end type cracks_t

contains

    !> The trial stress of a step with cracks, and what their growth lets go.
    !>
    !> The stress that uncracked concrete would have is found back from the one at the start, moves
    !> on with the strain, and gives the stress with cracks again. (No kappa is kept: D rises with
    !> it and never falls.) That of the cracks is large beside the stress when they are wide: it
    !> stands by itself, so that no difference of large numbers is taken.
    !@cuf attributes(host,device) &
    pure subroutine open_cracks(par, crack, s, p_old, trial, p, hist, cracks)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: crack !! width of the smeared crack [m]
        real(rk), intent(in) :: s(6) !! deviator at the start, in the axes of mid-step [Pa]
        real(rk), intent(in) :: p_old(2) !! pressure at the start with cracks, uncracked [Pa]
        real(rk), intent(inout) :: trial(6) !! deviator, elastic in, with cracks out [Pa]
        real(rk), intent(inout) :: p !! pressure at the end, uncracked in, with cracks out [Pa]
        real(rk), intent(inout) :: hist(n_hist)
        type(cracks_t), intent(out) :: cracks
        real(rk) :: old(6), parted(6), start(6), rise(6), change(6), values(3), taken
        real(rk) :: damage, kappa, volume, shift
        integer :: i

        cracks%released = 0
        cracks%damage = hist(h_tension)
        do i = 1, 6
            old(i) = s(i)
            if (i <= 3) old(i) = s(i) - p_old(1)
            parted(i) = 0
        end do
        volume = 0
        if (cracks%damage > 0) &
            call find_open(par, cracks%damage, old, logarithmic(par, p_old(2)), parted, volume)
        do i = 1, 6
            start(i) = old(i) + parted(i)
            if (i <= 3) start(i) = start(i) + volume
        end do
        shift = mean_pressure(start) - logarithmic(par, p)
        cracks%beyond = 0
        if (cracks%damage > 0) &
            cracks%beyond = max(0.0_rk, mean_pressure(start) - logarithmic(par, p_old(2)))
        do i = 1, 6
            rise(i) = trial(i) - s(i)
            if (i <= 3) rise(i) = rise(i) + shift
            change(i) = old(i) + rise(i)
            parted(i) = parted(i) + change(i)
        end do
        taken = elastic(par, old, rise)
        cracks%trace = -3*mean_pressure(change)
        call principal(parted, cracks%uncracked, cracks%axes)
        call carry(par, 0.0_rk, cracks, values)
        kappa = max(values(1), values(2), values(3))/((1 - cracks%damage)*par(p_young))
        damage = max(cracks%damage, crack_damage(par, crack, kappa, hist(h_rate)))
        if (.not. damage > 0) return
        if (damage > cracks%damage) then
            cracks%damage = damage
            call carry(par, 0.0_rk, cracks, values)
        end if
        call compose(values, cracks%axes, trial)
        if (damage > hist(h_tension)) then
            do i = 1, 6
                change(i) = trial(i) - old(i)
            end do
            cracks%released = max(0.0_rk, taken - elastic(par, change, start))
        end if
        hist(h_tension) = damage
        cracks%rate = hist(h_rate)
        call along(old, cracks%axes, cracks%old)
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
    !> It errs by rounding, step after step, the more the larger the stress beside the crack is. The
    !> volume does not: what of the difference can be rounding is the crack's, not a strain of the
    !> concrete beside it.
    !@cuf attributes(host,device) &
    pure subroutine find_open(par, damage, stress, pressure, parted, volume)
        real(rk), intent(in) :: par(n_par), damage
        real(rk), intent(in) :: stress(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(in) :: pressure !! of uncracked concrete of the same volume [Pa]
        real(rk), intent(out) :: parted(6) !! by shear stiffness, along the axes of the cracks [Pa]
        real(rk), intent(out) :: volume !! on every axis, for their trace [Pa]
        real(rk), parameter :: rounding = 4*epsilon(1.0_rk) !! of an opening in a step
        real(rk) :: values(3), axes(3, 3), nu, gain, total, rest, slack
        integer :: i

        call principal(stress, values, axes)
        nu = par(p_young)/(2*par(p_shear)) - 1
        gain = damage/(1 - damage)/(1 + nu)
        slack = 4*gain*max(abs(values(1)), abs(values(2)), abs(values(3)))
        total = 0
        do i = 1, 3
            values(i) = gain*max(values(i), 0.0_rk)
            total = total + values(i)
        end do
        call compose(values, axes, parted)
        volume = nu/(1 - 2*nu)*total
        if (.not. total > 0) return
        rest = 3*(mean_pressure(stress) - pressure)*(1 - 2*nu)/(1 + nu) - total
        slack = rounding*(total + slack)
        rest = max(0.0_rk, 1 + min(max(rest, -slack), slack)/total)
        do i = 1, 6
            parted(i) = rest*parted(i)
        end do
        volume = rest*volume
    end subroutine find_open

    !> Principal stresses with cracks from those without, at the same strain, after a flow.
    !>
    !> With S the sum of the stresses and w the uncracked ones, sigma_i (1/f_i + nu) = (1 + nu) w_i
    !> + nu (S - W): linear in S once it is known which f_i are 1 - D and which are 1. That depends
    !> on the sign of the left side; the line is that of a convex energy, so few passes find it.
    !> The part of the uncracked stress that is the same on every axis for the volume of the cracks
    !> may be left out of w: W is then the sum less that of the part left out.
    !> A flow that keeps the share k = 1/(1 + lambda) of a deviator has w_i - lambda (sigma_i - S/3)
    !> in place of w_i; all is multiplied by k. It is given by 1 - k, as most flows are small.
    !@cuf attributes(host,device) &
    pure subroutine carry(par, taken, cracks, values)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: taken !! 1 - k, 0: no flow
        type(cracks_t), intent(in) :: cracks
        real(rk), intent(out) :: values(3) !! principal stresses [Pa]
        real(rk) :: nu, keep, left, open, closed, flow, gain, total, rest, slope, share
        integer :: i, pass
        integer, parameter :: passes = 4

        do i = 1, 3
            values(i) = cracks%uncracked(i)
        end do
        if (.not. cracks%damage > 0) return
        nu = par(p_young)/(2*par(p_shear)) - 1
        left = 1 - cracks%damage
        keep = 1 - taken
        flow = (1 + nu)*taken
        open = left/(keep*(1 + nu*left) + flow*left)
        closed = 1/(1 + nu)
        gain = keep*nu + flow/3
        do i = 1, 3
            values(i) = keep*(1 + nu)*values(i) + flow/3*cracks%trace
        end do
        total = 0 ! S - W
        do pass = 1, passes
            rest = -cracks%trace
            slope = 1
            do i = 1, 3
                share = merge(open, closed, values(i) + gain*total > 0)
                rest = rest + share*values(i)
                slope = slope - share*gain
            end do
            total = rest/slope
        end do
        do i = 1, 3
            values(i) = values(i) + gain*total
            values(i) = values(i)*merge(open, closed, values(i) > 0)
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

    !> Principal values and their axes, column by column.
    !@cuf attributes(host,device) &
    pure subroutine principal(tensor, values, axes)
        real(rk), intent(in) :: tensor(6) !! xx, yy, zz, xy, yz, xz
        real(rk), intent(out) :: values(3), axes(3, 3)
        real(rk) :: matrix(3, 3)
        integer :: i

        call to_matrix(tensor, matrix)
        call diagonalise(matrix, axes)
        do i = 1, 3
            values(i) = matrix(i, i)
        end do
    end subroutine principal

    !> The tensor of principal values and axes.
    !@cuf attributes(host,device) &
    pure subroutine compose(values, axes, tensor)
        real(rk), intent(in) :: values(3), axes(3, 3) !! see `principal`
        real(rk), intent(out) :: tensor(6) !! xx, yy, zz, xy, yz, xz
        integer :: k

        do k = 1, 6
            tensor(k) = 0
        end do
        do k = 1, 3
            tensor(1) = tensor(1) + values(k)*axes(1, k)*axes(1, k)
            tensor(2) = tensor(2) + values(k)*axes(2, k)*axes(2, k)
            tensor(3) = tensor(3) + values(k)*axes(3, k)*axes(3, k)
            tensor(4) = tensor(4) + values(k)*axes(1, k)*axes(2, k)
            tensor(5) = tensor(5) + values(k)*axes(2, k)*axes(3, k)
            tensor(6) = tensor(6) + values(k)*axes(1, k)*axes(3, k)
        end do
    end subroutine compose

    !> What a tensor is along each axis, a . t a.
    !@cuf attributes(host,device) &
    pure subroutine along(tensor, axes, values)
        real(rk), intent(in) :: tensor(6), axes(3, 3) !! xx, yy, zz, xy, yz, xz; see `principal`
        real(rk), intent(out) :: values(3)
        integer :: k

        do k = 1, 3
            values(k) = tensor(1)*axes(1, k)**2 + tensor(2)*axes(2, k)**2 &
                        + tensor(3)*axes(3, k)**2 + 2*(tensor(4)*axes(1, k)*axes(2, k) &
                        + tensor(5)*axes(2, k)*axes(3, k) + tensor(6)*axes(1, k)*axes(3, k))
        end do
    end subroutine along

    !> Rate of the largest principal strain, filtered over the time of a wave across the crack; it
    !> rests once a crack has opened.
    !@cuf attributes(host,device) &
    pure subroutine follow_rate(par, crack, dt, l, hist)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: crack, dt !! width of the crack [m], time step [s]
        real(rk), intent(in) :: l(3, 3) !! dv_i/dx_j [1/s]
        real(rk), intent(inout) :: hist(n_hist)
        real(rk) :: share, d(6), values(3), axes(3, 3)

        if (int(par(p_crack_rate)) /= by_malvar .or. hist(h_tension) > 0) return
        call to_voigt(l, d)
        call principal(d, values, axes)
        share = dt*sqrt(par(p_young)/par(p_density))
        share = share/(share + crack)
        hist(h_rate) = hist(h_rate) + share*( &
            max(values(1), values(2), values(3), 0.0_rk) - hist(h_rate))
    end subroutine follow_rate
end module brz_hjc_cracks
