! SPDX-License-Identifier: MIT
!> Fluxes through all faces of a block of lines, the lines as the vector.
!>
!> A cell is split or turned into what is reconstructed once; the last cells are kept, which is
!> what a face needs.
module brz_air_lines
    use brz_kinds, only: rk
    use brz_air_state, only: lines_per_block, n_ghost
    use brz_products, only: face_fraction
    use brz_scheme, only: first_order, mixture_gamma, scheme_t
    use brz_steger_warming, only: split_flux
    use brz_weno3, only: weno3
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

        call split_fluxes(n, nv, scheme, q, f)
        if (nv == 6) call products_fluxes(n, nv, scheme, q, f)
    end subroutine line_fluxes

    !> Fluxes by splitting; the reconstruction works on the split fluxes.
    pure subroutine split_fluxes(n, nv, scheme, q, f)
        integer, intent(in) :: n !! cells on a line
        integer, intent(in) :: nv !! conserved variables
        type(scheme_t), intent(in) :: scheme
        real(rk), intent(in) :: q(nb, nv, 1 - n_ghost:n + n_ghost) !! conserved variables
        real(rk), intent(out) :: f(nb, nv, 0:n) !! flux through the face above each cell
        real(rk) :: up(nb, 5, 0:3), down(nb, 5, 0:3), gamma(nb)
        integer :: below, c, i, l, s0, s1, s2, s3

        do i = -1, n + 2
            s3 = iand(i, 3)
            if (scheme%mixture) then
                do l = 1, nb
                    gamma(l) = mixture_gamma(scheme, q(l, 6, i)/q(l, 1, i))
                    call split_lane(l, gamma(l), q(:, :, i), up(:, :, s3), down(:, :, s3))
                end do
            else
                do l = 1, nb
                    call split_lane(l, scheme%gamma, q(:, :, i), up(:, :, s3), down(:, :, s3))
                end do
            end if
            if (i < 2) cycle ! the first three cells only fill the window
            below = max(i - 2, 0)
            s0 = iand(i - 3, 3)
            s1 = iand(i - 2, 3)
            s2 = iand(i - 1, 3)
            if (scheme%reconstruction == first_order) then
                f(:, 1:5, below) = up(:, :, s1) + down(:, :, s2)
                cycle
            end if
            do c = 1, 5
                do l = 1, nb
                    f(l, c, below) = weno3(up(l, c, s0), up(l, c, s1), up(l, c, s2), &
                        scheme%scale(c)) &
                        + weno3(down(l, c, s3), down(l, c, s2), down(l, c, s1), scheme%scale(c))
                end do
            end do
        end do
    end subroutine split_fluxes

    !> Split the flux of one cell of a block.
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
