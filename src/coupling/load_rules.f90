! SPDX-License-Identifier: MIT
!> Walls that the gas pushes. Point physics: compiled for the CPU and for the GPU.
module brz_load_rules
    use brz_kinds, only: rk
    implicit none
    private
    public :: pushed_velocity, lightness

    real(rk), parameter :: middling = 0.3_rk !! yield of a wall that is neither light nor heavy

contains

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
