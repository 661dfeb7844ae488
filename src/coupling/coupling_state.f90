! SPDX-License-Identifier: MIT
!> The state of the coupling, a moving immersed boundary: walls in the air, particles by air cell,
!> cell stores and deferred sources.
!>
!> A solid cell's place in air%u is its cell store: the gas that went through its wall faces, per
!> cell volume. A gas cell may hold a deferred source: gas that belongs to it but is handed over
!> slowly. Gas, cell stores and deferred sources together change only by what leaves the box or
!> reaches the solid.
module brz_coupling_state
    use brz_air_state, only: wall_t
    use brz_driven_body_rules, only: driven_body_t
    use brz_bodies, only: bodies_t
    use brz_cell_shells, only: shells_t
    use brz_column_rules, only: side_of
    use brz_coupling_box, only: box_t
    use brz_coupling_device, only: coupling_device_t, n_sums
    use brz_coupling_part, only: coupling_part_t
    use brz_kinds, only: dp, int32, int64, int8, rk
    use brz_ranks, only: ranks_t
    implicit none
    private
    public :: coupling_t, coupling_diagnostics_t, side_of, sums_in, put_sums
    public :: n_sums

    !> What the air has given to the bodies, and other sums over all steps.
    type :: coupling_diagnostics_t
        real(dp) :: work = 0 !! sum of J.v_w: energy that the air spent on moving walls [J]
        real(dp) :: work_reference = 0 !! part of it that the reference pressure did [J]
        real(dp) :: impulse(3) = 0 !! given to the solid, reference pressure taken off [N s]
        real(dp) :: impulse_reference(3) = 0 !! what was taken off [N s]
        real(dp) :: images(3) = 0 !! momentum that images in planes of symmetry took [N s]
        integer(int64) :: covered = 0, cleared = 0 !! cells
        integer(int64) :: kept = 0 !! buried cell stores that found no taker (counted each step)
        real(rk) :: stored_low = 0 !! least cell store so far, in units of the gas beside it
        real(rk) :: stored_high = 0 !! largest, likewise
    end type coupling_diagnostics_t

    type :: coupling_t
        logical :: present = .false.
        logical :: on_gpu = .false.
        !! it is computed there: walls, velocities before and deferred sources are fetched
        type(coupling_device_t), pointer :: device => null() !! what it has there besides
        type(ranks_t) :: ranks !! of the air
        integer :: n_var = 5 !! conserved variables of the air
        type(box_t) :: box !! of the air
        integer :: outside = 0 !! particles outside the box
        integer(int64) :: rebuilds = -1 !! of the bodies' lists when the particles were sorted
        integer :: n_covered = 0, n_cleared = 0 !! cells that changed hands in this step
        real(rk) :: level = 0 !! part of a difference that neighbouring cell stores exchange
        integer :: n_deferred = 0 !! of gas cells
        integer :: bodies = 0 !! that may carry particles
        real(dp) :: dt_before = 0 !! last step of the air, 0: none yet [s]
        type(coupling_diagnostics_t) :: diagnostics
        logical :: paper = .false. !! as the paper prints it, see brz_coupling_paper
        real(rk) :: spread = 1.5_rk !! depth over which a load is spread, in air cells
        real(rk) :: reference_pressure = 0 !! taken off every load [Pa]
        logical :: wraps(3) = .false. !! periodic directions of the air
        type(wall_t) :: wall
        integer(int32), allocatable :: cell(:) !! (n_cells) number of each solid cell
        integer(int32), allocatable :: gas(:), rows(:) !! (n_faces) gas cell, row of face_of
        type(shells_t) :: shells !! neighbours of a cell in order of distance
        integer(int8), allocatable :: mark(:, :, :) !! (cells of the box) map being built; then the
                                                    !! donors
        ! several processes: what this one sees of the bodies, and what it has to do with others
        type(bodies_t), allocatable :: ghosts !! copies of the particles near the cells of the box
        type(bodies_t) :: ghost_bodies !! their bodies
        type(coupling_part_t) :: part
        ! particles by air cell
        integer(int32), allocatable :: cell_of(:) !! (particles) number of the air cell, 0: outside
        integer(int32), allocatable :: place_of(:) !! (particles) place of it in the wall list
        integer(int32), allocatable :: ends(:) !! (n_cells+1) last of the cell before in `binned`
        integer(int32), allocatable :: binned(:) !! (particles) particles, cell by cell
        integer(int32), allocatable :: above(:, :)
        !! (6, n_cells) face that begins the column of a cell and is near enough to load it, or 0
        integer(int32), allocatable :: cleared(:) !! in this step, by number of the cell
        integer(int32), allocatable :: listed(:) !! cells of a kind, to take another's place
        ! donors: cells whose gas goes to cell stores nearby; the cleared first, then the buried
        integer(int32), allocatable :: donor(:) !! (n_donors) number of the cell
        integer(int32), allocatable :: donor_shell(:) !! (n_donors) shell of the receivers, or 0
        real(rk), allocatable :: donation(:, :) !! (max_var, n_donors) share of each receiver
        real(rk), allocatable :: stored(:, :) !! (max_var, n_cells) copy; or what a face hands over
        real(rk), allocatable :: excess(:) !! (n_cells) part of a cell store to be moved to deferred
                                           !! sources
        integer(int32), allocatable :: slot(:, :, :) !! (cells of the box) place among the deferred
                                                     !! sources, 0
        integer(int32), allocatable :: deferred_cell(:) !! (n_deferred) number of the cell
        real(rk), allocatable :: deferred(:, :) !! (n_var, n_deferred) per cell volume, as air%u
        integer(int32), allocatable :: next_cell(:) !! room for the list without what is released
        real(rk), allocatable :: next_deferred(:, :)
        integer(int32), allocatable :: start(:) !! counts that become places in lists
        ! loads
        type(driven_body_t), allocatable :: driven(:) !! (bodies) how those move that carry
                                                      !! particles
        real(dp), allocatable :: shift(:, :) !! (3, bodies) mass times the way to middles of cells,
                                             !! summed over the particles of a rigid body [kg m]
        integer(int32), allocatable :: felt(:) !! (bodies) 1: has a load beyond rounding
        real(rk), allocatable :: v_before(:, :) !! (3, particles by id) velocity a step before [m/s]
        real(dp), allocatable :: surface(:) !! (n_faces) outermost particle behind the face [m]
        real(rk), allocatable :: weight(:) !! (n_faces) sum of the weights in the column [kg]
        real(rk), allocatable :: force(:) !! (n_faces) on the solid, along the axis, gauge [N]
        real(rk), allocatable :: impedance(:) !! (n_faces) loss of force per velocity [N s/m]
    end type coupling_t

contains

    !> Work and impulses of the diagnostics in a row, in the order of the columns on a GPU.
    pure function sums_in(diagnostics) result(sums)
        type(coupling_diagnostics_t), intent(in) :: diagnostics
        real(dp) :: sums(n_sums)

        sums = [diagnostics%work, diagnostics%work_reference, diagnostics%impulse, &
                diagnostics%impulse_reference, diagnostics%images]
    end function sums_in

    !> The same from a row.
    pure subroutine put_sums(sums, diagnostics)
        real(dp), intent(in) :: sums(n_sums)
        type(coupling_diagnostics_t), intent(inout) :: diagnostics

        diagnostics%work = sums(1)
        diagnostics%work_reference = sums(2)
        diagnostics%impulse = sums(3:5)
        diagnostics%impulse_reference = sums(6:8)
        diagnostics%images = sums(9:11)
    end subroutine put_sums
end module brz_coupling_state
