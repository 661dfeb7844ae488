! SPDX-License-Identifier: MIT
!> Open boundary: what stands behind the last cell so that waves leave.
!>
!> The gas that was at the boundary at first is taken to go on for ever beyond it. The two meet in a
!> Riemann problem: a wave into gas at rest is its own solution and finds no obstacle, shock or
!> not, and gas that is sucked in has the state of the gas outside. Gas that leaves faster than
!> sound is left alone. Point physics.
module brz_outflow
    use brz_kinds, only: rk
    use brz_gas, only: sound_speed
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: beyond, minmod

    integer, parameter :: steps = 3 !! of the iteration for the velocity; weak waves need one

contains

    !> State just outside an open boundary, from the gas inside and the gas far away.
    !>
    !> Equal to the state inside, bit for bit, if that is the far state or leaves faster than sound.
    !@cuf attributes(host,device) &
    pure subroutine beyond(gamma, w, gamma_far, far, side, out)
        real(rk), intent(in) :: gamma !! ratio of specific heats inside [-]
        real(rk), intent(in) :: w(5) !! density, velocity (normal in slot 2), pressure inside
        real(rk), intent(in) :: gamma_far !! ratio of specific heats far away [-]
        real(rk), intent(in) :: far(5) !! the same of the gas far away
        integer, intent(in) :: side !! +1: the boundary is above the gas, -1: below
        real(rk), intent(out) :: out(5) !! the same just outside
        real(rk) :: u, u_star, p_in, p_out, rho_in, rho_out, gap
        integer :: c, m

        do c = 1, 5
            out(c) = w(c)
        end do
        if (side*w(2) >= sound_speed(gamma, w(1), w(5))) return
        u = side*(w(2) - far(2))
        u_star = u
        do m = 1, steps
            call wall_star(gamma, w(1), w(5), u - u_star, p_in, rho_in)
            call wall_star(gamma_far, far(1), far(5), u_star, p_out, rho_out)
            gap = p_in - p_out
            if (abs(gap) <= 4*epsilon(gap)*p_in) exit
            u_star = u_star &
                + gap/(sqrt(gamma*p_in*rho_in) + sqrt(gamma_far*p_out*rho_out))
        end do
        if (.not. abs(u_star - u) > 0) return
        out(2) = far(2) + side*u_star
        if (side*out(2) > 0) then
            out(1) = rho_in
            out(5) = p_in
        else
            out(1) = rho_out
            out(3) = far(3)
            out(4) = far(4)
            out(5) = p_out
        end if
    end subroutine beyond

    !> The smaller of two differences, zero where they have different signs.
    !@cuf attributes(host,device) &
    pure elemental function minmod(a, b) result(slope)
        real(rk), intent(in) :: a, b
        real(rk) :: slope

        slope = 0
        if (a*b > 0) slope = sign(min(abs(a), abs(b)), a)
    end function minmod
end module brz_outflow
