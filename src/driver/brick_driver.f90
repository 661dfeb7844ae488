! SPDX-License-Identifier: MIT
!> Which bricks of the air something has reached, and which must be computed (see
!> brz_brick_loop_bodies).
module brz_brick_driver
    use brz_air_backend, only: exchange_bricks
    use brz_air_grid, only: brick, grid_of, grid_t, layers_around, rest_t
    use brz_air_state, only: air_t, bc_periodic
    use brz_brick_loop_bodies, only: rows_of_brick
    use brz_brick_loops, only: for_each_look_at_row, for_each_settle_row, &
        for_each_wake_near
    use brz_errors, only: error_t
    use brz_kinds, only: rk
    use brz_place_loops, only: for_each_pick_bytes, for_each_put_bytes
    use brz_ranks, only: several
    use brz_scheme, only: reach_of
    implicit none
    private
    public :: settle_bricks, wake_bricks

contains

    !> Mark what something has reached, and put the other bricks to rest, which are but for
    !> rounding. On a GPU those that hold solid are marked where walls are put there.
    subroutine settle_bricks(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(rest_t) :: rest
        integer :: n

        rest%u = air%rest
        rest%momentum = epsilon(1.0_rk)*sqrt(air%scheme%gamma*air%p_rest*air%rho_rest)
        n = rows_of_brick*product(air%grid%bricks)
        call for_each_look_at_row(air%on_gpu, n, air%grid, rest, air%u, air%active, air%reached, &
            err)
        call for_each_settle_row(air%on_gpu, n, air%grid, air%active, air%reached, air%u, err)
    end subroutine settle_bricks

    !> Active are the reached bricks and those as near as a step reaches, those of other processes
    !> around the box as well.
    subroutine wake_bricks(air, err)
        type(air_t), intent(inout) :: air
        type(error_t), intent(inout) :: err
        type(grid_t) :: near
        integer :: n, layers(3)

        n = product(air%grid%bricks)
        if (.not. several(air%part%ranks)) then
            layers = layers_around(air%n, air%bc(1, :) == bc_periodic, &
                                   air%n_stages*reach_of(air%scheme))
            call for_each_wake_near(air%on_gpu, n, air%grid, layers(1), layers(2), layers(3), &
                air%reached, air%active, err)
            return
        end if
        layers = layers_around(air%whole, air%outer(1, :) == bc_periodic, &
                               air%n_stages*reach_of(air%scheme))
        associate (whole => air%part%bricks%whole)
            near = grid_of(brick*(whole%hi - whole%lo + 1), air%g, air%n_var, real(air%dx, rk), &
                           air%bc, bc_periodic)
            call for_each_put_bytes(air%on_gpu, n, air%part%own, air%reached, air%part%reached, err)
            call exchange_bricks(air, err)
            call for_each_wake_near(air%on_gpu, product(near%bricks), near, layers(1), layers(2), &
                layers(3), air%part%reached, air%part%active, err)
            call for_each_pick_bytes(air%on_gpu, n, air%part%own, air%part%active, air%active, err)
        end associate
    end subroutine wake_bricks
end module brz_brick_driver
