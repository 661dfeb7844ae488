! SPDX-License-Identifier: MIT
!> Motion of a rigid body: quaternion, angular momentum, one leapfrog step. Point physics.
!>
!> Momentum and angular momentum live at half steps, position and attitude at steps. The angular
!> velocity of a step is that of its middle, so that a free body keeps its angular momentum to
!> rounding and its energy to second order, without drift.
!>
!> Source: docs/theory/contact.md
module brz_rigid
    use brz_kinds, only: dp
    use brz_rigid_body, only: rigid_t
    implicit none
    private
    public :: turn, attitude, spin_of, cross

    integer, parameter :: most_rounds = 50 !! of the implicit midpoint rule

contains

    !> Vector product.
    !@cuf attributes(host,device) &
    pure function cross(a, b) result(c)
        real(dp), intent(in) :: a(3), b(3)
        real(dp) :: c(3)

        c(1) = a(2)*b(3) - a(3)*b(2)
        c(2) = a(3)*b(1) - a(1)*b(3)
        c(3) = a(1)*b(2) - a(2)*b(1)
    end function cross

    !> Rotation matrix of a unit quaternion.
    !@cuf attributes(host,device) &
    pure function attitude(q) result(r)
        real(dp), intent(in) :: q(4)
        real(dp) :: r(3, 3)

        r(1, 1) = 1 - 2*(q(3)*q(3) + q(4)*q(4))
        r(2, 2) = 1 - 2*(q(2)*q(2) + q(4)*q(4))
        r(3, 3) = 1 - 2*(q(2)*q(2) + q(3)*q(3))
        r(1, 2) = 2*(q(2)*q(3) - q(1)*q(4))
        r(2, 1) = 2*(q(2)*q(3) + q(1)*q(4))
        r(1, 3) = 2*(q(2)*q(4) + q(1)*q(3))
        r(3, 1) = 2*(q(2)*q(4) - q(1)*q(3))
        r(2, 3) = 2*(q(3)*q(4) - q(1)*q(2))
        r(3, 2) = 2*(q(3)*q(4) + q(1)*q(2))
    end function attitude

    !> Angular velocity of a body with angular momentum l in the attitude q.
    !@cuf attributes(host,device) &
    pure function spin_of(compliance, q, l) result(omega)
        real(dp), intent(in) :: compliance(3, 3), q(4), l(3)
        real(dp) :: omega(3)
        real(dp) :: r(3, 3), own(3)
        integer :: i

        r = attitude(q)
        do i = 1, 3
            own(i) = r(1, i)*l(1) + r(2, i)*l(2) + r(3, i)*l(3)
        end do
        do i = 1, 3
            omega(i) = compliance(i, 1)*own(1) + compliance(i, 2)*own(2) + compliance(i, 3)*own(3)
        end do
        do i = 1, 3
            own(i) = r(i, 1)*omega(1) + r(i, 2)*omega(2) + r(i, 3)*omega(3)
        end do
        omega = own
    end function spin_of

    !> The quaternion q turned by the rotation vector a.
    !@cuf attributes(host,device) &
    pure function turned(q, a) result(p)
        real(dp), intent(in) :: q(4)
        real(dp), intent(in) :: a(3) !! [rad]
        real(dp) :: p(4)
        real(dp) :: angle, s, w, u(3), length

        angle = sqrt(a(1)*a(1) + a(2)*a(2) + a(3)*a(3))
        w = cos(angle/2)
        s = 0.5_dp
        if (angle > 1e-8_dp) s = sin(angle/2)/angle
        u = s*a
        p(1) = w*q(1) - u(1)*q(2) - u(2)*q(3) - u(3)*q(4)
        p(2) = w*q(2) + u(1)*q(1) + u(2)*q(4) - u(3)*q(3)
        p(3) = w*q(3) + u(2)*q(1) + u(3)*q(2) - u(1)*q(4)
        p(4) = w*q(4) + u(3)*q(1) + u(1)*q(3) - u(2)*q(2)
        length = sqrt(p(1)*p(1) + p(2)*p(2) + p(3)*p(3) + p(4)*p(4))
        p = p/length
    end function turned

    !> Turn a body over a step with constant angular momentum: implicit midpoint rule.
    !@cuf attributes(host,device) &
    pure subroutine turn(body, dt, omega, q_mid)
        type(rigid_t), intent(inout) :: body
        real(dp), intent(in) :: dt !! [s]
        real(dp), intent(out) :: omega(3) !! angular velocity of the step [1/s]
        real(dp), intent(out) :: q_mid(4) !! attitude in its middle
        real(dp) :: last(3)
        integer :: k

        omega = spin_of(body%compliance, body%q, body%l)
        do k = 1, most_rounds
            last = omega
            q_mid = turned(body%q, omega*(dt/2))
            omega = spin_of(body%compliance, q_mid, body%l)
            if (maxval(abs(omega - last)) <= 1e-15_dp*maxval(abs(omega))) exit
        end do
        q_mid = turned(body%q, omega*(dt/2))
        body%q = turned(body%q, omega*dt)
    end subroutine turn
end module brz_rigid
