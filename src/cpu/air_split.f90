! SPDX-License-Identifier: MIT
!> Fluxes of a block of lines by splitting, the lines as the vector.
!>
!> Each cell is split once; the last four or eight cells are kept, as the stencil of a face needs.
module brz_air_split
    use brz_kinds, only: rk
    use brz_air_state, only: lines_per_block, n_ghost
    use brz_muscl, only: muscl
    use brz_scheme, only: first_order, mixture_gamma, muscl_cells, reach_of, scheme_t, weno3_cells
    use brz_steger_warming, only: split_flux
    use brz_weno3, only: weno3
    use brz_weno5z, only: weno5z
    implicit none
    private
    public :: split_fluxes

    integer, parameter :: nb = lines_per_block
    integer, parameter :: most = 7 !! cell i is kept in place iand(i, mask), the mask at most this

contains

    !> Fluxes through all faces; the reconstruction works on the split fluxes.
    pure subroutine split_fluxes(n, nv, scheme, q, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv, 1 - n_ghost:n + n_ghost) !! conserved variables
        real(rk), intent(inout) :: f(nb, nv, 0:n) !! flux through the face above each cell
        real(rk) :: up(nb, 5, 0:most), down(nb, 5, 0:most)
        integer :: i, mask, reach

        reach = reach_of(scheme)
        mask = merge(3, most, reach == 2)
        do i = 1 - reach, n + reach
            call split_cells(nv, scheme, q(1, 1, i), up(1, 1, iand(i, mask)), &
                down(1, 1, iand(i, mask)))
            if (i >= reach) call join(scheme, i - reach, mask, up, down, f(1, 1, max(i - reach, 0)))
        end do
    end subroutine split_fluxes

    !> Split the fluxes of one cell of each line.
    pure subroutine split_cells(nv, scheme, q, up, down)
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv) !! conserved variables
        real(rk), intent(inout) :: up(nb, 5), down(nb, 5) !! split fluxes
        real(rk) :: gamma
        integer :: l

        if (scheme%mixture) then
            do l = 1, nb
                gamma = mixture_gamma(scheme, q(l, 6)/q(l, 1))
                call split_lane(l, gamma, q, up, down)
            end do
        else
            do l = 1, nb
                call split_lane(l, scheme%gamma, q, up, down)
            end do
        end if
    end subroutine split_cells

    !> Split the flux of one cell.
    pure subroutine split_lane(l, gamma, q, up, down)
        integer, intent(in) :: l !! line
        real(rk), intent(in) :: gamma !! ratio of specific heats [-]
        real(rk), intent(in) :: q(nb, 5) !! conserved variables
        real(rk), intent(inout) :: up(nb, 5), down(nb, 5) !! split fluxes
        real(rk) :: state(5), plus(5), minus(5)

        state(1) = q(l, 1)
        state(2) = q(l, 2)
        state(3) = q(l, 3)
        state(4) = q(l, 4)
        state(5) = q(l, 5)
        call split_flux(gamma, state, plus, minus)
        up(l, 1) = plus(1)
        up(l, 2) = plus(2)
        up(l, 3) = plus(3)
        up(l, 4) = plus(4)
        up(l, 5) = plus(5)
        down(l, 1) = minus(1)
        down(l, 2) = minus(2)
        down(l, 3) = minus(3)
        down(l, 4) = minus(4)
        down(l, 5) = minus(5)
    end subroutine split_lane

    !> Fluxes through the faces above cell b of the lines.
    pure subroutine join(scheme, b, mask, up, down, f)
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: b !! cell below the face
        integer, intent(in) :: mask !! of the places of cells
        real(rk), intent(in) :: up(nb, 5, 0:most), down(nb, 5, 0:most) !! split fluxes
        real(rk), intent(inout) :: f(nb, 5)
        integer :: c, l, m(-2:3)

        m = iand([b - 2, b - 1, b, b + 1, b + 2, b + 3], mask)
        do c = 1, 5
            select case (scheme%reconstruction)
            case (first_order)
                do l = 1, nb
                    f(l, c) = up(l, c, m(0)) + down(l, c, m(1))
                end do
            case (muscl_cells)
                do l = 1, nb
                    f(l, c) = muscl(up(l, c, m(-1)), up(l, c, m(0)), up(l, c, m(1))) &
                        + muscl(down(l, c, m(2)), down(l, c, m(1)), down(l, c, m(0)))
                end do
            case (weno3_cells)
                do l = 1, nb
                    f(l, c) = weno3(up(l, c, m(-1)), up(l, c, m(0)), up(l, c, m(1)), &
                        scheme%scale(c)) &
                        + weno3(down(l, c, m(2)), down(l, c, m(1)), down(l, c, m(0)), &
                        scheme%scale(c))
                end do
            case default
                do l = 1, nb
                    f(l, c) = weno5z(up(l, c, m(-2)), up(l, c, m(-1)), up(l, c, m(0)), &
                        up(l, c, m(1)), up(l, c, m(2))) &
                        + weno5z(down(l, c, m(3)), down(l, c, m(2)), down(l, c, m(1)), &
                        down(l, c, m(0)), down(l, c, m(-1)))
                end do
            end select
        end do
    end subroutine join
end module brz_air_split
