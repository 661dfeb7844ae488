! SPDX-License-Identifier: MIT
!> What the solids have on a GPU besides the arrays of solid_t: packed rows of the particles, lists
!> in slices, and what kernels need of each body. See brz_gpu_solid_layout.
module brz_solid_device
    use brz_buffers, only: buffer_t, doubles_t, integers_t, reals_t
    use brz_device, only: kernel_t
    use brz_energy_account, only: energy_account_t
    use brz_gpu_common, only: gpu_common_t
    use brz_gpu_message_buffers, only: gpu_message_buffers_t
    use brz_kinds, only: dp, int64, rk
    use brz_link_layout, only: link_layout_t
    use brz_rows, only: rows_t
    implicit none
    private
    public :: solid_device_t, adders_t, body_device_t, body_kind_t, links_device_t, columns_t, &
        lists_t
    public :: news_none, news_part, news_all

    ! what of a list is new: nothing; near marked cells, and in them; all
    integer, parameter :: news_none = 0, news_part = 1, news_all = 2

    !> Lists of particles, in slices of slice_width, see brz_gpu_solid_lists.
    type :: lists_t
        integer :: first = 1, last = 0 !! particles
        integer :: gone = 0 !! how many of them, the last ones, are no longer there: is_gone
        integer :: slices = 0
        integer :: spare = 0 !! entries more than a list needs that moves; 0: none moves yet
        integer :: filled = 0 !! end of the last slice
        type(integers_t) :: slice, list
        type(integers_t) :: width !! room of a list in each slice
    end type lists_t

    type, extends(lists_t) :: body_device_t
        integer :: rim = 0 !! last of its ghosts, as in body_t
        integer :: room = 0 !! places for both
        logical :: total = .false. !! total-Lagrangian
        logical :: rigid = .false.
        logical :: in_tension = .false. !! has the tensile control
        logical :: layer = .false. !! a single layer, see brz_membrane
        logical :: inactive = .false. !! left out of the steps
        logical :: packed = .false. !! `far` has the reference of its particles
        real(dp) :: box(3, 2) = 0 !! corners of `built` [m]
        type(buffer_t) :: params !! its part of `params` of solid_device_t
        type(integers_t) :: pairs !! those of its list that act, see solid_moments
        type(buffer_t) :: grid !! cells of its list, and of the search for links with it
        type(integers_t) :: code, start !! of these, see grid_gpu_t; end of each cell in `order`
        integer, allocatable :: ends_there(:), grid_there(:), code_there(:)
        !! what the GPU has: first and last particle, words of `grid`; what `code` was made for
        type(integers_t) :: marked !! cells of particles with new places: 1
        type(integers_t) :: below !! (6) 1: particles lie below planes of symmetry, see count_cells
        integer :: news = news_all !! what of its list is new since links were built
        type(kernel_t) :: moments, update, forces !! those that suit the body
    end type body_device_t

    !> Bodies that the same kernels suit, which go in one launch, see brz_gpu_solid_tiles.
    type :: body_kind_t
        integer :: like = 0 !! a body of the kind
        integer :: first = 1, tiles = 0 !! its part of `tiles`: where it begins, how many
    end type body_kind_t

    !> Threads that add up numbers of the particles, body by body, see lay_adders.
    type :: adders_t
        integer, allocatable :: first(:) !! (bodies + 1) tile of each body, of the end
        type(integers_t) :: tiles !! (2, tiles) body, threads of it before the tile
        type(integers_t) :: sets !! (4, bodies) first and last particle, gone or not; threads
                                 !! before those of the body, its own
        type(doubles_t) :: part !! what they have added up: body by body, (threads, columns)
        integer, allocatable :: sets_there(:) !! what the GPU has
    end type adders_t

    !> Pairs of particles of different bodies, arrays of links_t.
    type, extends(lists_t) :: links_device_t
        type(link_layout_t) :: lay
        logical :: breaks = .true., frees = .true. !! bonds may break; or what ties may let go
        type(buffer_t) :: table, touch, weight, face
        type(integers_t) :: ends, count, met, bond, joined
        integer, allocatable :: ends_there(:) !! what the GPU has of them
        type(doubles_t) :: box !! (3, 2, bodies) corners of `built` [m]
        type(integers_t) :: row !! `count`: not read here
        type(integers_t) :: loose !! `count`, but 0 of particles that are tied for good
        integer, allocatable :: active(:, :) !! (2, bodies) ranges of particles, see note_active
        type(integers_t) :: linked, touching !! of these, what may be bonded; may be in contact
        integer :: n_linked = 0, n_touching = 0 !! how many
        logical :: listed = .false. !! they are those of the links and bodies of now
        type(integers_t) :: mark, found !! to list them
        type(integers_t) :: acting, near !! (n) how many bonds of a particle act; they, as `list`
        type(reals_t) :: cell, press
    end type links_device_t

    !> Columns of `state` that not every scene has, 0: none.
    type :: columns_t
        integer :: reaction_force = 0 !! + 1..3: force on what holds a particle [N]
        integer :: control_due = 0 !! energy that the tensile control owes [J]
        integer :: load = 0 !! + 1..3: force of the air, or of the loads [N]
        integer :: face_stress = 0 !! + 1..6: stress of the load on its faces [Pa]
        integer :: before = 0 !! + 1..3: velocity a step of the air before [m/s]
    end type columns_t

    type :: solid_device_t
        logical :: fetched = .true. !! the host arrays hold the state of the GPU
        logical :: stepped = .false. !! the GPU has made a step
        logical :: summed = .false. !! the energy accounts are those of the present state
        logical :: settled = .true. !! bodies lie in the host arrays as they do here
        logical :: linked = .false., bonded = .false. !! bodies meet; some are bonded
        type(links_device_t) :: links
        logical :: points_fetched = .true. !! the host has the state of its points
        integer :: n = 0, n_state = 0 !! places of particles, columns of `state`
        type(columns_t) :: column
        type(body_device_t), allocatable :: bodies(:)
        type(buffer_t) :: params !! of all bodies, body_gpu_t
        type(buffer_t) :: offsets !! (bodies) list_offsets_t
        type(integers_t) :: tiles !! (2, tiles) body, particles of it before the tile
        type(body_kind_t), allocatable :: kinds(:)
        integer, allocatable :: kind_of(:) !! (bodies) 0: rigid, in no launch over kinds
        type(doubles_t) :: drifts !! (4, bodies) drift, unit of levels of motion [m]
        integer, allocatable :: tiles_there(:), offsets_there(:), drifts_there(:)
        !! what the GPU has: particles of each body with tiles; words of `offsets`, `drifts`
        type(energy_account_t), allocatable :: account(:) !! of the bodies when the GPU took over
        real(dp), allocatable :: reaction(:, :) !! (3, bodies) likewise
        type(doubles_t) :: sorted !! positions that lists are built for, cell by cell: order_cells
        type(adders_t) :: adders
        type(doubles_t) :: place, reference, built, diag, rate, region
        type(reals_t) :: motion, state, row, grad, control, axes, extra
        type(reals_t) :: near, far !! place and reference as pairs read them, see pack_places
        type(integers_t) :: tag, flags, count, cell, order
        type(integers_t) :: acting !! (n) how many `pairs` a particle has
        type(integers_t) :: seat !! every place
        type(integers_t) :: chosen !! 1: particles whose lists are built anew
        type(integers_t) :: picked, found !! they, from where a body begins; how many of each
        integer, allocatable :: region_there(:) !! what it has of the regions of all processes
        type(doubles_t) :: region_at, wants !! small tables: these; the ways to need a ghost
        type(buffer_t) :: k_axes
        ! parts of these arrays as loop bodies have them, under the names of solid_t
        integer :: wide = 4, stride_d = 0, stride_p = 1, stride_t = 1
        type(doubles_t) :: x, x_ref, x_built, work, contact_heat
        type(reals_t) :: v, v_before, volume, a, load, face_stress, reaction_force, mass, mu, energy
        type(reals_t) :: damage, stress, pair, control_due
        type(integers_t) :: id, fixed, moved
        real(dp) :: heat(1) = 0 !! the name of contact_heat on the host
        type(gpu_common_t) :: common
        integer :: n_record = 0, n_left = 0
        type(rows_t) :: record(7) !! what a particle takes along to another process
        type(rows_t) :: left(3) !! what pass 1 leaves for pass 2
        type(gpu_message_buffers_t) :: ghosts
        logical :: offered = .false. !! others have written what they move, and all have met since
        integer(int64) :: rebuilds = -1 !! of lists before the last step
    end type solid_device_t
end module brz_solid_device
