! SPDX-License-Identifier: MIT
!> The load of the air on a particle, in scenes with and without air.
module brz_air_force
    use brz_kinds, only: rk
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: air_force

contains

    !> Force of the air on particle i [N].
    pure function air_force(solid, i) result(force)
        type(solid_t), intent(in) :: solid
        integer, intent(in) :: i
        real(rk) :: force(3)

        force = 0
        if (allocated(solid%load)) force = solid%load(:, i)
    end function air_force
end module brz_air_force
