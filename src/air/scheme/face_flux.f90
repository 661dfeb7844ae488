! SPDX-License-Identifier: MIT
!> Flux through one face of the six cells around it, some of which may lie beyond a wall at the end
!> of the grid.
!>
!> Cells are numbered along the line: 0 is below the face, 1 above. The sweeps compute the same
!> fluxes line by line; this is the path for single faces. Point physics.
module brz_face_flux
    use brz_kinds, only: rk
    use brz_gas, only: mirror, to_primitive
    use brz_hllc, only: hllc_flux
    use brz_products, only: face_fraction
    use brz_muscl, only: limited_slope
    use brz_reconstruction, only: face_value, thinness
    use brz_scheme, only: first_order, hllc, scheme_t, weno3_cells
    use brz_steger_warming, only: split_flux
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: gas_face, end_face, end_fraction, join_split, cell_faces, speed_at_wall

contains

    !> Flux between cells 0 and 1 of six gas cells.
    !@cuf attributes(host,device) &
    pure subroutine gas_face(scheme, gamma, q, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: gamma(-2:3) !! ratio of specific heats of each cell [-]
        real(rk), intent(in) :: q(5, -2:3) !! conserved variables, normal momentum in slot 2
        real(rk), intent(out) :: f(5) !! flux in the positive direction

        if (scheme%flux == hllc) then
            call riemann_face(scheme, gamma, q, f)
        else
            call split_face(scheme, gamma, q, f)
        end if
    end subroutine gas_face

    !> Flux by splitting; the reconstruction works on the split fluxes.
    !@cuf attributes(host,device) &
    pure subroutine split_face(scheme, gamma, q, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: gamma(-2:3) !! ratio of specific heats of each cell [-]
        real(rk), intent(in) :: q(5, -2:3) !! conserved variables, normal momentum in slot 2
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk) :: plus(5, -2:3), minus(5, -2:3)
        integer :: m

        do m = -2, 3
            call split_flux(gamma(m), q(1, m), plus(1, m), minus(1, m))
        end do
        call join_split(scheme, plus, minus, f)
    end subroutine split_face

    !> Flux through a face from the split fluxes of the cells around it.
    !@cuf attributes(host,device) &
    pure subroutine join_split(scheme, plus, minus, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: plus(5, -2:3) !! what moves up, of each cell
        real(rk), intent(in) :: minus(5, -2:3) !! what moves down
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk) :: up(-2:2), down(-2:2)
        integer :: c, m

        do c = 1, 5
            do m = -2, 2
                up(m) = plus(c, m)
                down(m) = minus(c, 1 - m)
            end do
            f(c) = face_value(scheme, c, up) + face_value(scheme, c, down)
        end do
    end subroutine join_split

    !> Flux by the Riemann problem of the primitive variables reconstructed on the two sides.
    !@cuf attributes(host,device) &
    pure subroutine riemann_face(scheme, gamma, q, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: gamma(-2:3) !! ratio of specific heats of each cell [-]
        real(rk), intent(in) :: q(5, -2:3) !! conserved variables, normal momentum in slot 2
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk) :: w(5, -2:3), below(5), above(5), not_used(5)
        integer :: m

        do m = -2, 3
            call to_primitive(gamma(m), q(1, m), w(1, m))
        end do
        call cell_faces(scheme, w(1, -2), not_used, below)
        call cell_faces(scheme, w(1, -1), above, not_used)
        call hllc_flux(gamma(0), below, gamma(1), above, f)
    end subroutine riemann_face

    !> Values at the two faces of the third of five cells.
    !@cuf attributes(host,device) &
    pure subroutine cell_faces(scheme, w, low, high)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: w(5, -2:2) !! density, velocity, pressure
        real(rk), intent(out) :: low(5), high(5) !! the same at its lower and upper face
        real(rk) :: up(-2:2), down(-2:2)
        integer :: c, m

        do c = 1, 5
            do m = -2, 2
                up(m) = w(c, m)
                down(m) = w(c, -m)
            end do
            low(c) = face_value(scheme, c, down)
            high(c) = face_value(scheme, c, up)
        end do
        if (scheme%reconstruction < weno3_cells) return ! between the values of cells
        if (thinness(w(1, 0), low(1), high(1)) <= 0 .and. &
            thinness(w(5, 0), low(5), high(5)) <= 0) return
        do c = 1, 5
            low(c) = w(c, 0)
            high(c) = w(c, 0)
        end do
    end subroutine cell_faces

    !> Flux between cells 0 and 1 where some of the cells lie beyond a wall.
    !>
    !> Such a cell of the stencil is replaced by the mirror image of the gas in front of it. At the
    !> wall it is the flux there; beyond it nothing flows.
    !@cuf attributes(host,device) &
    pure subroutine end_face(scheme, gamma, beyond, q, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: gamma(-2:3) !! ratio of specific heats of each cell [-]
        integer, intent(in) :: beyond(-2:3) !! 1 where the cell lies beyond a wall
        real(rk), intent(in) :: q(5, -2:3) !! conserved variables, read in gas cells
        real(rk), intent(out) :: f(5) !! flux in the positive direction
        real(rk) :: s(5, -2:3), g(-2:3), far(2)
        integer :: c, m

        do c = 1, 5
            f(c) = 0
        end do
        if (beyond(0) == 1 .and. beyond(1) == 1) return
        if (beyond(1) == 1) then
            call next_to_wall(beyond(-1), gamma(-1), q(1, -1), gamma(0), q(1, 0), far)
            call slipping_wall(scheme, gamma(0), far, 1, q(1, 0), f)
            return
        else if (beyond(0) == 1) then
            call next_to_wall(beyond(2), gamma(2), q(1, 2), gamma(1), q(1, 1), far)
            call slipping_wall(scheme, gamma(1), far, -1, q(1, 1), f)
            return
        end if
        do m = -2, 3
            g(m) = gamma(m)
            do c = 1, 5
                s(c, m) = q(c, m)
            end do
        end do
        call mirror_beyond(beyond(-1), q(1, 0), gamma(0), s(1, -1), g(-1))
        call mirror_beyond(beyond(2), q(1, 1), gamma(1), s(1, 2), g(2))
        if (beyond(-1) == 1) then
            call mirror_beyond(1, q(1, 1), gamma(1), s(1, -2), g(-2))
        else
            call mirror_beyond(beyond(-2), q(1, -1), gamma(-1), s(1, -2), g(-2))
        end if
        if (beyond(2) == 1) then
            call mirror_beyond(1, q(1, 0), gamma(0), s(1, 3), g(3))
        else
            call mirror_beyond(beyond(3), q(1, 2), gamma(2), s(1, 3), g(3))
        end if
        call gas_face(scheme, g, s, f)
    end subroutine end_face

    !> Mass fraction of the products that the mass flux through a face carries, where some of the
    !> cells lie beyond a wall.
    !@cuf attributes(host,device) &
    pure function end_fraction(scheme, beyond, mass_flux, y) result(share)
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: beyond(-2:3) !! 1 where the cell lies beyond a wall
        real(rk), intent(in) :: mass_flux !! [kg/(m2 s)]
        real(rk), intent(in) :: y(-2:3) !! mass fractions of the gas cells
        real(rk) :: share, z(-1:2)
        integer :: m

        do m = -1, 2
            z(m) = y(m)
        end do
        if (beyond(0) == 1) z(0) = y(1)
        if (beyond(1) == 1) z(1) = y(0)
        if (beyond(-1) == 1 .or. scheme%reconstruction == first_order) z(-1) = z(0)
        if (beyond(2) == 1 .or. scheme%reconstruction == first_order) z(2) = z(1)
        share = face_fraction(mass_flux, z(-1), z(0), z(1), z(2))
    end function end_fraction

    !> Put the mirror image of a cell in the place of one beyond the wall.
    !@cuf attributes(host,device) &
    pure subroutine mirror_beyond(beyond, q, gamma, image, gamma_image)
        integer, intent(in) :: beyond !! 1 where the cell lies beyond a wall
        real(rk), intent(in) :: q(5), gamma !! gas in front of it
        real(rk), intent(inout) :: image(5), gamma_image !! its place

        if (beyond /= 1) return
        call mirror(q, 0.0_rk, image)
        gamma_image = gamma
    end subroutine mirror_beyond

    !> Normal velocity and pressure one cell further from the wall; mirrored if that cell lies
    !> beyond a wall too.
    !@cuf attributes(host,device) &
    pure subroutine next_to_wall(beyond, gamma, q, gamma_near, near, far)
        integer, intent(in) :: beyond !! 1 where the cell lies beyond a wall
        real(rk), intent(in) :: gamma !! its ratio of specific heats otherwise [-]
        real(rk), intent(in) :: q(5) !! conserved variables, read if the cell holds gas
        real(rk), intent(in) :: gamma_near, near(5) !! the same of the cell at the wall
        real(rk), intent(out) :: far(2)
        real(rk) :: w(5)

        if (beyond == 1) then
            call to_primitive(gamma_near, near, w)
            w(2) = -w(2)
        else
            call to_primitive(gamma, q, w)
        end if
        far(1) = w(2)
        far(2) = w(5)
    end subroutine next_to_wall

    !> Normal velocity of the gas at a wall; beyond first order it is extrapolated to it with a
    !> limited slope.
    !>
    !> Less of it where the pressure jumps: as a shock arrives, the slope would take away the speed
    !> at which the gas hits the wall, and thereby the work that the shock does; the gas piles up
    !> and its pressure overshoots by up to a quarter. In smooth flow the share is 1 - O(dx).
    !@cuf attributes(host,device) &
    pure function speed_at_wall(scheme, far, v, p, u) result(speed)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: far(2) !! one cell further: normal velocity [m/s], pressure [Pa]
        real(rk), intent(in) :: v !! normal velocity of the wall [m/s]
        real(rk), intent(in) :: p, u !! pressure and normal velocity of the cell at the wall
        real(rk) :: speed, share

        speed = u
        if (scheme%reconstruction == first_order) return
        share = max(min(p, far(2)), 0.0_rk)/max(p, far(2), tiny(share))
        speed = u + 0.5_rk*share*limited_slope(u - far(1), 2*(v - u))
    end function speed_at_wall

    !> Flux at a wall that stands.
    !@cuf attributes(host,device) &
    pure subroutine slipping_wall(scheme, gamma, far, side, near, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: far(2) !! one cell further: normal velocity [m/s], pressure [Pa]
        integer, intent(in) :: side !! +1: the wall is above the gas, -1: below
        real(rk), intent(in) :: near(5) !! conserved variables of the cell at the wall
        real(rk), intent(inout) :: f(5) !! flux in the positive direction, 0
        real(rk) :: rho_star, w(5)

        call to_primitive(gamma, near, w)
        w(2) = speed_at_wall(scheme, far, 0.0_rk, w(5), w(2))
        call wall_star(gamma, w(1), w(5), side*w(2), f(2), rho_star)
    end subroutine slipping_wall
end module brz_face_flux
