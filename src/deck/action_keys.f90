! SPDX-License-Identifier: MIT
!> Rows of the key table for what acts on a scene from outside: gas that comes in, loads, motions.
module brz_action_keys
    use brz_case, only: max_motion
    use brz_key, only: key_t, kind_text, required
    use brz_kinds, only: dp
    implicit none
    private
    public :: inflow_keys, load_keys, motion_keys, most_points

    integer, parameter :: most_points = 200 !! of a history

contains

    !> Append the rows of &inflow.
    subroutine inflow_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'inflow'
        real(dp), parameter :: zero = 0

        keys = [keys, &
                key_t(group=g, meaning='Gas outside an open face of the air that comes in: a '// &
                      'wave of a given overpressure, or a given state, steady or a history. '// &
                      'Waves from inside leave through it.'), &
                key_t(group=g, key='id', kind=kind_text, meaning='Name of the inflow.'), &
                key_t(group=g, key='face', kind=kind_text, default=required, &
                      choices='x-|x+|y-|y+|z-|z+', &
                      meaning="Face of the box; bc of &air there is 'outflow'."), &
                key_t(group=g, key='time', n_max=most_points, unit='s', &
                      meaning='Times of the history, growing; straight lines between them. Not '// &
                      'needed for what never changes.'), &
                key_t(group=g, key='overpressure', n_max=most_points, unit='Pa', &
                      meaning='Wave that runs from the face into the undisturbed air: its '// &
                      'overpressure at these times, 0 before and after; shock relations and '// &
                      'characteristics give the rest.'), &
                key_t(group=g, key='density', n_max=most_points, unit='kg/m3', lower=zero, &
                      open_lower=.true., &
                      meaning='State: density at these times, or one; that of the undisturbed '// &
                      'air if absent. Before the first time and after the last it stays.'), &
                key_t(group=g, key='pressure', n_max=most_points, unit='Pa', lower=zero, &
                      open_lower=.true., meaning='State: pressure, likewise.'), &
                key_t(group=g, key='velocity', n_max=3*most_points, unit='m/s', &
                      meaning='State: velocity at these times, or one, three numbers each.'), &
                key_t(group=g, key='mach', n_max=most_points, &
                      meaning='State, in place of velocity: speed into the box over the speed '// &
                      'of sound of the gas that comes.'), &
                key_t(group=g, key='table', kind=kind_text, longest=256, &
                      meaning='History from a file of comma-separated numbers: columns time '// &
                      'and overpressure; or time, density, pressure and velocity_x, ..., or mach.')]
    end subroutine inflow_keys

    !> Append the rows of &load.
    subroutine load_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'load'
        real(dp), parameter :: zero = 0

        keys = [keys, &
                key_t(group=g, meaning='A load on a body in a scene without air: a pressure on '// &
                      'faces, which it follows as they deform (a history, or a blast by '// &
                      'Kingery-Bulmash), or gravity or a force on all of it.'), &
                key_t(group=g, key='id', kind=kind_text, meaning='Name of the load.'), &
                key_t(group=g, key='body', kind=kind_text, default=required, &
                      meaning='Id of the body that is loaded.'), &
                key_t(group=g, key='faces', kind=kind_text, n_max=6, &
                      choices='x-|x+|y-|y+|z-|z+|inside|outside', &
                      meaning='pressure, mass: faces of it, seen along an axis: the outermost '// &
                      "particles there; with lattice='layered' inside (pressure) or outside of "// &
                      'the wall.'), &
                key_t(group=g, key='patch', kind=kind_text, longest=256, &
                      meaning='faces: only what lies under this surface is loaded, an STL file '// &
                      'that may be open, seen along the axis of the face, within two spacings.'), &
                key_t(group=g, key='time', n_max=most_points, unit='s', &
                      meaning='Times of the history, growing; straight lines between them, 0 '// &
                      'before and after. Not needed for one constant pressure.'), &
                key_t(group=g, key='pressure', n_max=most_points, unit='Pa', &
                      likely=[10.0_dp, 1e12_dp], &
                      meaning='Overpressure at these times; positive pushes on the face.'), &
                key_t(group=g, key='table', kind=kind_text, longest=256, &
                      meaning='History from a file of comma-separated numbers, in place of '// &
                      'time and pressure or scale: columns time and pressure, or scale.'), &
                key_t(group=g, key='mass', unit='kg', lower=zero, open_lower=.true., &
                      meaning='Charge of TNT that detonates, in place of a history.'), &
                key_t(group=g, key='burst', kind=kind_text, choices='air|surface', &
                      default='air', meaning='mass: a sphere in free air, or a hemisphere on '// &
                      'the ground, which reflects the blast: its own mass counts, once.'), &
                key_t(group=g, key='at', n_min=3, n_max=3, unit='m', &
                      meaning='mass: centre of the charge.'), &
                key_t(group=g, key='detonation_time', unit='s', default='0.0', &
                      meaning='mass: when it detonates. Negative: the run begins while the '// &
                      'wave is on its way, so that gauges and dumps are of what matters.'), &
                key_t(group=g, key='acceleration', n_min=3, n_max=3, unit='m/s2', &
                      meaning='Of all particles of the body, as by gravity.'), &
                key_t(group=g, key='force', n_min=3, n_max=3, unit='N', &
                      meaning='On the part of the body that is modelled, spread by mass.'), &
                key_t(group=g, key='scale', n_max=most_points, &
                      meaning='acceleration, force: factors at these times; if absent 1 for '// &
                      'ever.')]
    end subroutine load_keys

    !> Append the rows of &motion.
    subroutine motion_keys(keys)
        type(key_t), allocatable, intent(inout) :: keys(:)
        character(*), parameter :: g = 'motion'

        keys = [keys, &
                key_t(group=g, meaning='A velocity that is prescribed for regions of a body, '// &
                      'along all axes or some; a body may have many, and scenes without air.'), &
                key_t(group=g, key='id', kind=kind_text, default=required, &
                      meaning='Name of the motion, for gauges of its force.'), &
                key_t(group=g, key='body', kind=kind_text, default=required, &
                      meaning='Id of the body.'), &
                key_t(group=g, key='box', n_min=6, n_max=48, unit='m', default=required, &
                      meaning='Regions whose particles, where they are at the start, are '// &
                      'moved: x0, x1, y0, y1, z0, z1 of each, up to eight.'), &
                key_t(group=g, key='axes', kind=kind_text, n_max=3, choices='x|y|z', &
                      meaning='Axes along which they are moved; along the others they are '// &
                      'free. All if absent.'), &
                key_t(group=g, key='time', n_max=max_motion, unit='s', &
                      meaning='Times of the velocity, growing; straight lines between them, '// &
                      'constant before and after. Not needed for one that never changes.'), &
                key_t(group=g, key='velocity', n_min=3, n_max=3*max_motion, unit='m/s', &
                      default=required, meaning='Velocity at these times, or one, three '// &
                      'numbers each; 0 along axes that are free.')]
    end subroutine motion_keys
end module brz_action_keys
