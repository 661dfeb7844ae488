! SPDX-License-Identifier: MIT
!> The flux through one face of the grid, straight from the state of the air, walls included.
module brz_air_faces
    use brz_kinds, only: rk
    use brz_air_boundary, only: bc_symmetry, bc_wall, beyond_wall
    use brz_air_state, only: air_t, wall_t
    use brz_face_flux, only: cut_face, cut_fraction, gas_face
    use brz_grid_lines, only: turned
    use brz_scheme, only: max_var, mixture_gamma, scheme_t
    implicit none
    private
    public :: flux_at

contains

    !> Flux through the face above a cell in direction d.
    subroutine flux_at(air, wall, scheme, d, low, f, p_star, speed)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: d !! direction
        integer, intent(in) :: low(3) !! cell below the face
        real(rk), intent(out) :: f(max_var) !! flux, normal momentum in slot 2
        real(rk), intent(out) :: p_star !! pressure on the wall, 0 where there is none [Pa]
        real(rk), intent(out) :: speed !! normal velocity of the wall, 0 where there is none [m/s]
        real(rk) :: q(5, -2:3), v(-2:3), y(-2:3), gamma(-2:3)
        integer :: c, m, at(3), solid(-2:3)

        at = low
        solid = 0
        v = 0
        y = 0
        gamma = scheme%gamma
        do m = -2, 3
            at(d) = low(d) + m
            do c = 1, 5
                q(c, m) = air%u(at(1), at(2), at(3), turned(c, d))
            end do
            if (beyond_wall(scheme, air%bc(1, d), air%bc(2, d), air%n(d), at(d))) then
                solid(m) = 1
            else if (wall%present) then
                solid(m) = wall%solid(at(1), at(2), at(3))
                if (solid(m) == 1) v(m) = wall_speed(air, wall, d, at)
            end if
            if (air%n_var < 6 .or. solid(m) == 1) cycle
            y(m) = air%u(at(1), at(2), at(3), 6)/q(1, m)
            gamma(m) = mixture_gamma(scheme, y(m))
        end do
        p_star = 0
        speed = 0
        if (all(solid == 0)) then
            call gas_face(scheme, gamma, q, f)
        else
            call cut_face(scheme, gamma, solid, v, q, f, p_star)
            if (solid(0) /= solid(1)) speed = v(0)*solid(0) + v(1)*solid(1)
        end if
        f(6) = 0
        if (air%n_var == 6) f(6) = f(1)*cut_fraction(scheme, solid, f(1), y)
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
end module brz_air_faces
