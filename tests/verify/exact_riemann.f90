! SPDX-License-Identifier: MIT
!> The exact Riemann problem of an ideal gas with gamma 1.4.
module exact_riemann
    use brz_kinds, only: dp
    implicit none
    private
    public :: riemann

contains

    !> Exact solution at speed xi = x/t of a jump between two states (density, velocity, pressure).
    subroutine riemann(left, right, xi, state, p_star, u_star)
        real(dp), intent(in) :: left(3), right(3), xi
        real(dp), intent(out) :: state(3), p_star, u_star
        real(dp) :: lo, hi, mid
        integer :: m

        lo = 1e-14_dp*min(left(3), right(3))
        hi = 100*max(left(3), right(3))
        do m = 1, 200 ! bisection in the logarithm: slow and safe
            mid = sqrt(lo*hi)
            if (jump(mid, left) + jump(mid, right) + right(2) - left(2) > 0) then
                hi = mid
            else
                lo = mid
            end if
        end do
        p_star = sqrt(lo*hi)
        u_star = 0.5_dp*(left(2) + right(2) + jump(p_star, right) - jump(p_star, left))
        if (xi < u_star) then
            call sample(left, 1.0_dp, xi, p_star, u_star, state)
        else
            call sample(right, -1.0_dp, xi, p_star, u_star, state)
        end if
    end subroutine riemann

    !> Change of velocity across the wave that brings a state to pressure p.
    real(dp) function jump(p, s)
        real(dp), intent(in) :: p, s(3)
        real(dp), parameter :: g = 1.4_dp

        if (p > s(3)) then
            jump = (p - s(3))*sqrt(2/((g + 1)*s(1))/(p + (g - 1)/(g + 1)*s(3)))
        else
            jump = 2*sqrt(g*s(3)/s(1))/(g - 1)*((p/s(3))**((g - 1)/(2*g)) - 1)
        end if
    end function jump

    !> State on one side of the contact; sign +1: left.
    subroutine sample(s, sign, xi, p_star, u_star, state)
        real(dp), intent(in) :: s(3), sign, xi, p_star, u_star
        real(dp), intent(out) :: state(3)
        real(dp), parameter :: g = 1.4_dp, b = (g - 1)/(g + 1)
        real(dp) :: c, c_star, u, x

        c = sqrt(g*s(3)/s(1))
        x = p_star/s(3)
        if (x > 1) then
            state = s
            if (sign*(xi - s(2)) > -c*sqrt((g + 1)/(2*g)*x + (g - 1)/(2*g))) &
                state = [s(1)*(x + b)/(b*x + 1), u_star, p_star]
        else
            c_star = c*x**((g - 1)/(2*g))
            if (sign*(xi - s(2)) < -c) then
                state = s
            else if (sign*(xi - u_star) > -c_star) then
                state = [s(1)*x**(1/g), u_star, p_star]
            else
                u = 2/(g + 1)*(sign*c + (g - 1)/2*s(2) + xi)
                x = sign*(u - xi)/c
                state = [s(1)*x**(2/(g - 1)), u, s(3)*x**(2*g/(g - 1))]
            end if
        end if
    end subroutine sample
end module exact_riemann
