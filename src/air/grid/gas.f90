! SPDX-License-Identifier: MIT
!> Ideal gas: pressure, sound speed, and the way between conserved and primitive variables.
!>
!> Conserved: density, momentum (3), total energy per volume. Primitive: density, velocity (3),
!> pressure. The three vector components may be in any order. Point physics: compiled for the CPU
!> and for the GPU.
module brz_gas
    use brz_kinds, only: rk
    implicit none
    private
    public :: pressure, sound_speed, wave_rate, to_primitive, to_conserved, mirror

contains

    !> Pressure p = (gamma - 1)(E - rho v^2/2) [Pa]; negative where the state is unphysical.
    !@cuf attributes(host,device) &
    pure function pressure(gamma, q) result(p)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: q(5) !! conserved variables
        real(rk) :: p

        p = (gamma - 1)*(q(5) - (q(2)*q(2) + q(3)*q(3) + q(4)*q(4))/(2*q(1)))
    end function pressure

    !> Sound speed [m/s]; zero where the pressure is negative.
    !@cuf attributes(host,device) &
    pure function sound_speed(gamma, rho, p) result(c)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: rho !! density [kg/m3]
        real(rk), intent(in) :: p !! pressure [Pa]
        real(rk) :: c

        c = sqrt(gamma*max(p, 0.0_rk)/rho)
    end function sound_speed

    !> Sum of (|u_d| + c)/dx_d over the directions [1/s]; c = 0 where the pressure is negative.
    !@cuf attributes(host,device) &
    pure function wave_rate(gamma, rho, m1, m2, m3, energy, inverse_dx) result(rate)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: rho, m1, m2, m3, energy !! conserved variables
        real(rk), intent(in) :: inverse_dx(3) !! 1/side of a cell, 0 where not modelled [1/m]
        real(rk) :: rate, c2, volume

        volume = 1/rho
        c2 = gamma*(gamma - 1)*(energy - 0.5_rk*(m1*m1 + m2*m2 + m3*m3)*volume)*volume
        rate = (abs(m1)*inverse_dx(1) + abs(m2)*inverse_dx(2) + abs(m3)*inverse_dx(3))*volume &
               + sqrt(max(c2, 0.0_rk))*(inverse_dx(1) + inverse_dx(2) + inverse_dx(3))
    end function wave_rate

    !> Density, velocity and pressure of a conserved state.
    !@cuf attributes(host,device) &
    pure subroutine to_primitive(gamma, q, w)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: q(5) !! conserved variables
        real(rk), intent(out) :: w(5) !! density, velocity, pressure
        real(rk) :: volume

        volume = 1/q(1)
        w(1) = q(1)
        w(2) = q(2)*volume
        w(3) = q(3)*volume
        w(4) = q(4)*volume
        w(5) = (gamma - 1)*(q(5) - 0.5_rk*(q(2)*w(2) + q(3)*w(3) + q(4)*w(4)))
    end subroutine to_primitive

    !> Conserved state of density, velocity and pressure.
    !@cuf attributes(host,device) &
    pure subroutine to_conserved(gamma, w, q)
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: w(5) !! density, velocity, pressure
        real(rk), intent(out) :: q(5) !! conserved variables

        q(1) = w(1)
        q(2) = w(1)*w(2)
        q(3) = w(1)*w(3)
        q(4) = w(1)*w(4)
        q(5) = w(5)/(gamma - 1) + w(1)*(w(2)*w(2) + w(3)*w(3) + w(4)*w(4))/2
    end subroutine to_conserved

    !> Mirror image of a state in a wall that moves: same density, pressure and tangential
    !> velocity, normal velocity 2 v - u. Exact where the wall is at rest.
    !@cuf attributes(host,device) &
    pure subroutine mirror(q, v, image)
        real(rk), intent(in) :: q(5) !! conserved variables, normal momentum in slot 2
        real(rk), intent(in) :: v !! normal velocity of the wall [m/s]
        real(rk), intent(out) :: image(5) !! conserved variables behind the wall

        image(1) = q(1)
        image(2) = 2*v*q(1) - q(2)
        image(3) = q(3)
        image(4) = q(4)
        image(5) = q(5) + 2*v*(v*q(1) - q(2))
    end subroutine mirror
end module brz_gas
