! SPDX-License-Identifier: MIT
!> What several processes know together when a dump or a checkpoint begins, before each of them, or
!> a copy of it beside the run, writes what is its own. One process needs none of it.
module brz_together
    use brz_air_diagnostics, only: air_diagnostics_t, look_at_all_air
    use brz_air_state, only: air_t
    use brz_coupling_gather, only: gather_coupling
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, failed
    use brz_kinds, only: int64
    use brz_message_exchange, only: message_exchange_t
    use brz_ranks, only: several
    use brz_solid_gather, only: begin_gather, end_gather
    use brz_listed_bodies, only: listed_bodies_t
    use brz_interacting_bodies, only: interacting_bodies_t
    implicit none
    private
    public :: together_t, begin_bodies, begin_state, end_bodies

    type :: together_t
        character(:), allocatable :: folder !! of the results
        logical :: by_files = .false. !! copies of the processes write: they cannot send messages
        type(interacting_bodies_t), allocatable :: whole !! the bodies of all, in the first process
        integer(int64), allocatable :: in(:, :) !! particles that come: see begin_gather
        type(coupling_t), allocatable :: all !! diagnostics and cut cells of all, in the first
                                             !! process
        type(air_diagnostics_t) :: diagnostics !! of the air of all
    end type together_t

contains

    !> For a dump or a checkpoint. All must call.
    subroutine begin_bodies(together, solid)
        type(together_t), intent(inout) :: together
        class(interacting_bodies_t), intent(inout) :: solid

        if (.not. (solid%present .and. several(solid%ranks))) return
        if (allocated(together%whole)) deallocate (together%whole)
        allocate (together%whole)
        call begin_gather(solid, together%whole, together%in)
    end subroutine begin_bodies

    !> For a checkpoint, after begin_bodies. All must call.
    subroutine begin_state(together, air, coupling)
        type(together_t), intent(inout) :: together
        type(air_t), intent(in) :: air
        type(coupling_t), intent(in) :: coupling

        if (allocated(together%all)) deallocate (together%all)
        allocate (together%all)
        if (.not. (air%present .and. several(air%part%ranks))) return
        together%diagnostics = look_at_all_air(air)
        if (coupling%present) call gather_coupling(coupling, together%all)
    end subroutine begin_state

    !> Gather the particles for a file: by messages, then all must call; or by files beside it.
    subroutine end_bodies(together, solid, path, sorted, err)
        type(together_t), intent(inout) :: together
        class(listed_bodies_t), intent(inout) :: solid
        character(*), intent(in) :: path !! of the file
        logical, intent(in) :: sorted !! see end_gather
        type(error_t), intent(inout) :: err
        type(message_exchange_t) :: exchange

        if (together%by_files) exchange%path = path
        call end_gather(solid, together%whole, together%in, sorted, exchange)
        if (.not. failed(err)) err = exchange%fault
    end subroutine end_bodies
end module brz_together
