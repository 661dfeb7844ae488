! SPDX-License-Identifier: MIT
!> The flux through one face of the grid, straight from the state of the air, walls included.
module brz_air_faces
    use brz_kinds, only: rk
    use brz_air_state, only: air_t, bc_symmetry, bc_wall, wall_t
    use brz_face_flux, only: cut_face, gas_face
    use brz_grid_lines, only: turned
    implicit none
    private
    public :: flux_at, typical_scale

contains

    !> Flux through the face above a cell in direction d.
    subroutine flux_at(air, wall, order, d, low, f, p_star, speed)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: order !! 1: first order, 3: WENO3
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face
        real(rk), intent(out) :: f(5) !! flux, normal momentum in slot 2
        real(rk), intent(out) :: p_star !! pressure on the wall, 0 where there is none [Pa]
        real(rk), intent(out) :: speed !! normal velocity of the wall, 0 where there is none [m/s]
        real(rk) :: q(5, 4), v(4), scale(5)
        integer :: c, m, at(3), solid(4)

        at = low
        solid = 0
        v = 0
        do m = 1, 4
            at(d) = low(d) + m - 2
            do c = 1, 5
                q(c, m) = air%u(at(1), at(2), at(3), turned(c, d))
            end do
            if (.not. wall%present) cycle
            solid(m) = wall%solid(at(1), at(2), at(3))
            if (solid(m) == 1) v(m) = wall_speed(air, wall, d, at)
        end do
        call typical_scale(air, scale)
        p_star = 0
        speed = 0
        if (all(solid == 0)) then
            call gas_face(order, air%gamma, scale, q, f)
        else
            call cut_face(order, air%gamma, scale, solid, v, q, f, p_star)
            if (solid(2) /= solid(3)) speed = v(2)*solid(2) + v(3)*solid(3)
        end if
    end subroutine flux_at

    !> Normal velocity of a solid cell or of the image of one, which a mirror turns round.
    pure function wall_speed(air, wall, d, at) result(v)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: d !! direction
        integer, intent(in) :: at(3) !! cell, perhaps a ghost of direction d
        real(rk) :: v
        integer :: bc

        v = wall%v(d, wall%index(at(1), at(2), at(3)))
        if (at(d) >= 1 .and. at(d) <= air%n(d)) return
        bc = air%bc(merge(1, 2, at(d) < 1), d)
        if (bc == bc_wall .or. bc == bc_symmetry) v = -v
    end function wall_speed

    !> 1/(typical flux)^2 of mass, momentum and energy, from the undisturbed air.
    pure subroutine typical_scale(air, scale)
        type(air_t), intent(in) :: air
        real(rk), intent(out) :: scale(5)
        real(rk) :: c

        c = sqrt(air%gamma*air%p_rest/air%rho_rest)
        scale(1) = 1/(air%rho_rest*c)**2
        scale(2) = 1/(air%rho_rest*c*c)**2
        scale(3:4) = scale(2)
        scale(5) = 1/(air%rho_rest*c*c*c)**2
    end subroutine typical_scale
end module brz_air_faces
