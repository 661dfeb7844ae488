! SPDX-License-Identifier: MIT
!> The numbers of a cohesive interface that its traction-separation law takes.
module brz_cohesive_numbers
    use brz_kinds, only: dp
    implicit none
    private
    public :: cohesive_law_t, mixed_bk, mixed_power

    integer, parameter :: mixed_bk = 1, mixed_power = 2

    type :: cohesive_law_t
        real(dp) :: stiffness !! [Pa/m]
        real(dp) :: strength(2) !! in tension and in shear [Pa]
        real(dp) :: energy(2) !! in tension and in shear [J/m2]
        real(dp) :: exponent !! of the law of mixed modes [-]
        integer :: mixed !! mixed_bk or mixed_power
        !> of the opening across and along the interface: the law is that of openings so much
        !> smaller, which makes it softer by the square, with the same strength and energy
        real(dp) :: stretch(2) = 1
        !> in addition to stretch(2), of plies: along the first tangent more and along the second
        !> less by the first number, and across each other by the second
        real(dp) :: skew(2) = 0
    end type cohesive_law_t
end module brz_cohesive_numbers
