! SPDX-License-Identifier: MIT
!> Which bricks of the air something has reached, and which must be computed (see brz_brick_items).
!> scripts/steps.py writes the same for the GPU.
module brz_brick_steps
    use brz_air_grid, only: brick, grid_of, grid_t, layers_around, rest_t
    use brz_air_state, only: air_t, bc_periodic
    use brz_brick_items, only: rows_of_brick
    use brz_brick_loops, only: each_look_at_row, each_settle_row, each_wake_near
    use brz_fetch, only: fetch !@cpu
    use brz_kinds, only: rk
    use brz_place_loops, only: each_pick_bytes, each_put_bytes
    use brz_ranks, only: several
    use brz_scheme, only: reach_of
    implicit none
    private
    public :: settle_bricks, wake_bricks

contains

    !> Mark what something has reached, and put the other bricks to rest, which are but for
    !> rounding. On a GPU those that hold solid are marked where walls are put there.
    subroutine settle_bricks(air)
        type(air_t), intent(inout) :: air
        type(rest_t) :: rest
        integer :: n

        rest%u = air%rest
        rest%momentum = epsilon(1.0_rk)*sqrt(air%scheme%gamma*air%p_rest*air%rho_rest)
        n = rows_of_brick*product(air%grid%bricks)
        call each_look_at_row(n, air%grid, rest, air%u, air%awake, air%reached)
        call each_settle_row(n, air%grid, air%awake, air%reached, air%u)
    end subroutine settle_bricks

    !> Awake are the reached bricks and those as near as a step reaches, those of other processes
    !> around the box as well.
    subroutine wake_bricks(air)
        type(air_t), intent(inout) :: air
        type(grid_t) :: near
        integer :: n, layers(3)

        n = product(air%grid%bricks)
        if (.not. several(air%part%ranks)) then
            layers = layers_around(air%n, air%bc(1, :) == bc_periodic, &
                                   air%n_stages*reach_of(air%scheme))
            call each_wake_near(n, air%grid, layers(1), layers(2), layers(3), air%reached, &
                                air%awake)
            return
        end if
        layers = layers_around(air%whole, air%outer(1, :) == bc_periodic, &
                               air%n_stages*reach_of(air%scheme))
        associate (whole => air%part%bricks%whole)
            near = grid_of(brick*(whole%hi - whole%lo + 1), air%g, air%n_var, real(air%dx, rk), &
                           air%bc, bc_periodic)
            call each_put_bytes(n, air%part%own, air%reached, air%part%reached)
            call fetch(air%part%ranks, air%part%bricks, whole%lo, whole%hi, air%part%reached) !@cpu
            !@gpu call gpu%bricks%others%bytes_of_others(gpu%bricks%near_reached)
            call each_wake_near(product(near%bricks), near, layers(1), layers(2), layers(3), &
                                air%part%reached, air%part%awake)
            call each_pick_bytes(n, air%part%own, air%part%awake, air%awake)
        end associate
    end subroutine wake_bricks
end module brz_brick_steps
