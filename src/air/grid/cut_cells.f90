! SPDX-License-Identifier: MIT
!> Cut cells: the cells of the air near bodies, whose faces are open in part and which hold gas in
!> part. Plain data.
!>
!> The list has all cells within `near` cells of one that holds particles, in memory order of the
!> grid of nodes: entry s is the cell with that number, and the node at its low corner. At the high
!> end of a direction there is one more node than cells; an entry there is a node alone. Round a
!> periodic direction there is none: the nodes at both ends are the same. All other cells are gas
!> with open faces. Of several processes each has a list of its halo, whose entries in
!> the boxes of others hold what these have found, see brz_cut_share.
!>
!> Lengths, areas and volumes in arrays are in cells, and faces go by 2d - 1 (low) and 2d (high).
module brz_cut_cells
    use brz_air_grid, only: grid_t
    use brz_kinds, only: dp, int32, int64, int8, rk
    implicit none
    private
    public :: cut_before_t, cut_cells_t, layers_t, node_grid_t, near, bare, at_corner, n_met
    public :: list_bytes, of_plane, see_image, ring_of_loads, ring_of_stress

    integer, parameter :: near = 3 !! cells round one with particles that are listed
    integer, parameter :: at_corner = 7 !! sums of the particles of a cell at a corner of it
    integer, parameter :: of_plane = 1, of_wall = 2 !! images beyond a plane of symmetry, a wall
    integer, parameter :: ring_of_loads = 2 !! cells from a wall of particles that bear its load
    integer, parameter :: ring_of_stress = 4 !! of those that have the stress of it
    real(rk), parameter :: bare = 1e-12_rk !! wall area that counts as none, in faces
    integer, parameter :: n_met = 10 !! numbers of what stands at the walls of a cell, see met_t
    ! numbers that are kept of an entry, and what lists have room for beyond their entries
    integer, parameter :: doubles = 38 + 8*at_corner, reals = 141, integers = 34
    real(dp), parameter :: slack = 1.25_dp

    !> The grid of nodes, and how cells lie in memory.
    type :: node_grid_t
        integer :: n(3) = 1 !! nodes; 1 where a direction is not modelled
        integer :: cells(3) = 1
        integer :: whole(3) = 1 !! cells of the grid
        integer :: before(3) = 0 !! cells of the grid before the first: on several processes the box
                                 !! is a halo
        integer :: own(3, 2) = 1 !! first and last cell of this process
        logical :: mirrors(2, 3) = .false. !! a plane of symmetry is at this end of the grid
        logical :: closed(2, 3) = .false. !! a wall is at this end
        logical :: wraps(3) = .false. !! periodic directions, whole in the box of each process
        integer :: dimensions = 0 !! directions that are modelled
        real(dp) :: lo(3) = 0 !! low corner of the grid [m]
        real(dp) :: dx(3) = 1 !! sides of a cell [m]
        real(dp) :: inverse_dx(3) = 1 !! [1/m]
        real(rk) :: area(3) = 1 !! of the faces normal to each direction [m2]
        real(rk) :: volume = 1 !! of a cell [m3]
        type(grid_t) :: grid !! of the air
    end type node_grid_t

    !> Layers of the particles of a body.
    type :: layers_t
        real(dp) :: apart(3) = 1 !! distances of them along each direction [m]
    end type layers_t

    !> The list before bodies moved, or what a checkpoint has of it.
    type :: cut_before_t
        integer :: n = 0
        integer(int32), allocatable :: cell(:), shut(:), master(:)
        real(rk), allocatable :: aperture(:, :), volume(:), swept(:), kept(:, :)
    end type cut_before_t

    type :: cut_cells_t
        logical :: present = .false.
        type(node_grid_t) :: nodes
        integer :: n = 0 !! entries of the list
        integer(int64) :: rebuilds = -1 !! of the bodies' lists when it was made
        integer(int32), allocatable :: slot(:) !! (nodes) place in the list, 0: not listed
        integer(int8), allocatable :: mark(:) !! (nodes) work map of a new list
        integer(int8), allocatable :: next_mark(:)
        integer(int32), allocatable :: cell(:) !! (n) number in the grid of nodes
        integer(int32), allocatable :: place(:) !! (n) among the cells of the air; 0: a node alone
        integer(int32), allocatable :: beside(:, :) !! (6, n) entry across each face, 0: not listed
        ! nodes
        real(dp), allocatable :: sums(:, :) !! (8 at_corner, n) of the particles at corners
        integer(int32), allocatable :: top(:, :) !! (8, n) heaviest of them, 0: none
        real(rk), allocatable :: fill(:) !! (n) share of volume that particles fill
        real(dp), allocatable :: mass(:) !! (n) of the particles near it, by tent weights [kg]
        real(dp), allocatable :: momentum(:, :) !! (3, n) likewise [kg m/s]
        real(rk), allocatable :: above(:, :) !! (3, n) part of the mass above the node [kg]
        real(dp), allocatable :: pushes(:, :) !! (24, n) see cut_push_corner
        real(rk), allocatable :: smooth(:), next_smooth(:) !! (n) fill, smoothed
        real(rk), allocatable :: normal(:, :) !! (3, n) of it, out of the solid
        real(rk), allocatable :: sag(:) !! (n) of facets below a curved wall
        real(rk), allocatable :: octants(:, :) !! (8, n) distance by octants about the node
        real(rk), allocatable :: distance(:) !! (n) signed distance to the wall, + in the gas
        real(rk), allocatable :: thickest(:) !! (n) largest interpolated fill in the cell
        real(rk), allocatable :: thickness(:) !! (n) likewise with the cells around
        real(rk), allocatable :: ball(:) !! (n) largest radius of a ball of a thin part in the cell
        integer(int32), allocatable :: heaviest(:) !! (n) particle of the most mass there, 0: none
        real(dp), allocatable :: force(:, :) !! (3, n) load that the node hands to particles [N]
        real(rk), allocatable :: from_low(:, :) !! (3, n) of that from gas on the low side [N]
        real(rk), allocatable :: faces(:, :) !! (6, n) area of walls that it bears, see cut_bear
        real(rk), allocatable :: deeper(:, :), in_line(:, :) !! (6, n) see cut_sum_lines
        real(dp), allocatable :: moment(:, :) !! (3, n) its torque about the low corner [N m]
        real(dp), allocatable :: impedance(:, :) !! (3, n) loss of force of a node per velocity
                                                 !! [N s/m]
        real(dp), allocatable :: bearing(:) !! (n) mass of the nodes that bear the load of the cell,
                                            !! < 0: those around it [kg]
        ! cells
        real(rk), allocatable :: gas(:) !! (n) share of gas by geometry; 0: shut
        integer(int32), allocatable :: shut(:) !! (n) 1: no face of it is open
        real(rk), allocatable :: aperture(:, :) !! (6, n) open share of each face
        real(rk), allocatable :: middle(:, :) !! (3, n) of the wall, from the low corner
        real(rk), allocatable :: curvature(:, :) !! (6, n) of the wall [1/m], see cut_find_curvature
        real(rk), allocatable :: area(:, :) !! (3, n) of the wall, out of the gas [m2]
        integer(int32), allocatable :: ring(:) !! (n) cells to the nearest wall, see cut_widen_ring
        integer(int32), allocatable :: next_ring(:)
        real(rk), allocatable :: v(:, :) !! (3, n) velocity of the wall [m/s]
        real(rk), allocatable :: press(:, :) !! (3, n) force on the wall if it keeps its motion [N]
        real(rk), allocatable :: give(:, :) !! (3, n) loss of it per velocity [N s/m]
        integer(int32), allocatable :: carrier(:) !! (n) body that carries the wall, 0: none
        integer(int32), allocatable :: turns(:, :) !! (3, n) periods to its image there
        real(rk), allocatable :: volume(:) !! (n) of the gas, integrated
        real(rk), allocatable :: held(:) !! (n) gas by which clusters are made
        real(rk), allocatable :: swept(:) !! (n) what it gains in the step
        integer(int32), allocatable :: master(:) !! (n) entry whose cluster it belongs to
        integer(int32), allocatable :: next_master(:)
        integer(int32), allocatable :: ends(:), member(:) !! entries by their master
        real(rk), allocatable :: kept(:, :) !! (max_var + 1, n) content of cells without gas that
                                            !! waits, and its volume, over that of a cell
        ! what goes over to new shapes
        type(cut_before_t) :: before
        logical :: resumes = .false. !! `before` is from a checkpoint
        integer(int32), allocatable :: from(:), band(:), takers(:)
        real(rk), allocatable :: content(:, :), was_open(:, :), opening(:), off(:), flow(:, :)
        integer :: slowed = 0, pockets = 0, absorbed = 0 !! clusters, cells so far
        ! a stage
        real(rk), allocatable :: rate(:, :) !! (n_var, n) of the content over the volume of a cell
        real(rk), allocatable :: joined(:, :) !! (n_var, n) rate of the state, of the whole cluster
        real(rk), allocatable :: euler(:, :) !! (max_var, n) Euler step of the cluster
        real(rk), allocatable :: push(:, :) !! (3, n) impulse on the wall in the stage [N s]
        real(rk), allocatable :: impulse(:, :) !! (3, n) likewise in the step
        ! particles
        integer(int32), allocatable :: home(:) !! (particles) entry of its cell, 0: outside
        real(dp) :: whereabouts(2) = -1 !! of the particles of several processes, hashed
        integer(int32), allocatable :: bin_ends(:), binned(:) !! particles by entry
        real(rk), allocatable :: change(:, :) !! (3, particles) see cut_push_particle [kg m/s]
        real(rk), allocatable :: radius(:) !! (particles) of the ball of a thin part, 0: none
    end type cut_cells_t

contains

    !> Memory of a list [B].
    pure real(dp) function list_bytes(n)
        real(dp), intent(in) :: n !! entries

        list_bytes = slack*n*(8*doubles + storage_size(1.0_rk)/8*reals + 4*integers)
    end function list_bytes

    !> Index of a node, or a cell, along a direction or, beyond a plane of symmetry or a wall, of
    !> its image. What bodies carry is turned in the former. Beside a wall a body goes on as if it
    !> moved along, so that it bears its load evenly and the wall takes none of it.
    !@cuf attributes(host,device) &
    pure subroutine see_image(nodes, d, last, index, image)
        type(node_grid_t), intent(in) :: nodes
        integer, intent(in) :: d !! direction
        integer, intent(in) :: last !! 1: of nodes, of which one lies on the plane, 0: of cells
        integer, intent(inout) :: index
        integer, intent(out) :: image !! of_plane, of_wall, or 0: none
        integer :: i, side

        i = nodes%before(d) + index
        image = 0
        if (i >= 1 .and. i <= nodes%whole(d) + last) return
        side = merge(1, 2, i < 1)
        if (nodes%mirrors(side, d)) image = of_plane
        if (nodes%closed(side, d)) image = of_wall
        if (image == 0) return
        if (side == 1) then
            i = 1 + last - i
        else
            i = 2*nodes%whole(d) + 1 + last - i
        end if
        index = i - nodes%before(d)
    end subroutine see_image
end module brz_cut_cells
