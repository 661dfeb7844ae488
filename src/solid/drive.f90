! SPDX-License-Identifier: MIT
!> Work of the prescribed motion of a body.
module brz_drive
    use brz_kinds, only: dp
    use brz_motion, only: velocity_of
    use brz_solid_state, only: body_t, form_rigid
    implicit none
    private
    public :: book_drive

contains

    !> Work of what drives a body: its kinetic energy, less what the air and the body itself do. The
    !> second half of the latter is booked with the force, the work of the air on a rigid body with
    !> its step.
    subroutine book_drive(body, time, dt, v)
        type(body_t), intent(inout) :: body
        real(dp), intent(in) :: time, dt, v(3)
        real(dp) :: before(3), after(3), work

        before = velocity_of(body%motion, time)
        after = velocity_of(body%motion, time + dt)
        body%ledger%drive = body%ledger%drive - dt/2*dot_product(body%motion%force, v) &
            + body%motion%mass/2*(dot_product(after, after) - dot_product(before, before))
        if (body%formulation == form_rigid) return
        work = dt*dot_product(body%rigid%load(1:3), v)
        body%ledger%load = body%ledger%load + work
        body%ledger%drive = body%ledger%drive - work
    end subroutine book_drive
end module brz_drive
