! SPDX-License-Identifier: MIT
!> The state of the solids: particles, sorted body by body and by cell within a body.
!>
!> Time levels: x, stress and history live at the step, v half a step before (leapfrog). The
!> velocity at the step is v + dt_last/2 a. A kick is v += (dt_last + dt)/2 a + dt load/mass.
module brz_solid_state
    use brz_artificial_stress, only: artificial_none
    use brz_cohesive_state, only: cohesive_t
    use brz_face_load, only: loads_t
    use brz_face_stress, only: layers_t
    use brz_contact, only: meeting_t
    use brz_link_layout, only: link_layout_t
    use brz_kinds, only: dp, int16, int32, int64, int8, real32, rk
    use brz_material, only: material_t
    use brz_motion, only: motion_t
    use brz_ranks, only: ranks_t
    use brz_solid_part, only: solid_part_t
    use brz_rigid, only: rigid_t
    implicit none
    private
    public :: solid_t, body_t, body_numbers_t, ledger_t, search_t
    public :: form_uncorrected, form_corrected, form_corrected_hourglass, form_bending, form_rigid
    public :: form_names, form_total, lanes, worth_threads, links_t
    public :: bond_none, bond_whole, bond_broken, bond_breaks, loose_by, intact_share
    public :: is_free, is_held, is_gone, is_leaving, between_t, kept_cells_t
    public :: n_want, want_corners, want_reach
    public :: n_pair, pair_volume, pair_linear, pair_quadratic, pair_keep, pair_stress, &
              pair_affine, pair_zeta, pair_spin, pair_tilt
    public :: at_g, at_x, at_s, at_y, at_f, n_moments, n_sums
    public :: at_heat, at_friction, at_drag, at_stiff, at_work, n_terms
    public :: n_held, held_stiffness, held_affine, held_energy, held_whole

    integer, parameter :: form_corrected = 1, form_corrected_hourglass = 2, form_bending = 3, &
                          form_uncorrected = 4, form_rigid = 5, form_total = 6
    character(19), parameter :: form_names(6) = [character(19) :: 'corrected', &
                                                 'corrected_hourglass', 'bending', &
                                                 'uncorrected', 'rigid', 'total_lagrangian']
    integer, parameter :: lanes = 8 !! particles of a group, which share one list of neighbours

    integer(int32), parameter :: is_free = 0, is_held = 1
    integer(int32), parameter :: is_gone = 2 !! has left the region and is out of the computation
    integer(int32), parameter :: is_leaving = -1 !! is about to be

    ! a way to need a ghost: what is added to its place, how far that may be from a box, its corners
    integer, parameter :: want_reach = 4, want_corners = 5, n_want = 10
    integer(int32), parameter :: bond_none = 0, bond_whole = 1, bond_broken = 2
    integer(int32), parameter :: bond_breaks = 3 !! broke in this step
    integer, parameter :: loose_by = 15 !! what lets go in this step stands so many bits higher
    real(rk), parameter :: intact_share = 0.5_rk !! fewer intact neighbours end the stiff
                                                 !! hourglass force
    integer, parameter :: worth_threads = 2048 !! fewer particles are faster on one thread
    ! what a pair force needs of a particle, in one contiguous row of `pair`
    integer, parameter :: pair_volume = 1 !! [m3]
    integer, parameter :: pair_linear = 2 !! linear viscosity, alpha rho c/2 [kg/(m2 s)]
    integer, parameter :: pair_quadratic = 3 !! quadratic viscosity, beta rho/2 [kg/m3]
    integer, parameter :: pair_zeta = 4 !! strength of the hourglass force: zeta h rho c or zeta G
    integer, parameter :: pair_stress = 4 !! + 1..9: stress times gradient correction [Pa]
    !> + 1..9: stiff hourglass force: stiffness times dx/dX [Pa]; artificial stress: R; else dv/dx
    integer, parameter :: pair_affine = 13
    integer, parameter :: pair_spin = 13 !! + 1..3 of a rigid body: half a step before [1/s]
    integer, parameter :: pair_tilt = 23 !! tilt of the gradient in this step, 0: none [1/m]
    integer, parameter :: pair_keep = 24 !! share of the hourglass force that is left, 0..1
    integer, parameter :: n_pair = 24 !! a whole number of cache lines; also a buffer for sorting

    ! the same for the hold, in a row of `held`; brz_tension_hold
    integer, parameter :: held_affine = 0 !! + 1..9: K dx/dX [Pa]
    integer, parameter :: held_energy = 10 !! that it holds [J]
    integer, parameter :: held_stiffness = 11 !! K [Pa]
    integer, parameter :: held_whole = 12 !! 0: lost its support, holds nothing; else 1
    integer, parameter :: n_held = 12

    ! sums of pass 1: moments of x_ij (x) x_ij, then v_ij (x) x_ij, then X_ij (x) x_ij, then
    ! moments of X_ij (x) X_ij; with a tilt v_ij (x) y_ij in place of the second, and
    ! x_ij (x) y_ij after all; in total-Lagrangian bodies x and X change places, and with a tilt
    ! x_ij (x) y_ij comes last
    integer, parameter :: at_g = 6, at_x = 15, at_s = 24, at_y = 30, n_moments = 39
    integer, parameter :: at_f = 39, n_sums = 48 !! on the CPU

    ! sums of pass 2: 1..3 force of the stress [N]
    integer, parameter :: at_heat = 4 !! heat of the viscosity [W]
    integer, parameter :: at_friction = 5 !! heat of the viscous hourglass force [W]
    integer, parameter :: at_drag = 5 !! + 1..3: viscous forces [N]
    integer, parameter :: at_stiff = 8 !! + 1..3: stiff hourglass force, or artificial stress [N]
    integer, parameter :: at_work = 12 !! work against the hold, half of it to each of a pair [W]
    integer, parameter :: n_terms = 12

    !> What one body has done with its energy so far, all in J.
    type :: ledger_t
        real(dp) :: viscous = 0 !! heat by artificial viscosity
        real(dp) :: hourglass_heat = 0 !! heat by the viscous hourglass force and by the hold
        real(dp) :: hourglass = 0 !! energy held by (or fed to) the stiff hourglass force
        real(dp) :: artificial = 0 !! energy held by the artificial stress
        real(dp) :: ahead = 0 !! change of one of these two in the half step to come
        real(dp) :: early = 0 !! heat of the half step to come, in the internal energy already
        real(dp) :: load = 0 !! work of the air on the body
        real(dp) :: plastic = 0 !! plastic work
        real(dp) :: damage = 0 !! work spent in damage
        real(dp) :: contact = 0 !! energy that the springs of contact hold
        real(dp) :: contact_heat = 0 !! heat of damping, and of shared pressure, in contact
        real(dp) :: friction = 0 !! heat of friction
        real(dp) :: drive = 0 !! work of prescribed motion
        real(dp) :: clamped = 0 !! no energy: particle steps at the edge of the material's range
    end type ledger_t

    !> Surface of a round body in its first place; radius 0: it is not round.
    type :: round_t
        real(dp) :: centre(3) = 0, radius(2) = 0 !! outer and inner, 0: none [m]
        integer :: axis = 0 !! of a cylinder, 0: a sphere
    end type round_t

    !> What of a body pairs and gradients need, which a GPU is told as it is.
    type :: body_numbers_t
        integer :: first = 1, last = 0 !! particles; ahead of all others
        integer :: formulation = form_bending
        integer :: artificial = artificial_none !! artificial stress, see brz_artificial_stress
        integer :: layer = 0 !! normal of a body of a single layer that is a membrane; 0: none
        real(rk) :: h = 0 !! smoothing length of the unloaded body [m]
        real(rk) :: h_range(2) = 1 !! bounds over h, where it follows the density
        real(rk) :: crack = 0 !! width of a smeared crack, over which a fracture energy is spent [m]
        real(rk) :: alpha = 1, beta = 2 !! of the viscosity
        real(rk) :: cfl = 0.4_rk
        real(rk) :: tension_hold = 0 !! stiffness of the hold over the tension, 0: no hold
        real(rk) :: artificial_power = 0
        real(rk) :: shape_at_spacing = 1 !! W(dx)/W(0)
        real(rk) :: at_rest = 2 !! sum of the squares of the two smaller parts of `stretch`
        real(rk) :: normal(3) = 0 !! of its plies, or of a plate of metal, in the unloaded body;
                                  !! 0: no tilted gradients
        real(rk) :: lift = 0 !! of its faces over their tilt, see brz_tilted_arm
        real(rk) :: layer_stiffness(9) = 0 !! C11, C22, C33, C12, C23, C13, G12, G23, G13 [Pa]
        real(rk) :: contraction = 0 !! along the normal over the growth of the area
        type(layers_t) :: layers !! under the faces of the air
        real(rk) :: face_share = 0 !! of the stress of loaded faces, see brz_face_stress; 0: none
    end type body_numbers_t

    !> What lists keep that are built anew in part, see brz_list_drift.
    type :: kept_cells_t
        integer :: renewals = -1 !! how often a part was built anew; -1: the list is not yet built
        integer :: along(3) = 0 !! on a GPU: cells along each axis; 0: they must be chosen
        real(dp) :: lo(3) = 0 !! their low corner [m]
        logical :: in_part = .false. !! only chosen lists are about to be built
    end type kept_cells_t

    !> One body: particles first..last (of this process), one material, one formulation.
    type, extends(body_numbers_t) :: body_t
        character(32) :: id = ''
        character(:), allocatable :: place !! how messages about its group of the deck begin
        character(:), allocatable :: file !! of a table of its particles
        integer, allocatable :: line(:) !! (number(1):number(2)) of that table, from 1
        integer :: rim = 0 !! last of its ghosts, which follow its particles; `last` without
        integer :: room = 0 !! on several processes: places for both
        integer :: number(2) = 0 !! first and last number of the particles of all processes
        integer :: material = 0 !! place in solid%materials
        real(dp) :: spacing = 0 !! of cubes of the volume of its particles [m]
        real(dp) :: stretch(3) = 1 !! x_ref over the unloaded place, see brz_wide_lattice
        real(dp) :: volume_scale = 1 !! volume of a particle over that of its lattice cell
        integer :: across = 0 !! bars: particles across the diameter
        logical :: thin = .false. !! a single layer or row of particles
        integer :: group = 1 !! its first group of particles
        logical :: variable = .false. !! smoothing length follows the density
        real(rk) :: zeta = 2, zeta_viscous = 0
        logical :: drawn = .false. !! in this step something of it is held
        integer :: limiter = 0 !! of the viscosity in shear, see brz_gradient
        logical :: directional = .false. !! hourglass stiffness along the axes of the material
        real(rk), allocatable :: axes(:, :, :) !! (3, 4, 0:plies) unloaded axes of it, column by
                                               !! column, and the stiffness along them [Pa]
        logical :: curved = .false. !! a wall round the axis of `round`: the normal of a particle is
                                    !! radial, and `normal` 1 in the directions across the axis
        logical :: layer_of_ply = .false. !! `layer_stiffness` along the axes of a ply
        real(rk) :: outward = 0 !! from where its faces see the strain, further out [m]
        real(rk) :: artificial_strength = 0
        logical :: asleep = .false. !! unloaded and at rest: left out of the steps
        ! what all of the body has moved since its list was built, see brz_list_drift
        real(dp) :: drift(3) = 0, drift_velocity(3) = 0 !! [m], [m/s]
        type(kept_cells_t) :: cells !! of its list
        real(dp) :: dt_limit = 0 !! largest stable time step times the CFL number [s]
        real(dp) :: reaction(3) = 0 !! impulse that the held particles took up so far [N s]
        real(dp) :: impulse(3) = 0 !! of the load so far, where a gauge asks for it [N s]
        type(ledger_t) :: ledger
        type(rigid_t) :: rigid !! of a rigid body
        type(motion_t) :: motion !! that is prescribed
        type(motion_t), allocatable :: regions(:) !! those of regions of it; none if not allocated
        type(round_t) :: round !! its surface, where that is known to be round
        real(dp), allocatable :: surface(:, :, :) !! (3, 3, triangles) corners of it [m]; from a
                                                  !! file, until `find_skin`
    end type body_t

    !> Work arrays of the neighbour search and of the block sums, kept from one use to the next.
    type :: search_t
        integer :: cells(3) = 1 !! of the grid of the body at hand
        real(dp) :: lo(3) = 0, size = 1 !! its low corner and the side of a cell [m]
        real(dp) :: deep(3) = 0 !! what its particles are below 0, as some behind planes of symmetry
        integer, allocatable :: code(:, :) !! (cells, 3) share of an axis in the number of a cell
        integer, allocatable :: start(:) !! first place of a cell in `order`
        integer, allocatable :: order(:) !! (n) particles cell by cell
        integer, allocatable :: marked(:) !! (cells) 1: some particle there has a new place
        logical, allocatable :: chosen(:) !! (groups) whose lists are built anew
        real(dp), allocatable :: sums(:, :) !! (sums, blocks) partial sums of a pass
        real(dp), allocatable :: limit(:) !! (blocks) largest stable time step [s]
        logical, allocatable :: drawn(:) !! (blocks) some particle is held
        integer, allocatable :: bad(:) !! (blocks) first particle with an impossible state, 0: none
    end type search_t

    !> Pairs of particles of different bodies. Nothing is allocated where no two bodies meet.
    type :: links_t
        logical :: present = .false.
        logical :: bonds = .false. !! some bodies are bonded
        logical :: faces = .false. !! those of some may be in contact, see brz_contact_face
        type(meeting_t), allocatable :: table(:, :) !! (bodies, bodies) law of i's and j's body
        logical, allocatable :: met(:, :) !! (bodies, bodies) some particles of both have links
        real(dp), allocatable :: drift(:, :, :) !! (3, bodies, bodies) what the first had drifted
                                                !! beyond the second when links were built [m]
        real(dp), allocatable :: spare(:, :) !! (bodies, bodies) what they were further apart than
                                             !! links reach [m]
        logical, allocatable :: stale(:, :) !! (bodies, bodies) both are about to be linked anew
        type(link_layout_t) :: lay !! how lists and arrays lie
        real(dp), allocatable :: box(:, :, :) !! (3, 2, bodies) corners of x_built [m]
        integer(int32), allocatable :: ends(:) !! (bodies) last particle or ghost of each
        integer(int32), allocatable :: row(:) !! (n) row of a particle that has links, else 0
        integer :: rows = 0 !! particles that have links
        integer(int32), allocatable :: slice(:) !! (rows) entries before its own, over link_unit
        integer(int32), allocatable :: count(:) !! (rows) its links
        integer(int32), allocatable :: list(:) !! entries, see brz_link_layout
        real(rk), allocatable :: cell(:) !! (bodies) lattice volume per mass of particle [m3/kg]
        real(real32), allocatable :: touch(:) !! (n) kernel sum at which contact begins
        real(real32), allocatable :: face(:, :) !! (n_face, n) see brz_contact_face
        real(real32), allocatable :: weight(:) !! (n) of its cell in sums of contact, 1 but at the
                                               !! surface of round bodies
        integer(int32), allocatable :: bond(:) !! (n) bond_none, ..., bond_breaks
        integer(int32), allocatable :: joined(:) !! (n) cohesive interfaces that still hold a
                                                 !! particle, a bit each, and, see loose_by, those
                                                 !! that let go of it; only where there are some
        real(rk), allocatable :: press(:, :) !! (n_press, 0:rows) pressure of contact [Pa]; its
                                             !! gradient of the kernel sum [1/m]; stiffness [Pa];
                                             !! what its face adds to the row, see strain_face
        real(rk), allocatable :: push(:, :) !! (9, 0:rows) forces of contact: springs, drag [N];
                                            !! moment of drag on what turns [N m]
    end type links_t

    !> What a gauge asks of two bodies.
    type :: between_t
        integer :: body(2) = 0
        real(dp) :: force(3) = 0 !! on the first by the second, at the step [N]
        real(dp) :: impulse(3) = 0 !! the same from the start to the step [N s]
    end type between_t

    type :: solid_t
        logical :: present = .false.
        type(ranks_t) :: ranks !! the processes that share the particles
        type(solid_part_t) :: part !! what this one has to do with others
        integer :: n = 0 !! particles, with the ghosts of those of other processes
        integer :: wide = 3 !! rows of x and v; on a GPU there are four
        integer :: step_d = 1, step_p = 3 !! distances in `load` of directions, of particles
        integer :: step_t = 6 !! distance of particles in `face_stress`
        integer :: n_hist = 0 !! history variables kept per particle
        integer :: dimension = 3 !! 3, or 2 (plane strain), or 1
        logical :: mirror(3) = .false. !! symmetry plane through the origin normal to each axis
        real(dp) :: depth = 1 !! extent of directions that are not modelled, multiplied [m or m2]
        real(dp) :: time = 0 !! since the start, of the steps taken [s]
        real(dp) :: dt_last = 0 !! last time step [s]
        real(dp) :: dt_limit = 0 !! the smallest of the bodies' and that of contact, part of a
                                 !! checkpoint [s]
        real(dp) :: skin = 0 !! of the neighbour list [m]
        logical :: remove = .false. !! what leaves the region is taken out
        !> Corners of the region whose leaving is watched [m].
        real(dp) :: region(3, 2) = reshape([-huge(1.0_dp), -huge(1.0_dp), -huge(1.0_dp), &
                                            huge(1.0_dp), huge(1.0_dp), huge(1.0_dp)], [3, 2])
        integer(int64) :: steps = 0, rebuilds = 0
        type(body_t), allocatable :: bodies(:)
        type(material_t), allocatable :: materials(:)
        real(dp), allocatable :: x(:, :) !! (3, n) position [m]
        real(dp), allocatable :: x_ref(:, :) !! (3, n) position in the unloaded body [m]
        real(dp), allocatable :: x_built(:, :) !! (3, n) position when the list was built [m]
        real(rk), allocatable :: v(:, :) !! (3, n) velocity, half a step before [m/s]
        real(rk), allocatable :: a(:, :) !! (3, n) acceleration by internal forces [m/s2]
        real(rk), allocatable :: load(:, :) !! (3, n) force of the air, set by the coupling; only
                                            !! where there is air [N]
        real(rk), allocatable :: face_stress(:, :) !! (6, n) stress of the load on its faces, see
                                                   !! brz_face_stress; only with loads [Pa]
        real(rk), allocatable :: v_before(:, :) !! (3, n) velocity at the last step of the air; only
                                                !! where there is air, on several processes [m/s]
        real(rk), allocatable :: grip(:, :) !! (3, n) force on what holds a particle at the step;
                                            !! only where a gauge asks for it [N]
        real(dp), allocatable :: work(:) !! (n) of the loads in a kick; heat of drag; else 0 [J]
        integer, allocatable :: moved(:, :) !! (lost_level, bodies) 1: some particle has moved so
                                            !! far since its list was built
        logical :: impulses = .false. !! a gauge asks for those of the load
        type(between_t), allocatable :: between(:) !! pairs of bodies that gauges ask for
        real(rk), allocatable :: mass(:) !! (n) [kg]
        real(rk), allocatable :: mu(:) !! (n) compression rho/rho0 - 1 [-]
        real(rk), allocatable :: energy(:) !! (n) specific internal energy [J/kg]
        real(rk), allocatable :: stress(:, :) !! (6, n) Cauchy stress, tension positive [Pa]
        real(rk), allocatable :: hist(:, :) !! (n_hist, n) history of the material model
        real(rk), allocatable :: damage(:) !! (n) damage as pair forces see it, 0..1
        real(rk), allocatable :: volume(:) !! (n) as pass 1 sees it [m3]
        real(rk), allocatable :: h(:) !! (n) smoothing length; only where a body varies it [m]
        real(real32), allocatable :: k_axes(:, :) !! (6, n) hourglass stiffness xx, yy, zz, xy, yz,
                                                  !! xz; only where a body has one along axes [Pa]
        real(real32), allocatable :: tilt(:) !! (n) of the gradient in the outermost layers of
                                             !! plies and plates, see brz_tilted_arm; only where
                                             !! a body has a normal [1/m]
        real(rk), allocatable :: pair(:, :) !! (n_pair, n) written by pass 1 for pass 2
        real(rk), allocatable :: held(:, :) !! (n_held, n) the hold, where a body has it; by pass 1
        real(rk), allocatable :: owed(:) !! (n) where `held` is: energy of the hold, and its work
                                         !! in the half step to come; the rest became heat [J]
        integer(int32), allocatable :: id(:) !! (n) number of the particle, kept for life
        integer(int16), allocatable :: ply(:) !! (n) ply, from 1; 0 without plies
        integer(int32), allocatable :: fixed(:) !! (n) is_free, is_held, is_gone, or marks of
                                                !! brz_support
        integer(int8), allocatable :: limp(:) !! (n) 1: hourglass support lost for good
        integer(int16), allocatable :: support(:) !! (n) neighbours in the unloaded body
        integer, allocatable :: block(:, :) !! (3, blocks) body, first and last particle of a block
        character(:), allocatable :: notes !! warnings of the set-up, line by line
        type(search_t) :: search
        ! neighbours of a group: entries first(g)..first(g+1)-1 of `list`, its members among them;
        ! mirror images, only where there are planes: entries image_first(g)..image_first(g+1)-1
        integer(int64), allocatable :: first(:), image_first(:) !! (groups and an end for each body)
        integer(int32), allocatable :: list(:) !! particles within reach of a member
        integer(int32), allocatable :: image(:) !! particles whose image is within reach of one
        integer(int8), allocatable :: mask(:) !! mirrored axes of an image, bits 0..2
        type(links_t) :: links !! between different bodies
        type(cohesive_t) :: cohesive !! interfaces with a law of their own
        type(loads_t) :: loads !! pressures on faces, in scenes without air
    end type solid_t
end module brz_solid_state
