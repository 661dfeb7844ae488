! SPDX-License-Identifier: MIT
!> Tensile-instability control, called the tensile control: hourglass control in tension by a stiff
!> force in proportion to the tension.
!>
!> Sums over present positions have a negative stiffness for waves of two spacings in matter under
!> tension: 1.25 times the largest principal tension in an infinite lattice. A stiffness
!> K = kappa s, s that tension, towards the affine image of the unloaded body outweighs it, and
!> where there is no tension there is none. Faces with a lift (brz_one_sided_arm) have a negative
!> stiffness of some 2.2 times it, and more of the tensile control. It lets go of matter that has
!> expanded (spalled) and of neighbourhoods that the unloaded body no longer describes. Point
!> physics.
!>
!> Source: docs/theory/solids.md
module brz_tensile_control
    use brz_kinds, only: rk
    implicit none
    private
    public :: largest_tension, may_be_in_tension, deviation, stiffness_of_control, kappa_of, &
        kept_work

    real(rk), parameter :: open = 0.05_rk !! expansion to which all is held; gone at twice that
    real(rk), parameter :: more_lifted = 2 !! of the tensile control at faces with a lift
    real(rk), parameter :: strange = 0.5_rk !! deviation, likewise

contains

    !> Mean tension and von Mises stress q; the largest principal stress is mean + 2/3 q at most.
    !@cuf attributes(host,device) &
    pure subroutine mean_and_mises(t, mean, q)
        real(rk), intent(in) :: t(6) !! stress, xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(out) :: mean, q !! [Pa]

        mean = (t(1) + t(2) + t(3))/3
        q = sqrt(1.5_rk*((t(1) - mean)**2 + (t(2) - mean)**2 + (t(3) - mean)**2) &
                 + 3*(t(4)*t(4) + t(5)*t(5) + t(6)*t(6)))
    end subroutine mean_and_mises

    !> False where no principal stress can be a tension. Sums that only the tensile control needs
    !> are made for particles that may be drawn before a step.
    !@cuf attributes(host,device) &
    pure function may_be_in_tension(t) result(yes)
        real(rk), intent(in) :: t(6) !! see mean_and_mises
        logical :: yes
        real(rk) :: mean, q

        call mean_and_mises(t, mean, q)
        yes = mean + 2*q/3 > 0
    end function may_be_in_tension

    !> Largest principal tension, 0 in compression: mean + 2/3 q cos(arccos(27 J3/(2 q^3))/3).
    !@cuf attributes(host,device) &
    pure function largest_tension(t) result(s)
        real(rk), intent(in) :: t(6) !! see mean_and_mises
        real(rk) :: s !! [Pa]
        real(rk) :: mean, q, x, y, z, xy, yz, xz, c

        call mean_and_mises(t, mean, q)
        s = 0
        if (mean + 2*q/3 <= 0) return
        c = 1
        if (q > 0) then ! of the deviator over q: its cube could be no number
            x = (t(1) - mean)/q
            y = (t(2) - mean)/q
            z = (t(3) - mean)/q
            xy = t(4)/q
            yz = t(5)/q
            xz = t(6)/q
            c = 13.5_rk*(x*(y*z - yz*yz) - xy*(xy*z - yz*xz) + xz*(xy*yz - y*xz))
            c = cos(acos(max(-1.0_rk, min(1.0_rk, c)))/3)
        end if
        s = max(mean + 2*q*c/3, 0.0_rk)
    end function largest_tension

    !> Mean square of what an affine image of the unloaded body misses: sum_j V_j F_ij |e_ij|^2 with
    !> e_ij = F X_ij - x_ij, from the sums S = sum V_j F_ij X_ij (x) X_ij and the trace of M.
    !@cuf attributes(host,device) &
    pure function deviation(dimension, f, s, trace) result(q)
        integer, intent(in) :: dimension !! over the axes of which traces go
        real(rk), intent(in) :: f(3, 3) !! deformation dx/dX
        real(rk), intent(in) :: s(6) !! S, xx, yy, zz, xy, yz, xz
        real(rk), intent(in) :: trace !! of M, over these axes
        real(rk) :: q
        integer :: a

        q = -trace
        do a = 1, 3 ! not to dimension: f would lie in memory on a GPU
            if (a > dimension) exit
            q = q + f(a, 1)*(f(a, 1)*s(1) + 2*(f(a, 2)*s(4) + f(a, 3)*s(6))) &
                + f(a, 2)*(f(a, 2)*s(2) + 2*f(a, 3)*s(5)) + f(a, 3)*f(a, 3)*s(3)
        end do
        q = max(q, 0.0_rk)
    end function deviation

    !> Stiffness of the tensile control of a particle over the tension.
    !@cuf attributes(host,device) &
    pure function kappa_of(kappa, lift, tilt) result(k)
        real(rk), intent(in) :: kappa !! of the body
        real(rk), intent(in) :: lift, tilt !! of its faces; of the particle; see brz_one_sided_arm
        real(rk) :: k

        k = kappa
        if (lift*abs(tilt) > 0) k = more_lifted*kappa
    end function kappa_of

    !> Stiffness K of the tensile control.
    !@cuf attributes(host,device) &
    pure function stiffness_of_control(kappa, stress, mu, share) result(k)
        real(rk), intent(in) :: kappa !! over the largest principal tension
        real(rk), intent(in) :: stress(6) !! see mean_and_mises
        real(rk), intent(in) :: mu !! compression; 0 for what springs back from any expansion
        real(rk), intent(in) :: share !! deviation over the trace of M
        real(rk) :: k !! [Pa]

        k = kappa*largest_tension(stress)*faded(-mu/open)*faded(sqrt(share)/strange)
        if (.not. k <= huge(k)) k = 0
    end function stiffness_of_control

    !> What the tensile control keeps of the work against it; the rest is heat. Its stiffness
    !> follows the tension, so that it can do more work than it took: then it keeps less than
    !> nothing, as heat below none would cool the particle, raise its tension, and with that the
    !> stiffness.
    !@cuf attributes(host,device) &
    pure function kept_work(work, energy) result(kept)
        real(rk), intent(in) :: work !! against the tensile control, less what became heat [J]
        real(rk), intent(in) :: energy !! U = V K q/2, which it can hold [J]
        real(rk) :: kept !! [J]

        kept = min(work, energy)
    end function kept_work

    !> 1 up to 1, 0 from 2 on.
    !@cuf attributes(host,device) &
    pure function faded(x) result(left)
        real(rk), intent(in) :: x
        real(rk) :: left

        left = max(0.0_rk, min(1.0_rk, 2 - x))
    end function faded
end module brz_tensile_control
