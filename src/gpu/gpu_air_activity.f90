! SPDX-License-Identifier: MIT
!> Which bricks of the air on the GPU must be computed: see brz_air_activity. The maps stay there.
module brz_gpu_air_activity
    use brz_air_grid, only: rest_t
    use brz_air_state, only: air_t
    use brz_place_launches, only: place_kernels
    use brz_brick_launches, only: brick_kernels
    use brz_air_launches, only: air_kernels
    use brz_errors, only: error_t
    use brz_gpu_air_state, only: gpu_air_t
    use brz_kinds, only: rk
    use brz_ranks, only: several
    implicit none
    private
    public :: find_awake_bricks

contains

    !> Bring the maps of reached and awake bricks up to date. At the start of a step.
    !>
    !> The first step is computed everywhere, so that all states and fluxes hold gas at rest.
    subroutine find_awake_bricks(gpu, air, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(air_t), intent(in) :: air
        type(error_t), intent(inout) :: err
        type(rest_t) :: rest
        integer :: columns(3)

        rest%u = air%rest
        rest%momentum = epsilon(1.0_rk)*sqrt(air%scheme%gamma*air%p_rest*air%rho_rest)
        columns = [air%n(1:2), gpu%grid%bricks(3)]
        call air_kernels%air_look(columns, gpu%grid, rest, gpu%u, gpu%bricks%awake, &
                                  gpu%bricks%reached, err)
        call air_kernels%air_settle(columns, gpu%grid, gpu%bricks%awake, gpu%bricks%reached, &
                                    gpu%u, err)
        if (air%activity .and. gpu%bricks%swept) then
            associate (bricks => gpu%bricks, layers => gpu%bricks%layers)
                if (several(air%part%ranks)) then
                    call wake_from_others(gpu, err)
                else
                    call brick_kernels%wake_near(product(gpu%grid%bricks), gpu%grid, layers(1), &
                                               layers(2), layers(3), bricks%reached, &
                                               bricks%awake, err)
                end if
            end associate
        end if
        gpu%bricks%swept = .true.
    end subroutine find_awake_bricks

    !> Awake are the reached bricks and those as near as a step reaches, those of other processes
    !> around the box as well.
    subroutine wake_from_others(gpu, err)
        type(gpu_air_t), intent(inout) :: gpu
        type(error_t), intent(inout) :: err
        integer :: n

        n = product(gpu%grid%bricks)
        associate (bricks => gpu%bricks, layers => gpu%bricks%layers)
            call place_kernels%put_bytes(n, bricks%own, bricks%reached, bricks%near_reached, err)
            call bricks%others%bytes_of_others(bricks%near_reached, err)
            call brick_kernels%wake_near(product(bricks%grid%bricks), bricks%grid, layers(1), &
                                       layers(2), layers(3), bricks%near_reached, &
                                       bricks%near_awake, err)
            call place_kernels%pick_bytes(n, bricks%own, bricks%near_awake, bricks%awake, err)
        end associate
    end subroutine wake_from_others
end module brz_gpu_air_activity
