! SPDX-License-Identifier: MIT
!> How gas and particles push each other. Point physics: compiled for the CPU and for the GPU.
module brz_load_rules
    use brz_kinds, only: rk
    implicit none
    private
    public :: load_weight, pushed_velocity

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

    !> Velocity of a wall in the middle of a step, from that at its start.
    !>
    !> Semi-implicit in the radiation of the gas (its impedance), so that solids of less weight than
    !> a cell of gas stay stable: they move with the gas.
    !@cuf attributes(host,device) &
    pure function pushed_velocity(v, force, impedance, mass, dt) result(w)
        real(rk), intent(in) :: v !! one component at the start of the step [m/s]
        real(rk), intent(in) :: force !! of the gas on the cell at that velocity [N]
        real(rk), intent(in) :: impedance !! d(force)/dv, positive [N s/m]
        real(rk), intent(in) :: mass !! of the free particles in the cell [kg]
        real(rk), intent(in) :: dt !! [s]
        real(rk) :: w

        w = v + dt/2*force/(mass + dt/2*impedance)
    end function pushed_velocity
end module brz_load_rules
