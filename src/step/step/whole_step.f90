! SPDX-License-Identifier: MIT
!> A time step of the air that holds a whole number of steps of the bodies.
module brz_whole_step
    use brz_kinds, only: dp
    implicit none
    private
    public :: whole_step

    ! Steps of one core [1/s] by which `whole_step` weighs air and bodies: the results depend on it.
    real(dp), parameter :: cell_rate = 4e6_dp, particle_rate = 1.3e6_dp
    real(dp), parameter :: most_ratio = 1e6_dp !! of steps beyond which a part of one is nothing

contains

    !> A step of the air that is a whole number of the bodies' own steps, or as it was, whichever
    !> carries a scene on for less work: 2.2 steps of the bodies would have to be made as three.
    pure real(dp) function whole_step(dt, dt_solid, cells, particles) result(step)
        real(dp), intent(in) :: dt, dt_solid !! largest steps of the air and the bodies [s]
        real(dp), intent(in) :: cells, particles !! of them all
        real(dp) :: air, body, ratio

        step = dt
        ratio = dt/dt_solid
        if (.not. ratio > 1 .or. ratio > most_ratio) return
        air = cells/cell_rate
        body = particles/particle_rate
        if ((air + aint(ratio)*body)*ratio > (air + real(ceiling(ratio), dp)*body)*aint(ratio)) &
            return
        step = aint(ratio)*dt_solid*(1 - 4*epsilon(dt)) ! does not round to one step more
    end function whole_step
end module brz_whole_step
