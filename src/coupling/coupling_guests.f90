! SPDX-License-Identifier: MIT
!> The coupling halo of processes (windows of the air), and ghost exchange with it (guests): see
!> brz_guest_steps.
module brz_coupling_guests
    use brz_air_part, only: window_of
    use brz_air_state, only: air_t
    use brz_boxes, only: widened
    use brz_coupling_state, only: coupling_t
    use brz_fetch, only: fetch
    use brz_kinds, only: dp
    use brz_solid_fields, only: fields_of, fields_t
    use brz_solid_ghosts, only: for_the_air, of_air_motion, send_particles
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: open_windows, see_window, send_guests

contains

    !> The cells that each process sees. No guests are there yet, but the bodies are known.
    subroutine open_windows(air, solid, coupling)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        integer :: r

        associate (part => coupling%part)
            part%boxes = air%part%boxes
            allocate (part%windows(0:air%part%ranks%n - 1))
            do r = 0, ubound(part%windows, 1)
                part%windows(r) = window_of(air%part, r, air%whole, air%around)
            end do
            part%near = part%windows ! a particle may move for some steps until it is missed
            do r = 0, ubound(part%near, 1)
                part%near(r) = widened(part%near(r), [1, 1, 1]) ! beyond the grid, too
            end do
            part%parcels%ranks = air%part%ranks
        end associate
        coupling%crowd%present = .true.
        coupling%crowd%ranks = solid%ranks
        coupling%crowd%bodies = solid%bodies
        allocate (coupling%guests, source=coupling%crowd)
    end subroutine open_windows

    !> Bring the gas and the ledgers in the window of this process up to date.
    subroutine see_window(air)
        type(air_t), intent(inout) :: air

        call fetch(air%part%ranks, air%part%window, air%n_var, air%before + 1 - air%g, &
                   air%before + air%n + air%g, air%u)
    end subroutine see_window

    !> Send what the copies have of their particles.
    subroutine send_guests(p, coupling, all_of_it)
        type(solid_t), intent(inout), target :: p
        type(coupling_t), intent(inout), target :: coupling
        logical, intent(in) :: all_of_it !! else what changes in a step
        type(fields_t) :: from, to

        call fields_of(p, from)
        call fields_of(coupling%guests, to)
        call send_particles(coupling%ranks, merge(for_the_air, of_air_motion, all_of_it), from, &
                            coupling%part%out, to, coupling%part%in, coupling%part%parcels%mail)
    end subroutine send_guests
end module brz_coupling_guests
