! SPDX-License-Identifier: MIT
!> Open boundary: what stands behind the last cell so that waves leave.
!>
!> The gas that was at the boundary at first is taken to go on for ever beyond it. The two meet in a
!> Riemann problem: a wave into gas at rest is its own solution and finds no obstacle, shock or
!> not, and gas that is sucked in has the state of the gas outside. Gas that leaves faster than
!> sound is left alone; gas that comes faster than sound is that of the outside. Point physics.
module brz_outflow
    use brz_kinds, only: rk
    use brz_gas, only: sound_speed, to_conserved, to_primitive
    use brz_positivity, only: margin, vacuum
    use brz_scheme, only: max_var, mixture_gamma, scheme_t
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: beyond, minmod, open_ghosts

    integer, parameter :: steps = 3 !! of the iteration for the velocity; weak waves need one

contains

    !> Three ghosts behind an open boundary: the gas inside goes on with a limited slope, and the
    !> gas outside answers. Vectors have their normal component in slot 2.
    !@cuf attributes(host,device) &
    pure subroutine open_ghosts(scheme, cells, inside, outside, side, ghost)
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: cells !! different cells among those inside: 1 to 3
        real(rk), intent(in) :: inside(max_var, 3) !! conserved variables; 1: at the boundary
        real(rk), intent(in) :: outside(max_var) !! the same of the gas outside
        integer, intent(in) :: side !! +1: the boundary is above the gas, -1: below
        real(rk), intent(out) :: ghost(max_var, 3) !! 1: at the boundary
        real(rk) :: w(5, 3), far(5), slope(5), edge(5), out(5), next(5)
        real(rk) :: gamma, gamma_far, gamma_out, fraction
        integer :: c, m
        logical :: copy

        do m = 3, 1, -1
            call turn_to_primitive(scheme, inside(1, m), w(1, m), gamma)
        end do
        call turn_to_primitive(scheme, outside, far, gamma_far)
        do c = 1, 5
            slope(c) = 0
            if (cells == 3) slope(c) = minmod(w(c, 2) - w(c, 3), w(c, 1) - w(c, 2))
            if (c == 1 .or. c == 5) slope(c) = max(slope(c), -w(c, 1)/6)
            edge(c) = w(c, 1) + slope(c)
        end do
        call beyond(gamma, edge, gamma_far, far, side, out)
        copy = .true.
        do c = 1, 5
            if (abs(out(c) - w(c, 1)) > 0) copy = .false.
        end do
        gamma_out = gamma
        fraction = inside(6, 1)/inside(1, 1)
        if (side*out(2) < 0) then ! gas from outside, to which the slope does not belong
            do c = 1, 5
                slope(c) = 0
            end do
            gamma_out = gamma_far
            fraction = outside(6)/outside(1)
        end if
        do m = 1, 3
            do c = 1, 5
                next(c) = out(c) + (m - 1)*slope(c)
                if (c == 1 .or. c == 5) & ! stays positive
                    next(c) = out(c)*(w(c, 1) + m*slope(c))/(w(c, 1) + slope(c))
            end do
            next(1) = max(next(1), vacuum(1)*far(1))
            next(5) = max(next(5), vacuum(2)*far(5), &
                          margin*next(1)*(next(2)*next(2) + next(3)*next(3) + next(4)*next(4)))
            call to_conserved(gamma_out, next, ghost(1, m))
            ghost(6, m) = fraction*ghost(1, m)
            if (copy) then
                do c = 1, max_var
                    ghost(c, m) = inside(c, 1)
                end do
            end if
        end do
    end subroutine open_ghosts

    !> Primitive variables of a state and its gamma.
    !@cuf attributes(host,device) &
    pure subroutine turn_to_primitive(scheme, q, w, gamma)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(max_var) !! conserved variables
        real(rk), intent(out) :: w(5)
        real(rk), intent(out) :: gamma

        gamma = scheme%gamma
        if (scheme%mixture) gamma = mixture_gamma(scheme, q(6)/q(1))
        call to_primitive(gamma, q, w)
    end subroutine turn_to_primitive

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
        real(rk) :: u, u_star, p_in, p_out, rho_in, rho_out, gap, front
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
        if (.not. abs(u_star - u) > 0) then ! no wave comes back
            if (side*w(2) >= 0) return
            out(1) = far(1)
            if (abs(u) > 0) out(1) = rho_out
            out(3) = far(3)
            out(4) = far(4)
            return
        end if
        ! the wave into the gas outside; where the wind blows it back, nothing inside is felt
        front = sound_speed(gamma_far, far(1), far(5))*sqrt(1 &
            + max((gamma_far + 1)/(2*gamma_far)*(p_out/far(5) - 1), 0.0_rk))
        if (side*far(2) + front <= 0) then
            do c = 1, 5
                out(c) = far(c)
            end do
            return
        end if
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
