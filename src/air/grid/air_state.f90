! SPDX-License-Identifier: MIT
!> The state of the air: conserved variables on a Cartesian grid, and the bodies in it.
module brz_air_state
    use brz_air_device, only: air_device_t
    use brz_air_grid, only: brick, grid_t
    use brz_air_part, only: air_part_t
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_share, only: cut_share_t
    use brz_boundary_codes, only: bc_inside, bc_outflow, bc_periodic, bc_symmetry, bc_wall
    use brz_inflow_history, only: inflow_t
    use brz_kinds, only: dp, int8, int32, int64, rk
    use brz_total_state, only: running_total_t
    use brz_scheme, only: hllc, max_var, mixture_gamma, scheme_t
    implicit none
    private
    public :: air_t, wall_t, filled_t, met_t, sweep_work_t, charge_report_t
    public :: n_ghost, lines_per_block, brick
    public :: cell_centre, cell_gamma, set_scale
    public :: bc_outflow, bc_wall, bc_symmetry, bc_periodic, bc_inside
    public :: air_ok, air_unphysical

    integer, parameter :: n_ghost = 3 !! ghost layers in a direction that is modelled
    integer, parameter :: lines_per_block = 16
    !! lines of cells that are swept together, the vector dimension
    integer, parameter :: air_ok = 0 !! status of a step: done
    integer, parameter :: air_unphysical = 1
    !! a density or pressure that is not positive, or NaN, in spite of the fallback

    !> Buffers of one thread for a block of lines.
    type :: sweep_work_t
        real(rk), allocatable :: q(:, :, :)
        !! (lines, n_var, 1-n_ghost:n+n_ghost) conserved variables, normal momentum in slot 2
        real(rk), allocatable :: f(:, :, :) !! (lines, n_var, 0:n) fluxes, then rates
        real(rk), allocatable :: ends(:, :, :) !! (lines, n_var, 2) fluxes through the outer faces
    end type sweep_work_t

    !> What became of a charge on the grid.
    type :: charge_report_t
        real(dp) :: radius = 0 !! half of the shortest side or diameter [m]
        real(dp) :: cells = 0 !! cells across it
        real(dp) :: mass = 0
        !! inside the box: the whole charge less what symmetry planes cut off [kg]
        real(dp) :: lost = 0 !! of that mass, in cells that bodies fill [kg]
        real(dp) :: scale = 1 !! factor on the density that makes the mass exact
    end type charge_report_t

    !> Conserved variables are density, momentum x, y, z [kg/(m2 s)] and total energy per volume,
    !> and where n_var = 6 the density of the products of explosives, rho Y. Arrays run over
    !> (1-g1:n1+g1, 1-g2:n2+g2, 1-g3:n3+g3, n_var) with g = n_ghost where n > 1, else 0. On several
    !> processes with bodies there are `around` layers instead.
    type :: air_t
        logical :: present = .false.
        integer :: n(3) = 1 !! cells; 1: direction not modelled
        integer :: whole(3) = 1 !! cells of the grid; n are those of the box of this process
        integer :: before(3) = 0 !! cells of the grid before the box
        integer :: g(3) = 0 !! layers of ghosts and of cells of others in the arrays
        integer :: around = 0 !! of them, as far as the coupling looks into boxes of others
        real(dp) :: lo(3) = 0 !! low corner of the grid [m]
        real(dp) :: dx(3) = 1 !! cell sides [m]
        integer :: bc(2, 3) = bc_outflow !! (low/high, direction)
        integer :: outer(2, 3) = bc_outflow !! the same of the whole grid
        type(air_part_t) :: part !! the processes that share the grid
        integer :: n_var = 5 !! conserved variables; 6 if a charge has a gas of its own
        type(scheme_t) :: scheme !! reconstruction, flux, gases
        integer :: n_stages = 3 !! of the Runge-Kutta method: 2 or 3
        logical :: fallback = .true.
        real(rk) :: rho_rest = 1.225_rk, p_rest = 101325 !! undisturbed air
        real(rk) :: rest(max_var) = 0 !! its conserved variables
        real(rk), allocatable :: outside(:, :, :)
        !! (lines, n_var, low/high) gas beyond open boundaries, see grid_t: that of the cells next
        !! to them before anything happened
        type(inflow_t), allocatable :: inflow(:) !! gas outside that changes; none if not allocated
        logical :: on_gpu = .false. !! it is computed there; the arrays below are fetched
        type(air_device_t), pointer :: device => null() !! what it has there besides
        logical :: activity = .false. !! leave out what nothing has reached
        real(rk), allocatable :: u(:, :, :, :) !! conserved variables
        real(rk), allocatable :: u_start(:, :, :, :) !! u at the start of the step (ghosts unused)
        real(rk), allocatable :: rate(:, :, :, :)
        !! du/dt of the stage (ghosts unused: all three alike, so that one index serves)
        integer(int64) :: fallback_faces = 0
        !! faces that fell back to first order, all stages of all steps
        integer(int64) :: limited_cells = 0
        !! cells held because first order did not save them, all stages of all steps
        real(dp) :: outflow(5) = 0
        !! mass, momentum, energy that left through the outer faces, all steps
        real(dp) :: outflow_products = 0 !! mass of products that left likewise [kg]
        type(running_total_t) :: left(6) !! both, exactly: of this process, on the CPU
        type(charge_report_t), allocatable :: charge(:) !! one for each &charge
        integer :: bad_cell(3) = 0 !! first unphysical cell of the grid in a step that failed
        real(rk) :: bad_state(5) = 0 !! what its conserved variables would have become
        integer(int8), allocatable :: reached(:, :, :) !! (bricks) 1: something has reached it
        integer(int8), allocatable :: active(:, :, :)
        !! (bricks) 1: it is computed; who changes u between two steps far from all solid sets all
        !! to 1, for air_time_step
        ! work arrays of the sweeps; nothing outside a step reads them
        type(sweep_work_t), allocatable :: work(:) !! (0:threads-1)
        real(rk), allocatable :: edge(:, :, :)
        !! (lines, n_var, low/high) fluxes of a stage through the outer faces, see grid_t
        real(dp), allocatable :: brick_sum(:, :) !! (0:n_var, bricks) totals of bricks
        real(dp), allocatable :: leaving(:, :, :)
        !! (faces of bricks at one end, n_var, low/high) what leaves in a stage
        integer, allocatable :: suspect(:)
        !! (blocks) cells of a block whose next state looks unphysical
        integer(int8), allocatable :: bad(:, :, :) !! marks of a stage, see brz_fallback_loop_bodies
        integer :: found(1) = 0 !! 1: a cell has been marked
        type(grid_t), allocatable :: grid !! as set_grid has it, in steps
        logical :: swept = .false. !! a step has been made: a first one on a GPU is computed
                                   !! everywhere, so that all states and fluxes hold gas at rest
    end type air_t

    !> Cells that hold particles, of the coupling as printed, see brz_paper_cells.
    type :: filled_t
        integer :: n = 0
        integer(int64) :: rebuilds = -1 !! of the bodies' lists when it was made
        integer, allocatable :: cell(:, :) !! (3, n) indices
        integer, allocatable :: place(:) !! (cells) place in the list, 0: gas
        logical, allocatable :: touches(:) !! (n) gas is beside it
        real(rk), allocatable :: v(:, :) !! (3, n) mean velocity of the particles [m/s]
        integer(int32), allocatable :: ends(:) !! (n+1) last of the cell before in `binned`
        integer(int32), allocatable :: binned(:) !! particles, cell by cell
    end type filled_t

    !> What stands at the walls of some cells, for gauges: asked for anew when these look.
    type :: met_t
        integer :: n = 0 !! cells that are asked for
        integer, allocatable :: cell(:, :) !! (3, n) their indices
        integer(int32), allocatable :: place(:, :, :) !! (cells of the air) in the list, 0: not
        integer(int32), allocatable :: number(:) !! (n) in the grid of nodes, 0: none
        real(rk), allocatable :: state(:, :)
        !! (n_met, n) density, velocity and pressure at the walls; area of these [m2], 0: none;
        !! their distance from the centre of the cell, in cells across them, and what that falls by
        !! for each cell along x, y and z
    end type met_t

    !> Bodies in the air.
    type :: wall_t
        logical :: present = .false.
        integer(int8), allocatable :: solid(:, :, :)
        !! 1 in cells without gas, or that hold particles as the paper has them
        type(cut_cells_t) :: cells
        type(cut_share_t) :: share !! of cut cells with other processes
        type(met_t) :: met !! at gauges
        type(filled_t) :: filled !! in place of cut cells, as the paper has them
    end type wall_t

contains

    !> Centre of a cell of the box [m].
    pure function cell_centre(air, i, j, k) result(x)
        type(air_t), intent(in) :: air
        integer, intent(in) :: i, j, k !! cell
        real(dp) :: x(3)

        x = air%lo + (air%before + [i, j, k] - 0.5_dp)*air%dx
    end function cell_centre

    !> Ratio of specific heats of the gas in a cell [-].
    pure real(rk) function cell_gamma(air, i, j, k)
        type(air_t), intent(in) :: air
        integer, intent(in) :: i, j, k !! cell

        cell_gamma = air%scheme%gamma
        if (air%scheme%mixture) cell_gamma = mixture_gamma(air%scheme, &
            air%u(i, j, k, 6)/air%u(i, j, k, 1))
    end function cell_gamma

    !> 1/(typical value)^2 of what is reconstructed, from the undisturbed air: fluxes of mass,
    !> momentum and energy; or density, velocity and pressure.
    pure subroutine set_scale(air)
        type(air_t), intent(inout) :: air
        real(rk) :: c

        c = sqrt(air%scheme%gamma*air%p_rest/air%rho_rest)
        if (air%scheme%flux == hllc) then
            air%scheme%scale = [1/air%rho_rest**2, 1/c**2, 1/c**2, 1/c**2, 1/air%p_rest**2]
            return
        end if
        air%scheme%scale(1) = 1/(air%rho_rest*c)**2
        air%scheme%scale(2:4) = 1/(air%rho_rest*c*c)**2
        air%scheme%scale(5) = 1/(air%rho_rest*c*c*c)**2
    end subroutine set_scale
end module brz_air_state
