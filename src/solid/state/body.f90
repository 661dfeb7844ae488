! SPDX-License-Identifier: MIT
!> A body: which particles it has, of what, and what happened to it as a whole.
module brz_body
    use brz_body_numbers, only: body_numbers_t
    use brz_energy_account, only: energy_account_t
    use brz_kept_cells, only: kept_cells_t
    use brz_kinds, only: dp, rk
    use brz_motion, only: motion_t
    use brz_rigid_body, only: rigid_t
    use brz_round_surface, only: round_t
    implicit none
    private
    public :: body_t

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
        logical :: in_tension = .false. !! in this step something of it is held
        integer :: limiter = 0 !! of the viscosity in shear, see brz_gradient
        logical :: directional = .false. !! hourglass stiffness along the axes of the material
        real(rk), allocatable :: axes(:, :, :) !! (3, 4, 0:plies) unloaded axes of it, column by
                                               !! column, and the stiffness along them [Pa]
        logical :: curved = .false. !! a wall round the axis of `round`: the normal of a particle is
                                    !! radial, and `normal` 1 in the directions across the axis
        logical :: layer_of_ply = .false. !! `layer_stiffness` along the axes of a ply
        real(rk) :: outward = 0 !! from where its faces see the strain, further out [m]
        real(rk) :: artificial_strength = 0
        logical :: inactive = .false. !! unloaded and at rest: left out of the steps
        ! what all of the body has moved since its list was built, see brz_list_drift
        real(dp) :: drift(3) = 0, drift_velocity(3) = 0 !! [m], [m/s]
        type(kept_cells_t) :: cells !! of its list
        real(dp) :: dt_limit = 0 !! largest stable time step times the CFL number [s]
        real(dp) :: reaction(3) = 0 !! impulse that the fixed particles took up so far [N s]
        real(dp) :: impulse(3) = 0 !! of the load so far, where a gauge asks for it [N s]
        type(energy_account_t) :: account
        type(rigid_t) :: rigid !! of a rigid body
        type(motion_t) :: motion !! that is prescribed
        type(motion_t), allocatable :: regions(:) !! those of regions of it; none if not allocated
        type(round_t) :: round !! its surface, where that is known to be round
        real(dp), allocatable :: surface(:, :, :) !! (3, 3, triangles) corners of it [m]; from a
                                                  !! file, until `find_contact_surface`
    end type body_t
end module brz_body
