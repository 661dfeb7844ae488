! SPDX-License-Identifier: MIT
!> What the point physics of the air must know of the scheme and of the gases: plain data.
!>
!> Besides air there may be one more gas, the products of the explosives, carried as a sixth
!> conserved variable rho Y. Point physics.
module brz_scheme
    use brz_kinds, only: rk
    implicit none
    private
    public :: scheme_t, mixture_gamma, reach_of, max_var
    public :: first_order, muscl_cells, weno3_cells, weno5z_cells, steger_warming, hllc

    integer, parameter :: max_var = 6 !! conserved variables: density, momentum, energy, products
    integer, parameter :: first_order = 1, muscl_cells = 2, weno3_cells = 3, weno5z_cells = 4
    !! reconstructions
    integer, parameter :: steger_warming = 1, hllc = 2 !! fluxes

    !> Without a deck the combination of the paper; what a deck says nothing about is in case.f90.
    type :: scheme_t
        integer :: reconstruction = weno3_cells
        integer :: flux = steger_warming
        logical :: mixture = .false. !! the products have a ratio of specific heats of their own
        real(rk) :: gamma = 1.4_rk !! ratio of specific heats of the air [-]
        real(rk) :: gamma_products = 1.4_rk !! likewise of the products [-]
        real(rk) :: scale(5) = 1 !! 1/(typical value)^2 of what is reconstructed, see weno3
    end type scheme_t

contains

    !> Ratio of specific heats of air with a mass fraction Y of products, clipped to 0..1.
    !>
    !> Ideal gases of equal molar mass at one temperature: 1/(gamma - 1) is the mean by mass.
    !> Written so that pure air gives its own gamma exactly.
    !@cuf attributes(host,device) &
    pure function mixture_gamma(scheme, fraction) result(gamma)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: fraction !! mass fraction of the products [-]
        real(rk) :: gamma, y, a, p

        y = max(0.0_rk, min(1.0_rk, fraction))
        a = scheme%gamma - 1
        p = scheme%gamma_products - 1
        gamma = scheme%gamma - a*y*(a - p)/(p + y*(a - p))
    end function mixture_gamma

    !> Cells on each side of a face that its flux depends on.
    !@cuf attributes(host,device) &
    pure function reach_of(scheme) result(reach)
        type(scheme_t), intent(in) :: scheme
        integer :: reach

        reach = 2
        if (scheme%reconstruction == weno5z_cells) reach = 3
    end function reach_of
end module brz_scheme
