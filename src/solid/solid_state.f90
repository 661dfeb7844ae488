! SPDX-License-Identifier: MIT
!> The state of the solids: particles, sorted body by body and by cell within a body.
!>
!> Time levels: x, stress and history live at the step, v half a step before (leapfrog). The
!> velocity at the step is v + dt_last/2 a. A kick is v += (dt_last + dt)/2 a + dt load/mass.
module brz_solid_state
    use brz_kinds, only: dp, int8, int32, int64, rk
    use brz_material, only: material_t
    implicit none
    private
    public :: solid_t, body_t, ledger_t
    public :: form_corrected, form_corrected_hourglass, form_bending, lanes

    integer, parameter :: form_corrected = 1, form_corrected_hourglass = 2, form_bending = 3
    integer, parameter :: lanes = 8 !! neighbour lists are padded with the particle itself to a multiple of this

    !> What one body has done with its energy so far, all in J.
    type :: ledger_t
        real(dp) :: viscous = 0 !! heat by artificial viscosity
        real(dp) :: hourglass = 0 !! energy held by (or fed to) the hourglass force
        real(dp) :: load = 0 !! work of the air on the body
        real(dp) :: plastic = 0 !! plastic work
        real(dp) :: damage = 0 !! work spent in damage
    end type ledger_t

    !> One body: particles first..last, one material, one formulation.
    type :: body_t
        character(32) :: id = ''
        integer :: first = 1, last = 0
        integer :: material = 0 !! place in solid%materials
        integer :: formulation = form_bending
        real(dp) :: spacing = 0 !! [m]
        real(rk) :: h = 0 !! smoothing length, constant [m]
        real(rk) :: alpha = 1, beta = 2, zeta = 2, zeta_viscous = 0
        real(rk) :: cfl = 0.4_rk
        type(ledger_t) :: ledger
    end type body_t

    type :: solid_t
        logical :: present = .false.
        integer :: n = 0 !! particles
        integer :: n_hist = 0 !! history variables kept per particle
        integer :: dimension = 3 !! 3, or 2 (plane strain), or 1
        logical :: mirror(3) = .false. !! symmetry plane through the origin normal to each axis
        real(dp) :: depth = 1 !! extent of the directions that are not modelled, multiplied [m or m2]
        real(dp) :: dt_last = 0 !! last time step [s]
        real(dp) :: skin = 0 !! of the neighbour list [m]
        logical :: asleep = .true. !! unloaded and at rest: no steps are taken
        integer(int64) :: steps = 0, rebuilds = 0
        type(body_t), allocatable :: bodies(:)
        type(material_t), allocatable :: materials(:)
        real(dp), allocatable :: x(:, :) !! (3, n) position [m]
        real(dp), allocatable :: x_ref(:, :) !! (3, n) position in the unloaded body [m]
        real(dp), allocatable :: x_built(:, :) !! (3, n) position when the neighbour list was built [m]
        real(rk), allocatable :: v(:, :) !! (3, n) velocity, half a step before [m/s]
        real(rk), allocatable :: a(:, :) !! (3, n) acceleration by internal forces [m/s2]
        real(rk), allocatable :: load(:, :) !! (3, n) force of the air, set by the coupling [N]
        real(rk), allocatable :: mass(:) !! (n) [kg]
        real(rk), allocatable :: mu(:) !! (n) compression rho/rho0 - 1 [-]
        real(rk), allocatable :: energy(:) !! (n) specific internal energy [J/kg]
        real(rk), allocatable :: stress(:, :) !! (6, n) Cauchy stress, tension positive [Pa]
        real(rk), allocatable :: hist(:, :) !! (n_hist, n) history of the material model
        real(rk), allocatable :: damage(:) !! (n) damage as pair forces see it, 0..1
        real(rk), allocatable :: c_wave(:) !! (n) fastest wave, for the time step [m/s]
        real(rk), allocatable :: c_bulk(:) !! (n) sound speed in the viscosity [m/s]
        real(rk), allocatable :: grad(:, :) !! (9, n) 'bending': dX/dx; 'corrected_hourglass': dv/dx
        integer(int32), allocatable :: id(:) !! (n) number of the particle, kept for life
        integer(int32), allocatable :: ply(:) !! (n) ply, from 1; 0 without plies
        integer(int8), allocatable :: fixed(:) !! (n) 1: held in place
        integer(int8), allocatable :: cut(:) !! (n) 1: hourglass support lost for good
        ! neighbour list: entries first(i)..first(i+1)-1 of `list`, image masks apart
        integer(int64), allocatable :: first(:) !! (n+1)
        integer(int64), allocatable :: image(:) !! (n) entries from here on are mirror images
        integer(int32), allocatable :: list(:) !! neighbour, padded with i itself
        integer(int8), allocatable :: mask(:) !! mirrored axes of an entry, bits 0..2
    end type solid_t
end module brz_solid_state
