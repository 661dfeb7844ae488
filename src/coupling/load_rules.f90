! SPDX-License-Identifier: MIT
!> Wall tractions: how gas and particles push each other. Point physics: compiled for the CPU and
!> for the GPU.
module brz_load_rules
    use brz_column_rules, only: direction_of, sign_of
    use brz_gas, only: to_primitive
    use brz_kinds, only: dp, rk
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: load_weight, gauge_force, is_felt, wall_traction, pushed_velocity, lightness

    real(rk), parameter :: middling = 0.3_rk !! yield of a wall that is neither light nor heavy

contains

    !> Weight of a particle in the load of a face: falls linearly from the surface inwards.
    !>
    !> An even split over the particles of a cell rings: the number of loaded layers jumps as the
    !> surface crosses cells.
    !@cuf attributes(host,device) &
    pure function load_weight(depth, range) result(w)
        real(rk), intent(in) :: depth !! below the outermost particle of the column [m]
        real(rk), intent(in) :: range !! depth that carries no load any more [m]
        real(rk) :: w

        w = max(1 - depth/range, 0.0_rk)
    end function load_weight

    !> Force on the solid behind a face over a step, along the axis, reference pressure off [N].
    !@cuf attributes(host,device) &
    pure function gauge_force(s, impulse, pressure, area, dt) result(force)
        integer, intent(in) :: s !! +1: solid above the gas, -1: solid below
        real(rk), intent(in) :: impulse !! of the gas, along the side [N s]
        real(rk), intent(in) :: pressure !! that is taken off [Pa]
        real(dp), intent(in) :: area !! of the face [m2]
        real(dp), intent(in) :: dt !! [s]
        real(rk) :: force
        real(dp) :: reference

        reference = pressure*area
        force = real(s*(impulse/dt - reference), rk)
    end function gauge_force

    !> True for a wall face with more than rounding above or below the reference pressure.
    !@cuf attributes(host,device) &
    pure function is_felt(impulse, pressure, area, dt) result(felt)
        real(rk), intent(in) :: impulse !! of the gas on the face [N s]
        real(rk), intent(in) :: pressure !! that is taken off [Pa]
        real(dp), intent(in) :: area !! of the face [m2]
        real(dp), intent(in) :: dt !! [s]
        logical :: felt
        real(dp), parameter :: negligible = max(1e-9_dp, 16*real(epsilon(1.0_rk), dp))
        !! of the reference pressure
        real(dp) :: reference

        reference = pressure*area*dt
        felt = abs(impulse - reference) > negligible*reference
    end function is_felt

    !> Force of the gas on a face if the wall keeps its velocity, and its fall if the wall yields.
    !@cuf attributes(host,device) &
    pure subroutine wall_traction(row, gamma, u, v, area, reference, force, impedance)
        integer, intent(in) :: row !! side of the face, see side_of
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: u(5) !! the gas, conserved variables
        real(rk), intent(in) :: v !! velocity of the wall along the axis [m/s]
        real(dp), intent(in) :: area !! of the face [m2]
        real(rk), intent(in) :: reference !! pressure taken off [Pa]
        real(rk), intent(out) :: force !! on the solid, along the axis [N]
        real(rk), intent(out) :: impedance !! loss of force per velocity [N s/m]
        real(rk) :: p, rho, speed, w(5)
        integer :: k, s

        s = sign_of(row)
        call to_primitive(gamma, u, w)
        speed = 0
        do k = 1, 3
            if (k == direction_of(row)) speed = w(1 + k)
        end do
        call wall_star(gamma, w(1), w(5), s*(speed - v), p, rho)
        force = real(s*(p - reference)*area, rk)
        impedance = real(sqrt(gamma*p*rho)*area, rk)
    end subroutine wall_traction

    !> Velocity of a wall in the middle of a step, from that at its start.
    !>
    !> A heavy wall goes on as it did in the last step. A light one feels at once how the push of
    !> the gas has changed, semi-implicit in the radiation of the gas (its impedance): so solids of
    !> less weight than a cell of gas stay stable, and move with the gas.
    !@cuf attributes(host,device) &
    pure function pushed_velocity(v, force, change, impedance, mass, dt) result(w)
        real(rk), intent(in) :: v !! one component at the start of the step [m/s]
        real(rk), intent(in) :: force !! on the mass, over the last step, of all kinds [N]
        real(rk), intent(in) :: change !! of the push of the gas since then, at velocity v [N]
        real(rk), intent(in) :: impedance !! loss of push per velocity [N s/m]
        real(rk), intent(in) :: mass !! [kg]
        real(rk), intent(in) :: dt !! [s]
        real(rk) :: w, yield, light

        yield = dt/2*impedance/mass
        light = lightness(yield)
        w = v + dt/2*(force + light*change)/(mass*(1 + light*yield))
    end function pushed_velocity

    !> How much a wall follows the gas, from its yield in half a step: 0 heavy, 1 light.
    !@cuf attributes(host,device) &
    pure function lightness(yield) result(light)
        real(rk), intent(in) :: yield !! dt/2 times impedance over mass [-]
        real(rk) :: light

        light = yield*yield/(yield*yield + middling*middling)
    end function lightness
end module brz_load_rules
