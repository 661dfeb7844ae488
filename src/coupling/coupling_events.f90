! SPDX-License-Identifier: MIT
!> Cells that change between gas and solid, see brz_event_steps, on one process and on several.
module brz_coupling_events
    use brz_air_state, only: air_t
    use brz_coupling_guests, only: invite_guests, see_window
    use brz_coupling_shared, only: share_debts
    use brz_coupling_state, only: coupling_t
    use brz_event_steps, only: move_on
    use brz_ranks, only: several
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: reclassify

contains

    !> Bring walls, ledgers and gas up to date with the particles. Once per step of the air.
    !>
    !> Mass, momentum and energy of gas, ledgers and debts together do not change.
    subroutine reclassify(air, solid, coupling)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(solid_t), allocatable :: guests

        if (several(solid%ranks)) then
            call invite_guests(air, solid, coupling)
            call see_window(air)
            call share_debts(air, coupling)
            call move_alloc(coupling%guests, guests)
            coupling%rebuilds = -1 ! a guest's place is another one's in the next step
            call move_on(air, guests, guests, coupling)
            call move_alloc(guests, coupling%guests)
            call see_window(air)
        else
            call move_on(air, solid, solid, coupling)
        end if
    end subroutine reclassify
end module brz_coupling_events
