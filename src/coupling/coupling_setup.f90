! SPDX-License-Identifier: MIT
!> Start of the coupling: walls from the particles at time zero, empty cell stores, no deferred
!> sources.
module brz_coupling_setup
    use brz_air_state, only: air_t, bc_periodic, bc_symmetry, bc_wall
    use brz_air_walls, only: set_up_walls
    use brz_air_grid, only: grid_of
    use brz_air_part, only: halo_of
    use brz_boxes, only: cells_t
    use brz_case, only: case_t, label
    use brz_cell_shells, only: make_shells
    use brz_coupling_box, only: box_t
    use brz_coupling_ghosts, only: open_halos
    use brz_coupling_state, only: coupling_t
    use brz_coupling_driver, only: move_walls
    use brz_coupling_windows, only: see_halo
    use brz_cut_driver, only: mix_clusters
    use brz_cut_share, only: plan_share
    use brz_cut_start_driver, only: begin_cut_cells, set_up_cut_cells
    use brz_deferred_source_driver, only: enter_deferred_sources, size_deferred_sources
    use brz_errors, only: error_t, exit_deck, failed, raise
    use brz_reclassification_driver, only: put_up_walls
    use brz_face_stress, only: spread_shares
    use brz_coupling_ghost_driver, only: renew_coupling_ghosts
    use brz_kinds, only: dp, int32, real32, rk
    use brz_positivity, only: floors_of
    use brz_ranks, only: several
    use brz_shared_driver, only: put_halos
    use brz_text, only: to_text
    use brz_particles, only: particles_t
    use brz_bodies, only: bodies_t
    use brz_listed_bodies, only: listed_bodies_t
    implicit none
    private
    public :: set_up_coupling, couple, restart_coupling, make_box, empty_part

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
        if (case%coupling%scheme == 'cut_cells') then
            call refuse_small_periods(air, err)
            if (failed(err)) return
            call judge_spacing(case, air, solid)
        end if
        call couple(air, solid, real(case%coupling%spread, rk), &
                    real(case%coupling%reference_pressure, rk), coupling, &
                    case%coupling%scheme == 'cut_cells')
        coupling%paper = case%coupling%scheme == 'paper'
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

    !> Put the walls up where the particles are. What gas was there is taken out.
    subroutine couple(air, solid, spread, reference_pressure, coupling, cut)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        real(rk), intent(in) :: spread !! depth over which a load is spread, in air cells
        real(rk), intent(in) :: reference_pressure !! taken off every load [Pa]
        type(coupling_t), intent(out) :: coupling
        logical, intent(in), optional :: cut !! by cut cells
        type(error_t) :: none !! nothing fails on the host
        integer :: n(3)
        logical :: by_cut_cells

        by_cut_cells = .false.
        if (present(cut)) by_cut_cells = cut
        coupling%present = .true.
        coupling%ranks = air%part%ranks
        coupling%n_var = air%n_var
        coupling%spread = spread
        coupling%reference_pressure = reference_pressure
        coupling%wraps = air%bc(1, :) == bc_periodic .and. air%n > 1
        call make_box(air, coupling)
        call lay_layers(coupling%box, solid)
        call make_shells(coupling%box%whole, coupling%shells)
        if (coupling%shells%n >= 3 .and. count(coupling%box%whole > 1) > 1) &
            coupling%level = 1/3.0_rk**count(coupling%box%whole > 1)
        n = coupling%box%n
        if (by_cut_cells) n = 1 ! neither cell stores nor deferred sources
        allocate (coupling%mark(n(1), n(2), n(3)), coupling%slot(n(1), n(2), n(3)))
        call set_up_walls(air, coupling%wall)
        coupling%wall%stops = .not. coupling%paper
        coupling%wall%lo = 1 - (air%before - coupling%box%before)
        coupling%wall%hi = coupling%wall%lo + coupling%box%n - 1
        if (by_cut_cells) call set_up_cut_cells(air, coupling)
        if (several(solid%ranks)) then
            call open_halos(air, solid, coupling)
            call put_halos(coupling, none)
            if (by_cut_cells) call plan_share(air%part%ranks, coupling%part%boxes, &
                coupling%part%halos, air%whole, coupling%wraps, coupling%wall%share)
            call restart_coupling(air, solid, coupling)
            if (by_cut_cells) then
                call mix_clusters(air, coupling, none)
            else
                call empty_walls(air, coupling%ghosts, coupling)
            end if
            call see_halo(air, coupling, .false., none)
        else
            allocate (coupling%cell_of(solid%n), coupling%place_of(solid%n), &
                      coupling%binned(solid%n))
            allocate (coupling%v_before(3, solid%n), source=0.0_rk)
            call restart_coupling(air, solid, coupling)
            if (by_cut_cells) then
                call mix_clusters(air, coupling, none)
            else
                call empty_walls(air, solid, coupling)
            end if
        end if
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

    !> Take out of the surface cells what gas the particles leave no room for, all of the others.
    subroutine empty_walls(air, solid, coupling)
        type(air_t), intent(inout) :: air
        class(particles_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer :: c, ijk(3)

        do c = 1, coupling%wall%n_cells
            ijk = coupling%wall%cell(:, c)
            air%u(ijk(1), ijk(2), ijk(3), :) = empty_part(air, solid, coupling, c) &
                                               *air%u(ijk(1), ijk(2), ijk(3), :)
        end do
    end subroutine empty_walls

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
        coupling%box%cells = product(coupling%box%n)
        coupling%box%n_var = air%n_var
        coupling%box%layers = ceiling(coupling%spread)
        call find_ends(air%outer == bc_wall, halo, coupling%box%whole, coupling%box%closed)
        call find_ends(air%outer == bc_symmetry, halo, coupling%box%whole, coupling%box%mirrors)
        coupling%box%wraps = coupling%wraps
        coupling%box%floors = floors_of(.true., air%scheme%gamma, air%rho_rest, air%p_rest)
        coupling%box%spread = coupling%spread
        coupling%box%reference = coupling%reference_pressure
        coupling%box%lo = air%lo
        coupling%box%dx = air%dx
        coupling%box%area = product(air%dx)/air%dx
        coupling%box%grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        coupling%box%grid%n = coupling%box%n
        coupling%box%grid%g = air%g - (air%before - coupling%box%before) ! cell 1 of the halo
    end subroutine make_box

    !> The lattices of bodies under the faces of the air.
    subroutine lay_layers(box, solid)
        type(box_t), intent(in) :: box
        class(bodies_t), intent(inout) :: solid
        real(dp) :: per_cell(3)
        integer :: b, d, k

        if (.not. allocated(solid%bodies)) return
        do b = 1, size(solid%bodies)
            associate (body => solid%bodies(b), layers => solid%bodies(b)%layers)
                if (.not. body%face_share > 0) cycle
                layers%share = body%face_share
                layers%apart = real(body%spacing/body%stretch, rk)
                per_cell = 1
                where (box%whole > 1) per_cell = box%dx/layers%apart
                layers%across = real(product(per_cell)/per_cell, rk)
                do d = 1, 3
                    if (box%whole(d) == 1) cycle
                    layers%range(d) = real(box%spread*per_cell(d), rk)
                    layers%whole(d) = real(sum([(max(1 - k/layers%range(d), 0.0_rk), &
                                                 k=0, int(layers%range(d)))]), rk)
                    layers%more(:, d) = spread_shares(solid%dimension, &
                        real(body%h/body%spacing, dp), real(layers%range(d), dp))
                end do
            end associate
        end do
    end subroutine lay_layers

    !> Ends of a halo that are ends of a kind of the grid, in the directions that are modelled.
    pure subroutine find_ends(outer, halo, whole, ends)
        logical, intent(in) :: outer(2, 3) !! ends of the grid
        type(cells_t), intent(in) :: halo
        integer, intent(in) :: whole(3) !! cells of the grid
        logical, intent(out) :: ends(2, 3)

        ends(1, :) = outer(1, :) .and. halo%lo == 1 .and. whole > 1
        ends(2, :) = outer(2, :) .and. halo%hi == whole .and. whole > 1
    end subroutine find_ends

    !> Part of a surface cell that its particles do not fill: its gas is where the cell store
    !> starts.
    !>
    !> A body that moves leaves and covers gas a cell at a time; without this its cell stores would
    !> lack, all the way, what was there at the start.
    pure real(rk) function empty_part(air, solid, coupling, c)
        type(air_t), intent(in) :: air
        class(particles_t), intent(in) :: solid
        type(coupling_t), intent(in) :: coupling
        integer, intent(in) :: c !! place in the wall list
        real(dp) :: full
        integer :: i

        empty_part = 0
        if (.not. any(coupling%wall%face_of(:, c) > 0)) return
        full = 0
        do i = coupling%ends(c) + 1, coupling%ends(c + 1)
            full = full + solid%volume(coupling%binned(i))
        end do
        empty_part = real(max(1 - full/product(air%dx), 0.0_dp), rk)
    end function empty_part

    !> Walls, bins and the map of deferred sources as the particles and the list of deferred sources
    !> say.
    subroutine restart_coupling(air, solid, coupling)
        type(air_t), intent(inout) :: air
        class(listed_bodies_t), intent(inout) :: solid !! read
        type(coupling_t), intent(inout) :: coupling
        type(error_t) :: none

        if (several(solid%ranks)) then
            coupling%part%rebuilds = -1 ! none are listed
            call renew_coupling_ghosts(solid, coupling, none)
            call see_halo(air, coupling, .false., none)
            call begin_walls(air, solid, coupling%ghost_bodies, coupling%ghosts, coupling)
        else
            call begin_walls(air, solid, solid, solid, coupling)
        end if
    end subroutine restart_coupling

    subroutine begin_walls(air, all, solid, p, coupling)
        type(air_t), intent(inout) :: air
        class(bodies_t), intent(in) :: all !! particles of this process
        class(bodies_t), intent(in) :: solid !! bodies of those that it sees
        class(bodies_t), intent(in) :: p !! these particles
        type(coupling_t), intent(inout) :: coupling
        type(error_t) :: none

        coupling%cell_of = -1
        if (coupling%wall%cells%present) then
            call begin_cut_cells(air, all, solid, p, coupling, none)
            return
        end if
        ! from none: a checkpoint has a map, and not the lists that belong to it
        coupling%wall%n_cells = 0
        coupling%wall%solid = 0
        coupling%wall%index = 0
        call put_up_walls(air, p, coupling, none)
        coupling%rebuilds = solid%rebuilds
        call move_walls(solid, p, coupling, none)
        coupling%slot = 0
        call size_deferred_sources(coupling, 0, none)
        call enter_deferred_sources(coupling, none)
    end subroutine begin_walls
end module brz_coupling_setup
