! SPDX-License-Identifier: MIT
!> Rows of the key table for bodies and for how they meet.
module brz_body_keys
    use brz_key, only: key_t, kind_integer, kind_logical, kind_real, kind_text, required
    use brz_kinds, only: dp
    use brz_outlines, only: own_keys, shape_choices
    implicit none
    private
    public :: body_keys

    real(dp), parameter :: zero = 0, one = 1

contains

    !> Append the rows of &body and &interaction.
    subroutine body_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call shape_keys(keys)
        keys = [keys, own_keys()]
        call state_keys(keys)
        call method_keys(keys)
        call interaction_keys(keys)
    end subroutine body_keys

    subroutine shape_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'body'

        keys = [keys, &
                key_t(group=g, &
                      meaning='A solid body of particles on a lattice. Without one no solid '// &
                      'is computed.'), &
                key_t(group=g, key='id', kind=kind_text, default=required, &
                      meaning='Name of the body.'), &
                key_t(group=g, key='shape', kind=kind_text, default='box', &
                      choices=shape_choices(), &
                      meaning='Shape; planes of symmetry cut it. bars: rows of equal '// &
                      'round bars; stl: within a closed surface; particles: from a file.'), &
                key_t(group=g, key='file', kind=kind_text, longest=256, &
                      meaning="stl: a surface of triangles; particles: a table (.csv) with "// &
                      "x, y, z and perhaps volume, or a dump (.vtkhdf, .h5). Relative to the "// &
                      "deck."), &
                key_t(group=g, key='scale', default='1.0', lower=zero, open_lower=.true., &
                      meaning='stl, particles: factor of the coordinates in the file.'), &
                key_t(group=g, key='move', n_min=3, n_max=3, unit='m', &
                      default='0.0, 0.0, 0.0', &
                      meaning='stl, particles: added to the scaled coordinates.'), &
                key_t(group=g, key='box', n_min=6, n_max=6, unit='m', &
                      meaning='Box: corners x0, x1, y0, y1, z0, z1. Bars: the box that they '// &
                      'fill, from the outside of the first to that of the last.'), &
                key_t(group=g, key='centre', n_min=3, n_max=3, unit='m', &
                      meaning='Sphere, cylinder: centre.'), &
                key_t(group=g, key='radius', unit='m', lower=zero, open_lower=.true., &
                      meaning='Sphere, cylinder: radius.'), &
                key_t(group=g, key='length', unit='m', lower=zero, open_lower=.true., &
                      meaning='Cylinder: length.'), &
                key_t(group=g, key='inner_radius', unit='m', default='0.0', lower=zero, &
                      meaning='Radius of the hole of a cylinder, of the hollow of a sphere.'), &
                key_t(group=g, key='axis', kind=kind_text, default='z', choices='x|y|z', &
                      meaning='Cylinder, bars: direction of the axis.'), &
                key_t(group=g, key='diameter', unit='m', lower=zero, open_lower=.true., &
                      meaning='Bars: diameter. Area and mass of each bar are exact at any '// &
                      'spacing. One particle across needs a body bonded around it, two '// &
                      'stretch right, three bend right too.'), &
                key_t(group=g, key='bars', kind=kind_integer, n_min=2, n_max=2, default='1, 1', &
                      lower=one, upper=10000*one, &
                      meaning='Bars: number of bars in the two directions across them, in '// &
                      'cyclic order (y and z for axis x).'), &
                key_t(group=g, key='cuts', kind=kind_text, n_max=8, &
                      meaning='Ids of bodies that make room for this one where they overlap.'), &
                key_t(group=g, key='spacing', unit='m', default=required, lower=zero, &
                      open_lower=.true., likely=[1e-8_dp, one], &
                      meaning='Distance of the particles.'), &
                key_t(group=g, key='lattice', kind=kind_text, default='cubic', &
                      choices='cubic|layered', &
                      meaning='layered: a cylinder with a hole is laid in rings round its '// &
                      'axis, in corrected_hourglass, so that walls of three layers and more '// &
                      'bend right.'), &
                key_t(group=g, key='aspect', n_min=3, n_max=3, default='1.0, 1.0, 1.0', &
                      lower=one, upper=6*one, &
                      meaning='Box, total_lagrangian: width of a particle along x, y, z over '// &
                      'the spacing, as 3, 3, 1 for a plate across z. Bends as cubes do with '// &
                      'fewer particles; alone, without air.')]
    end subroutine shape_keys

    subroutine state_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'body'

        keys = [keys, &
                key_t(group=g, key='material', kind=kind_text, default=required, &
                      meaning='Id of its &material.'), &
                key_t(group=g, key='plies', kind=kind_text, unit='deg', longest=2048, &
                      meaning="Angles of the plies from the low to the high side, such as "// &
                      "'0/45/-45/90', '7*(0/90)' or '[0/90]s' (mirrored)."), &
                key_t(group=g, key='ply_axis', kind=kind_text, default='z', choices='x|y|z', &
                      meaning='Normal of the plies.'), &
                key_t(group=g, key='delamination', kind=kind_text, default='none', &
                      choices='none|cohesive', &
                      meaning='cohesive: the laminate is laid as bodies id.1, id.2, ... with '// &
                      'cohesive interfaces between them, by zt, s13, s23, gdl of its material '// &
                      'or an &interaction of it with itself.'), &
                key_t(group=g, key='interfaces', kind=kind_text, n_max=32, default='all', &
                      bare=.true., &
                      meaning="delamination: between which plies; 'all', 'angles' (where the "// &
                      "angle changes), or numbers (1 lies above the lowest ply)."), &
                key_t(group=g, key='fix', kind=kind_text, n_max=8, &
                      choices='sides|all|x-|x+|y-|y+|z-|z+', &
                      meaning='Faces that are fixed; sides: all but the two across the '// &
                      'thinnest direction.'), &
                key_t(group=g, key='fix_layers', kind=kind_integer, default='3', lower=one, &
                      upper=1000*one, &
                      meaning='Layers of particles that are fixed at such a face.'), &
                key_t(group=g, key='fix_width', unit='m', lower=zero, open_lower=.true., &
                      meaning='Depth that is fixed at such a face, in place of fix_layers: it '// &
                      'stays the same where the spacing changes.'), &
                key_t(group=g, key='fix_box', n_min=6, n_max=48, unit='m', &
                      meaning='Regions in which particles are fixed: x0, x1, y0, y1, z0, z1 '// &
                      'of each, up to eight.'), &
                key_t(group=g, key='roller_box', n_min=6, n_max=48, unit='m', &
                      meaning='Regions in which particles are fixed along one axis alone: x0, '// &
                      'x1, y0, y1, z0, z1 of each, up to eight; a thin one is a line support.'), &
                key_t(group=g, key='roller_axis', kind=kind_text, n_max=8, choices='x|y|z', &
                      meaning='That axis, for each roller_box.'), &
                key_t(group=g, key='velocity', n_min=3, n_max=3, unit='m/s', &
                      default='0.0, 0.0, 0.0', likely=[zero, 2e4_dp], &
                      meaning='Initial velocity.'), &
                key_t(group=g, key='spin', n_min=3, n_max=3, unit='rad/s', &
                      default='0.0, 0.0, 0.0', likely=[zero, 1e5_dp], &
                      meaning='Initial angular velocity, about spin_centre.'), &
                key_t(group=g, key='spin_centre', n_min=3, n_max=3, unit='m', &
                      meaning='Point that the spin turns about; if absent the centre of mass.'), &
                key_t(group=g, key='start_file', kind=kind_text, longest=256, &
                      meaning='Initial velocity (added), stress (linear_elastic) of the '// &
                      'nearest point of a file: .csv with x, y, z, velocity_x, ..., '// &
                      'stress_xx, ... or strain_xx, ..., or a dump.'), &
                key_t(group=g, key='start_stress', kind=kind_logical, default='.false.', &
                      meaning='start_file is a dump: take its stress and displacements too '// &
                      '(linear_elastic).'), &
                key_t(group=g, key='motion_time', n_max=64, unit='s', &
                      meaning='Times of a prescribed velocity, of a rigid body or of the '// &
                      'particles that are fixed.'), &
                key_t(group=g, key='motion_velocity', n_min=3, n_max=192, unit='m/s', &
                      likely=[zero, 2e4_dp], &
                      meaning='Velocity at these times, three numbers each, straight lines '// &
                      'between them.')]
    end subroutine state_keys

    subroutine method_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'body'

        keys = [keys, &
                key_t(group=g, key='formulation', kind=kind_text, default='auto', &
                      choices='auto|bending|corrected_hourglass|corrected|uncorrected|paper|'// &
                      'total_lagrangian|rigid', &
                      meaning='auto: bending for elastic materials and plies (they bend and '// &
                      'may break), corrected_hourglass for all others (they flow or '// &
                      'fragment); rigid: moves and turns as a whole.'), &
                key_t(group=g, key='alpha', lower=zero, upper=10*one, &
                      meaning='Linear artificial viscosity; 1, with paper 2, if absent.'), &
                key_t(group=g, key='beta', lower=zero, upper=20*one, &
                      meaning='Quadratic artificial viscosity; 2, with paper 10, if absent.'), &
                key_t(group=g, key='limiter', kind=kind_text, default='auto', &
                      choices='auto|none|balsara|compression|slope', &
                      meaning='Less artificial viscosity: balsara, where the material turns; '// &
                      'compression, where it is not compressed; slope, where the velocity is '// &
                      'smooth (corrected_hourglass). auto (without alpha): compression for '// &
                      'hjc, balsara for metals that meet at up to 1 km/s.'), &
                key_t(group=g, key='crack_band', kind=kind_text, default='weaken', &
                      choices='weaken|refuse', meaning='Where the spacing is too large for a '// &
                      'fracture energy: keep the energy, lower the strength and warn; or stop.'), &
                key_t(group=g, key='artificial_stress', kind=kind_text, default='auto', &
                      choices='auto|none|monaghan|gray', &
                      meaning='Repulsion in tension, by pressure or by principal stresses; '// &
                      'auto: monaghan with paper, else none.'), &
                key_t(group=g, key='artificial_strength', lower=zero, upper=one, &
                      meaning='Its strength; 0.2 for monaghan, 0.3 for gray if absent.'), &
                key_t(group=g, key='zeta', lower=zero, upper=4*one, &
                      meaning='bending, total_lagrangian: stiffness of the hourglass force; if '// &
                      'absent 2 (of the shear modulus; in plies what their bending needs).'), &
                key_t(group=g, key='hourglass_axes', kind=kind_logical, default='T', &
                      meaning='bending of plies: hourglass stiffness along the axes of the '// &
                      'laminate; F: that of an isotropic plate.'), &
                key_t(group=g, key='zeta_viscous', default='0.05', lower=zero, upper=one, &
                      meaning='corrected_hourglass: strength of the viscous hourglass force.'), &
                key_t(group=g, key='tensile_control', lower=zero, upper=12*one, &
                      alias='tension_hold', &
                      meaning='corrected_hourglass: control of the tensile instability: '// &
                      'stiffness over the largest principal tension; if absent 3, in fluids 0. '// &
                      'Below 1.25 bodies tear by themselves. Faces of plates have twice it.'), &
                key_t(group=g, key='plate_axis', kind=kind_text, default='auto', &
                      choices='auto|none|x|y|z', &
                      meaning='corrected_hourglass: normal of a flat body, so that it bends '// &
                      'right. auto: boxes and discs of 3 to 12 layers, at most 1/3 of every '// &
                      'other side, and bars, where bodies meet at up to 1 km/s.'), &
                key_t(group=g, key='smoothing', default='1.2', lower=one, upper=2*one, &
                      meaning='Smoothing length over spacing.'), &
                key_t(group=g, key='variable_h', kind=kind_logical, default='F', &
                      meaning='The smoothing length follows the density (slower).'), &
                key_t(group=g, key='h_range', n_min=2, n_max=2, default='0.7, 1.2', &
                      lower=0.5_dp, upper=2*one, &
                      meaning='variable_h: bounds of the smoothing length over that of the '// &
                      'unloaded body.'), &
                key_t(group=g, key='cfl', default='0.4', lower=zero, open_lower=.true., &
                      upper=0.9_dp, meaning='Time step of the body: c dt/h. Steel '// &
                      'plates become unstable between 0.9 and 0.95.')]
    end subroutine method_keys

    subroutine interaction_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'interaction'

        keys = [keys, &
                key_t(group=g, &
                      meaning='How bodies meet; later groups cover earlier ones. Without any, '// &
                      'a body is bonded to those that it cuts and in contact with all others.'), &
                key_t(group=g, key='id', kind=kind_text, meaning='Name of the interaction.'), &
                key_t(group=g, key='bodies', kind=kind_text, n_max=2, default="'*'", &
                      meaning="Ids of two bodies; one: that body and every other; '*': all; "// &
                      "'id*': all ids that begin so."), &
                key_t(group=g, key='law', kind=kind_text, default=required, &
                      choices='contact|bonded|shared|cohesive|none', &
                      meaning='contact: they press and rub; bonded: one continuum; shared: '// &
                      'the same while pressed together; cohesive: joined by an interface with '// &
                      'strength and energy, then contact; none: they pass each other.'), &
                key_t(group=g, key='friction', default='0.0', lower=zero, upper=2*one, &
                      meaning="contact: Coulomb's coefficient."), &
                key_t(group=g, key='stiffness', default='1.0', lower=0.1_dp, upper=2*one, &
                      meaning='contact: stiffness over that of one spacing of material.'), &
                key_t(group=g, key='damping', default='0.0', lower=zero, upper=2*one, &
                      meaning='contact: damping on approach over half the linear viscosity.'), &
                key_t(group=g, key='shared_pressure', kind=kind_logical, default='.false.', &
                      meaning='contact: share pressure and viscosity across the contact, for '// &
                      'impacts beyond 1 km/s.'), &
                key_t(group=g, key='tensile_strength', unit='Pa', lower=zero, &
                      open_lower=.true., likely=[1e3_dp, 1e11_dp], &
                      meaning='bonded: tension that breaks the bond; it never breaks if '// &
                      'absent. cohesive: traction at which opening begins; required.'), &
                key_t(group=g, key='shear_strength', unit='Pa', lower=zero, open_lower=.true., &
                      likely=[1e3_dp, 1e11_dp], &
                      meaning='The same in shear.'), &
                key_t(group=g, key='bond_law', kind=kind_text, default='quadratic', &
                      choices='quadratic|cut_off', &
                      meaning='bonded: both strengths act together, or each for itself.'), &
                key_t(group=g, key='gi', unit='J/m2', lower=zero, open_lower=.true., &
                      likely=[1e-2_dp, 1e7_dp], &
                      meaning='cohesive: energy per area of opening (mode I); required.'), &
                key_t(group=g, key='gii', unit='J/m2', lower=zero, open_lower=.true., &
                      likely=[1e-2_dp, 1e7_dp], &
                      meaning='cohesive: energy per area of sliding (mode II, III); required.'), &
                key_t(group=g, key='mixed', kind=kind_text, default='bk', choices='bk|power', &
                      meaning='cohesive: energy between the modes, by Benzeggagh and Kenane, '// &
                      'gi + (gii - gi) B^n, or by (G_I/gi)^n + (G_II/gii)^n = 1.'), &
                key_t(group=g, key='mixed_exponent', lower=zero, open_lower=.true., &
                      upper=10*one, &
                      meaning='cohesive: n of it; if absent 2 with bk, 1 with power.'), &
                key_t(group=g, key='interface_stiffness', unit='Pa/m', lower=zero, &
                      open_lower=.true., &
                      meaning='cohesive: traction over opening before damage; if absent ten '// &
                      'times the lesser modulus over the finer spacing, or less, so that it '// &
                      'never halves the time step.'), &
                key_t(group=g, key='open_box', n_min=6, n_max=48, unit='m', &
                      meaning='cohesive: regions that are not joined, cracks from the start: '// &
                      'x0, x1, y0, y1, z0, z1 of each, up to eight.')]
    end subroutine interaction_keys
end module brz_body_keys
