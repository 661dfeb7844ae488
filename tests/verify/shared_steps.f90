! SPDX-License-Identifier: MIT
!> Steps on the CPU, where nothing can fail but the physics.
module shared_steps
    use brz_air_state, only: air_t, wall_t
    use brz_air_steps, only: step_of_air => air_step
    use brz_errors, only: error_t, failed
    use brz_kinds, only: dp
    implicit none
    private
    public :: air_step

contains

    !> As brz_air_steps has it.
    subroutine air_step(air, wall, dt, status)
        type(air_t), intent(inout) :: air
        type(wall_t), intent(inout) :: wall
        real(dp), intent(in) :: dt !! [s]
        integer, intent(out) :: status
        type(error_t) :: err

        call step_of_air(air, wall, dt, status, err)
        if (failed(err)) error stop 'a step on the CPU failed'
    end subroutine air_step
end module shared_steps
