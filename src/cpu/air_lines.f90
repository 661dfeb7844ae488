! SPDX-License-Identifier: MIT
!> Fluxes through all faces of a block of lines, the lines as the vector.
module brz_air_lines
    use brz_kinds, only: rk
    use brz_air_riemann, only: riemann_fluxes
    use brz_air_split, only: split_fluxes
    use brz_air_state, only: lines_per_block, n_ghost
    use brz_products, only: face_fraction
    use brz_scheme, only: first_order, hllc, scheme_t
    implicit none
    private
    public :: line_fluxes

    integer, parameter :: nb = lines_per_block

contains

    !> Fluxes through all faces of the lines of a block as if there were gas everywhere.
    pure subroutine line_fluxes(n, nv, scheme, q, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv, 1 - n_ghost:n + n_ghost) !! conserved variables
        real(rk), intent(out) :: f(nb, nv, 0:n) !! flux through the face above each cell

        if (scheme%flux == hllc) then
            call riemann_fluxes(n, nv, scheme, q, f)
        else
            call split_fluxes(n, nv, scheme, q, f)
        end if
        if (nv == 6) call products_fluxes(n, nv, scheme, q, f)
    end subroutine line_fluxes

    !> Fluxes of the products: the mass fluxes times the fraction that they carry.
    pure subroutine products_fluxes(n, nv, scheme, q, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv, 1 - n_ghost:n + n_ghost) !! conserved variables
        real(rk), intent(inout) :: f(nb, nv, 0:n) !! fluxes: the first is read, the sixth set
        real(rk) :: y(nb, 0:3)
        integer :: below, i, l, s0, s1, s2, s3

        do i = -1, n + 2
            s3 = iand(i, 3)
            y(:, s3) = q(:, 6, i)/q(:, 1, i)
            if (i < 2) cycle
            below = max(i - 2, 0)
            s0 = iand(i - 3, 3)
            s1 = iand(i - 2, 3)
            s2 = iand(i - 1, 3)
            if (scheme%reconstruction == first_order) then
                f(:, 6, below) = f(:, 1, below)*merge(y(:, s1), y(:, s2), f(:, 1, below) >= 0)
                cycle
            end if
            do l = 1, nb
                f(l, 6, below) = f(l, 1, below)*face_fraction(f(l, 1, below), y(l, s0), y(l, s1), &
                    y(l, s2), y(l, s3))
            end do
        end do
    end subroutine products_fluxes
end module brz_air_lines
