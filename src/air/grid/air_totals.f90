! SPDX-License-Identifier: MIT
!> Sums over all cells of the air, of all processes: the same bits whatever the threads do and
!> however many processes there are. Bricks are summed in order, and the bricks exactly.
module brz_air_totals
    use brz_air_grid, only: faces_of_bricks, grid_of, grid_t, stage_t
    use brz_air_state, only: air_t, bc_periodic, wall_t
    use brz_brick_loops, only: each_total_brick, for_each_sum_face
    use brz_cut_cells, only: cut_cells_t
    use brz_cut_sum_loops, only: for_each_cut_lack
    use brz_errors, only: error_t
    use brz_exact_sum, only: exact_sums
    use brz_kinds, only: dp, int64, int8, rk
    use brz_ranks, only: several, sum_of_all
    use brz_running_total, only: add_to_total, value_of, values_of_all
    implicit none
    private
    public :: air_totals, gas_sums, leave_out, outflow_of_all, counts_of_all
    public :: add_outflow, record_outflow, take_outflow

contains

    !> Sums over the gas cells, per volume of a cell; without walls over all cells.
    subroutine gas_sums(air, sums, wall)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        real(dp), intent(out) :: sums(0:6) !! kinetic energy, density, momentum, energy, products
        type(wall_t), intent(in), optional :: wall
        type(grid_t) :: grid
        integer :: n
        integer(int8), parameter :: none(1) = 0

        grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
        if (present(wall)) grid%walls = merge(2, 0, wall%present)
        n = (air%n_var + 1)*product(grid%bricks)
        if (grid%walls == 2) then
            call each_total_brick(n, grid, air%u, wall%solid, air%brick_sum)
        else
            call each_total_brick(n, grid, air%u, none, air%brick_sum)
        end if
        sums = 0
        call exact_sums(air%part%ranks, air%brick_sum, sums(:air%n_var))
    end subroutine gas_sums

    !> Mass, momentum and energy of the gas, of all processes; kinetic energy, products in it.
    subroutine air_totals(air, wall, gas, kinetic, products)
        type(air_t), intent(inout) :: air !! its sums of bricks are overwritten
        type(wall_t), intent(in) :: wall
        real(dp), intent(out) :: gas(5) !! [kg, kg m/s, J]
        real(dp), intent(out), optional :: kinetic !! [J]
        real(dp), intent(out), optional :: products !! of explosives [kg]
        real(dp) :: sums(0:6)
        type(error_t) :: none !! nothing fails on the host

        call gas_sums(air, sums, wall)
        if (wall%cells%present) call leave_out(air, wall%cells, sums, none)
        gas = sums(1:5)*product(air%dx)
        if (present(kinetic)) kinetic = sums(0)*product(air%dx)
        if (present(products)) products = sums(6)*product(air%dx)
    end subroutine air_totals

    !> Take out of sums over whole cells what cut cells do not hold, and add what waits in others.
    subroutine leave_out(air, cells, sums, err)
        type(air_t), intent(in) :: air
        type(cut_cells_t), intent(in) :: cells
        real(dp), intent(inout) :: sums(0:6) !! see gas_sums
        type(error_t), intent(inout) :: err
        real(dp) :: total(7)

        call for_each_cut_lack(air%on_gpu, cells%n, air%part%ranks, cells%nodes, air%n_var, &
                               cells%nodes%grid%apart, cells%cell, cells%place, cells%shut, &
                               cells%volume, cells%kept, air%u, total, err)
        sums = sums + total
    end subroutine leave_out

    !> What left through the outer faces of the grid so far, and the products in it [kg].
    subroutine outflow_of_all(air, outflow, products)
        type(air_t), intent(in) :: air
        real(dp), intent(out) :: outflow(5) !! mass, momentum, energy
        real(dp), intent(out) :: products
        real(dp) :: all(6)

        outflow = air%outflow
        products = air%outflow_products
        if (.not. several(air%part%ranks)) return
        call values_of_all(air%part%ranks, air%left, all)
        outflow = all(:5)
        products = all(6)
    end subroutine outflow_of_all

    !> Add up what leaves through the outer faces; on a GPU it is recorded when somebody asks.
    subroutine add_outflow(air, stage, err)
        type(air_t), intent(inout) :: air
        type(stage_t), intent(in) :: stage
        type(error_t), intent(inout) :: err
        integer :: faces

        if (.not. air%on_gpu) air%leaving = 0
        faces = faces_of_bricks(air%grid%n, air%grid%bricks)
        call for_each_sum_face(air%on_gpu, 2*air%n_var*faces, faces, air%grid, stage, air%edge, &
                               air%leaving, err)
        if (.not. air%on_gpu) call record_outflow(air)
    end subroutine add_outflow

    !> Add air%leaving to the outflow of this process, exactly: neither the order nor processes
    !> matter.
    subroutine record_outflow(air)
        type(air_t), intent(inout) :: air
        integer :: c, f, s

        do s = 1, 2
            do c = 1, air%n_var
                do f = 1, size(air%leaving, 1)
                    call add_to_total(air%left(c), air%leaving(f, c, s))
                end do
            end do
        end do
        do c = 1, 5
            air%outflow(c) = value_of(air%left(c))
        end do
        air%outflow_products = value_of(air%left(6))
    end subroutine record_outflow

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

        counts = [air%fallback_faces, air%limited_cells]
        call sum_of_all(air%part%ranks, counts)
        faces = counts(1)
        cells = counts(2)
    end subroutine counts_of_all
end module brz_air_totals
