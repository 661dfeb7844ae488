! SPDX-License-Identifier: MIT
!> Sums over all cells of the air, of all processes: the same bits whatever the threads do and
!> however many processes there are. Bricks are summed in order, and the bricks exactly.
module brz_air_totals
    use brz_air_grid, only: brick
    use brz_air_state, only: air_t
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, int64
    use brz_ranks, only: several, sum_of_all
    use brz_running_total, only: add_to_total, value_of, value_of_all
    implicit none
    private
    public :: cell_sums, sum_bricks, first_of_brick, outflow_of_all, counts_of_all
    public :: show_outflow, take_outflow

    integer, parameter :: few_numbers = 40000 !! fewer are not worth waking the other threads

contains

    !> Sums of the conserved variables over all cells, solid ones too, per volume of a cell.
    subroutine cell_sums(air, sums)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        real(dp), intent(out) :: sums(6) !! density, momentum, energy, products
        integer :: i, j, k, c, b, n_var, at(3)
        real(dp) :: total

        n_var = air%n_var
        !$omp parallel do collapse(2) schedule(static) private(i, j, k, at, total) &
        !$omp& if (size(air%rate) > few_numbers)
        do c = 1, n_var
            do b = 1, size(air%brick_sum, 2)
                at = first_of_brick(air, b)
                total = 0
                do k = at(3), min(at(3) + brick - 1, air%n(3))
                    do j = at(2), min(at(2) + brick - 1, air%n(2))
                        do i = at(1), min(at(1) + brick - 1, air%n(1))
                            total = total + air%u(i, j, k, c)
                        end do
                    end do
                end do
                air%brick_sum(c, b) = total
            end do
        end do
        !$omp end parallel do
        sums = 0
        call exact_sums(air%part%ranks, air%brick_sum(:n_var, :), sums(:n_var))
    end subroutine cell_sums

    !> Sum of what has been put into the first row of the sums of bricks.
    real(dp) function sum_bricks(air) result(total)
        type(air_t), intent(in) :: air
        real(dp) :: sums(1)

        call exact_sums(air%part%ranks, air%brick_sum(1:1, :), sums)
        total = sums(1)
    end function sum_bricks

    !> The first cell of a brick.
    pure function first_of_brick(air, b) result(at)
        type(air_t), intent(in) :: air
        integer, intent(in) :: b
        integer :: at(3), n(3)

        n = shape(air%reached)
        at(1) = modulo(b - 1, n(1))*brick + 1
        at(2) = modulo((b - 1)/n(1), n(2))*brick + 1
        at(3) = ((b - 1)/(n(1)*n(2)))*brick + 1
    end function first_of_brick

    !> What left through the outer faces of the grid so far, and the products in it [kg].
    subroutine outflow_of_all(air, outflow, products)
        type(air_t), intent(in) :: air
        real(dp), intent(out) :: outflow(5) !! mass, momentum, energy
        real(dp), intent(out) :: products
        integer :: c

        outflow = air%outflow
        products = air%outflow_products
        if (.not. several(air%part%ranks)) return
        do c = 1, 5
            outflow(c) = value_of_all(air%part%ranks, air%left(c))
        end do
        products = value_of_all(air%part%ranks, air%left(6))
    end subroutine outflow_of_all

    !> Bring the outflow of this process up to date as numbers.
    subroutine show_outflow(air)
        type(air_t), intent(inout) :: air
        integer :: c

        do c = 1, 5
            air%outflow(c) = value_of(air%left(c))
        end do
        air%outflow_products = value_of(air%left(6))
    end subroutine show_outflow

    !> After a restart: where the exact totals are not those of the outflow, as a GPU has gone on
    !> without them, they begin with it.
    subroutine take_outflow(air)
        type(air_t), intent(inout) :: air
        real(dp) :: now(6)
        integer :: c

        now = [air%outflow, air%outflow_products]
        do c = 1, 6
            if (abs(value_of(air%left(c)) - now(c)) <= 0) cycle
            air%left(c)%limb = 0
            call add_to_total(air%left(c), now(c))
        end do
    end subroutine take_outflow

    !> Faces that fell back and cells that were held so far.
    subroutine counts_of_all(air, faces, cells)
        type(air_t), intent(in) :: air
        integer(int64), intent(out) :: faces, cells
        integer(int64) :: counts(2)

        counts = [air%fallback_faces, air%held_cells]
        call sum_of_all(air%part%ranks, counts)
        faces = counts(1)
        cells = counts(2)
    end subroutine counts_of_all
end module brz_air_totals
