! SPDX-License-Identifier: MIT
!> Explosives that a deck can name: density, energy, detonation velocity, constants of JWL.
!>
!> Source: Dobratz and Crawford 1985, LLNL Explosives Handbook, UCRL-52997. The constants of each
!> give its Chapman-Jouguet pressure and velocity back to 0.1 % (tests/unit/test_jwl.pf). There is
!> no row for PE4, for which no such set is established; C-4 is its nearest relative.
module brz_explosives
    use brz_kinds, only: dp
    implicit none
    private
    public :: explosive_t, explosives, explosive_names, find_explosive

    type :: explosive_t
        character(8) :: name = ''
        real(dp) :: density = 0 !! [kg/m3]
        real(dp) :: energy = 0 !! per initial volume [J/m3]
        real(dp) :: velocity = 0 !! of the detonation [m/s]
        real(dp) :: cj_pressure = 0 !! [Pa]
        real(dp) :: a = 0, b = 0 !! [Pa]
        real(dp) :: r1 = 0, r2 = 0, omega = 0
    end type explosive_t

    type(explosive_t), parameter :: explosives(4) = [ &
        explosive_t('tnt', 1630.0_dp, 7.0e9_dp, 6930.0_dp, 21.0e9_dp, &
            371.2e9_dp, 3.231e9_dp, 4.15_dp, 0.95_dp, 0.30_dp), &
        explosive_t('c4', 1601.0_dp, 9.0e9_dp, 8193.0_dp, 28.0e9_dp, &
            609.77e9_dp, 12.95e9_dp, 4.50_dp, 1.40_dp, 0.25_dp), &
        explosive_t('comp_b', 1717.0_dp, 8.5e9_dp, 7980.0_dp, 29.5e9_dp, &
            524.23e9_dp, 7.678e9_dp, 4.20_dp, 1.10_dp, 0.34_dp), &
        explosive_t('petn', 1770.0_dp, 10.1e9_dp, 8300.0_dp, 33.5e9_dp, &
            617.0e9_dp, 16.926e9_dp, 4.40_dp, 1.20_dp, 0.25_dp)]

    character(*), parameter :: explosive_names = 'tnt|c4|comp_b|petn' !! choices of the deck

contains

    !> Row of an explosive; 0 if there is none of that name.
    pure integer function find_explosive(name)
        character(*), intent(in) :: name

        find_explosive = findloc(explosives%name == name, .true., dim=1)
    end function find_explosive
end module brz_explosives
