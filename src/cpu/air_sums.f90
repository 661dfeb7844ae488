! SPDX-License-Identifier: MIT
!> The stable time step of the air.
module brz_air_sums
    use brz_air_activity, only: next_run
    use brz_kinds, only: dp, int8, rk
    use brz_air_grid, only: grid_of, grid_t
    use brz_air_state, only: air_t, bc_periodic, brick, cell_gamma, wall_t
    use brz_gas, only: wave_rate
    use brz_load_loops, only: each_wall_speed
    use brz_ranks, only: least_of_all
    implicit none
    private
    public :: air_time_step

    integer, parameter :: few_numbers = 40000 !! fewer are not worth waking the other threads

contains

    !> Largest stable time step: cfl over the largest sum_d (|u_d| + c)/dx_d of all gas cells of all
    !> processes.
    !>
    !> Walls count with their speed. The first steps of a blast need a smaller step,
    !> see time_step_ramp. Cells that are not numbers are left out: air_step reports them.
    real(dp) function air_time_step(air, wall, cfl)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        real(dp), intent(in) :: cfl !! Courant number [-]
        real(rk) :: fastest, inverse(3)
        real(dp) :: least(1)
        type(grid_t) :: grid
        integer :: j, k, at(3)

        inverse = merge(real(1/air%dx, rk), 0.0_rk, air%n > 1)
        fastest = 0
        at = findloc(air%active, 0_int8)
        if (at(1) > 0) fastest = fastest_of_row(air, wall, (at - 1)*brick + 1, 1, inverse)
        !$omp parallel do collapse(2) schedule(static) reduction(max: fastest) &
        !$omp& if (size(air%rate) > few_numbers)
        do k = 1, air%n(3)
            do j = 1, air%n(2)
                fastest = max(fastest, fastest_active(air, wall, j, k, inverse))
            end do
        end do
        !$omp end parallel do
        if (wall%present) then
            grid = grid_of(air%n, air%g, air%n_var, real(air%dx, rk), air%bc, bc_periodic)
            if (wall%cells%present) then
                call each_wall_speed(wall%cells%n, grid, wall%cells%v, fastest)
            else
                call each_wall_speed(wall%filled%n, grid, wall%filled%v, fastest)
            end if
        end if
        least = cfl/fastest
        call least_of_all(air%part%ranks, least)
        air_time_step = least(1)
    end function air_time_step

    !> Largest sum_d (|u_d| + c)/dx_d of the active cells of one row along x.
    pure real(rk) function fastest_active(air, wall, j, k, inverse)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: j, k !! row
        real(rk), intent(in) :: inverse(3) !! 1/dx of the directions that are modelled [1/m]
        integer :: lo, hi

        fastest_active = 0
        hi = 0
        do
            call next_run(air%active(:, (j - 1)/brick + 1, (k - 1)/brick + 1), air%n(1), lo, hi)
            if (lo > air%n(1)) exit
            fastest_active = max(fastest_active, &
                fastest_of_row(air, wall, [lo, j, k], hi - lo + 1, inverse))
        end do
    end function fastest_active

    !> Largest sum_d (|u_d| + c)/dx_d of some gas cells in a row along x.
    pure real(rk) function fastest_of_row(air, wall, first, n, inverse)
        type(air_t), intent(in) :: air
        type(wall_t), intent(in) :: wall
        integer, intent(in) :: first(3) !! the first of them
        integer, intent(in) :: n !! how many
        real(rk), intent(in) :: inverse(3) !! 1/dx of the directions that are modelled [1/m]
        real(rk) :: gamma, speed
        integer :: i, j, k, last
        logical :: has_solid

        j = first(2)
        k = first(3)
        last = first(1) + n - 1
        has_solid = .false.
        if (wall%present) has_solid = any(wall%solid(first(1):last, j, k) /= 0)
        fastest_of_row = 0
        gamma = air%scheme%gamma
        do i = first(1), last
            if (has_solid) then
                if (wall%solid(i, j, k) /= 0) cycle
            end if
            if (air%scheme%mixture) gamma = cell_gamma(air, i, j, k)
            speed = wave_rate(gamma, air%u(i, j, k, 1), air%u(i, j, k, 2), air%u(i, j, k, 3), &
                              air%u(i, j, k, 4), air%u(i, j, k, 5), inverse)
            if (speed > fastest_of_row) fastest_of_row = speed
        end do
    end function fastest_of_row
end module brz_air_sums
