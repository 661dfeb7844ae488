! SPDX-License-Identifier: MIT
!> A validated scene as plain data: what the deck says, in SI units, with all defaults filled in.
!>
!> Nothing after the deck layer reads the deck itself. Names of options stay words here; the module
!> that uses an option turns the word into a code.
module brz_case
    use brz_kinds, only: dp
    use brz_text, only: string_t
    implicit none
    private
    public :: case_t, run_case_t, air_case_t, gas_case_t, charge_case_t, material_case_t, &
                 body_case_t, gauge_case_t, solid_case_t, coupling_case_t, output_case_t, &
                 point_case_t, segment_case_t
    public :: name_len, max_plies, max_motion, region_case_t, interaction_case_t, inflow_case_t, &
              load_case_t, is_from_file, is_held_whole, label, means

    integer, parameter :: name_len = 32 !! longest id or option word
    integer, parameter :: max_plies = 256 !! most plies of one body
    integer, parameter :: max_motion = 64 !! most points of a prescribed velocity

    !> &run
    type :: run_case_t
        character(:), allocatable :: title
        character(name_len) :: job = '' !! name of the deck without folder and ending
        real(dp) :: t_end = 0 !! [s]
        logical :: symmetry(3) = .false. !! mirror plane through the origin, normal to x, y, z
        integer :: dimension = 3 !! 3, or 2 (plane strain in x, y), or 1 (along x)
        character(name_len) :: backend = 'auto' !! 'cpu', 'gpu', 'auto'
        real(dp) :: dt_max = huge(1.0_dp) !! [s]
        real(dp) :: dt_min = 0 !! a smaller step ends the run with code 3 [s]
        real(dp) :: energy_band = huge(1.0_dp) !! largest allowed energy error [-]
        integer :: max_steps = huge(1)
    end type run_case_t

    !> &air
    type :: air_case_t
        logical :: present = .false.
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        character(name_len) :: geometry = 'cartesian'
        !! 'spherical', 'cylindrical', 'planar', 'axial'
        real(dp) :: floor = -huge(1.0_dp) !! 'axial': coordinate of a rigid floor; none [m]
        real(dp) :: lo(3) = 0, hi(3) = 1 !! corners of the box [m]
        integer :: cells(3) = 1 !! 1 in a direction that is not modelled
        !> (low/high, direction): 'outflow', 'wall', 'symmetry', 'periodic'
        character(name_len) :: bc(2, 3) = 'outflow'
        real(dp) :: density = 1.225_dp !! undisturbed air [kg/m3]
        real(dp) :: pressure = 101325 !! undisturbed air [Pa]
        real(dp) :: gamma = 1.4_dp
        real(dp) :: cfl = 0.5_dp
        integer :: ramp_steps = 20 !! first steps, over which the time step grows from a tenth
        character(name_len) :: reconstruction = 'muscl'
        !! 'first_order', 'muscl', 'weno3', 'weno5z'
        character(name_len) :: flux = 'hllc' !! or 'steger_warming'
        character(name_len) :: integrator = 'ssprk2' !! or 'ssprk3'
        logical :: activity = .true. !! leave out what nothing has reached
        logical :: fallback = .true. !! first-order fluxes where a state would become unphysical
    end type air_case_t

    !> &gas: a box of gas with its own initial state
    type :: gas_case_t
        character(name_len) :: id = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        real(dp) :: lo(3) = 0, hi(3) = 0 !! [m]
        real(dp) :: density = 0, pressure = 0, velocity(3) = 0
        character(512) :: file = '' !! has the state in place of these; '': none
        real(dp) :: move(3) = 0, at(3) = 0 !! of a file: shift, centre of a radius [m]
    end type gas_case_t

    !> &inflow: gas outside an open face of the box, which comes in
    type :: inflow_case_t
        character(name_len) :: id = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        integer :: axis = 0, side = 0 !! of the face; 1: low, 2: high
        logical :: wave = .false. !! an overpressure is given, no states
        real(dp), allocatable :: time(:) !! none where nothing changes [s]
        real(dp), allocatable :: overpressure(:) !! (points) [Pa]
        real(dp), allocatable :: state(:, :) !! (points, 5) density, velocity, pressure
    end type inflow_case_t

    !> &charge: explosive as a balloon of hot gas; the mass is that of the whole charge
    type :: charge_case_t
        character(name_len) :: id = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        character(name_len) :: explosive = 'tnt'
        character(name_len) :: start = '3d' !! or '1d', '2d'
        character(name_len) :: eos = 'ideal' !! or 'jwl'
        character(name_len) :: burn = 'programmed' !! or 'instant'
        character(name_len) :: shape = 'sphere' !! 'sphere', 'cylinder', 'box'
        real(dp) :: mass = 0 !! with the image of a charge on the ground [kg]
        logical :: on_ground = .false. !! half of its shape, mirrored by the ground
        real(dp) :: density = 1630 !! [kg/m3]
        real(dp) :: energy = 7.0e9_dp/1630 !! [J/kg]
        real(dp) :: velocity = 6930 !! of the detonation [m/s]
        real(dp) :: gamma = 0 !! ratio of specific heats of its gas; 0: that of the air
        integer :: radial_cells = 240 !! in the charge, where it is computed along the radius
        integer :: plane_cells = 160 !! from the axis to the edge of the plane through it
        real(dp) :: ignition(3) = 0 !! where the detonation begins; the centre if not given [m]
        real(dp) :: afterburn = 0 !! energy that the products set free in the air [J/kg]
        real(dp) :: afterburn_time = 0 !! how long that takes [s]
        real(dp) :: at(3) = 0 !! centre [m]
        real(dp) :: aspect = 1 !! cylinder: length over diameter
        real(dp) :: sides(3) = 1 !! box: ratio of the sides
        character(1) :: axis = 'z' !! cylinder
    end type charge_case_t

    !> &material: the model and its keys; materials/ turns it into numbers
    type :: material_case_t
        character(name_len) :: id = ''
        character(name_len) :: model = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        integer :: n = 0
        character(24), allocatable :: key(:) !! keys of the model, defaults included (n)
        real(dp), allocatable :: value(:) !! numbers; a logical is 0 or 1; 0 for a text (n)
        character(name_len), allocatable :: word(:) !! texts (n)
        character(:), allocatable :: unconfirmed !! keys whose preset says so, ' a b n'
        logical :: doubtful = .false. !! constants of failure are among them
        logical, allocatable :: given(:) !! false where the value is the default (n)
    end type material_case_t

    !> &motion: a velocity that is prescribed for regions of a body
    type :: region_case_t
        character(name_len) :: id = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        integer :: n_boxes = 0
        real(dp) :: box(6, 8) = 0 !! x0, x1, y0, y1, z0, z1 [m]
        logical :: along(3) = .true. !! axes along which they are moved
        real(dp), allocatable :: time(:), velocity(:, :) !! history (n), (3, n) [s, m/s]
    end type region_case_t

    !> &body
    type :: body_case_t
        character(name_len) :: id = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        character(name_len) :: shape = 'box' !! 'box', 'sphere', 'cylinder', 'bars', 'stl', ...
        real(dp) :: lo(3) = 0, hi(3) = 0 !! box, bars: corners [m]
        real(dp) :: centre(3) = 0, radius = 0, length = 0 !! sphere, cylinder [m]
        real(dp) :: below(3) = 0 !! of a box, what planes of symmetry have cut off [m]
        real(dp) :: inner_radius = 0 !! of a hollow cylinder or sphere [m]
        real(dp) :: own(6) = 0 !! numbers of the keys that its shape has alone, see
                               !! brz_body_geometry
        character(1) :: axis = 'z' !! cylinder, bars
        real(dp) :: diameter = 0 !! bars [m]
        integer :: bars(2) = 1 !! bars along the two directions across, in cyclic order
        character(512) :: file = '' !! stl, particles: path, from the folder of the deck
        real(dp) :: scale = 1, move(3) = 0 !! of the coordinates in the file [-], [m]
        character(name_len) :: cuts(8) = '' !! bodies that make room for this one
        real(dp) :: spacing = 0 !! distance of the particles [m]
        logical :: layered = .false. !! in rings round the axis of a cylinder with a hole
        character(name_len) :: material = ''
        integer :: material_index = 0
        integer :: n_plies = 0
        real(dp) :: ply_angle(max_plies) = 0 !! [deg], from low to high along the axis
        character(1) :: ply_axis = 'z' !! normal of the plies
        character(name_len) :: fix(8) = '' !! 'sides', 'all', 'x-', 'x+', 'y-', 'y+', 'z-', 'z+'
        integer :: fix_layers = 3 !! particle layers that are held
        real(dp) :: fix_width = 0 !! depth that is held; 0: fix_layers [m]
        integer :: n_fix_boxes = 0
        real(dp) :: fix_box(6, 8) = 0 !! regions that are held: x0, x1, y0, y1, z0, z1 [m]
        integer :: n_rollers = 0
        real(dp) :: roller_box(6, 8) = 0 !! regions that are held along one axis [m]
        character(1) :: roller_axis(8) = ''
        real(dp) :: velocity(3) = 0 !! [m/s]
        integer :: n_motion = 0 !! points of a prescribed velocity, 0: none
        real(dp) :: motion_time(max_motion) = 0 !! [s]
        real(dp) :: motion_velocity(3, max_motion) = 0 !! [m/s]
        type(region_case_t), allocatable :: regions(:) !! of its &motion groups; none if absent
        real(dp) :: spin(3) = 0 !! angular velocity about spin_centre [rad/s]
        character(512) :: start_file = '' !! of initial velocities and stresses
        logical :: start_stress = .false. !! those of a dump too
        logical :: about_point = .false. !! else that is the centre of mass
        real(dp) :: spin_centre(3) = 0 !! [m]
        character(name_len) :: formulation = 'auto' !! see the deck reference
        real(dp) :: alpha = -1, beta = -1 !! artificial viscosity; negative: that of the formulation
        character(name_len) :: limiter = 'auto' !! or 'none', 'balsara', 'compression'
        character(name_len) :: crack_band = 'weaken' !! or 'refuse'
        character(name_len) :: artificial_stress = 'auto' !! or 'none', 'monaghan', 'gray'
        real(dp) :: artificial_strength = -1 !! negative: the usual one
        real(dp) :: zeta = -1 !! stiffness of the hourglass force; negative: the usual one
        logical :: hourglass_axes = .true. !! plies: along the axes of the material
        real(dp) :: zeta_viscous = 0.05_dp !! viscous hourglass force ('corrected_hourglass')
        real(dp) :: tensile_control = -1 !! of 'corrected_hourglass'; negative: the usual one
        real(dp) :: aspect(3) = 1 !! width of a particle over `spacing` along each axis
        character(4) :: plate_axis = 'auto' !! normal of a plate; 'auto', 'none', 'x', 'y', 'z'
        real(dp) :: smoothing = 1.2_dp !! smoothing length over spacing
        logical :: variable_h = .false. !! the smoothing length follows the density
        real(dp) :: h_range(2) = [0.7_dp, 1.2_dp] !! its bounds over that of the unloaded body
        real(dp) :: cfl = 0.4_dp
    end type body_case_t

    !> &interaction: how bodies meet; later ones cover earlier ones
    type :: interaction_case_t
        integer :: body(2) = 0 !! places of the bodies, 0: every body
        integer :: last(2) = 0 !! of several bodies the last one; else 0
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        character(name_len) :: law = 'contact' !! or 'bonded', 'shared', 'cohesive', 'none'
        real(dp) :: friction = 0 !! Coulomb's coefficient
        real(dp) :: stiffness = 1, damping = 0 !! factors
        logical :: shared_pressure = .false.
        real(dp) :: tensile_strength = huge(1.0_dp), shear_strength = huge(1.0_dp) !! [Pa]
        character(name_len) :: bond_law = 'quadratic' !! or 'cut_off'
        real(dp) :: gi = 0, gii = 0 !! fracture energies of a cohesive interface [J/m2]
        character(name_len) :: mixed = 'bk' !! or 'power'
        real(dp) :: mixed_exponent = 0 !! 0: the usual one
        real(dp) :: interface_stiffness = 0 !! 0: the usual one [Pa/m]
        integer :: n_open_boxes = 0
        real(dp) :: open_box(6, 8) = 0 !! regions that are not glued: x0, x1, ... [m]
    end type interaction_case_t

    !> &load: a pressure on faces of a body, or a force on all of it
    type :: load_case_t
        character(name_len) :: id = ''
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        integer :: body = 0 !! its place
        logical :: faces(8) = .false. !! x-, x+, y-, ..., inside and outside of a layered wall
        real(dp), allocatable :: time(:), pressure(:) !! history of the overpressure [s, Pa]
        real(dp) :: mass = 0 !! of a charge of TNT; 0: the history [kg]
        logical :: on_ground = .false. !! a hemisphere on the ground, no sphere in free air
        real(dp) :: at(3) = 0 !! of its centre [m]
        real(dp) :: start = 0 !! when it detonates [s]
        character(512) :: patch = '' !! surface that the faces lie under, '': all of them
        logical :: in_table = .false. !! time and pressure are those of a file
        logical :: on_all = .false. !! of a body; then `pressure` has factors of one of these:
        real(dp) :: acceleration(3) = 0 !! [m/s2]
        real(dp) :: force(3) = 0 !! on the part of the body that is modelled [N]
    end type load_case_t

    !> &gauge
    type :: gauge_case_t
        character(name_len) :: id = ''
        real(dp) :: at(3) = 0 !! [m]
        character(name_len) :: quantity = 'pressure' !! see the deck reference
        character(:), allocatable :: place !! in front of messages, 'deck.nml:14: '
        real(dp) :: to(3) = 0 !! other end of a strain gauge [m]
        real(dp) :: width(3) = 0 !! sides of the box over which it averages [m]
        character(name_len) :: body = '' !! for quantities of a solid
        integer :: body_index = 0
        character(name_len) :: with = '' !! other body of a force or impulse of contact
        integer :: with_index = 0
        character(name_len) :: motion = '' !! of the body, whose force is measured
        integer :: motion_index = 0
    end type gauge_case_t

    !> &solid: settings shared by all bodies
    type :: solid_case_t
        logical :: present = .false. !! at least one body
        real(dp) :: skin = 0.3_dp !! of the neighbour list, in spacings
        logical :: has_region = .false.
        real(dp) :: region(3, 2) = 0 !! corners; particles that leave it are reported [m]
        character(name_len) :: leave = 'report' !! or 'stop', 'remove'
        real(dp) :: jitter = 0 !! largest shift of a particle at the start, in spacings
        integer :: seed = 1 !! of these shifts
    end type solid_case_t

    !> &coupling
    type :: coupling_case_t
        logical :: present = .false. !! air and at least one body
        character(name_len) :: scheme = 'cut_cells' !! or 'paper'
        real(dp) :: reference_pressure = 101325 !! taken off every load [Pa]
    end type coupling_case_t

    !> &output
    type :: output_case_t
        real(dp) :: dump_every = huge(1.0_dp) !! [s]
        real(dp) :: dump_from = 0 !! none of these before [s]
        real(dp), allocatable :: dump_times(:) !! of dumps besides, growing [s]
        real(dp) :: history_every = 0 !! 0: every step [s]
        real(dp) :: checkpoint_every = huge(1.0_dp) !! [s]
        real(dp) :: report_every = 5 !! wall-clock time between progress lines [s]
    end type output_case_t

    type :: case_t
        type(run_case_t) :: run
        type(air_case_t) :: air
        type(gas_case_t), allocatable :: gas(:)
        type(inflow_case_t), allocatable :: inflows(:)
        type(charge_case_t), allocatable :: charges(:)
        type(material_case_t), allocatable :: materials(:)
        type(body_case_t), allocatable :: bodies(:)
        type(interaction_case_t), allocatable :: interactions(:)
        type(load_case_t), allocatable :: loads(:)
        type(gauge_case_t), allocatable :: gauges(:)
        type(solid_case_t) :: solid
        type(coupling_case_t) :: coupling
        type(output_case_t) :: output
        type(string_t), allocatable :: warnings(:) !! what can be run but may not be meant
        character(:), allocatable :: echo !! the complete runnable deck with defaults marked
    end type case_t

    !> &segment: a part of the path of a material point
    type :: segment_case_t
        real(dp) :: duration = 0 !! [s]
        integer :: steps = 1000
        character(name_len) :: control = 'strain' !! 'uniaxial_stress', 'triaxial', 'pressure'
        real(dp) :: l(3, 3) = 0 !! velocity gradient dv_i/dx_j [1/s]
        character(1) :: axis = 'x' !! along it the rate is given
        real(dp) :: rate = 0 !! rate of deformation along that axis [1/s]
        real(dp) :: lateral_stress = 0 !! normal stress across that axis [Pa]
        real(dp) :: pressure = 0 !! at the end [Pa]
    end type segment_case_t

    !> &point with its material and its path: what `brisance mat` is asked for
    type :: point_case_t
        character(name_len) :: job = '' !! name of the deck without folder and ending
        type(material_case_t) :: material
        integer :: steps = 1000 !! of a segment that has no number of its own
        integer :: output_every = 1 !! steps between rows
        real(dp) :: rotation = 0 !! of the ply about its normal [deg]
        character(1) :: ply_axis = 'z' !! normal of the ply
        real(dp) :: crack_length = 1e-3_dp !! width of a smeared crack [m]
        type(segment_case_t), allocatable :: segments(:)
        type(string_t), allocatable :: warnings(:)
    end type point_case_t

contains

    !> True if a name stands for an id: the same, or as far as to a star at its end.
    elemental logical function means(name, id)
        character(*), intent(in) :: name, id
        integer :: n

        means = name == id .and. id /= ''
        n = len_trim(name)
        if (n < 2 .or. means) return
        if (name(n:n) == '*') means = index(id, name(:n - 1)) == 1
    end function means

    !> True for a body whose shape is in a file.
    pure logical function is_from_file(body)
        type(body_case_t), intent(in) :: body

        is_from_file = body%shape == 'stl' .or. body%shape == 'particles'
    end function is_from_file

    !> True for a body that is held as a whole.
    pure logical function is_held_whole(body)
        type(body_case_t), intent(in) :: body

        is_held_whole = any(body%fix == 'all')
    end function is_held_whole

    !> How messages about a group begin: 'deck.nml:14: &body id='plate': '.
    pure function label(group, id, place) result(text)
        character(*), intent(in) :: group, id
        character(*), intent(in), optional :: place !! absent, or not allocated, without a deck
        character(:), allocatable :: text

        text = '&'//group
        if (id /= '') text = text//" id='"//trim(id)//"'"
        text = text//': '
        if (present(place)) text = place//text
    end function label
end module brz_case
