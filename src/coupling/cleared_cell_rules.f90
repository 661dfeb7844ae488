! SPDX-License-Identifier: MIT
!> The surroundings of a freshly cleared cell, one that the solid has left. Point physics: compiled
!> for the CPU and for the GPU.
module brz_cleared_cell_rules
    use brz_cell_shells, only: touching
    use brz_gas, only: to_primitive
    use brz_kinds, only: rk
    use brz_wall_riemann, only: wall_star
    implicit none
    private
    public :: surrounding_t, no_gas, add_gas, mean_gas

    !> Sums over the gas cells of a shell, then their means.
    type :: surrounding_t
        integer :: n !! gas cells
        real(rk) :: w(6) !! density, velocity, pressure, products' share
        real(rk) :: follows !! density that can keep up with the solid over that of the gas
        logical :: normal(3) !! directions in which the cell moves with the solid
    end type surrounding_t

contains

    !> Empty sums for a shell.
    !@cuf attributes(host,device) &
    pure subroutine no_gas(shell, s)
        integer, intent(in) :: shell !! by distance, from 1
        type(surrounding_t), intent(out) :: s
        integer :: d

        s%n = 0
        s%follows = 0
        do d = 1, 6
            s%w(d) = 0
        end do
        do d = 1, 3
            s%normal(d) = shell > 1
        end do
    end subroutine no_gas

    !> Add a gas cell to the sums.
    !>
    !> In the first shell the density at the wall that leaves the gas counts for `follows`; behind
    !> it all of it where the shell touches the cell, none farther out.
    !@cuf attributes(host,device) &
    pure subroutine add_gas(shell, offset, gamma, u, v, s)
        integer, intent(in) :: shell !! by distance, from 1
        integer, intent(in) :: offset(3) !! from the cell to the gas
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: u(6) !! the gas, conserved variables
        real(rk), intent(in) :: v(3) !! velocity of the solid that left [m/s]
        type(surrounding_t), intent(inout) :: s
        real(rk) :: q(5), thin, du, p, rho
        integer :: c

        call to_primitive(gamma, u, q)
        do c = 1, 5
            s%w(c) = s%w(c) + q(c)
        end do
        s%w(6) = s%w(6) + u(6)/q(1)
        s%n = s%n + 1
        thin = merge(1.0_rk, 0.0_rk, shell <= touching)
        if (shell == 1) then
            du = 0
            do c = 1, 3
                du = du + (v(c) - q(1 + c))*offset(c)
                s%normal(c) = s%normal(c) .or. offset(c) /= 0
            end do
            call wall_star(gamma, q(1), q(5), min(du, 0.0_rk), p, rho)
            thin = rho/q(1)
        end if
        s%follows = s%follows + thin
    end subroutine add_gas

    !> Means of the sums; across the faces to the gas the velocity is that of the solid that left.
    !@cuf attributes(host,device) &
    pure subroutine mean_gas(v, s)
        real(rk), intent(in) :: v(3) !! [m/s]
        type(surrounding_t), intent(inout) :: s
        integer :: c

        do c = 1, 6
            s%w(c) = s%w(c)/s%n
        end do
        s%follows = s%follows/s%n
        do c = 1, 3
            if (s%normal(c)) s%w(1 + c) = v(c)
        end do
    end subroutine mean_gas
end module brz_cleared_cell_rules
