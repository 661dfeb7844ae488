! SPDX-License-Identifier: MIT
!> The state of the air: conserved variables on a Cartesian grid, and the walls inside it.
module brz_air_state
    use brz_kinds, only: dp, int8, int64, rk
    implicit none
    private
    public :: air_t, wall_t, n_ghost
    public :: bc_outflow, bc_wall, bc_symmetry, bc_periodic

    integer, parameter :: n_ghost = 2 !! ghost layers in a direction that is modelled
    integer, parameter :: bc_outflow = 1, bc_wall = 2, bc_symmetry = 3, bc_periodic = 4

    !> Conserved variables are density, momentum x, y, z [kg/(m2 s)] and total energy per volume.
    !> Arrays run over (1-g1:n1+g1, 1-g2:n2+g2, 1-g3:n3+g3, 5) with g = n_ghost where n > 1, else 0.
    type :: air_t
        logical :: present = .false.
        integer :: n(3) = 1 !! cells; 1: direction not modelled
        integer :: g(3) = 0 !! ghost layers
        real(dp) :: lo(3) = 0 !! low corner [m]
        real(dp) :: dx(3) = 1 !! cell sides [m]
        integer :: bc(2, 3) = bc_outflow !! (low/high, direction)
        integer :: order = 3 !! 1: first order, 3: WENO3
        logical :: fallback = .true.
        real(rk) :: gamma = 1.4_rk
        real(rk) :: rho_rest = 1.225_rk, p_rest = 101325 !! undisturbed air
        real(rk), allocatable :: u(:, :, :, :) !! conserved variables; in solid cells the ledger
        real(rk), allocatable :: u_start(:, :, :, :) !! u at the start of the step (interior)
        real(rk), allocatable :: rate(:, :, :, :) !! du/dt of the stage (interior)
        integer(int64) :: fallback_faces = 0 !! faces that fell back to first order, all steps
        real(dp) :: outflow(5) = 0 !! mass, momentum, energy that left through the outer faces, all steps
    end type air_t

    !> Cells that hold solid, and the faces between them and the gas. The coupling fills `solid` and
    !> `v`; the lists are derived by `build_walls`; the air step adds up `impulse`.
    type :: wall_t
        logical :: present = .false.
        integer(int8), allocatable :: solid(:, :, :) !! 1 in cells that hold solid, ghosts included
        integer, allocatable :: index(:, :, :) !! place of a solid cell in the list, 0 for gas; ghosts hold that of their image
        integer :: n_cells = 0
        integer, allocatable :: cell(:, :) !! (3, n_cells) indices of the solid cells
        real(rk), allocatable :: v(:, :) !! (3, n_cells) wall velocity of this step [m/s]
        integer :: n_faces = 0
        integer, allocatable :: face(:, :) !! (5, n_faces): i, j, k of the gas cell, direction 1..3, side (+1: solid above, -1: solid below)
        integer, allocatable :: face_cell(:) !! (n_faces) place of the solid cell in the list
        real(rk), allocatable :: impulse(:) !! (n_faces) integral of p* A dt over the step, along the side [N s]
    end type wall_t
end module brz_air_state
