! SPDX-License-Identifier: MIT
!> Rows of the key table for bodies and for how they meet.
module brz_body_keys
    use brz_key, only: key_t, required
    use brz_key_rows, only: add_group, add_rows, also_called, flag, number, whole_number, words
    use brz_kinds, only: dp
    use brz_body_geometries, only: own_keys, shape_choices
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

        call add_group(keys, 'body', 'A solid body of particles on a lattice. Without one no '// &
            'solid is computed.', [ &
            words('id', 'Name of the body.', default=required), &
            words('shape', 'Shape; planes of symmetry cut it. bars: rows of equal round bars; '// &
                'stl: within a closed surface; particles: from a file.', default='box', &
                choices=shape_choices()), &
            words('file', 'stl: a surface of triangles; particles: a table (.csv) with x, y, '// &
                'z and perhaps volume, or a dump (.vtkhdf, .h5). Relative to the deck.', &
                longest=256), &
            number('scale', '-', 'stl, particles: factor of the coordinates in the file.', &
                default='1.0', above=zero), &
            number('move', 'm', 'stl, particles: added to the scaled coordinates.', &
                default='0.0, 0.0, 0.0', n=3), &
            number('box', 'm', 'Box: corners x0, x1, y0, y1, z0, z1. Bars: the box that they '// &
                'fill, from the outside of the first to that of the last.', n=6), &
            number('centre', 'm', 'Sphere, cylinder: centre.', n=3), &
            number('radius', 'm', 'Sphere, cylinder: radius.', above=zero), &
            number('length', 'm', 'Cylinder: length.', above=zero), &
            number('inner_radius', 'm', 'Radius of the hole of a cylinder, of the hollow of a '// &
                'sphere.', default='0.0', lower=zero), &
            words('axis', 'Cylinder, bars: direction of the axis.', default='z', choices='x|y|z'), &
            number('diameter', 'm', 'Bars: diameter. Area and mass of each bar are exact at '// &
                'any spacing. One particle across needs a body bonded around it, two stretch '// &
                'right, three bend right too.', above=zero), &
            whole_number('bars', 'Bars: number of bars in the two directions across them, in '// &
                'cyclic order (y and z for axis x).', one, 10000*one, default='1, 1', n=2), &
            words('cuts', 'Ids of bodies that make room for this one where they overlap.', &
                n_max=8), &
            number('spacing', 'm', 'Distance of the particles.', default=required, above=zero, &
                likely=[1e-8_dp, one]), &
            words('lattice', 'layered: a cylinder with a hole is laid in rings round its '// &
                'axis, in corrected_hourglass, so that walls of three layers and more bend '// &
                'right.', default='cubic', choices='cubic|layered'), &
            number('aspect', '-', 'Box, total_lagrangian: width of a particle along x, y, z '// &
                'over the spacing, as 3, 3, 1 for a plate across z. Bends as cubes do with '// &
                'fewer particles; alone, without air.', default='1.0, 1.0, 1.0', lower=one, &
                upper=6*one, n=3)], &
            basic='id shape box centre radius length spacing')
    end subroutine shape_keys

    subroutine state_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_rows(keys, 'body', [ &
            words('material', 'Id of its &material.', default=required), &
            words('plies', 'Angles of the plies from the low to the high side, such as '// &
                "'0/45/-45/90', '7*(0/90)' or '[0/90]s' (mirrored).", unit='deg', longest=2048), &
            words('ply_axis', 'Normal of the plies.', default='z', choices='x|y|z'), &
            words('delamination', 'cohesive: the laminate is laid as bodies id.1, id.2, ... '// &
                'with cohesive interfaces between them, by zt, s13, s23, gdl of its material '// &
                'or an &interaction of it with itself.', default='none', choices='none|cohesive'), &
            words('interfaces', "delamination: between which plies; 'all', 'angles' (where "// &
                'the angle changes), or numbers (1 lies above the lowest ply).', default='all', &
                n_max=32, bare=.true.), &
            words('fix', 'Faces that are fixed; sides: all but the two across the thinnest '// &
                'direction.', choices='sides|all|x-|x+|y-|y+|z-|z+', n_max=8), &
            whole_number('fix_layers', 'Layers of particles that are fixed at such a face.', one, &
                1000*one, default='3'), &
            number('fix_width', 'm', 'Depth that is fixed at such a face, in place of '// &
                'fix_layers: it stays the same where the spacing changes.', above=zero), &
            number('fix_box', 'm', 'Regions in which particles are fixed: x0, x1, y0, y1, z0, '// &
                'z1 of each, up to eight.', n_min=6, n_max=48), &
            number('roller_box', 'm', 'Regions in which particles are fixed along one axis '// &
                'alone: x0, x1, y0, y1, z0, z1 of each, up to eight; a thin one is a line '// &
                'support.', n_min=6, n_max=48), &
            words('roller_axis', 'That axis, for each roller_box.', choices='x|y|z', n_max=8), &
            number('velocity', 'm/s', 'Initial velocity.', default='0.0, 0.0, 0.0', &
                likely=[zero, 2e4_dp], n=3), &
            number('spin', 'rad/s', 'Initial angular velocity, about spin_centre.', &
                default='0.0, 0.0, 0.0', likely=[zero, 1e5_dp], n=3), &
            number('spin_centre', 'm', 'Point that the spin turns about; if absent the centre '// &
                'of mass.', n=3), &
            words('start_file', 'Initial velocity (added), stress (linear_elastic) of the '// &
                'nearest point of a file: .csv with x, y, z, velocity_x, ..., stress_xx, ... '// &
                'or strain_xx, ..., or a dump.', longest=256), &
            flag('start_stress', 'start_file is a dump: take its stress and displacements too '// &
                '(linear_elastic).', '.false.'), &
            number('motion_time', 's', 'Times of a prescribed velocity, of a rigid body or of '// &
                'the particles that are fixed.', n_max=64), &
            number('motion_velocity', 'm/s', 'Velocity at these times, three numbers each, '// &
                'straight lines between them.', likely=[zero, 2e4_dp], n_min=3, n_max=192)], &
            basic='material plies fix velocity')
    end subroutine state_keys

    subroutine method_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_rows(keys, 'body', [ &
            words('formulation', 'auto: bending for elastic materials and plies (they bend '// &
                'and may break), corrected_hourglass for all others (they flow or fragment); '// &
                'rigid: moves and turns as a whole.', default='auto', choices='auto|bending|'// &
                'corrected_hourglass|corrected|uncorrected|paper|total_lagrangian|rigid'), &
            number('alpha', '-', 'Linear artificial viscosity; 1, with paper 2, if absent.', &
                lower=zero, upper=10*one), &
            number('beta', '-', 'Quadratic artificial viscosity; 2, with paper 10, if absent.', &
                lower=zero, upper=20*one), &
            words('limiter', 'Less artificial viscosity: balsara, where the material turns; '// &
                'compression, where it is not compressed; slope, where the velocity is smooth '// &
                '(corrected_hourglass). auto (without alpha): compression for hjc, balsara '// &
                'for metals that meet at up to 1 km/s.', default='auto', &
                choices='auto|none|balsara|compression|slope'), &
            words('crack_band', 'Where the spacing is too large for a fracture energy: keep '// &
                'the energy, lower the strength and warn; or stop.', default='weaken', &
                choices='weaken|refuse'), &
            words('artificial_stress', 'Repulsion in tension, by pressure or by principal '// &
                'stresses; auto: monaghan with paper, else none.', default='auto', &
                choices='auto|none|monaghan|gray'), &
            number('artificial_strength', '-', 'Its strength; 0.2 for monaghan, 0.3 for gray '// &
                'if absent.', lower=zero, upper=one), &
            number('zeta', '-', 'bending, total_lagrangian: stiffness of the hourglass force; '// &
                'if absent 2 (of the shear modulus; in plies what their bending needs).', &
                lower=zero, upper=4*one), &
            flag('hourglass_axes', 'bending of plies: hourglass stiffness along the axes of '// &
                'the laminate; F: that of an isotropic plate.', 'T'), &
            number('zeta_viscous', '-', 'corrected_hourglass: strength of the viscous '// &
                'hourglass force.', default='0.05', lower=zero, upper=one), &
            also_called('tension_hold', number('tensile_control', '-', &
                'corrected_hourglass: control of the tensile instability: stiffness over the '// &
                'largest principal tension; if absent 3, in fluids 0. Below 1.25 bodies tear '// &
                'by themselves. Faces of plates have twice it.', lower=zero, upper=12*one)), &
            words('plate_axis', 'corrected_hourglass: normal of a flat body, so that it bends '// &
                'right. auto: boxes and discs of 3 to 12 layers, at most 1/3 of every other '// &
                'side, and bars, where bodies meet at up to 1 km/s.', default='auto', &
                choices='auto|none|x|y|z'), &
            number('smoothing', '-', 'Smoothing length over spacing.', default='1.2', lower=one, &
                upper=2*one), &
            flag('variable_h', 'The smoothing length follows the density (slower).', 'F'), &
            number('h_range', '-', 'variable_h: bounds of the smoothing length over that of '// &
                'the unloaded body.', default='0.7, 1.2', lower=0.5_dp, upper=2*one, n=2), &
            number('cfl', '-', 'Time step of the body: c dt/h. Steel plates become unstable '// &
                'between 0.9 and 0.95.', default='0.4', above=zero, upper=0.9_dp)], &
            expert='alpha beta limiter crack_band artificial_stress '// &
                'artificial_strength zeta hourglass_axes zeta_viscous '// &
                'tensile_control plate_axis smoothing variable_h h_range '// &
                'cfl')
    end subroutine method_keys

    subroutine interaction_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'interaction', 'How bodies meet; later groups cover earlier '// &
            'ones. Without any, a body is bonded to those that it cuts and in contact with '// &
            'all others.', [ &
            words('id', 'Name of the interaction.'), &
            words('bodies', "Ids of two bodies; one: that body and every other; '*': all; "// &
                "'id*': all ids that begin so.", default="'*'", n_max=2), &
            words('law', 'contact: they press and rub; bonded: one continuum; shared: the '// &
                'same while pressed together; cohesive: joined by an interface with strength '// &
                'and energy, then contact; none: they pass each other.', default=required, &
                choices='contact|bonded|shared|cohesive|none'), &
            number('friction', '-', "contact: Coulomb's coefficient.", default='0.0', lower=zero, &
                upper=2*one), &
            number('stiffness', '-', 'contact: stiffness over that of one spacing of material.', &
                default='1.0', lower=0.1_dp, upper=2*one), &
            number('damping', '-', 'contact: damping on approach over half the linear viscosity.', &
                default='0.0', lower=zero, upper=2*one), &
            flag('shared_pressure', 'contact: share pressure and viscosity across the '// &
                'contact, for impacts beyond 1 km/s.', '.false.'), &
            number('tensile_strength', 'Pa', 'bonded: tension that breaks the bond; it never '// &
                'breaks if absent. cohesive: traction at which opening begins; required.', &
                above=zero, likely=[1e3_dp, 1e11_dp]), &
            number('shear_strength', 'Pa', 'The same in shear.', above=zero, &
                likely=[1e3_dp, 1e11_dp]), &
            words('bond_law', 'bonded: both strengths act together, or each for itself.', &
                default='quadratic', choices='quadratic|cut_off'), &
            number('gi', 'J/m2', 'cohesive: energy per area of opening (mode I); required.', &
                above=zero, likely=[1e-2_dp, 1e7_dp]), &
            number('gii', 'J/m2', 'cohesive: energy per area of sliding (mode II, III); '// &
                'required.', above=zero, likely=[1e-2_dp, 1e7_dp]), &
            words('mixed', 'cohesive: energy between the modes, by Benzeggagh and Kenane, gi '// &
                '+ (gii - gi) B^n, or by (G_I/gi)^n + (G_II/gii)^n = 1.', default='bk', &
                choices='bk|power'), &
            number('mixed_exponent', '-', 'cohesive: n of it; if absent 2 with bk, 1 with power.', &
                above=zero, upper=10*one), &
            number('interface_stiffness', 'Pa/m', 'cohesive: traction over opening before '// &
                'damage; if absent ten times the lesser modulus over the finer spacing, or '// &
                'less, so that it never halves the time step.', above=zero), &
            number('open_box', 'm', 'cohesive: regions that are not joined, cracks from the '// &
                'start: x0, x1, y0, y1, z0, z1 of each, up to eight.', n_min=6, n_max=48)], &
            basic='bodies law friction tensile_strength shear_strength gi '// &
                'gii', &
            expert='stiffness damping shared_pressure bond_law mixed '// &
                'mixed_exponent interface_stiffness')
    end subroutine interaction_keys
end module brz_body_keys
