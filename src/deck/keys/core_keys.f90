! SPDX-License-Identifier: MIT
!> The key table of the deck: one row per key, for all groups but the models of &material.
!>
!> A row whose key is empty describes its group. A group with a key 'id' may stand many times. The
!> keys of the material models are more rows of the same kind, with the model as owner.
module brz_core_keys
    use brz_action_keys, only: inflow_keys, load_keys, motion_keys
    use brz_body_keys, only: body_keys
    use brz_boundary_names, only: boundary_choices
    use brz_explosives, only: explosive_names
    use brz_gauge_quantities, only: quantity_choices
    use brz_key, only: key_t, none, required
    use brz_key_rows, only: add_group, flag, number, whole_number, words
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

        call add_group(keys, 'run', 'The run as a whole. Required.', [ &
            words('title', 'Title of the scene, for logs and pictures.', longest=200), &
            number('t_end', 's', 'Time at which the run ends.', default=required, above=zero), &
            words('symmetry', 'Mirror planes through the origin, normal to these axes; only '// &
                'the positive side is modelled.', choices='x|y|z', n_max=3), &
            whole_number('dimension', '3; or 2: plane strain in x and y; or 1: along x.', one, &
                3*one, default='3'), &
            words('backend', 'Where to compute; auto takes a GPU if there is one.', &
                default='auto', choices='auto|cpu|gpu'), &
            number('dt_max', 's', 'Largest time step; no limit if absent.', above=zero), &
            number('dt_min', 's', 'A smaller time step ends the run with exit code 3.', &
                default='0.0', lower=zero), &
            number('energy_band', '-', 'Largest allowed relative error of the total energy; a '// &
                'larger one ends the run with exit code 3. No limit if absent.', above=zero), &
            whole_number('max_steps', 'The run ends after so many steps; no limit if absent.', &
                zero, real(huge(1), dp))], &
            basic='title t_end symmetry dimension backend', &
            expert='dt_max dt_min energy_band max_steps')
    end subroutine run_keys

    subroutine air_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'air', 'The air: a box of equal cells. Without it no fluid is '// &
            'computed.', [ &
            words('geometry', 'cartesian: a box of cells. Otherwise one charge in open air, '// &
                'along the radius alone, or in the plane through its axis (axial); takes '// &
                'neither box nor cells.', default='cartesian', &
                choices='cartesian|spherical|cylindrical|planar|axial'), &
            number('floor', 'm', "geometry='axial': coordinate of a rigid floor across the "// &
                'axis of the charge, below its centre. If absent: open air.'), &
            number('box', 'm', 'Corners of the box: x0, x1, y0, y1, z0, z1.', n=6), &
            whole_number('cells', 'Cells in x, y, z; 1 in a direction that is not modelled.', one, &
                1e6_dp, n=3), &
            words('bc', 'Boundaries: one word for all, or six: x low, x high, y low, y high, '// &
                'z low, z high. A plane of symmetry of &run sets its low face.', &
                default='outflow', choices=boundary_choices(), n_max=6), &
            number('density', 'kg/m3', 'Density of the undisturbed air.', default='1.225', &
                above=zero, likely=[0.01_dp, 100*one]), &
            number('pressure', 'Pa', 'Pressure of the undisturbed air.', default='101325.0', &
                above=zero, likely=[1e3_dp, 1e8_dp]), &
            number('gamma', '-', 'Ratio of the specific heats.', default='1.4', above=one, &
                upper=5*one), &
            number('cfl', '-', 'Time step of the air over its limit of stability.', default='0.5', &
                above=zero, upper=one), &
            whole_number('ramp_steps', 'First steps, over which the time step grows from a '// &
                'tenth to the whole.', zero, 1e6_dp, default='20'), &
            words('reconstruction', 'Reconstruction at the faces: of the split fluxes with '// &
                'steger_warming, of density, velocity and pressure with hllc.', default='muscl', &
                choices='first_order|muscl|weno3|weno5z'), &
            words('flux', 'Flux: by splitting, or by an approximate Riemann solver that keeps '// &
                'contacts.', default='hllc', choices='steger_warming|hllc'), &
            words('integrator', 'Runge-Kutta method: three stages or two; weno5z needs three.', &
                default='ssprk2', choices='ssprk3|ssprk2'), &
            flag('activity', 'Leave out cells that nothing has reached; the results are the '// &
                'same.', '.true.'), &
            flag('fallback', 'First-order fluxes at faces where a state would become '// &
                'unphysical; they are counted.', '.true.')], &
            basic='geometry floor box cells bc', &
            expert='gamma cfl ramp_steps reconstruction flux integrator '// &
                'activity fallback')
    end subroutine air_keys

    subroutine gas_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'gas', 'A box of gas with an initial state of its own, or gas '// &
            'from a file; later ones cover earlier ones.', [ &
            words('id', 'Name of the box of gas.', default=required), &
            number('box', 'm', 'Corners: x0, x1, y0, y1, z0, z1.', n=6), &
            number('density', 'kg/m3', 'Initial density.', above=zero), &
            number('pressure', 'Pa', 'Initial pressure.', above=zero), &
            number('velocity', 'm/s', 'Initial velocity.', default='0.0, 0.0, 0.0', n=3), &
            words('file', 'In place of these: a dump of the air (other cells are fine), or a '// &
                '.csv with density, pressure and x, y, z, velocity_x, ..., or r, velocity.', &
                longest=256), &
            number('move', 'm', 'file: shift of what it holds.', default='0.0, 0.0, 0.0', n=3), &
            number('at', 'm', 'file along a radius r: centre.', default='0.0, 0.0, 0.0', n=3)], &
            basic='id box density pressure velocity')
    end subroutine gas_keys

    subroutine charge_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'charge', 'An explosive charge, as a balloon of hot gas.', [ &
            words('id', 'Name of the charge.', default=required), &
            number('mass', 'kg', 'Mass of the whole charge, also of the parts behind planes '// &
                "of symmetry; with burst='surface' of what lies on the ground, once.", &
                default=required, above=zero), &
            words('burst', 'surface: the charge is half of its shape and lies on the ground, '// &
                'a floor or plane of symmetry through at, which mirrors it; as in &load. If '// &
                'absent: air; on a floor it must be given.', choices='air|surface'), &
            words('explosive', 'Explosive: gives density, energy, detonation velocity and the '// &
                'constants of JWL.', default='tnt', choices=explosive_names), &
            words('start', '3d: a balloon of hot gas on the grid. 1d: computed along the '// &
                'radius, 2d: in the plane through the axis, until the shock nears an '// &
                'obstacle, then mapped.', default='3d', choices='3d|1d|2d'), &
            words('eos', 'Equation of state of the products: ideal gas, or Jones-Wilkins-Lee, '// &
                "which needs start='1d' or '2d', or a geometry without a box.", default='ideal', &
                choices='ideal|jwl'), &
            words('burn', "eos='jwl': a detonation from the centre (2d: from ignition), or "// &
                'burnt at once at constant volume.', default='programmed', &
                choices='programmed|instant'), &
            number('ignition', 'm', "start='2d': the point on the axis where the detonation "// &
                'begins. If absent: the centre.', n=3), &
            number('gamma', '-', 'Ratio of the specific heats of the products. If absent: '// &
                'that of the air, or with jwl 1 + omega. All charges must give the same.', &
                above=one, upper=5*one), &
            words('shape', 'Shape.', default='sphere', choices='sphere|cylinder|box'), &
            number('at', 'm', 'Centre.', default=required, n=3), &
            number('density', 'kg/m3', 'Density of the explosive, if not that of the table.', &
                above=zero, likely=[100*one, 3000*one]), &
            number('energy', 'J/kg', 'Energy set free by detonation, if not that of the table.', &
                above=zero, likely=[1e5_dp, 2e7_dp]), &
            number('velocity', 'm/s', 'Velocity of the detonation, if not that of the table.', &
                above=zero, likely=[500*one, 12000*one]), &
            whole_number('radial_cells', 'Cells in the charge while it is computed along the '// &
                'radius; the air has up to three times as many.', 40*one, 4000*one, &
                default='240'), &
            whole_number('plane_cells', "start='2d': cells from the axis to the edge of the "// &
                'plane, which grows with the blast; a quarter of them lie in the charge at '// &
                'first.', 40*one, 4000*one, default='160'), &
            number('afterburn', 'J/kg', 'Along the radius alone: energy that the products set '// &
                'free by burning with the air, at a constant rate.', default='0.0', lower=zero), &
            number('afterburn_time', 's', 'How long that takes.', above=zero), &
            number('aspect', '-', 'Cylinder: length over diameter.', default='1.0', above=zero), &
            number('sides', '-', 'Box: ratio of the sides.', default='1.0, 1.0, 1.0', above=zero, &
                n=3), &
            words('axis', "Axis of a cylinder; with start='2d' also the line about which all "// &
                'is round (across the floor).', default='z', choices='x|y|z')], &
            basic='id mass burst explosive start eos shape at', &
            expert='radial_cells plane_cells')
    end subroutine charge_keys

    subroutine material_group_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'material', 'A material: a model and the keys of that model.', [ &
            words('id', 'Name of the material, to which bodies refer.', default=required), &
            words('model', 'Model; it decides on the other keys. A preset brings its own.', &
                default=required), &
            words('preset', 'Named set of keys that this group need not give: see brisance '// &
                '--describe presets.'), &
            words('failure', "'none': a metal or a ply that never fails, whatever the group "// &
                'or its preset says of that.', default='model', choices='model|none')], &
            basic='id model preset failure')
    end subroutine material_group_keys

    subroutine gauge_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'gauge', 'A gauge: the history of one quantity, at one point or '// &
            'of a whole body.', [ &
            words('id', 'Name of the gauge.', default=required), &
            number('at', 'm', 'Point; a gauge in a body moves with the nearest particle. '// &
                'moment: point that it is taken about. Not of other forces on a body.', n=3), &
            number('to', 'm', 'strain: the other end of the strain gauge.', n=3), &
            number('width', 'm', 'Sides of a box about the point, one for all or along x, y '// &
                'and z: the mean over what lies of it in the air, or of the unloaded body '// &
                'in it, takes the place of the value at the point. 0: not along that axis.', &
                lower=zero, n_min=1, n_max=3), &
            words('quantity', 'What is measured. The air has the first seven; with body it is '// &
                'of the body, and from reaction_x on of all of it.', default='pressure', &
                choices=quantity_choices()), &
            words('body', 'Id of the body that is measured; absent: the air.'), &
            words('with', 'contact_x, ..., impulse_x, ...: what this other body alone does to '// &
                'the body.'), &
            words('motion', 'reaction_x, ...: force of the body on what this &motion of it '// &
                'moves alone.')], &
            basic='id at quantity body')
    end subroutine gauge_keys

    subroutine settings_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'solid', 'Settings shared by all bodies.', [ &
            number('skin', '-', 'Skin of the neighbour list over the spacing of the particles.', &
                default='0.3', lower=zero, upper=2*one), &
            number('region', 'm', 'Box x0, x1, y0, y1, z0, z1 whose leaving is watched; that '// &
                'of the air if absent.', n=6), &
            words('leave', 'When particles leave the region: report it and let them fly on, '// &
                'stop with a checkpoint and exit code 3, or remove them from everything but '// &
                'the totals.', default='report', choices='report|stop|remove'), &
            number('jitter', '-', 'Largest shift of each particle along each axis at the '// &
                'start, over the spacing, to see what chance does to bodies that break; '// &
                'rigid bodies stay.', default='0.0', lower=zero, upper=0.1_dp), &
            whole_number('seed', 'Number of the set of shifts by jitter.', zero, &
                real(huge(1), dp), default='1')], &
            basic='region leave', &
            expert='skin jitter seed')
        call add_group(keys, 'coupling', 'How air and bodies meet.', [ &
            words('scheme', 'cut_cells: walls where they are, through cells; nothing is lost. '// &
                'paper: as the paper prints it, solid cells filled with gas, to compare; it '// &
                'loses mass.', default='cut_cells', choices='cut_cells|paper'), &
            number('reference_pressure', 'Pa', 'Pressure taken off every load; that of the '// &
                'undisturbed air if absent.', lower=zero)], &
            expert='scheme reference_pressure')
        call add_group(keys, 'output', 'What is written, and how often.', [ &
            number('dump_every', 's', 'Time between dumps; only the first and the last if '// &
                'absent.', above=zero), &
            number('dump_from', 's', 'First time of the dumps of dump_every; the start is '// &
                'dumped in any case.', default='0.0', lower=zero), &
            number('dump_times', 's', 'Times of dumps besides those of dump_every, growing.', &
                lower=zero, n_max=max_times), &
            number('history_every', 's', 'Time between rows of the histories; 0: every step.', &
                default='0.0', lower=zero), &
            number('checkpoint_every', 's', 'Time between checkpoints; none if absent.', &
                above=zero), &
            number('report_every', 's', 'Wall-clock time between lines of the log.', &
                default='5.0', lower=zero)], &
            basic='dump_every history_every checkpoint_every', &
            expert='report_every')
    end subroutine settings_keys

    !> What `brisance mat` reads: one material point and the path it is driven along.
    subroutine point_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'point', 'A material point, for `brisance mat`.', [ &
            words('material', 'Id of its &material.', default=required), &
            whole_number('steps', 'Steps of a segment.', one, 1e8_dp, default='1000'), &
            whole_number('output_every', 'Steps between rows of the table; ends of segments '// &
                'are always written.', one, 1e8_dp, default='1'), &
            number('rotation', 'deg', 'Angle of the ply about its normal.', default='0.0'), &
            words('ply_axis', 'Normal of the ply.', default='z', choices='x|y|z'), &
            number('crack_length', 'm', 'Width of a smeared crack, over which a fracture '// &
                'energy is spent; in a body 2.1 or, in bending, 2.35 spacings.', default='0.001', &
                above=zero, former='smoothing_length')], &
            basic='material steps')
        call add_group(keys, 'segment', 'A part of the path of `brisance mat`; they follow in '// &
            'the order of the deck.', [ &
            words('id', 'Name, where --set has to tell segments apart.'), &
            number('duration', 's', 'Time that it takes; strain may be given instead.', &
                above=zero), &
            number('strain', '-', 'uniaxial_stress, triaxial: strain along the axis at the '// &
                'end less that at the start; with the rate it gives the duration.'), &
            whole_number('steps', 'Steps of this segment; absent: those of &point.', one, 1e8_dp), &
            words('control', 'What is given: l; rate, no other stress; rate and '// &
                'lateral_stress; pressure alone.', default='strain', &
                choices='strain|uniaxial_stress|triaxial|pressure'), &
            number('l', '1/s', 'strain: velocity gradient dv_i/dx_j, row by row.', n=9), &
            words('axis', 'uniaxial_stress, triaxial: axis along which the rate is given.', &
                default='x', choices='x|y|z'), &
            number('rate', '1/s', 'uniaxial_stress, triaxial: rate of deformation along the '// &
                'axis.'), &
            number('lateral_stress', 'Pa', 'triaxial: both normal stresses across the axis, '// &
                'negative in compression, held.'), &
            number('pressure', 'Pa', 'pressure: reached evenly in time from that at the '// &
                'start, without shear stress.')], &
            basic='duration strain control rate')
    end subroutine point_keys
end module brz_core_keys
