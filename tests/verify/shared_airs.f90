! SPDX-License-Identifier: MIT
!> Airs that several processes share, for tests that compare them with the same air of one.
module shared_airs
    use brz_air_setup, only: make_grid
    use brz_air_state, only: air_t, bc_outflow, bc_periodic, bc_symmetry, bc_wall
    use brz_gas, only: to_conserved
    use brz_kinds, only: dp, int32, int64, rk
    use brz_ranks, only: sum_of_all
    use brz_scheme, only: first_order, hllc, muscl_cells, steger_warming, weno3_cells, weno5z_cells
    implicit none
    private
    public :: methods, make_burst, make_wild, differing

    integer, parameter :: methods = 7
    integer, parameter :: method(2, methods) = reshape([first_order, steger_warming, muscl_cells, &
        steger_warming, weno3_cells, steger_warming, weno5z_cells, steger_warming, muscl_cells, &
        hllc, weno3_cells, hllc, weno5z_cells, hllc], [2, methods])
    integer, parameter :: bounds(2, 3, 2) = reshape([bc_symmetry, bc_outflow, bc_periodic, &
        bc_periodic, bc_wall, bc_outflow, bc_outflow, bc_wall, bc_outflow, bc_symmetry, &
        bc_periodic, bc_periodic], [2, 3, 2])

contains

    !> A hot spot that bursts over the borders of boxes.
    subroutine make_burst(air, m, cells, products, middle)
        type(air_t), intent(inout) :: air !! with its processes
        integer, intent(in) :: m !! scheme
        integer, intent(in) :: cells(3)
        logical, intent(in) :: products
        integer, intent(in), optional :: middle !! cell along x, else that of the grid
        integer :: i, j, k, at(3), spot(3)

        air%scheme%reconstruction = method(1, m)
        air%scheme%flux = method(2, m)
        air%n_stages = merge(2, 3, m == 5)
        air%bc = bounds(:, :, 1 + modulo(m, 2))
        if (products) then
            air%n_var = 6
            air%scheme%mixture = .true.
            air%scheme%gamma_products = 1.3_rk
        end if
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], 0.01_dp*cells, cells, air)
        spot = (cells + 1)/2
        if (present(middle)) spot(1) = middle
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    at = [i, j, k] + air%before
                    if (any(abs(at - spot) > 3 .and. cells > 1)) cycle
                    air%u(i, j, k, 5) = 300*air%u(i, j, k, 5)
                    air%u(i, j, k, 1) = 10*air%u(i, j, k, 1)
                    air%u(i, j, k, 2) = 20*at(1)
                    if (products) air%u(i, j, k, 6) = air%u(i, j, k, 1)
                end do
            end do
        end do
    end subroutine make_burst

    !> Gas of which no two cells are alike, and many are nearly empty.
    subroutine make_wild(air, m)
        type(air_t), intent(inout) :: air !! with its processes
        integer, intent(in) :: m
        integer :: i, j, k, c, at(3), cells(3)
        real(rk) :: q(6), x(5)

        cells = [16, 19, 8]
        air%scheme%reconstruction = merge(weno5z_cells, muscl_cells, m == 1)
        air%scheme%flux = hllc
        air%bc = bounds(:, :, m)
        call make_grid([0.0_dp, 0.0_dp, 0.0_dp], 0.01_dp*cells, cells, air)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                do i = 1, air%n(1)
                    at = [i, j, k] + air%before
                    x = [(sin(real(12.9_dp*at(1) + 78.2_dp*at(2) + 37.7_dp*at(3) + 5*c**2, rk)), &
                          c=1, 5)]
                    call to_conserved(air%scheme%gamma, [air%rho_rest*10**(2*x(1)), 3000*x(2), &
                        3000*x(3), 3000*x(4), air%p_rest*10**(3*x(5))], q)
                    air%u(i, j, k, :) = q(:5)
                end do
            end do
        end do
    end subroutine make_wild

    !> Cells of which a bit differs, in all processes.
    integer function differing(shared, alone) result(n)
        type(air_t), intent(in) :: shared, alone
        integer(int64) :: wrong(1)
        integer :: i, j, k

        wrong = 0
        do k = 1, shared%n(3)
            do j = 1, shared%n(2)
                do i = 1, shared%n(1)
                    associate (at => [i, j, k] + shared%before)
                        if (any(transfer(shared%u(i, j, k, :), [0_int32]) /= &
                                transfer(alone%u(at(1), at(2), at(3), :), [0_int32]))) &
                            wrong = wrong + 1
                    end associate
                end do
            end do
        end do
        call sum_of_all(shared%part%ranks, wrong)
        n = int(wrong(1))
    end function differing
end module shared_airs
