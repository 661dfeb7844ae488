! SPDX-License-Identifier: MIT
!> Rows of the key table for what acts on a scene from outside: gas that comes in, loads, motions.
module brz_action_keys
    use brz_case, only: max_motion
    use brz_key, only: key_t, required
    use brz_key_rows, only: add_group, number, words
    use brz_kinds, only: dp
    implicit none
    private
    public :: inflow_keys, load_keys, motion_keys, most_points

    integer, parameter :: most_points = 200 !! of a history

contains

    !> Append the rows of &inflow.
    subroutine inflow_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        real(dp), parameter :: zero = 0

        call add_group(keys, 'inflow', 'Gas outside an open face of the air that comes in: a '// &
            'wave of a given overpressure, or a given state, steady or a history. Waves from '// &
            'inside leave through it.', [ &
            words('id', 'Name of the inflow.'), &
            words('face', "Face of the box; bc of &air there is 'outflow'.", default=required, &
                choices='x-|x+|y-|y+|z-|z+'), &
            number('time', 's', 'Times of the history, growing; straight lines between them. '// &
                'Not needed for what never changes.', n_max=most_points), &
            number('overpressure', 'Pa', 'Wave that runs from the face into the undisturbed '// &
                'air: its overpressure at these times, 0 before and after; shock relations '// &
                'and characteristics give the rest.', n_max=most_points), &
            number('density', 'kg/m3', 'State: density at these times, or one; that of the '// &
                'undisturbed air if absent. Before the first time and after the last it '// &
                'stays.', above=zero, n_max=most_points), &
            number('pressure', 'Pa', 'State: pressure, likewise.', above=zero, n_max=most_points), &
            number('velocity', 'm/s', 'State: velocity at these times, or one, three numbers '// &
                'each.', n_max=3*most_points), &
            number('mach', '-', 'State, in place of velocity: speed into the box over the '// &
                'speed of sound of the gas that comes.', n_max=most_points), &
            words('table', 'History from a file of comma-separated numbers: columns time and '// &
                'overpressure; or time, density, pressure and velocity_x, ..., or mach.', &
                longest=256)], &
            basic='face time overpressure')
    end subroutine inflow_keys

    !> Append the rows of &load.
    subroutine load_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        real(dp), parameter :: zero = 0

        call add_group(keys, 'load', 'A load on a body in a scene without air: a pressure on '// &
            'faces, which it follows as they deform (a history, or a blast by '// &
            'Kingery-Bulmash), or gravity or a force on all of it.', [ &
            words('id', 'Name of the load.'), &
            words('body', 'Id of the body that is loaded.', default=required), &
            words('faces', 'pressure, mass: faces of it, seen along an axis: the outermost '// &
                "particles there; with lattice='layered' inside (pressure) or outside of the "// &
                'wall.', choices='x-|x+|y-|y+|z-|z+|inside|outside', n_max=6), &
            words('patch', 'faces: only what lies under this surface is loaded, an STL file '// &
                'that may be open, seen along the axis of the face, within two spacings.', &
                longest=256), &
            number('time', 's', 'Times of the history, growing; straight lines between them, '// &
                '0 before and after. Not needed for one constant pressure.', n_max=most_points), &
            number('pressure', 'Pa', 'Overpressure at these times; positive pushes on the face.', &
                likely=[10.0_dp, 1e12_dp], n_max=most_points), &
            words('table', 'History from a file of comma-separated numbers, in place of time '// &
                'and pressure or scale: columns time and pressure, or scale.', longest=256), &
            number('mass', 'kg', 'Charge of TNT that detonates, in place of a history.', &
                above=zero), &
            words('burst', 'mass: a sphere in free air, or a hemisphere on the ground, which '// &
                'reflects the blast: its own mass counts, once.', default='air', &
                choices='air|surface'), &
            number('at', 'm', 'mass: centre of the charge.', n=3), &
            number('detonation_time', 's', 'mass: when it detonates. Negative: the run begins '// &
                'while the wave is on its way, so that gauges and dumps are of what matters.', &
                default='0.0'), &
            number('acceleration', 'm/s2', 'Of all particles of the body, as by gravity.', n=3), &
            number('force', 'N', 'On the part of the body that is modelled, spread by mass.', &
                n=3), &
            number('scale', '-', 'acceleration, force: factors at these times; if absent 1 '// &
                'for ever.', n_max=most_points)], &
            basic='body faces time pressure mass burst at')
    end subroutine load_keys

    !> Append the rows of &motion.
    subroutine motion_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)

        call add_group(keys, 'motion', 'A velocity that is prescribed for regions of a body, '// &
            'along all axes or some; a body may have many, and scenes without air.', [ &
            words('id', 'Name of the motion, for gauges of its force.', default=required), &
            words('body', 'Id of the body.', default=required), &
            number('box', 'm', 'Regions whose particles, where they are at the start, are '// &
                'moved: x0, x1, y0, y1, z0, z1 of each, up to eight.', default=required, n_min=6, &
                n_max=48), &
            words('axes', 'Axes along which they are moved; along the others they are free. '// &
                'All if absent.', choices='x|y|z', n_max=3), &
            number('time', 's', 'Times of the velocity, growing; straight lines between them, '// &
                'constant before and after. Not needed for one that never changes.', &
                n_max=max_motion), &
            number('velocity', 'm/s', 'Velocity at these times, or one, three numbers each; 0 '// &
                'along axes that are free.', default=required, n_min=3, n_max=3*max_motion)], &
            basic='id body box time velocity')
    end subroutine motion_keys
end module brz_action_keys
