! SPDX-License-Identifier: MIT
!> One solid cell in the coupling of Chen et al. as printed: what gas it is filled with, and the
!> force on its particles. Point physics: compiled for the CPU and for the GPU.
!>
!> Source: Chen et al., Eq. 26-30. The state of solid cells that touch no gas is not given there;
!> they hold air at rest, moving with the solid.
module brz_paper_rules
    use brz_kinds, only: rk
    use brz_scheme, only: max_var
    implicit none
    private
    public :: add_neighbour, filled_state, paper_force

contains

    !> Add a gas cell to the means by inverse distance (Eq. 30).
    !@cuf attributes(host,device) &
    pure subroutine add_neighbour(u, distance, sums)
        real(rk), intent(in) :: u(max_var) !! conserved variables of the gas cell
        real(rk), intent(in) :: distance !! to it, in cells
        real(rk), intent(inout) :: sums(4)
        !! weight; density, specific internal energy and share of products times weight
        real(rk) :: weight, inner

        weight = 1/distance
        inner = (u(5) - (u(2)*u(2) + u(3)*u(3) + u(4)*u(4))/(2*u(1)))/u(1)
        sums(1) = sums(1) + weight
        sums(2) = sums(2) + weight*u(1)
        sums(3) = sums(3) + weight*inner
        sums(4) = sums(4) + weight*(u(6)/u(1))
    end subroutine add_neighbour

    !> Conserved variables of a solid cell: means of the gas, velocity of the solid (Eq. 26).
    !@cuf attributes(host,device) &
    pure subroutine filled_state(sums, v, u)
        real(rk), intent(in) :: sums(4) !! from add_neighbour
        real(rk), intent(in) :: v(3) !! mean velocity of the particles
        real(rk), intent(out) :: u(max_var)
        integer :: i

        u(1) = sums(2)/sums(1)
        do i = 1, 3
            u(1 + i) = u(1)*v(i)
        end do
        u(5) = u(1)*(sums(3)/sums(1) + (v(1)*v(1) + v(2)*v(2) + v(3)*v(3))/2)
        u(6) = u(1)*sums(4)/sums(1)
    end subroutine filled_state

    !> Force on the solid of a cell over its volume (Eq. 27, with rates as d/dt of the gas).
    !@cuf attributes(host,device) &
    pure subroutine paper_force(rate, v, force)
        real(rk), intent(in) :: rate(4) !! of density and momentum, as if the cell held gas
        real(rk), intent(in) :: v(3) !! mean velocity of the particles
        real(rk), intent(out) :: force(3) !! [N/m3]
        integer :: i

        do i = 1, 3
            force(i) = rate(1 + i) - v(i)*rate(1)
        end do
    end subroutine paper_force
end module brz_paper_rules
