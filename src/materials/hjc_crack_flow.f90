! SPDX-License-Identifier: MIT
!> Concrete with open cracks that flows, or whose mean tension is cut off.
!>
!> The flow is along the deviator of the end, at the traction that cracks carry; it takes what of
!> the work of the step is not held any more. See docs/theory/concrete.md.
!> Point physics: compiled for the CPU and for the GPU.
module brz_hjc_crack_flow
    use brz_hjc_cracks, only: carry, compose, cracks_t
    use brz_hjc_pressure, only: p_k_el, p_shear, p_t, p_young
    use brz_hjc_softening, only: faint
    use brz_hjc_strength, only: strength
    use brz_kinds, only: rk
    use brz_material, only: n_par
    implicit none
    private
    public :: flow_with_cracks

    real(rk), parameter :: near = 1e-9_rk + 64*epsilon(1.0_rk) !! to the surface, over the strength
    real(rk), parameter :: most_taken = 1 - (1e-4_rk + faint)

    !> A point after a flow.
    type :: flown_t
        real(rk) :: taken !! share of the deviator that the flow took
        real(rk) :: values(3), p !! principal stresses, pressure [Pa]
        real(rk) :: mises, yield !! equivalent stress, strength [Pa]
    end type flown_t

contains

    !> Back to the yield surface and to the cut-off in tension, at the traction that cracks carry.
    !>
    !> The flow is along the deviator s of the end: it takes lambda s from the uncracked stress,
    !> and what cracks carry follows (`carry`), so that an open one is neither pressed nor pulled
    !> by it. Without an open crack this is the radial return, 1/(1 + lambda) of the trial. The
    !> pressure falls with the stress beside a crack; the surface is met at the one of the end.
    !> What is left beyond it (no strength: the tip in tension) goes as the deviator and the mean
    !> tension themselves.
    !@cuf attributes(host,device) &
    pure subroutine flow_with_cracks(par, damage, rate, cracks, trial, p, strain, lost)
        real(rk), intent(in) :: par(n_par)
        real(rk), intent(in) :: damage, rate !! for `strength`
        type(cracks_t), intent(in) :: cracks
        real(rk), intent(inout) :: trial(6), p !! deviator, pressure: of `open_cracks` in, end out
        real(rk), intent(out) :: strain !! equivalent plastic strain
        real(rk), intent(out) :: lost !! energy that the flow takes [J/m3]
        type(flown_t) :: flown
        real(rk) :: held(3), least, share
        integer :: i

        call meet_surface(par, damage, rate, cracks, flown)
        share = 1 ! a cut of what is near would pull at the cracks
        if (flown%mises - flown%yield > 2*near*flown%yield) share = flown%yield/flown%mises
        strain = (flown%taken/(1 - flown%taken) + 1 - share)*flown%mises/(3*par(p_shear))
        least = max(flown%p, -par(p_t)*(1 - damage))
        do i = 1, 3
            flown%values(i) = share*(flown%values(i) + flown%p) - least
        end do
        call carry(par, 0.0_rk, cracks, held) ! again: three numbers less for the search
        lost = spent(par, cracks, held, flown%values, least > flown%p)
        p = least
        call compose(flown%values, cracks%axes, trial)
        do i = 1, 3
            trial(i) = trial(i) + p
        end do
    end subroutine flow_with_cracks

    !> The least flow that meets the surface.
    !>
    !> The strength falls along the way of the flow beside a crack, with the pressure, and may meet
    !> the stress more than once: secants from no flow on look for the first change of sign, at most
    !> four times as far each time, and then stay between its bounds.
    !@cuf attributes(host,device) &
    pure subroutine meet_surface(par, damage, rate, cracks, flown)
        real(rk), intent(in) :: par(n_par), damage, rate !! of `strength`
        type(cracks_t), intent(in) :: cracks
        type(flown_t), intent(out) :: flown
        real(rk) :: low, high, last, before, excess, next
        integer :: pass
        integer, parameter :: passes = 30

        low = 0
        high = 2 ! not known
        last = 0
        before = 0
        next = 0
        do pass = 0, passes ! the first without flow
            flown%taken = min(next, most_taken)
            call judge(par, damage, rate, cracks, flown)
            excess = flown%mises - flown%yield
            if (pass == 0) then
                if (.not. excess > 0) return
                before = excess
                next = excess/flown%mises
                cycle
            end if
            if (abs(excess) <= near*flown%yield) return
            if (excess > 0) then
                if (flown%taken >= most_taken) return
                low = flown%taken
            else
                high = flown%taken
            end if
            next = 0
            if (abs(before - excess) > 0) &
                next = flown%taken + excess*(flown%taken - last)/(before - excess)
            if (.not. (next > low .and. next < merge(high, 4*low, high <= 1))) &
                next = merge((low + high)/2, 4*low, high <= 1)
            last = flown%taken
            before = excess
        end do
    end subroutine meet_surface

    !> Stress, pressure and strength after a flow.
    !@cuf attributes(host,device) &
    pure subroutine judge(par, damage, rate, cracks, flown)
        real(rk), intent(in) :: par(n_par), damage, rate !! of `strength`
        type(cracks_t), intent(in) :: cracks
        type(flown_t), intent(inout) :: flown !! `taken` in
        real(rk) :: s(3)
        integer :: i

        call carry(par, flown%taken, cracks, s)
        flown%p = -(s(1) + s(2) + s(3))/3
        flown%mises = sqrt(((s(1) - s(2))**2 + (s(2) - s(3))**2 + (s(3) - s(1))**2)/2)
        flown%yield = strength(par, max(flown%p, -par(p_t)*(1 - damage)), damage, rate, &
                               cracks%rate, flown%mises, &
                               (s(1) + flown%p)*(s(2) + flown%p)*(s(3) + flown%p))
        do i = 1, 3
            flown%values(i) = s(i)
        end do
    end subroutine judge

    !> Work of the step that is not held any more [J/m3].
    !>
    !> It is the mean stress of the step times the strain that was lost from one stress to another.
    !> What the cut-off leaves open is no loss: its mean tension times the volume is held, and is
    !> given back as it closes; of what was open at the start the fall of the tension is lost.
    !@cuf attributes(host,device) &
    pure function spent(par, cracks, held, left, cut) result(work)
        real(rk), intent(in) :: par(n_par)
        type(cracks_t), intent(in) :: cracks
        real(rk), intent(in) :: held(3), left(3) !! along the axes of the cracks [Pa]
        logical, intent(in) :: cut !! the mean tension of `left` is that of the cut-off
        real(rk) :: work, nu, total, open, part, volume, p
        integer :: i

        nu = par(p_young)/(2*par(p_shear)) - 1
        total = held(1) - left(1) + held(2) - left(2) + held(3) - left(3)
        open = cracks%damage/(1 - cracks%damage)
        work = 0
        volume = 0
        do i = 1, 3
            part = (1 + nu)*(held(i) - left(i)) - nu*total &
                   + open*(max(held(i), 0.0_rk) - max(left(i), 0.0_rk))
            work = work + (cracks%old(i) + left(i))*part
            volume = volume + part
        end do
        work = work/(2*par(p_young))
        if (cut) then
            p = -(left(1) + left(2) + left(3))/3
            total = p + (cracks%old(1) + cracks%old(2) + cracks%old(3))/3 ! rise of the pressure
            work = work + p*volume/par(p_young) + total/2*cracks%beyond/par(p_k_el)
        end if
        work = max(merge(-cracks%released, 0.0_rk, cut), work)
    end function spent
end module brz_hjc_crack_flow
