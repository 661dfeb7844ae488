! SPDX-License-Identifier: MIT
!> Air and the products of an explosive in one cell: pressure and speed of sound. Point physics.
!>
!> Both fill the cell at one temperature (Dalton): p = the two exponentials of JWL at the partial
!> density of the products, plus thermal energy over 1/(gamma - 1), which is the mean by mass of
!> those of air and products. Far out the exponentials vanish, and what is left is the mixture of
!> ideal gases that the box carries. Explosive that is not burnt yet holds its energy back and
!> fills no volume; so it lies in air of the pressure p0 without moving.
module brz_axial_products
    use brz_jwl, only: jwl_t
    use brz_kinds, only: dp
    implicit none
    private
    public :: axial_gas_t, gas_state

    real(dp), parameter :: spent = 40 !! exponent beyond which an exponential of JWL is nothing

    !> The two gases.
    type :: axial_gas_t
        type(jwl_t) :: eos !! products; rho0 and e0 are those of the charge
        real(dp) :: gamma = 1.4_dp !! of the air [-]
        real(dp) :: density = 1.225_dp, pressure = 101325 !! undisturbed air
        real(dp) :: held_back = 0 !! energy that burning sets free [J/kg]
    end type axial_gas_t

contains

    !> Pressure, at least `least`, and speed of sound.
    pure subroutine gas_state(gas, rho, products, energy, burnt, least, p, c)
        type(axial_gas_t), intent(in) :: gas
        real(dp), intent(in) :: rho !! density of all [kg/m3]
        real(dp), intent(in) :: products !! density of products, burnt or not [kg/m3]
        real(dp), intent(in) :: energy !! internal, per volume [J/m3]
        real(dp), intent(in) :: burnt !! part of the products, 0..1
        real(dp), intent(in) :: least !! [Pa]
        real(dp), intent(out) :: p !! [Pa]
        real(dp), intent(out) :: c !! [m/s]
        real(dp) :: lit, air, thermal, heat, cold, stiff, v, first, second

        lit = burnt*products
        air = max(rho - products, 0.0_dp)
        thermal = energy - (products - lit)*gas%held_back
        heat = 1/(gas%gamma - 1)
        if (air + lit > 1e-9_dp*rho) &
            heat = (air*heat + lit/gas%eos%omega)/(air + lit)
        cold = 0
        stiff = 0
        if (lit*spent > gas%eos%rho0*min(gas%eos%r1, gas%eos%r2)) then
            v = gas%eos%rho0/lit
            first = gas%eos%a*exp(-gas%eos%r1*v)
            second = gas%eos%b*exp(-gas%eos%r2*v)
            cold = first + second
            stiff = v*(gas%eos%r1*first + gas%eos%r2*second)
            thermal = thermal - (first/gas%eos%r1 + second/gas%eos%r2)/v
        end if
        p = max(cold + thermal/heat, least)
        c = sqrt(max(stiff + (1 + 1/heat)*(p - cold), p)/rho)
    end subroutine gas_state
end module brz_axial_products
