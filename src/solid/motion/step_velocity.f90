! SPDX-License-Identifier: MIT
!> The velocity of a particle at the step: the state holds that half a step before.
module brz_step_velocity
    use brz_kinds, only: rk
    use brz_particles, only: particles_t
    implicit none
    private
    public :: velocity_at_step

contains

    !> Velocity of a particle at the step itself [m/s].
    pure function velocity_at_step(solid, i) result(v)
        class(particles_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk) :: v(3)

        v = solid%v(:, i) + real(solid%dt_last/2, rk)*solid%a(:, i)
    end function velocity_at_step
end module brz_step_velocity
