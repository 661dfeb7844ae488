! SPDX-License-Identifier: MIT
!> Start of the coupling: walls from the particles at time zero, empty ledgers, no debts.
module brz_coupling_setup
    use brz_air_state, only: air_t, bc_periodic
    use brz_air_walls, only: build_walls, set_up_walls
    use brz_air_grid, only: grid_of
    use brz_case, only: case_t
    use brz_cell_shells, only: make_shells
    use brz_coupling_bins, only: fill_bins, find_cells, index_faces, mark_cells, &
                                 move_walls
    use brz_coupling_debts, only: enter_debts
    use brz_coupling_events, only: size_walls
    use brz_coupling_state, only: coupling_t
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_kinds, only: dp, int32, rk
    use brz_positivity, only: floors_of
    use brz_solid_state, only: solid_t
    implicit none
    private
    public :: set_up_coupling, couple, restart_coupling, make_box

contains

    !> Couple the air and the solids of a case.
    subroutine set_up_coupling(case, air, solid, coupling, err)
        type(case_t), intent(in) :: case
        type(air_t), intent(inout) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(out) :: coupling
        type(error_t), intent(inout) :: err

        if (.not. (air%present .and. solid%present)) return
        if (product(real(air%n, dp)) > huge(1_int32)) then
            call raise(err, exit_deck, &
                       'the air has more than 2**31 cells: too many for the coupling')
        end if
        if (failed(err)) return
        call couple(air, solid, real(case%coupling%spread, rk), &
                    real(case%coupling%reference_pressure, rk), coupling)
        coupling%paper = case%coupling%scheme == 'paper'
        if (coupling%paper) air%activity = .false.
    end subroutine set_up_coupling

    !> Put the walls up where the particles are. What gas was there is taken out.
    subroutine couple(air, solid, spread, reference_pressure, coupling)
        type(air_t), intent(inout) :: air
        type(solid_t), intent(in) :: solid
        real(rk), intent(in) :: spread !! depth over which a load is spread, in air cells
        real(rk), intent(in) :: reference_pressure !! taken off every load [Pa]
        type(coupling_t), intent(out) :: coupling
        integer :: c, ijk(3)

        coupling%present = .true.
        coupling%n_var = air%n_var
        coupling%spread = spread
        coupling%reference_pressure = reference_pressure
        coupling%wraps = air%bc(1, :) == bc_periodic .and. air%n > 1
        call make_box(air, coupling)
        call make_shells(air%n, coupling%shells)
        allocate (coupling%cell_of(solid%n), coupling%place_of(solid%n), coupling%binned(solid%n))
        allocate (coupling%v_before(3, solid%n), source=0.0_rk)
        allocate (coupling%mark(air%n(1), air%n(2), air%n(3)))
        allocate (coupling%slot(air%n(1), air%n(2), air%n(3)))
        call set_up_walls(air, coupling%wall)
        call restart_coupling(air, solid, coupling)
        do c = 1, coupling%wall%n_cells
            ijk = coupling%wall%cell(:, c)
            air%u(ijk(1), ijk(2), ijk(3), :) = empty_part(air, solid, coupling, c) &
                                               *air%u(ijk(1), ijk(2), ijk(3), :)
        end do
    end subroutine couple

    !> The box of the air as the loops see it.
    subroutine make_box(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling

        coupling%box%n = air%n
        coupling%box%cells = product(air%n)
        coupling%box%n_var = air%n_var
        coupling%box%layers = ceiling(coupling%spread)
        coupling%box%bc = air%bc
        coupling%box%wraps = coupling%wraps
        coupling%box%floors = floors_of(.true., air%scheme%gamma, air%rho_rest, air%p_rest)
        coupling%box%spread = coupling%spread
        coupling%box%reference = coupling%reference_pressure
        coupling%box%lo = air%lo
        coupling%box%dx = air%dx
        coupling%box%area = product(air%dx)/air%dx
        coupling%box%grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
    end subroutine make_box

    !> Part of a surface cell that its particles do not fill: its gas is where the ledger starts.
    !>
    !> A body that moves leaves and covers gas a cell at a time; without this its ledgers would
    !> lack, all the way, what was there at the start.
    pure real(rk) function empty_part(air, solid, coupling, c)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(dp) :: full
        integer :: i

        empty_part = 0
        if (.not. any(coupling%face_of(:, c) > 0)) return
        full = 0
        do i = coupling%ends(c) + 1, coupling%ends(c + 1)
            full = full + solid%volume(coupling%binned(i))
        end do
        empty_part = real(max(1 - full/product(air%dx), 0.0_dp), rk)
    end function empty_part

    !> Walls, bins and the map of debts as the particles and the list of debts say.
    subroutine restart_coupling(air, solid, coupling)
        type(air_t), intent(in) :: air
        type(solid_t), intent(in) :: solid
        type(coupling_t), intent(inout) :: coupling
        logical :: moved

        coupling%cell_of = -1
        call find_cells(solid, coupling, moved)
        call mark_cells(air, solid, coupling)
        coupling%wall%solid(1:air%n(1), 1:air%n(2), 1:air%n(3)) = coupling%mark
        call build_walls(air, coupling%wall)
        call index_faces(air, coupling)
        call size_walls(coupling)
        call fill_bins(air, solid, coupling)
        call move_walls(solid, coupling)
        call enter_debts(coupling)
    end subroutine restart_coupling
end module brz_coupling_setup
