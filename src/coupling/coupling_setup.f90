! SPDX-License-Identifier: MIT
!> Start of the coupling: walls from the particles at time zero.
module brz_coupling_setup
    use brz_air_state, only: air_t, bc_periodic
    use brz_air_grid, only: grid_of
    use brz_air_part, only: halo_of
    use brz_boxes, only: cells_t
    use brz_case, only: case_t, label
    use brz_coupling_ghosts, only: open_halos
    use brz_coupling_state, only: coupling_t
    use brz_coupling_windows, only: put_halos, see_halo
    use brz_cut_driver, only: mix_clusters
    use brz_cut_share, only: plan_share
    use brz_cut_start_driver, only: begin_cut_cells, set_up_cut_cells
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_coupling_ghost_driver, only: renew_coupling_ghosts
    use brz_kinds, only: dp, int32, int8, real32, rk
    use brz_paper_cells, only: find_filled_velocities, move_filled_cells
    use brz_ranks, only: several
    use brz_text, only: to_text
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: set_up_coupling, couple, restart_coupling

contains

    !> Couple the air and the solids of a case.
    subroutine set_up_coupling(case, air, solid, coupling, err)
        type(case_t), intent(in) :: case
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid
        type(coupling_t), intent(out) :: coupling
        type(error_t), intent(inout) :: err

        if (.not. (air%present .and. solid%present)) return
        if (product(real(air%whole, dp)) > huge(1_int32)) then
            call raise(err, exit_deck, &
                       'the air has more than 2**31 cells: too many for the coupling')
        end if
        if (failed(err)) return
        if (case%coupling%scheme /= 'paper') then
            call refuse_small_periods(air, err)
            if (failed(err)) return
            call judge_spacing(case, air, solid)
        end if
        call couple(air, solid, real(case%coupling%reference_pressure, rk), coupling, &
                    case%coupling%scheme /= 'paper')
        if (coupling%paper) air%activity = .false.
    end subroutine set_up_coupling

    !> Warn of particles that lie too far apart to make a wall.
    subroutine judge_spacing(case, air, solid)
        type(case_t), intent(in) :: case
        type(air_t), intent(in) :: air
        class(bodies_t), intent(inout) :: solid !! its notes
        real(dp), parameter :: widest = 0.7_dp !! spacing, in cells
        real(dp) :: cells
        integer :: b

        do b = 1, size(solid%bodies)
            cells = solid%bodies(b)%spacing/minval(air%dx, air%whole > 1)
            if (cells <= widest) cycle
            solid%notes = solid%notes//label('body', case%bodies(b)%id, case%bodies(b)%place)// &
                'warning: its particles are '//to_text(real(cells, real32))//' cells of the '// &
                "air apart; walls of scheme='cut_cells' may have holes beyond 0.7: take finer "// &
                'particles or larger cells'//new_line('a')
        end do
    end subroutine judge_spacing

    !> Put the walls up where the particles are: cut cells, or those of the paper.
    subroutine couple(air, solid, reference_pressure, coupling, cut)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        real(rk), intent(in) :: reference_pressure !! taken off every load [Pa]
        type(coupling_t), intent(out) :: coupling
        logical, intent(in), optional :: cut !! false: as the paper has it
        type(error_t) :: none !! nothing fails on the host

        if (present(cut)) coupling%paper = .not. cut
        coupling%present = .true.
        coupling%ranks = air%part%ranks
        coupling%n_var = air%n_var
        coupling%reference_pressure = reference_pressure
        coupling%wraps = air%bc(1, :) == bc_periodic .and. air%n > 1
        call make_box(air, coupling)
        associate (lo => 1 - air%g, hi => air%n + air%g)
            allocate (coupling%wall%solid(lo(1):hi(1), lo(2):hi(2), lo(3):hi(3)), source=0_int8)
        end associate
        coupling%wall%present = .true.
        if (.not. coupling%paper) call set_up_cut_cells(air, coupling)
        if (several(solid%ranks)) then
            call open_halos(air, solid, coupling)
            call put_halos(coupling, none)
            call plan_share(air%part%ranks, coupling%part%boxes, coupling%part%halos, air%whole, &
                            coupling%wraps, coupling%wall%share)
        else
            allocate (coupling%cell_of(solid%n))
            allocate (coupling%v_before(3, solid%n), source=0.0_rk)
        end if
        call restart_coupling(air, solid, coupling)
        if (.not. coupling%paper) call mix_clusters(air, coupling, none)
        if (several(solid%ranks)) call see_halo(air)
    end subroutine couple

    !> Refuse a periodic direction in which what belongs to one image of a body would meet what
    !> belongs to the next: clusters, and cells near a particle.
    subroutine refuse_small_periods(air, err)
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        integer, parameter :: least = 8 !! cells

        if (any(air%bc(1, :) == bc_periodic .and. air%whole > 1 .and. air%whole < least)) &
            call raise(err, exit_deck, "the coupling scheme='cut_cells' needs "//to_text(least)// &
                       ' or more cells of the air in a periodic direction')
    end subroutine refuse_small_periods

    !> The box of the air as the loops see it: of several processes the halo of this one.
    subroutine make_box(air, coupling)
        type(air_t), intent(in) :: air
        type(coupling_t), intent(inout) :: coupling
        type(cells_t) :: halo

        halo = cells_t([1, 1, 1], air%n)
        coupling%box%whole = air%n
        if (several(air%part%ranks)) then
            halo = halo_of(air%part, air%part%ranks%rank, air%whole, air%around)
            coupling%box%whole = air%whole
        end if
        coupling%box%n = halo%hi - halo%lo + 1
        coupling%box%before = halo%lo - 1
        coupling%box%own(:, 1) = air%before - coupling%box%before + 1
        coupling%box%own(:, 2) = air%before - coupling%box%before + air%n
        coupling%box%wraps = coupling%wraps
        coupling%box%lo = air%lo
        coupling%box%dx = air%dx
        coupling%box%grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        coupling%box%grid%n = coupling%box%n
        coupling%box%grid%g = air%g - (air%before - coupling%box%before) ! cell 1 of the halo
    end subroutine make_box

    !> Walls as the particles say and, from a checkpoint, their gas as it has that.
    subroutine restart_coupling(air, solid, coupling)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(error_t) :: none

        if (several(solid%ranks)) then
            coupling%part%rebuilds = -1 ! none are listed
            call renew_coupling_ghosts(solid, coupling, none)
            call see_halo(air)
            coupling%cell_of = -1
            call begin_cut_cells(air, solid, coupling%ghost_bodies, coupling%ghosts, coupling, none)
            return
        end if
        coupling%cell_of = -1
        if (coupling%paper) then
            call move_filled_cells(air, solid, coupling)
            call find_filled_velocities(solid, coupling)
        else
            call begin_cut_cells(air, solid, solid, solid, coupling, none)
        end if
    end subroutine restart_coupling
end module brz_coupling_setup
