! SPDX-License-Identifier: MIT
!> Forces between two particles: stress, artificial viscosity, hourglass control by a viscous
!> (rate-based) or a stiff (displacement-based) force.
!>
!> Every force here changes sign when the particles change places: momentum is conserved to
!> rounding whatever the state of the material. w = V_i V_j F_ij, x_ij = x_i - x_j. Point physics.
!>
!> Source: docs/theory/solids.md
module brz_pair_force
    use brz_kinds, only: rk
    implicit none
    private
    public :: stress_force, viscous_force, jump_speed, hourglass_viscous, hourglass_stiff, &
              hourglass_axial, axial_stiffness, metric_square, overstretched, most_bent, &
              most_in_tension

    real(rk), parameter :: jumps = 3 !! see jump_speed

    ! a pair beyond these stretches, or below their inverse, is let go
    real(rk), parameter :: most_bent = 1.6_rk !! by what holds elastic bodies and plies together
    real(rk), parameter :: most_in_tension = 3 !! by the tensile control

contains

    !> Force of the stress, -w (T_i + T_j) x_ij with T = stress times gradient correction.
    !@cuf attributes(host,device) &
    pure subroutine stress_force(w, ti, tj, r, f)
        real(rk), intent(in) :: w
        real(rk), intent(in) :: ti(9), tj(9) !! T of the two particles [Pa]
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(out) :: f(3) !! on i [N]

        f(1) = -w*((ti(1) + tj(1))*r(1) + (ti(4) + tj(4))*r(2) + (ti(7) + tj(7))*r(3))
        f(2) = -w*((ti(2) + tj(2))*r(1) + (ti(5) + tj(5))*r(2) + (ti(8) + tj(8))*r(3))
        f(3) = -w*((ti(3) + tj(3))*r(1) + (ti(6) + tj(6))*r(2) + (ti(9) + tj(9))*r(3))
    end subroutine stress_force

    !> Factor u of Monaghan's viscosity: force u x_ij on i, heat -u/2 v_ij.x_ij for each particle.
    !@cuf attributes(host,device) &
    pure function viscous_force(w, h, r2, vr, linear, quadratic) result(u)
        real(rk), intent(in) :: w
        real(rk), intent(in) :: h !! smoothing length [m]
        real(rk), intent(in) :: r2 !! |x_ij|^2 [m2]
        real(rk), intent(in) :: vr !! v_ij.x_ij, or what jump_speed leaves of it [m2/s]
        real(rk), intent(in) :: linear !! sum over the two particles of alpha rho c/2 [kg/(m2 s)]
        real(rk), intent(in) :: quadratic !! sum of beta rho/2 [kg/m3]
        real(rk) :: u
        real(rk) :: phi

        phi = h*min(vr, 0.0_rk)/(r2 + 0.01_rk*h*h)
        u = w*(quadratic*phi - linear)*phi
    end function viscous_force

    !> What the viscosity sees of v_ij.x_ij where it spares smooth flow: three times the jump that
    !> is left at the middle of the pair when both velocities are drawn on to it by their gradients.
    !>
    !> With p = x_ij.H x_ij of each particle the jump is v_ij.x_ij less the harmonic mean of both p,
    !> which is 0 where their signs differ (van Leer's limiter): no jump is left in linear flow.
    !> Within a shock the gradients are those of a few spacings, and a part of v_ij.x_ij is left:
    !> three times that keeps shocks from ringing (docs/theory/solids.md). Seen is what lies between
    !> v_ij.x_ij and 0, and 0 where the pair parts: the force resists approach alone, by no more
    !> than without the limiter, and makes heat.
    !>
    !> Source: Frontiere, Raskin and Owen 2017 after Christensen 1990
    !@cuf attributes(host,device) &
    pure function jump_speed(hi, hj, r, vr) result(q)
        real(rk), intent(in) :: hi(9), hj(9) !! velocity gradients [1/s]
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(in) :: vr !! v_ij.x_ij [m2/s]
        real(rk) :: q
        real(rk) :: p, s

        p = r(1)*(hi(1)*r(1) + hi(4)*r(2) + hi(7)*r(3)) &
            + r(2)*(hi(2)*r(1) + hi(5)*r(2) + hi(8)*r(3)) &
            + r(3)*(hi(3)*r(1) + hi(6)*r(2) + hi(9)*r(3))
        q = r(1)*(hj(1)*r(1) + hj(4)*r(2) + hj(7)*r(3)) &
            + r(2)*(hj(2)*r(1) + hj(5)*r(2) + hj(8)*r(3)) &
            + r(3)*(hj(3)*r(1) + hj(6)*r(2) + hj(9)*r(3))
        s = p + q
        q = vr - 2*max(p*q, 0.0_rk)*s/(s*s + tiny(s))
        q = min(max(jumps*q, vr), 0.0_rk)
    end function jump_speed

    !> Viscous hourglass force: resists the part of v_ij that the velocity gradients miss.
    !>
    !> Each particle's own strength goes with its own gradient. With the corrected gradient,
    !> sum_j V_j F_ij (v_ij - H_i x_ij) (x) x_ij = 0: no torque, and never negative heat in i.
    !@cuf attributes(host,device) &
    pure subroutine hourglass_viscous(zi, zj, hi, hj, dv, r, f, heat)
        real(rk), intent(in) :: zi, zj !! w times zeta h rho c of the two particles
        real(rk), intent(in) :: hi(9), hj(9) !! velocity gradients at the new positions [1/s]
        real(rk), intent(in) :: dv(3), r(3) !! v_ij, x_ij
        real(rk), intent(out) :: f(3) !! on i [N]
        real(rk), intent(out) :: heat !! power that becomes heat in i [W]
        real(rk) :: d(3), e(3)

        d(1) = dv(1) - (hi(1)*r(1) + hi(4)*r(2) + hi(7)*r(3))
        d(2) = dv(2) - (hi(2)*r(1) + hi(5)*r(2) + hi(8)*r(3))
        d(3) = dv(3) - (hi(3)*r(1) + hi(6)*r(2) + hi(9)*r(3))
        e(1) = dv(1) - (hj(1)*r(1) + hj(4)*r(2) + hj(7)*r(3))
        e(2) = dv(2) - (hj(2)*r(1) + hj(5)*r(2) + hj(8)*r(3))
        e(3) = dv(3) - (hj(3)*r(1) + hj(6)*r(2) + hj(9)*r(3))
        f(1) = -(zi*d(1) + zj*e(1))
        f(2) = -(zi*d(2) + zj*e(2))
        f(3) = -(zi*d(3) + zj*e(3))
        heat = zi*(d(1)*dv(1) + d(2)*dv(2) + d(3)*dv(3))
    end subroutine hourglass_viscous

    !> Stiff hourglass force: pulls x_ij towards the image of X_ij under the deformations.
    !>
    !> Each particle's own stiffness goes with its own deformation F: with P = z F the force is
    !> y (P_i X_ij - z_i x_ij) and the same of j. With the corrected gradient,
    !> sum_j V_j F_ij (F_i X_ij - x_ij) (x) x_ij = 0: no torque. The stiffness is zeta G in elastic
    !> bodies, or K of brz_tensile_control.
    !@cuf attributes(host,device) &
    pure subroutine hourglass_stiff(most, y, z, pi, pj, x_ref, r, f)
        real(rk), intent(in) :: most !! stretch of a pair that is held, most_bent or most_in_tension
        real(rk), intent(in) :: y !! w times what damage leaves of it
        real(rk), intent(in) :: z !! sum of the stiffnesses of the two particles [Pa]
        real(rk), intent(in) :: pi(9), pj(9) !! their stiffness times deformation dx/dX [Pa]
        real(rk), intent(in) :: x_ref(3) !! X_ij [m]
        real(rk), intent(in) :: r(3) !! x_ij [m]
        real(rk), intent(out) :: f(3) !! on i [N]
        real(rk) :: h

        h = y
        if (overstretched(most, x_ref, r)) h = 0
        f(1) = h*((pi(1) + pj(1))*x_ref(1) + (pi(4) + pj(4))*x_ref(2) + (pi(7) + pj(7))*x_ref(3) &
                  - z*r(1))
        f(2) = h*((pi(2) + pj(2))*x_ref(1) + (pi(5) + pj(5))*x_ref(2) + (pi(8) + pj(8))*x_ref(3) &
                  - z*r(2))
        f(3) = h*((pi(3) + pj(3))*x_ref(1) + (pi(6) + pj(6))*x_ref(2) + (pi(9) + pj(9))*x_ref(3) &
                  - z*r(3))
    end subroutine hourglass_stiff

    !> Stiff hourglass force with a stiffness along axes: y (P_i X_ij - K_i x_ij), and that of j.
    !@cuf attributes(host,device) &
    pure subroutine hourglass_axial(y, k, pi, pj, x_ref, unloaded, r, f)
        real(rk), intent(in) :: y !! w times what damage leaves of it
        real(rk), intent(in) :: k(6) !! sum of the stiffnesses K, xx, yy, zz, xy, yz, xz [Pa]
        real(rk), intent(in) :: pi(9), pj(9) !! K dx/dX of the two particles [Pa]
        real(rk), intent(in) :: x_ref(3), r(3) !! X_ij, x_ij [m]
        real(rk), intent(in) :: unloaded(3) !! X_ij, also where x_ref are lattice coordinates [m]
        real(rk), intent(out) :: f(3) !! on i [N]
        real(rk) :: h

        h = y
        if (overstretched(most_bent, unloaded, r)) h = 0
        f(1) = h*((pi(1) + pj(1))*x_ref(1) + (pi(4) + pj(4))*x_ref(2) + (pi(7) + pj(7))*x_ref(3) &
                  - (k(1)*r(1) + k(4)*r(2) + k(6)*r(3)))
        f(2) = h*((pi(2) + pj(2))*x_ref(1) + (pi(5) + pj(5))*x_ref(2) + (pi(8) + pj(8))*x_ref(3) &
                  - (k(4)*r(1) + k(2)*r(2) + k(5)*r(3)))
        f(3) = h*((pi(3) + pj(3))*x_ref(1) + (pi(6) + pj(6))*x_ref(2) + (pi(9) + pj(9))*x_ref(3) &
                  - (k(6)*r(1) + k(5)*r(2) + k(3)*r(3)))
    end subroutine hourglass_axial

    !> Stiffness along the axes of a material that the deformation has carried along:
    !> K = sum of z_a n_a (x) n_a with n_a = F e_a/|F e_a|.
    !@cuf attributes(host,device) &
    pure subroutine axial_stiffness(z, e, f, k)
        real(rk), intent(in) :: z(3) !! stiffness along each axis [Pa]
        real(rk), intent(in) :: e(3, 3) !! unloaded axes, column by column
        real(rk), intent(in) :: f(3, 3) !! deformation dx/dX
        real(rk), intent(out) :: k(6) !! xx, yy, zz, xy, yz, xz [Pa]
        real(rk) :: n(3), c
        integer :: a, i

        do i = 1, 6
            k(i) = 0
        end do
        do a = 1, 3
            do i = 1, 3
                n(i) = f(i, 1)*e(1, a) + f(i, 2)*e(2, a) + f(i, 3)*e(3, a)
            end do
            c = z(a)/max(n(1)*n(1) + n(2)*n(2) + n(3)*n(3), sqrt(tiny(c))) ! finite without n
            k(1) = k(1) + c*n(1)*n(1)
            k(2) = k(2) + c*n(2)*n(2)
            k(3) = k(3) + c*n(3)*n(3)
            k(4) = k(4) + c*n(1)*n(2)
            k(5) = k(5) + c*n(2)*n(3)
            k(6) = k(6) + c*n(1)*n(3)
        end do
    end subroutine axial_stiffness

    !> Square of the length of a pair in lattice coordinates over that in the unloaded body: by it
    !> the viscosity has the weight, and by its root the smoothing length, of the direction.
    !@cuf attributes(host,device) &
    pure function metric_square(x_ref, unloaded) result(s2)
        real(rk), intent(in) :: x_ref(3), unloaded(3) !! [m]
        real(rk) :: s2

        s2 = (x_ref(1)*x_ref(1) + x_ref(2)*x_ref(2) + x_ref(3)*x_ref(3) + tiny(s2)) &
             /(unloaded(1)*unloaded(1) + unloaded(2)*unloaded(2) + unloaded(3)*unloaded(3) &
               + tiny(s2))
    end function metric_square

    !> True for a pair that what holds to the unloaded body has let go.
    !@cuf attributes(host,device) &
    pure function overstretched(most, x_ref, r) result(yes)
        real(rk), intent(in) :: most !! stretch, or its inverse
        real(rk), intent(in) :: x_ref(3), r(3) !! X_ij, x_ij [m]
        logical :: yes
        real(rk) :: a, b

        a = r(1)*r(1) + r(2)*r(2) + r(3)*r(3)
        b = x_ref(1)*x_ref(1) + x_ref(2)*x_ref(2) + x_ref(3)*x_ref(3)
        yes = a > most*most*b .or. b > most*most*a
    end function overstretched
end module brz_pair_force
