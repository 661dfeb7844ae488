! SPDX-License-Identifier: MIT
!> Flux through one face of the four cells around it, with or without solid among them.
!>
!> The sweeps compute the same fluxes line by line; this is the path for single faces.
!> Point physics.
module brz_face_flux
    use brz_kinds, only: rk
    use brz_gas, only: mirror, to_primitive
    use brz_steger_warming, only: split_flux
    use brz_weno3, only: weno3
    use brz_wall_riemann, only: wall_flux
    implicit none
    private
    public :: gas_face, cut_face

contains

    !> Flux between cells 2 and 3 of four gas cells.
    !@cuf attributes(host,device) &
    pure subroutine gas_face(order, gamma, scale, q, f)
        integer, intent(in) :: order !! 1: first order, 3: WENO3
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: scale(5) !! 1/(typical flux)^2, see weno3
        real(rk), intent(in) :: q(5, 4) !! conserved variables, normal momentum in slot 2
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk) :: plus(5, 4), minus(5, 4)
        integer :: c

        call split_flux(gamma, q(1, 2), plus(1, 2), minus(1, 2))
        call split_flux(gamma, q(1, 3), plus(1, 3), minus(1, 3))
        if (order == 1) then
            do c = 1, 5
                f(c) = plus(c, 2) + minus(c, 3)
            end do
            return
        end if
        call split_flux(gamma, q(1, 1), plus(1, 1), minus(1, 1))
        call split_flux(gamma, q(1, 4), plus(1, 4), minus(1, 4))
        do c = 1, 5
            f(c) = weno3(plus(c, 1), plus(c, 2), plus(c, 3), scale(c)) &
                + weno3(minus(c, 4), minus(c, 3), minus(c, 2), scale(c))
        end do
    end subroutine gas_face

    !> Flux between cells 2 and 3 where some of the four cells hold solid.
    !>
    !> A solid cell of the stencil is replaced by the mirror image of the gas cell next to it.
    !> Between gas and solid it is the flux at the wall; between two solid cells nothing flows.
    !@cuf attributes(host,device) &
    pure subroutine cut_face(order, gamma, scale, solid, v, q, f, p_star)
        integer, intent(in) :: order !! 1: first order, 3: WENO3
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: scale(5) !! 1/(typical flux)^2, see weno3
        integer, intent(in) :: solid(4) !! 1 where the cell holds solid
        real(rk), intent(in) :: v(4) !! normal velocity of the solid, read in solid cells [m/s]
        real(rk), intent(in) :: q(5, 4) !! conserved variables, read in gas cells
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk), intent(out) :: p_star !! pressure on the wall, 0 where there is none [Pa]
        real(rk) :: s(5, 4), u
        integer :: c, m

        p_star = 0
        do c = 1, 5
            f(c) = 0
        end do
        if (solid(2) == 1 .and. solid(3) == 1) return
        if (solid(3) == 1) then
            u = far_velocity(solid(1), v(1), q(1, 1), q(1, 2))
            call slipping_wall(order, gamma, u, v(3), 1, q(1, 2), f, p_star)
            return
        else if (solid(2) == 1) then
            u = far_velocity(solid(4), v(4), q(1, 4), q(1, 3))
            call slipping_wall(order, gamma, u, v(2), -1, q(1, 3), f, p_star)
            return
        end if
        do m = 1, 4
            do c = 1, 5
                s(c, m) = q(c, m)
            end do
        end do
        if (solid(1) == 1) call mirror(q(1, 2), v(1), s(1, 1))
        if (solid(4) == 1) call mirror(q(1, 3), v(4), s(1, 4))
        call gas_face(order, gamma, scale, s, f)
    end subroutine cut_face

    !> Normal velocity one cell further from the wall, mirrored if that cell holds solid too.
    !@cuf attributes(host,device) &
    pure function far_velocity(solid, v, far, near) result(u)
        integer, intent(in) :: solid !! 1 where the far cell holds solid
        real(rk), intent(in) :: v !! its normal velocity, then [m/s]
        real(rk), intent(in) :: far(5) !! conserved variables, read if the far cell holds gas
        real(rk), intent(in) :: near(5) !! conserved variables of the cell at the wall
        real(rk) :: u

        if (solid == 1) then
            u = 2*v - near(2)/near(1)
        else
            u = far(2)/far(1)
        end if
    end function far_velocity

    !> Flux at a wall; at order 3 the normal velocity is extrapolated to it with a limited slope.
    !@cuf attributes(host,device) &
    pure subroutine slipping_wall(order, gamma, u_far, v, side, near, f, p_star)
        integer, intent(in) :: order !! 1: first order, 3: limited slope
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: u_far !! normal velocity one cell further from the wall [m/s]
        real(rk), intent(in) :: v !! normal velocity of the wall [m/s]
        integer, intent(in) :: side !! +1: the wall is above the gas, -1: below
        real(rk), intent(in) :: near(5) !! conserved variables of the cell at the wall
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk), intent(out) :: p_star !! pressure on the wall [Pa]
        real(rk) :: w(5), a, b

        call to_primitive(gamma, near, w)
        if (order /= 1) then
            a = w(2) - u_far
            b = 2*(v - w(2))
            if (a*b > 0) w(2) = w(2) + a*b/(a + b)
        end if
        call wall_flux(gamma, w, v, side, f, p_star)
    end subroutine slipping_wall
end module brz_face_flux
