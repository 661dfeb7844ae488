! SPDX-License-Identifier: MIT
!> What a pair force needs of a particle: the places of its numbers in a row of `pair`.
module brz_pair_layout
    implicit none
    private
    public :: n_pair, pair_volume, pair_linear, pair_quadratic, pair_zeta, pair_stress, &
              pair_affine, pair_spin, pair_tilt, pair_keep

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
end module brz_pair_layout
