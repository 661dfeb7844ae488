! SPDX-License-Identifier: MIT
!> Where the cells of a Cartesian grid lie in memory: plain data for kernels. Point physics.
module brz_air_grid
    use brz_kinds, only: int64, rk
    implicit none
    private
    public :: grid_t, grid_of, place_of, variable_in_slot

    !> Arrays run over (1-g1:n1+g1, 1-g2:n2+g2, 1-g3:n3+g3, n_var).
    type :: grid_t
        integer :: n(3) !! cells
        integer :: g(3) !! ghost layers
        integer :: n_var !! conserved variables
        integer :: step(3) !! distance of neighbours in memory
        integer(int64) :: apart !! distance of two variables in memory
        real(rk) :: inverse_dx(3) !! 1/side of a cell, 0 in directions that are not modelled [1/m]
    end type grid_t

contains

    !> Grid of an array.
    pure function grid_of(n, g, n_var, dx) result(grid)
        integer, intent(in) :: n(3) !! cells
        integer, intent(in) :: g(3) !! ghost layers
        integer, intent(in) :: n_var !! conserved variables
        real(rk), intent(in) :: dx(3) !! sides of a cell [m]
        type(grid_t) :: grid

        grid%n = n
        grid%g = g
        grid%n_var = n_var
        grid%step = [1, n(1) + 2*g(1), (n(1) + 2*g(1))*(n(2) + 2*g(2))]
        grid%apart = int(grid%step(3), int64)*(n(3) + 2*g(3))
        grid%inverse_dx = merge(1/dx, 0.0_rk, n > 1)
    end function grid_of

    !> Place of a cell among the values of a variable, from 1.
    !@cuf attributes(host,device) &
    pure function place_of(grid, i, j, k) result(place)
        type(grid_t), intent(in) :: grid
        integer, intent(in) :: i, j, k !! cell
        integer(int64) :: place

        place = i + grid%g(1) + int(j + grid%g(2) - 1, int64)*grid%step(2) &
            + int(k + grid%g(3) - 1, int64)*grid%step(3)
    end function place_of

    !> Variable in a slot of a state turned into direction d, as the table `turned` has it.
    !@cuf attributes(host,device) &
    pure function variable_in_slot(slot, d) result(variable)
        integer, intent(in) :: slot !! 1: density, 2..4: momentum, normal first, 5, 6
        integer, intent(in) :: d !! direction
        integer :: variable

        variable = slot
        if (slot >= 2 .and. slot <= 4) variable = 2 + mod(slot + d - 3, 3)
    end function variable_in_slot
end module brz_air_grid
