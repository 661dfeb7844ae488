! SPDX-License-Identifier: MIT
!> The key table of the deck: one row per key, for all groups but the models of &material.
!>
!> A row whose key is empty describes its group. A group with a key 'id' may stand many times. The
!> keys of the material models are more rows of the same kind, with the model as owner.
module brz_core_keys
    use brz_body_keys, only: body_keys
    use brz_boundary_names, only: boundary_choices
    use brz_explosives, only: explosive_names
    use brz_check_inflow, only: inflow_keys
    use brz_check_loads, only: load_keys
    use brz_check_motions, only: motion_keys
    use brz_gauge_quantities, only: quantity_choices
    use brz_key, only: key_t, kind_integer, kind_logical, kind_real, kind_text, none, required
    use brz_kinds, only: dp
    implicit none
    private
    public :: core_keys

    real(dp), parameter :: zero = 0, one = 1
    integer, parameter :: max_times = 1000 !! most times of dumps

contains

    !> Fill the key table.
    subroutine core_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        if (allocated(keys)) deallocate (keys)
        allocate (keys(0))
        call run_keys(keys)
        call air_keys(keys)
        call gas_keys(keys)
        call inflow_keys(keys)
        call charge_keys(keys)
        call material_group_keys(keys)
        call body_keys(keys)
        call load_keys(keys)
        call motion_keys(keys)
        call gauge_keys(keys)
        call settings_keys(keys)
        call point_keys(keys)
    end subroutine core_keys

    subroutine run_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'run'

        keys = [keys, &
                key_t(group=g, meaning='The run as a whole. Required.'), &
                key_t(group=g, key='title', kind=kind_text, longest=200, &
                      meaning='Title of the scene, for logs and pictures.'), &
                key_t(group=g, key='t_end', unit='s', default=required, lower=zero, &
                      open_lower=.true., meaning='Time at which the run ends.'), &
                key_t(group=g, key='symmetry', kind=kind_text, n_max=3, choices='x|y|z', &
                      meaning='Mirror planes through the origin, normal to these axes; only '// &
                      'the positive side is modelled.'), &
                key_t(group=g, key='dimension', kind=kind_integer, default='3', lower=one, &
                      upper=3*one, meaning='3; or 2: plane strain in x and y; or 1: along x.'), &
                key_t(group=g, key='backend', kind=kind_text, default='auto', &
                      choices='auto|cpu|gpu', &
                      meaning='Where to compute; auto takes a GPU if there is one.'), &
                key_t(group=g, key='dt_max', unit='s', lower=zero, open_lower=.true., &
                      meaning='Largest time step; no limit if absent.'), &
                key_t(group=g, key='dt_min', unit='s', default='0.0', lower=zero, &
                      meaning='A smaller time step ends the run with exit code 3.'), &
                key_t(group=g, key='energy_band', lower=zero, open_lower=.true., &
                      meaning='Largest allowed relative error of the total energy; a larger '// &
                      'one ends the run with exit code 3. No limit if absent.'), &
                key_t(group=g, key='max_steps', kind=kind_integer, lower=zero, &
                      upper=real(huge(1), dp), &
                      meaning='The run ends after so many steps; no limit if absent.')]
    end subroutine run_keys

    subroutine air_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'air'

        keys = [keys, &
                key_t(group=g, &
                      meaning='The air: a box of equal cells. Without it no fluid is '// &
                      'computed.'), &
                key_t(group=g, key='geometry', kind=kind_text, default='cartesian', &
                      choices='cartesian|spherical|cylindrical|planar|axial', &
                      meaning='cartesian: a box of cells. Otherwise one charge in open air, '// &
                      'along the radius alone, or in the plane through its axis (axial); takes '// &
                      'neither box nor cells.'), &
                key_t(group=g, key='floor', unit='m', &
                      meaning="geometry='axial': coordinate of a rigid floor across the axis "// &
                      'of the charge, below its centre. If absent: open air.'), &
                key_t(group=g, key='box', n_min=6, n_max=6, unit='m', &
                      meaning='Corners of the box: x0, x1, y0, y1, z0, z1.'), &
                key_t(group=g, key='cells', kind=kind_integer, n_min=3, n_max=3, &
                      lower=one, upper=1e6_dp, &
                      meaning='Cells in x, y, z; 1 in a direction that is not modelled.'), &
                key_t(group=g, key='bc', kind=kind_text, n_max=6, default='outflow', &
                      choices=boundary_choices(), &
                      meaning='Boundaries: one word for all, or six: x low, x high, y low, y '// &
                      'high, z low, z high. A plane of symmetry of &run sets its low face.'), &
                key_t(group=g, key='density', unit='kg/m3', default='1.225', lower=zero, &
                      open_lower=.true., likely=[0.01_dp, 100*one], &
                      meaning='Density of the undisturbed air.'), &
                key_t(group=g, key='pressure', unit='Pa', default='101325.0', lower=zero, &
                      open_lower=.true., likely=[1e3_dp, 1e8_dp], &
                      meaning='Pressure of the undisturbed air.'), &
                key_t(group=g, key='gamma', default='1.4', lower=one, open_lower=.true., &
                      upper=5*one, meaning='Ratio of the specific heats.'), &
                key_t(group=g, key='cfl', default='0.5', lower=zero, open_lower=.true., &
                      upper=one, meaning='Time step of the air over its limit of stability.'), &
                key_t(group=g, key='ramp_steps', kind=kind_integer, default='20', lower=zero, &
                      upper=1e6_dp, &
                      meaning='First steps, over which the time step grows from a tenth to '// &
                      'the whole.'), &
                key_t(group=g, key='reconstruction', kind=kind_text, default='muscl', &
                      choices='first_order|muscl|weno3|weno5z', &
                      meaning='Reconstruction at the faces: of the split fluxes with '// &
                      'steger_warming, of density, velocity and pressure with hllc.'), &
                key_t(group=g, key='flux', kind=kind_text, default='hllc', &
                      choices='steger_warming|hllc', &
                      meaning='Flux: by splitting, or by an approximate Riemann solver that '// &
                      'keeps contacts.'), &
                key_t(group=g, key='integrator', kind=kind_text, default='ssprk2', &
                      choices='ssprk3|ssprk2', &
                      meaning='Runge-Kutta method: three stages or two; weno5z needs three.'), &
                key_t(group=g, key='activity', kind=kind_logical, default='.true.', &
                      meaning='Leave out cells that nothing has reached; the results are the '// &
                      'same.'), &
                key_t(group=g, key='fallback', kind=kind_logical, default='.true.', &
                      meaning='First-order fluxes at faces where a state would become '// &
                      'unphysical; they are counted.')]
    end subroutine air_keys

    subroutine gas_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'gas'

        keys = [keys, &
                key_t(group=g, &
                      meaning='A box of gas with an initial state of its own, or gas from a '// &
                      'file; later ones cover earlier ones.'), &
                key_t(group=g, key='id', kind=kind_text, default=required, &
                      meaning='Name of the box of gas.'), &
                key_t(group=g, key='box', n_min=6, n_max=6, unit='m', &
                      meaning='Corners: x0, x1, y0, y1, z0, z1.'), &
                key_t(group=g, key='density', unit='kg/m3', lower=zero, &
                      open_lower=.true., meaning='Initial density.'), &
                key_t(group=g, key='pressure', unit='Pa', lower=zero, &
                      open_lower=.true., meaning='Initial pressure.'), &
                key_t(group=g, key='velocity', n_min=3, n_max=3, unit='m/s', &
                      default='0.0, 0.0, 0.0', meaning='Initial velocity.'), &
                key_t(group=g, key='file', kind=kind_text, longest=256, &
                      meaning='In place of these: a dump of the air (other cells are fine), or '// &
                      'a .csv with density, pressure and x, y, z, velocity_x, ..., or r, '// &
                      'velocity.'), &
                key_t(group=g, key='move', n_min=3, n_max=3, unit='m', default='0.0, 0.0, 0.0', &
                      meaning='file: shift of what it holds.'), &
                key_t(group=g, key='at', n_min=3, n_max=3, unit='m', default='0.0, 0.0, 0.0', &
                      meaning='file along a radius r: centre.')]
    end subroutine gas_keys

    subroutine charge_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'charge'

        keys = [keys, &
                key_t(group=g, meaning='An explosive charge, as a balloon of hot gas.'), &
                key_t(group=g, key='id', kind=kind_text, default=required, &
                      meaning='Name of the charge.'), &
                key_t(group=g, key='mass', unit='kg', default=required, lower=zero, &
                      open_lower=.true., &
                      meaning='Mass of the whole charge, also of the parts behind planes of '// &
                      "symmetry; with burst='surface' of what lies on the ground, once."), &
                key_t(group=g, key='burst', kind=kind_text, choices='air|surface', &
                      meaning='surface: the charge is half of its shape and lies on the '// &
                      'ground, a floor or plane of symmetry through at, which mirrors it; as '// &
                      'in &load. If absent: air; on a floor it must be given.'), &
                key_t(group=g, key='explosive', kind=kind_text, default='tnt', &
                      choices=explosive_names, &
                      meaning='Explosive: gives density, energy, detonation velocity and the '// &
                      'constants of JWL.'), &
                key_t(group=g, key='start', kind=kind_text, default='3d', &
                      choices='3d|1d|2d', &
                      meaning='3d: a balloon of hot gas on the grid. 1d: computed along the '// &
                      'radius, 2d: in the plane through the axis, until the shock nears an '// &
                      'obstacle, then mapped.'), &
                key_t(group=g, key='eos', kind=kind_text, default='ideal', choices='ideal|jwl', &
                      meaning='Equation of state of the products: ideal gas, or Jones-Wilkins-'// &
                      "Lee, which needs start='1d' or '2d', or a geometry without a box."), &
                key_t(group=g, key='burn', kind=kind_text, default='programmed', &
                      choices='programmed|instant', &
                      meaning="eos='jwl': a detonation from the centre (2d: from ignition), "// &
                      'or burnt at once at constant volume.'), &
                key_t(group=g, key='ignition', n_min=3, n_max=3, unit='m', &
                      meaning="start='2d': the point on the axis where the detonation begins. "// &
                      'If absent: the centre.'), &
                key_t(group=g, key='gamma', lower=one, open_lower=.true., upper=5*one, &
                      meaning='Ratio of the specific heats of the products. If absent: that '// &
                      'of the air, or with jwl 1 + omega. All charges must give the same.'), &
                key_t(group=g, key='shape', kind=kind_text, default='sphere', &
                      choices='sphere|cylinder|box', meaning='Shape.'), &
                key_t(group=g, key='at', n_min=3, n_max=3, unit='m', default=required, &
                      meaning='Centre.'), &
                key_t(group=g, key='density', unit='kg/m3', lower=zero, open_lower=.true., &
                      likely=[100*one, 3000*one], &
                      meaning='Density of the explosive, if not that of the table.'), &
                key_t(group=g, key='energy', unit='J/kg', lower=zero, open_lower=.true., &
                      likely=[1e5_dp, 2e7_dp], &
                      meaning='Energy set free by detonation, if not that of the table.'), &
                key_t(group=g, key='velocity', unit='m/s', lower=zero, open_lower=.true., &
                      likely=[500*one, 12000*one], &
                      meaning='Velocity of the detonation, if not that of the table.'), &
                key_t(group=g, key='radial_cells', kind=kind_integer, default='240', &
                      lower=40*one, upper=4000*one, &
                      meaning='Cells in the charge while it is computed along the radius; the '// &
                      'air has up to three times as many.'), &
                key_t(group=g, key='plane_cells', kind=kind_integer, default='160', &
                      lower=40*one, upper=4000*one, &
                      meaning="start='2d': cells from the axis to the edge of the plane, which "// &
                      'grows with the blast; a quarter of them lie in the charge at first.'), &
                key_t(group=g, key='afterburn', unit='J/kg', default='0.0', lower=zero, &
                      meaning='Along the radius alone: energy that the products set free by '// &
                      'burning with the air, at a constant rate.'), &
                key_t(group=g, key='afterburn_time', unit='s', lower=zero, open_lower=.true., &
                      meaning='How long that takes.'), &
                key_t(group=g, key='aspect', default='1.0', lower=zero, open_lower=.true., &
                      meaning='Cylinder: length over diameter.'), &
                key_t(group=g, key='sides', n_min=3, n_max=3, default='1.0, 1.0, 1.0', &
                      lower=zero, open_lower=.true., meaning='Box: ratio of the sides.'), &
                key_t(group=g, key='axis', kind=kind_text, default='z', choices='x|y|z', &
                      meaning="Axis of a cylinder; with start='2d' also the line about which "// &
                      'all is round (across the floor).')]
    end subroutine charge_keys

    subroutine material_group_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'material'

        keys = [keys, &
                key_t(group=g, meaning='A material: a model and the keys of that model.'), &
                key_t(group=g, key='id', kind=kind_text, default=required, &
                      meaning='Name of the material, to which bodies refer.'), &
                key_t(group=g, key='model', kind=kind_text, default=required, &
                      meaning='Model; it decides on the other keys. A preset brings its own.'), &
                key_t(group=g, key='preset', kind=kind_text, &
                      meaning='Named set of keys that this group need not give: see brisance '// &
                      '--describe presets.'), &
                key_t(group=g, key='failure', kind=kind_text, default='model', &
                      choices='model|none', &
                      meaning="'none': a metal or a ply that never fails, whatever the group "// &
                      'or its preset says of that.')]
    end subroutine material_group_keys

    subroutine gauge_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'gauge'

        keys = [keys, &
                key_t(group=g, meaning='A gauge: the history of one quantity, at one '// &
                      'point or of a whole body.'), &
                key_t(group=g, key='id', kind=kind_text, default=required, &
                      meaning='Name of the gauge.'), &
                key_t(group=g, key='at', n_min=3, n_max=3, unit='m', &
                      meaning='Point; a gauge in a body moves with the nearest particle. '// &
                      'moment: point that it is taken about. Not of other forces on a body.'), &
                key_t(group=g, key='to', n_min=3, n_max=3, unit='m', &
                      meaning='strain: the other end of the strain gauge.'), &
                key_t(group=g, key='quantity', kind=kind_text, default='pressure', &
                      choices=quantity_choices(), &
                      meaning='What is measured. The air has the first seven; with body it is '// &
                      'of the body, and from reaction_x on of all of it.'), &
                key_t(group=g, key='body', kind=kind_text, &
                      meaning='Id of the body that is measured; absent: the air.'), &
                key_t(group=g, key='with', kind=kind_text, &
                      meaning='contact_x, ..., impulse_x, ...: what this other body alone does '// &
                      'to the body.'), &
                key_t(group=g, key='motion', kind=kind_text, &
                      meaning='reaction_x, ...: force of the body on what this &motion of it '// &
                      'moves alone.')]
    end subroutine gauge_keys

    subroutine settings_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        keys = [keys, &
                key_t(group='solid', meaning='Settings shared by all bodies.'), &
                key_t(group='solid', key='skin', default='0.3', lower=zero, upper=2*one, &
                      meaning='Skin of the neighbour list over the spacing of the particles.'), &
                key_t(group='solid', key='region', n_min=6, n_max=6, unit='m', &
                      meaning='Box x0, x1, y0, y1, z0, z1 whose leaving is watched; that of '// &
                      'the air if absent.'), &
                key_t(group='solid', key='leave', kind=kind_text, default='report', &
                      choices='report|stop|remove', &
                      meaning='When particles leave the region: report it and let them fly on, '// &
                      'stop with a checkpoint and exit code 3, or remove them from everything '// &
                      'but the totals.'), &
                key_t(group='coupling', meaning='How air and bodies meet.'), &
                key_t(group='coupling', key='scheme', kind=kind_text, default='wall_flux', &
                      choices='wall_flux|paper', &
                      meaning='wall_flux: fluxes at walls, nothing is lost. paper: as the paper'// &
                      ' prints it, solid cells filled with gas, to compare; it loses mass.'), &
                key_t(group='coupling', key='spread', default='1.5', lower=zero, &
                      open_lower=.true., upper=10*one, &
                      meaning='Depth over which a surface load is spread into a body, in air '// &
                      'cells.'), &
                key_t(group='coupling', key='reference_pressure', unit='Pa', lower=zero, &
                      meaning='Pressure taken off every load; that of the undisturbed air if '// &
                      'absent.'), &
                key_t(group='output', meaning='What is written, and how often.'), &
                key_t(group='output', key='dump_every', unit='s', lower=zero, open_lower=.true., &
                      meaning='Time between dumps; only the first and the last if absent.'), &
                key_t(group='output', key='dump_from', unit='s', default='0.0', lower=zero, &
                      meaning='First time of the dumps of dump_every; the start is dumped in '// &
                      'any case.'), &
                key_t(group='output', key='dump_times', n_max=max_times, unit='s', lower=zero, &
                      meaning='Times of dumps besides those of dump_every, growing.'), &
                key_t(group='output', key='history_every', unit='s', default='0.0', lower=zero, &
                      meaning='Time between rows of the histories; 0: every step.'), &
                key_t(group='output', key='checkpoint_every', unit='s', lower=zero, &
                      open_lower=.true., meaning='Time between checkpoints; none if absent.'), &
                key_t(group='output', key='report_every', unit='s', default='5.0', lower=zero, &
                      meaning='Wall-clock time between lines of the log.')]
    end subroutine settings_keys

    !> What `brisance mat` reads: one material point and the path it is driven along.
    subroutine point_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: p = 'point', s = 'segment'

        keys = [keys, &
                key_t(group=p, meaning='A material point, for `brisance mat`.'), &
                key_t(group=p, key='material', kind=kind_text, default=required, &
                      meaning='Id of its &material.'), &
                key_t(group=p, key='steps', kind=kind_integer, default='1000', lower=one, &
                      upper=1e8_dp, meaning='Steps of a segment.'), &
                key_t(group=p, key='output_every', kind=kind_integer, default='1', lower=one, &
                      upper=1e8_dp, &
                      meaning='Steps between rows of the table; ends of segments are always '// &
                      'written.'), &
                key_t(group=p, key='rotation', unit='deg', default='0.0', &
                      meaning='Angle of the ply about its normal.'), &
                key_t(group=p, key='ply_axis', kind=kind_text, default='z', choices='x|y|z', &
                      meaning='Normal of the ply.'), &
                key_t(group=p, key='crack_length', unit='m', default='0.001', lower=zero, &
                      open_lower=.true., former='smoothing_length', &
                      meaning='Width of a smeared crack, over which a fracture energy is '// &
                      'spent; in a body 2.1 or, in bending, 2.35 spacings.'), &
                key_t(group=s, meaning='A part of the path of `brisance mat`; they follow in '// &
                      'the order of the deck.'), &
                key_t(group=s, key='id', kind=kind_text, &
                      meaning='Name, where --set has to tell segments apart.'), &
                key_t(group=s, key='duration', unit='s', lower=zero, open_lower=.true., &
                      meaning='Time that it takes; strain may be given instead.'), &
                key_t(group=s, key='strain', &
                      meaning='uniaxial_stress, triaxial: strain along the axis at the end '// &
                      'less that at the start; with the rate it gives the duration.'), &
                key_t(group=s, key='steps', kind=kind_integer, lower=one, upper=1e8_dp, &
                      meaning='Steps of this segment; absent: those of &point.'), &
                key_t(group=s, key='control', kind=kind_text, default='strain', &
                      choices='strain|uniaxial_stress|triaxial|pressure', &
                      meaning='What is given: l; rate, no other stress; rate and '// &
                      'lateral_stress; pressure alone.'), &
                key_t(group=s, key='l', n_min=9, n_max=9, unit='1/s', &
                      meaning='strain: velocity gradient dv_i/dx_j, row by row.'), &
                key_t(group=s, key='axis', kind=kind_text, default='x', choices='x|y|z', &
                      meaning='uniaxial_stress, triaxial: axis along which the rate is given.'), &
                key_t(group=s, key='rate', unit='1/s', &
                      meaning='uniaxial_stress, triaxial: rate of deformation along the axis.'), &
                key_t(group=s, key='lateral_stress', unit='Pa', &
                      meaning='triaxial: both normal stresses across the axis, negative in '// &
                      'compression, held.'), &
                key_t(group=s, key='pressure', unit='Pa', &
                      meaning='pressure: reached evenly in time from that at the start, '// &
                      'without shear stress.')]
    end subroutine point_keys
end module brz_core_keys
