! SPDX-License-Identifier: MIT
!> Fluxes of a block of lines by Riemann problems between reconstructed primitive variables, the
!> lines as the vector.
!>
!> Both faces of a cell are reconstructed when its last neighbour has been read; the last four
!> or eight cells are kept.
module brz_air_riemann
    use brz_kinds, only: rk
    use brz_air_state, only: lines_per_block, n_ghost
    use brz_gas, only: to_primitive
    use brz_hllc, only: hllc_flux
    use brz_muscl, only: limited_slope
    use brz_reconstruction, only: thinness
    use brz_scheme, only: first_order, mixture_gamma, muscl_cells, reach_of, scheme_t, weno3_cells
    use brz_weno3, only: weno3
    use brz_weno5z, only: weno5z
    implicit none
    private
    public :: riemann_fluxes

    integer, parameter :: nb = lines_per_block
    integer, parameter :: most = 7 !! cell i is kept in place iand(i, mask), the mask at most this

contains

    !> Fluxes through all faces.
    pure subroutine riemann_fluxes(n, nv, scheme, q, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv, 1 - n_ghost:n + n_ghost) !! conserved variables
        real(rk), intent(inout) :: f(nb, nv, 0:n) !! flux through the face above each cell
        real(rk) :: w(nb, 5, 0:most), gamma(nb, 0:most), low(nb, 5), high(nb, 5, 0:1)
        integer :: i, c, mask, reach

        reach = reach_of(scheme)
        mask = merge(3, most, reach == 2)
        do i = 1 - reach, n + reach
            call take_cells(nv, scheme, q(1, 1, i), gamma(1, iand(i, mask)), w(1, 1, iand(i, mask)))
            c = i + 1 - reach
            if (c < 0) cycle
            call reconstruct(scheme, c, mask, w, low, high(1, 1, iand(c, 1)))
            if (c == 0) cycle
            call solve(scheme, gamma(1, iand(c - 1, mask)), high(1, 1, iand(c - 1, 1)), &
                gamma(1, iand(c, mask)), low, f(1, 1, max(c - 1, 0)))
        end do
    end subroutine riemann_fluxes

    !> Primitive variables and ratio of specific heats of one cell of each line.
    pure subroutine take_cells(nv, scheme, q, gamma, w)
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv) !! conserved variables
        real(rk), intent(inout) :: gamma(nb) !! ratio of specific heats [-]
        real(rk), intent(inout) :: w(nb, 5) !! density, velocity, pressure
        real(rk) :: state(5), primitive(5)
        integer :: l

        if (scheme%mixture) then
            do l = 1, nb
                gamma(l) = mixture_gamma(scheme, q(l, 6)/q(l, 1))
            end do
        else
            gamma = scheme%gamma
        end if
        do l = 1, nb
            state(1) = q(l, 1)
            state(2) = q(l, 2)
            state(3) = q(l, 3)
            state(4) = q(l, 4)
            state(5) = q(l, 5)
            call to_primitive(gamma(l), state, primitive)
            w(l, 1) = primitive(1)
            w(l, 2) = primitive(2)
            w(l, 3) = primitive(3)
            w(l, 4) = primitive(4)
            w(l, 5) = primitive(5)
        end do
    end subroutine take_cells

    !> Values at the two faces of cell i of the lines.
    pure subroutine reconstruct(scheme, i, mask, w, low, high)
        type(scheme_t), intent(in) :: scheme
        integer, intent(in) :: i !! cell
        integer, intent(in) :: mask !! of the places of cells
        real(rk), intent(in) :: w(nb, 5, 0:most) !! density, velocity, pressure
        real(rk), intent(inout) :: low(nb, 5), high(nb, 5) !! the same at the faces
        real(rk) :: half
        integer :: c, l, m(-2:2)

        m = iand([i - 2, i - 1, i, i + 1, i + 2], mask)
        do c = 1, 5
            select case (scheme%reconstruction)
            case (first_order)
                low(:, c) = w(:, c, m(0))
                high(:, c) = w(:, c, m(0))
            case (muscl_cells)
                do l = 1, nb
                    half = 0.5_rk*limited_slope(w(l, c, m(0)) - w(l, c, m(-1)), &
                        w(l, c, m(1)) - w(l, c, m(0)))
                    low(l, c) = w(l, c, m(0)) - half
                    high(l, c) = w(l, c, m(0)) + half
                end do
            case (weno3_cells)
                do l = 1, nb
                    low(l, c) = weno3(w(l, c, m(1)), w(l, c, m(0)), w(l, c, m(-1)), scheme%scale(c))
                    high(l, c) = weno3(w(l, c, m(-1)), w(l, c, m(0)), w(l, c, m(1)), &
                        scheme%scale(c))
                end do
            case default
                do l = 1, nb
                    low(l, c) = weno5z(w(l, c, m(2)), w(l, c, m(1)), w(l, c, m(0)), &
                        w(l, c, m(-1)), w(l, c, m(-2)))
                    high(l, c) = weno5z(w(l, c, m(-2)), w(l, c, m(-1)), w(l, c, m(0)), &
                        w(l, c, m(1)), w(l, c, m(2)))
                end do
            end select
        end do
        if (scheme%reconstruction >= weno3_cells) call flatten(w(1, 1, m(0)), low, high)
    end subroutine reconstruct

    !> Take cells as constant where a face would be thin.
    pure subroutine flatten(w, low, high)
        real(rk), intent(in) :: w(nb, 5) !! density, velocity, pressure
        real(rk), intent(inout) :: low(nb, 5), high(nb, 5) !! the same at the faces
        real(rk) :: thin(nb) ! a number: gcc vectorises tests of it better
        integer :: c, l

        do l = 1, nb
            thin(l) = max(thinness(w(l, 1), low(l, 1), high(l, 1)), &
                thinness(w(l, 5), low(l, 5), high(l, 5)))
        end do
        if (all(thin <= 0)) return
        do c = 1, 5
            do l = 1, nb
                low(l, c) = merge(w(l, c), low(l, c), thin(l) > 0)
                high(l, c) = merge(w(l, c), high(l, c), thin(l) > 0)
            end do
        end do
    end subroutine flatten

    !> Solve the Riemann problems of one face of each line.
    pure subroutine solve(scheme, gamma_below, below, gamma_above, above, f)
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: gamma_below(nb), gamma_above(nb) !! ratios of specific heats [-]
        real(rk), intent(in) :: below(nb, 5), above(nb, 5) !! density, velocity, pressure
        real(rk), intent(inout) :: f(nb, 5) !! flux
        integer :: l

        if (scheme%mixture) then
            do l = 1, nb
                call solve_lane(l, gamma_below(l), below, gamma_above(l), above, f)
            end do
        else
            do l = 1, nb
                call solve_lane(l, scheme%gamma, below, scheme%gamma, above, f)
            end do
        end if
    end subroutine solve

    !> Solve one Riemann problem.
    pure subroutine solve_lane(l, gamma_below, below, gamma_above, above, f)
        integer, intent(in) :: l !! line
        real(rk), intent(in) :: gamma_below, gamma_above !! ratios of specific heats [-]
        real(rk), intent(in) :: below(nb, 5), above(nb, 5) !! density, velocity, pressure
        real(rk), intent(inout) :: f(nb, 5) !! flux
        real(rk) :: a(5), b(5), flux(5)

        a(1) = below(l, 1)
        a(2) = below(l, 2)
        a(3) = below(l, 3)
        a(4) = below(l, 4)
        a(5) = below(l, 5)
        b(1) = above(l, 1)
        b(2) = above(l, 2)
        b(3) = above(l, 3)
        b(4) = above(l, 4)
        b(5) = above(l, 5)
        call hllc_flux(gamma_below, a, gamma_above, b, flux)
        f(l, 1) = flux(1)
        f(l, 2) = flux(2)
        f(l, 3) = flux(3)
        f(l, 4) = flux(4)
        f(l, 5) = flux(5)
    end subroutine solve_lane
end module brz_air_riemann
